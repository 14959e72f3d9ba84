//! Cholesky's method for a sparse positive definite matrix.
//!
//! ```text
//! P A P^T = L L^T
//! ```
//! `A` a [`SymmetricMatrix`] (n x n), `P` the order of elimination (approximate minimum degree), `L`
//! lower triangular. Order, elimination tree and the places of L are found once, by
//! [`SparseCholesky::analyse`]; [`SparseCholesky::factor`] runs numbers only and allocates nothing.
//! Whether L is kept column by column or in dense panels of columns is decided by the work that its
//! fill makes (faer's threshold). A pivot that is not positive, or that rounding left of a zero, is an
//! error that names the freedom; a factor that is not finite is one too.

use std::sync::Arc;

use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::FaerError;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::hessian_solver::ZERO_PIVOT;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::pattern::Pattern;
use crate::sparse::scratch::Scratch;
use crate::sparse::{ANALYSED_SHAPE, SparseError};

/// The factor of a matrix, or the memory for it.
#[derive(Clone, Debug)]
pub struct SparseCholesky {
    pattern: Arc<Pattern>,
    symbolic: Arc<SymbolicCholesky<u32>>,
    factor: Vec<f64>,
    scratch: Scratch,
}

pub(crate) fn analysis_error(n: usize, error: FaerError) -> SparseError {
    match error {
        FaerError::IndexOverflow => {
            SparseError::TooLarge { what: "the factor of a matrix of this size", size: n }
        }
        _ => SparseError::OutOfMemory { size: n },
    }
}

impl SparseCholesky {
    /// Finds the order of elimination and takes all memory, from the pattern of `matrix`.
    pub fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        let n = matrix.dim();
        let symbolic = factorize_symbolic_cholesky(
            matrix.pattern().columns.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams::default(),
        )
        .map_err(|error| analysis_error(n, error))?;
        let scratch = Scratch::new(
            n,
            &[
                symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
                symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            ],
        )?;
        Ok(SparseCholesky {
            pattern: Arc::clone(matrix.pattern()),
            factor: vec![0.0; symbolic.len_val()],
            symbolic: Arc::new(symbolic),
            scratch,
        })
    }

    /// Factors a matrix of the analysed pattern.
    pub fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        let factored = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix.lower(),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
        if let Err(LltError::NonPositivePivot { index }) = factored {
            let freedom = self.freedom(index.saturating_sub(1));
            return Err(SparseError::NotPositiveDefinite { freedom });
        }
        self.check_pivots(matrix)
    }

    /// Solves `A x = b` in place.
    pub fn solve(&mut self, b: &mut [f64]) {
        let b = MatMut::from_column_major_slice_mut(b, self.symbolic.nrows(), 1);
        LltRef::new(&self.symbolic, &self.factor).solve_in_place_with_conj(
            Conj::No,
            b,
            Par::Seq,
            self.scratch.stack(),
        );
    }

    /// How many numbers the factor has.
    pub fn factor_len(&self) -> usize {
        self.factor.len()
    }

    /// The freedom that is eliminated at the given place.
    fn freedom(&self, place: usize) -> usize {
        match self.symbolic.perm() {
            Some(perm) => perm.arrays().0.get(place).map_or(place, |&freedom| freedom as usize),
            None => place,
        }
    }

    /// faer takes infinite pivots and what rounding leaves of zero ones for positive: not so here. A
    /// number that is not finite anywhere in the factor makes a later pivot infinite or NaN.
    fn check_pivots(&self, matrix: &SymmetricMatrix) -> Result<(), SparseError> {
        let check = |place: usize, root: f64| {
            let freedom = self.freedom(place);
            let pivot = root * root;
            if pivot.is_nan() || pivot == f64::INFINITY {
                Err(SparseError::NonFinite)
            } else if pivot > ZERO_PIVOT * matrix.diagonal(freedom) {
                Ok(())
            } else {
                Err(SparseError::NotPositiveDefinite { freedom })
            }
        };
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = &symbolic.col_ptr()[..symbolic.ncols()];
                let mut roots = starts.iter().map(|&start| self.factor[start as usize]).enumerate();
                roots.try_for_each(|(place, root)| check(place, root))
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLltRef::new(symbolic, &self.factor);
                (0..symbolic.n_supernodes()).try_for_each(|s| {
                    let panel = factor.supernode(s);
                    let block = panel.val();
                    (0..block.ncols()).try_for_each(|j| check(panel.start() + j, block[(j, j)]))
                })
            }
        }
    }
}
