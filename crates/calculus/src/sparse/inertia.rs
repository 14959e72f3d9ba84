//! How many eigenvalues a sparse symmetric matrix has on either side of zero.
//!
//! ```text
//! P (A + E) P^T = L D L^T       A + E and D have as many negative eigenvalues (Sylvester)
//! ```
//! `A` a [`SymmetricMatrix`] (n x n), `E` what rounding made of it. Elimination without exchanges may
//! break down on a matrix that is perfectly regular, so the signs of D are not believed by
//! themselves: A and A + E have the same count if `(A + E)^-1 E` shortens every vector, for then no
//! matrix on the way from one to the other is singular. That is measured, by power iteration on
//! random vectors, which are solved for together; where it shortens them by less than half the count
//! is refused. But for one in a thousand, a random vector of n numbers has more than a thousandth of
//! `1/sqrt(n)` in any direction: where all are shortened to half of that at once, no direction can
//! be left at half its length, and one step is enough.
//!
//! Counts for `A - mu M` say how many eigenvalues of `A v = lambda M v` lie below mu.

use std::sync::Arc;

use faer::dyn_stack::StackReq;
use faer::linalg::cholesky::ldlt::factor::LdltRegularization;
use faer::sparse::linalg::cholesky::{LdltRef, SymbolicCholeskyRaw, supernodal::SupernodalLdltRef};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::first_non_finite;
use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::cholesky::SparseCholesky;
use stationary_measure::SplitMix64;

/// Numbers of eigenvalues by their sign. A count that was not refused has no zeros.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inertia {
    /// How many are negative.
    pub negative: usize,
    /// How many are positive.
    pub positive: usize,
}

/// Steps of the power iteration, and vectors that it starts from.
const POWERS: u32 = 6;
const STARTS: usize = 3;
/// A vector must be shortened at least this much.
const SHORTENED: f64 = 0.5;
/// The share of `1/sqrt(n)` that a random vector has in any direction, but for one in a thousand.
const SHARE: f64 = 1e-3;

impl SparseCholesky {
    /// The counts of a matrix of the analysed pattern, which need not be definite. They are made in
    /// the factor's memory: what was factored before is lost.
    ///
    /// # Errors
    /// [`SparseError::OtherPattern`] for a matrix of another analysis; [`SparseError::NonFinite`] for
    /// an entry; [`SparseError::OutOfMemory`]; [`SparseError::Singular`] where the matrix is too close to a singular one for a count.
    pub fn inertia(&mut self, matrix: &SymmetricMatrix) -> Result<Inertia, SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        if first_non_finite(matrix.values()).is_some() {
            return Err(SparseError::NonFinite);
        }
        self.factored = false;
        self.scratch.grow(StackReq::any_of(&[
            self.symbolic.factorize_numeric_ldlt_scratch::<f64>(Par::Seq, Spec::default()),
            self.symbolic.solve_in_place_scratch::<f64>(STARTS, Par::Seq),
        ]))?;
        let factored = self.symbolic.factorize_numeric_ldlt(
            &mut self.factor,
            matrix.lower(),
            Side::Lower,
            LdltRegularization::default(),
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
        if factored.is_err() || !self.shortens(matrix) {
            return Err(SparseError::Singular);
        }
        let negative = self.pivots().filter(|&pivot| pivot < 0.0).count();
        Ok(Inertia { negative, positive: matrix.dim() - negative })
    }

    /// Whether `(A + E)^-1 E` shortens what random vectors become under its powers.
    fn shortens(&mut self, matrix: &SymmetricMatrix) -> bool {
        let n = matrix.dim();
        let mut random = SplitMix64::new(0);
        let mut vectors: Vec<f64> = (0..n * STARTS).map(|_| random.symmetric()).collect();
        let mut products = vec![0.0; n * STARTS];
        for _ in 0..POWERS {
            products.fill(0.0);
            let pairs = vectors.chunks_exact_mut(n.max(1));
            for (x, y) in pairs.zip(products.chunks_exact_mut(n.max(1))) {
                let length = norm(x);
                if length > 0.0 {
                    x.iter_mut().for_each(|x| *x /= length);
                }
                matrix.add_product_unchecked(1.0, x, y);
            }
            LdltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(&mut products, n, STARTS),
                Par::Seq,
                self.scratch.stack(),
            );
            vectors.iter_mut().zip(&products).for_each(|(x, y)| *x -= y);
            let lengths = vectors.chunks_exact(n.max(1)).map(norm);
            // The comparison is so written that NaN is long.
            let within = |limit: f64| lengths.clone().all(|length| length < limit);
            if !within(SHORTENED) {
                return false;
            }
            if within(SHORTENED * SHARE / (n as f64).sqrt()) {
                return true;
            }
        }
        true
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

    #[test]
    fn what_was_factored_before_a_count_is_lost_and_can_be_factored_again() {
        let matrix = grid(12, 0.3);
        let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
        cholesky.factor(&matrix).unwrap();
        let mut once = vec![1.0; 144];
        cholesky.solve(&mut once);
        assert_eq!(cholesky.inertia(&matrix), Ok(Inertia { negative: 0, positive: 144 }));
        let mut lost = vec![1.0; 144];
        cholesky.solve(&mut lost);
        assert!(lost.iter().all(|x| x.is_nan()));
        cholesky.factor(&matrix).unwrap();
        let mut again = vec![1.0; 144];
        cholesky.solve(&mut again);
        assert_eq!(once, again);
    }

    fn count(matrix: &SymmetricMatrix) -> Result<Inertia, SparseError> {
        SparseCholesky::analyse(matrix)?.inertia(matrix)
    }
}
