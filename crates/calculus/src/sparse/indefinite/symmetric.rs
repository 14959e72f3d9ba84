//! Elimination of a symmetric matrix that stays symmetric, with exchanges inside of panels.
//!
//! ```text
//! P A P^T = L B L^T      B diagonal, with blocks of 1 and 2 on it
//! ```
//! The fill is that of Cholesky's method. Exchanges stay within a panel of columns, so that even a
//! regular matrix may break down: what comes out must be checked.

use std::sync::Arc;

use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::first_non_finite;
use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::cholesky::analysis_error;
use crate::sparse::scratch::Scratch;

/// `L`, `B` and `P`, or the memory for them.
#[derive(Clone, Debug)]
pub(super) struct SymmetricPivoting {
    symbolic: Arc<SymbolicCholesky<u32>>,
    factor: Vec<f64>,
    subdiagonal: Vec<f64>,
    forward: Vec<u32>,
    inverse: Vec<u32>,
    scratch: Scratch,
}

impl SymmetricPivoting {
    pub(super) fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        let n = matrix.dim();
        let symbolic = factorize_symbolic_cholesky(
            matrix.pattern().columns.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..CholeskySymbolicParams::default()
            },
        )
        .map_err(|error| analysis_error(n, error))?;
        let scratch = Scratch::new(
            n,
            &[
                symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Spec::default()),
                symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            ],
        )?;
        Ok(SymmetricPivoting {
            factor: vec![0.0; symbolic.len_val()],
            subdiagonal: vec![0.0; n],
            forward: vec![0; n],
            inverse: vec![0; n],
            symbolic: Arc::new(symbolic),
            scratch,
        })
    }

    /// False where the factor is not finite, and where faer has no panels: it would then eliminate
    /// without any exchange and keep its errors to itself.
    pub(super) fn factor(&mut self, matrix: &SymmetricMatrix) -> bool {
        if matches!(self.symbolic.raw(), SymbolicCholeskyRaw::Simplicial(_)) {
            return false;
        }
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut self.factor,
            &mut self.subdiagonal,
            &mut self.forward,
            &mut self.inverse,
            matrix.lower(),
            Side::Lower,
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
        first_non_finite(&self.factor).is_none() && first_non_finite(&self.subdiagonal).is_none()
    }

    pub(super) fn solve(&mut self, b: &mut [f64]) {
        let n = b.len();
        let permutation = PermRef::new_checked(&self.forward, &self.inverse, n);
        IntranodeLbltRef::new(&self.symbolic, &self.factor, &self.subdiagonal, permutation)
            .solve_in_place_with_conj(
                Conj::No,
                MatMut::from_column_major_slice_mut(b, n, 1),
                Par::Seq,
                self.scratch.stack(),
            );
    }
}
