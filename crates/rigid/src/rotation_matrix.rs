//! A rotation as its nine entries, and back.
//!
//! ```text
//! R = I + 2 w [x] + 2 [x]^2                     of the quaternion (w, x)
//! R = cos a I + sin a [n] + (1 - cos a) n n^T   Rodrigues, of axis n and angle a      (9.1)
//! ```
//! `[x]` the cross-product matrix. Back: four times the quaternion's squares are read off the
//! diagonal, and the largest component, which is at least 1/2, divides the others, so that no angle
//! is worse than another. Source: notes 9.1; Shepperd 1978.

use nalgebra::Matrix3;

use crate::error::check_finite;
use crate::{RigidError, Rotation};

/// How far `R^T R` may be from the identity: what a file with ten digits has.
const ORTHOGONAL: f64 = 1e-9;

impl Rotation {
    /// The rotation of an orthogonal matrix of determinant 1.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`]; [`RigidError::NotOrthogonal`] where an entry of `R^T R` is off
    /// the identity's by more than 1e-9; [`RigidError::Reflection`] for a negative determinant.
    pub fn from_matrix(r: &Matrix3<f64>) -> Result<Self, RigidError> {
        check_finite("the rotation matrix", r.as_slice())?;
        let defect = (r.transpose() * r - Matrix3::identity()).amax();
        if defect > ORTHOGONAL {
            return Err(RigidError::NotOrthogonal { defect });
        }
        let determinant = r.determinant();
        if determinant < 0.0 {
            return Err(RigidError::Reflection { determinant });
        }
        Ok(Rotation::from_orthogonal(r))
    }

    /// The rotation of a matrix that is known to be one.
    pub(crate) fn from_orthogonal(r: &Matrix3<f64>) -> Self {
        Rotation::unchecked(quaternion(r)).normalized()
    }

    /// The matrix, whose columns are the body's axes as seen from the world.
    #[inline]
    pub fn rotation_matrix(&self) -> Matrix3<f64> {
        let [w, x, y, z] = self.quaternion();
        let (xx, yy, zz) = (2.0 * x * x, 2.0 * y * y, 2.0 * z * z);
        let (xy, yz, zx) = (2.0 * x * y, 2.0 * y * z, 2.0 * z * x);
        let (wx, wy, wz) = (2.0 * w * x, 2.0 * w * y, 2.0 * w * z);
        Matrix3::new(
            1.0 - (yy + zz),
            xy - wz,
            zx + wy,
            xy + wz,
            1.0 - (zz + xx),
            yz - wx,
            zx - wy,
            yz + wx,
            1.0 - (xx + yy),
        )
    }
}

/// A multiple of the quaternion of a rotation matrix, by its largest component.
fn quaternion(r: &Matrix3<f64>) -> [f64; 4] {
    let [a, b, c] = [r[(0, 0)], r[(1, 1)], r[(2, 2)]];
    // Four times w^2, x^2, y^2 and z^2.
    let squares = [1.0 + a + b + c, 1.0 + a - b - c, 1.0 - a + b - c, 1.0 - a - b + c];
    let wx = r[(2, 1)] - r[(1, 2)];
    let wy = r[(0, 2)] - r[(2, 0)];
    let wz = r[(1, 0)] - r[(0, 1)];
    let xy = r[(1, 0)] + r[(0, 1)];
    let yz = r[(2, 1)] + r[(1, 2)];
    let zx = r[(0, 2)] + r[(2, 0)];
    let largest = (1..4).fold(0, |best, i| if squares[i] > squares[best] { i } else { best });
    match largest {
        0 => [squares[0], wx, wy, wz],
        1 => [wx, squares[1], xy, zx],
        2 => [wy, xy, squares[2], yz],
        _ => [wz, zx, yz, squares[3]],
    }
}
