//! Elimination with row exchanges for a full matrix, in blocks: for many unknowns.
//!
//! ```text
//! P A = L U
//! ```
//! The matrix (n x n by columns) stays with the caller and is overwritten by its factors; here are the
//! permutation and the memory to work in.

use faer::linalg::lu::partial_pivoting::factor::{lu_in_place, lu_in_place_scratch};
use faer::linalg::lu::partial_pivoting::solve::{solve_in_place, solve_in_place_scratch};
use faer::perm::PermRef;
use faer::{MatMut, MatRef, Par, Spec};

use crate::sparse::SparseError;
use crate::sparse::scratch::Scratch;

#[derive(Clone, Debug)]
pub(crate) struct BlockedLu {
    forward: Vec<u32>,
    inverse: Vec<u32>,
    scratch: Scratch,
}

impl BlockedLu {
    pub(crate) fn new(n: usize) -> Result<Self, SparseError> {
        let sizes = [
            lu_in_place_scratch::<u32, f64>(n, n, Par::Seq, Spec::default()),
            solve_in_place_scratch::<u32, f64>(n, 1, Par::Seq),
        ];
        let scratch = Scratch::new(n, &sizes)?;
        Ok(BlockedLu { forward: vec![0; n], inverse: vec![0; n], scratch })
    }

    pub(crate) fn eliminate(&mut self, matrix: &mut [f64]) {
        let n = self.forward.len();
        lu_in_place(
            MatMut::from_column_major_slice_mut(matrix, n, n),
            &mut self.forward,
            &mut self.inverse,
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
    }

    pub(crate) fn solve(&mut self, factors: &[f64], b: &mut [f64]) {
        let n = self.forward.len();
        let factors = MatRef::from_column_major_slice(factors, n, n);
        solve_in_place(
            factors,
            factors,
            PermRef::new_checked(&self.forward, &self.inverse, n),
            MatMut::from_column_major_slice_mut(b, n, 1),
            Par::Seq,
            self.scratch.stack(),
        );
    }
}
