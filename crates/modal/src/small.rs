//! The lowest modes of a small system, by dense matrices.
//!
//! ```text
//! (H + c M R R^T M) v = lambda M v,      R^T M R = I
//! ```
//! `H M` stiffness and mass (n x n), `R` rigid motions (n x k), which the second term puts at `c`,
//! above all others. Every mode is found; the cost is the cube of n.

use nalgebra::{DMatrix, DMatrixView};
use stationary_calculus::{BilinearForm, SymmetricMatrix};

use crate::modes::Found;
use crate::{ModalError, RigidMotions, dense};

/// Vectors that span the lowest `count` modes besides the rigid motions, which are put at `raised`.
pub(crate) fn lowest(
    stiffness: &SymmetricMatrix,
    mass: &SymmetricMatrix,
    rigid: &RigidMotions,
    raised: f64,
    count: usize,
) -> Result<Found, ModalError> {
    let n = mass.dim();
    let moved = dense::times(mass, &rigid.columns);
    let moved = DMatrixView::from_slice(&moved, n, rigid.len());
    let form = whole(stiffness) + raised * moved * moved.transpose();
    let pairs = BilinearForm(form).eigenpairs(&BilinearForm(whole(mass)))?;
    let vectors = pairs.vectors.as_slice()[..count * n].to_vec();
    let next = pairs.values.as_slice()[..n - rigid.len()].get(count).copied();
    Ok(Found { vectors, next, solves: 0 })
}

/// Both triangles.
fn whole(matrix: &SymmetricMatrix) -> DMatrix<f64> {
    let n = matrix.dim();
    let mut unit = DMatrix::identity(n, n);
    let columns = dense::times(matrix, unit.as_mut_slice());
    DMatrix::from_vec(n, n, columns)
}
