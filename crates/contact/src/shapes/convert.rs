//! The border to the geometry library: its vectors and poses to ours and back, nowhere else.
//!
//! Nothing but numbers is copied; see the detection bench for what it costs.

use nalgebra::Vector3;
use parry3d_f64::math::{Pose, Rotation, Vector};
use stationary_rigid::RigidMotion;

#[inline]
pub(crate) fn vector(v: &Vector3<f64>) -> Vector {
    Vector::new(v.x, v.y, v.z)
}

#[inline]
pub(crate) fn from_vector(v: Vector) -> Vector3<f64> {
    Vector3::new(v.x, v.y, v.z)
}

#[inline]
pub(crate) fn pose(motion: &RigidMotion) -> Pose {
    let [w, x, y, z] = motion.rotation.quaternion();
    Pose::from_parts(vector(&motion.translation), Rotation::from_xyzw(x, y, z, w))
}
