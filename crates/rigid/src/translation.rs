//! The translations of N-dimensional space, the group in which everything commutes.
//!
//! ```text
//! exp(v) = v,   log(t) = t,   Ad_t v = v,   [v, w] = 0
//! matrix(t) = ( I  t )     hat(v) = ( 0  v )
//!             ( 0  1 )              ( 0  0 )
//! ```
//! `t v w` in metres. The matrices are for reading, not for computing: the identity block in the
//! first is as printed on the notes' p. 85 (errata 8.2).

use nalgebra::{DMatrix, SVector};

use crate::LieGroup;

/// A translation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Translation<const N: usize>(pub SVector<f64, N>);

impl<const N: usize> LieGroup for Translation<N> {
    type Algebra = SVector<f64, N>;
    type Matrix = DMatrix<f64>;

    fn identity() -> Self {
        Translation(SVector::zeros())
    }

    fn inverse(&self) -> Self {
        Translation(-self.0)
    }

    fn compose(&self, first: &Self) -> Self {
        Translation(self.0 + first.0)
    }

    fn exp(v: SVector<f64, N>) -> Self {
        Translation(v)
    }

    fn log(&self) -> SVector<f64, N> {
        self.0
    }

    fn adjoint(&self, v: SVector<f64, N>) -> SVector<f64, N> {
        v
    }

    fn bracket(_v: SVector<f64, N>, _w: SVector<f64, N>) -> SVector<f64, N> {
        SVector::zeros()
    }

    fn matrix(&self) -> DMatrix<f64> {
        DMatrix::identity(N + 1, N + 1) + Self::hat(self.0)
    }

    fn hat(v: SVector<f64, N>) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(N + 1, N + 1);
        matrix.view_mut((0, N), (N, 1)).copy_from(&v);
        matrix
    }
}
