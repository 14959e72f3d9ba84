//! The border to the geometry library in the plane: its vectors and poses to ours and back.
//!
//! Nothing but numbers is copied.

use nalgebra::Vector2;
use parry2d_f64::math::{Pose, Rot2, Vector};
use stationary_rigid::PlanarMotion;

#[inline]
pub(crate) fn vector(v: &Vector2<f64>) -> Vector {
    Vector::new(v.x, v.y)
}

#[inline]
pub(crate) fn from_vector(v: Vector) -> Vector2<f64> {
    Vector2::new(v.x, v.y)
}

#[inline]
pub(crate) fn pose(motion: &PlanarMotion) -> Pose {
    let axis = motion.rotation.rotate(&Vector2::x());
    Pose::from_parts(vector(&motion.translation), Rot2::from_cos_sin_unchecked(axis.x, axis.y))
}
