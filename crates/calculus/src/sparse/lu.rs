//! Elimination with row exchanges for a sparse square matrix, symmetric or not.
//!
//! ```text
//! P A Q = L U
//! ```
//! `Q` an order of the columns that keeps the factors sparse, found once from the pattern; `P` the row
//! exchanges, found anew from the numbers each time, so that the places of L and U may change and
//! their memory may grow. Says nothing of accuracy: the caller checks the residual.

use faer::sparse::linalg::LuError;
use faer::sparse::linalg::lu::{
    LuRef, LuSymbolicParams, NumericLu, SymbolicLu, factorize_symbolic_lu,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Spec};

use crate::sparse::SparseError;
use crate::sparse::cholesky::analysis_error;
use crate::sparse::scratch::Scratch;

/// The factors of a matrix, or the memory for them.
#[derive(Clone, Debug)]
pub(crate) struct SparseLu {
    symbolic: SymbolicLu<u32>,
    numeric: NumericLu<u32, f64>,
    factored: bool,
    scratch: Scratch,
}

impl SparseLu {
    pub(crate) fn analyse(pattern: SymbolicSparseColMatRef<'_, u32>) -> Result<Self, SparseError> {
        let n = pattern.ncols();
        let symbolic = factorize_symbolic_lu(pattern, LuSymbolicParams::default())
            .map_err(|error| analysis_error(n, error))?;
        let scratch = Scratch::new(
            n,
            &[
                symbolic.factorize_numeric_lu_scratch::<f64>(Par::Seq, Spec::default()),
                symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            ],
        )?;
        Ok(SparseLu { symbolic, numeric: NumericLu::new(), factored: false, scratch })
    }

    pub(crate) fn factor(
        &mut self,
        matrix: SparseColMatRef<'_, u32, f64>,
    ) -> Result<(), SparseError> {
        self.factored = false;
        if matrix.val().iter().any(|entry| !entry.is_finite()) {
            return Err(SparseError::NonFinite);
        }
        let stack = self.scratch.stack();
        self.symbolic
            .factorize_numeric_lu(&mut self.numeric, matrix, Par::Seq, stack, Spec::default())
            .map_err(|error| match error {
                LuError::SymbolicSingular { .. } => SparseError::Singular,
                LuError::Generic(error) => analysis_error(matrix.ncols(), error),
            })?;
        self.factored = true;
        Ok(())
    }

    /// Solves `A x = b` in place; NaN where no matrix is factored.
    pub(crate) fn solve(&mut self, b: &mut [f64]) {
        if !self.factored {
            return b.fill(f64::NAN);
        }
        let b = MatMut::from_column_major_slice_mut(b, self.symbolic.nrows(), 1);
        LuRef::new_unchecked(&self.symbolic, &self.numeric).solve_in_place_with_conj(
            Conj::No,
            b,
            Par::Seq,
            self.scratch.stack(),
        );
    }
}
