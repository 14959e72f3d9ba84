//! How many eigenvalues a sparse symmetric matrix has on either side of zero.
//!
//! ```text
//! P (A + E) P^T = L D L^T       A + E and D have as many negative eigenvalues (Sylvester)
//! ```
//! `A` a [`SymmetricMatrix`] (n x n), `E` what rounding made of it. Elimination without exchanges may
//! break down on a matrix that is perfectly regular, so the signs of D are not believed by
//! themselves: A and A + E have the same count if `(A + E)^-1 E` shortens every vector, for then no
//! matrix on the way from one to the other is singular. That is measured, by power iteration on random
//! vectors; where it shortens them by less than half the count is refused.
//!
//! Counts for `A - mu M` say how many eigenvalues of `A v = lambda M v` lie below mu.

use std::sync::Arc;

use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::{
    LdltRef, SymbolicCholesky, SymbolicCholeskyRaw, supernodal::SupernodalLdltRef,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::cholesky::SparseCholesky;
use crate::sparse::pattern::Pattern;
use crate::sparse::scratch::Scratch;
use crate::{SplitMix64, first_non_finite};

/// Numbers of eigenvalues by their sign. A count that was not refused has no zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inertia {
    /// How many are negative.
    pub negative: usize,
    /// How many are positive.
    pub positive: usize,
}

/// The order and memory of counts for matrices of one pattern.
#[derive(Clone, Debug)]
pub struct SparseInertia {
    pattern: Arc<Pattern>,
    symbolic: Arc<SymbolicCholesky<u32>>,
    factor: Vec<f64>,
    scratch: Scratch,
    vector: Vec<f64>,
    product: Vec<f64>,
}

/// Steps of the power iteration, and vectors that it starts from.
const POWERS: u32 = 6;
const STARTS: u64 = 3;
/// A vector must be shortened at least this much.
const SHORTENED: f64 = 0.5;

impl SparseInertia {
    /// Takes all memory for matrices of the pattern of `analysed`, and its order of elimination.
    pub fn new(analysed: &SparseCholesky) -> Result<Self, SparseError> {
        let symbolic = Arc::clone(analysed.symbolic());
        let n = symbolic.nrows();
        let scratch = Scratch::new(
            n,
            &[
                symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default()),
                symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            ],
        )?;
        Ok(SparseInertia {
            pattern: Arc::clone(analysed.pattern()),
            factor: vec![0.0; symbolic.len_val()],
            symbolic,
            scratch,
            vector: vec![0.0; n],
            product: vec![0.0; n],
        })
    }

    /// The counts of a matrix of the analysed pattern.
    ///
    /// # Errors
    /// [`SparseError::Singular`] where the matrix is too close to a singular one for a count.
    pub fn count(&mut self, matrix: &SymmetricMatrix) -> Result<Inertia, SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        if first_non_finite(matrix.values()).is_some() {
            return Err(SparseError::NonFinite);
        }
        let factored = self.symbolic.factorize_numeric_ldlt(
            &mut self.factor,
            matrix.lower(),
            Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
        if factored.is_err() || !(0..STARTS).all(|start| self.shortens(matrix, start)) {
            return Err(SparseError::Singular);
        }
        let negative = self.pivots().filter(|&pivot| pivot < 0.0).count();
        Ok(Inertia { negative, positive: matrix.dim() - negative })
    }

    /// Whether `(A + E)^-1 E` shortens what a random vector becomes under its powers.
    fn shortens(&mut self, matrix: &SymmetricMatrix, start: u64) -> bool {
        let mut random = SplitMix64::new(start);
        self.vector.iter_mut().for_each(|x| *x = random.symmetric());
        (0..POWERS).all(|_| {
            let length = norm(&self.vector);
            if length == 0.0 {
                return true;
            }
            self.vector.iter_mut().for_each(|x| *x /= length);
            self.product.fill(0.0);
            matrix.add_product_unchecked(1.0, &self.vector, &mut self.product);
            let product = MatMut::from_column_major_slice_mut(&mut self.product, matrix.dim(), 1);
            LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                Conj::No,
                product,
                Par::Seq,
                self.scratch.stack(),
            );
            self.vector.iter_mut().zip(&self.product).for_each(|(x, y)| *x -= y);
            norm(&self.vector) < SHORTENED
        })
    }

    /// The diagonal of D.
    fn pivots(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = &symbolic.col_ptr()[..symbolic.ncols()];
                Box::new(starts.iter().map(|&start| self.factor[start as usize]))
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLdltRef::new(symbolic, &self.factor);
                Box::new((0..symbolic.n_supernodes()).flat_map(move |s| {
                    let block = factor.supernode(s).val();
                    (0..block.ncols()).map(move |j| block[(j, j)])
                }))
            }
        }
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The edges of a square grid and `ground` on the diagonal: eigenvalues
    /// `4 sin^2(i pi/2n) + 4 sin^2(j pi/2n) + ground`.
    fn grid(side: usize, ground: f64) -> SymmetricMatrix {
        let mut blocks = Vec::new();
        for v in 0..side * side {
            blocks.push((vec![v], vec![ground]));
            for (stride, inside) in [(1, v % side + 1 < side), (side, v / side + 1 < side)] {
                if inside {
                    blocks.push((vec![v, v + stride], vec![1.0, -1.0, -1.0, 1.0]));
                }
            }
        }
        SymmetricMatrix::from_blocks(side * side, &blocks).unwrap()
    }

    fn below(side: usize, limit: f64) -> usize {
        let one = |i: usize| 4.0 * (0.5 * PI * i as f64 / side as f64).sin().powi(2);
        (0..side * side).filter(|v| one(v % side) + one(v / side) < limit).count()
    }

    #[test]
    fn eigenvalues_below_a_limit_are_counted() {
        for side in [4, 12, 40] {
            for limit in [-0.1, 0.1, 1.07, 2.123, 5.01, 9.0] {
                let matrix = grid(side, -limit);
                let counted = count(&matrix).unwrap();
                assert_eq!(counted.negative, below(side, limit), "{side} {limit}");
                assert_eq!(counted.negative + counted.positive, side * side);
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_refused() {
        let matrix = grid(6, 0.0);
        assert_eq!(count(&matrix), Err(SparseError::Singular));
    }

    #[test]
    fn a_regular_matrix_on_which_elimination_breaks_down_is_refused_and_not_miscounted() {
        let blocks = [(vec![0, 1], vec![0.0, 1.0, 1.0, 0.0])];
        let matrix = SymmetricMatrix::from_blocks(2, &blocks).unwrap();
        assert_eq!(count(&matrix), Err(SparseError::Singular));
        let blocks = [(vec![0, 1], vec![1e-20, 1.0, 1.0, 0.0])];
        let matrix = SymmetricMatrix::from_blocks(2, &blocks).unwrap();
        assert_eq!(count(&matrix), Err(SparseError::Singular));
    }

    fn count(matrix: &SymmetricMatrix) -> Result<Inertia, SparseError> {
        SparseInertia::new(&SparseCholesky::analyse(matrix)?)?.count(matrix)
    }
}
