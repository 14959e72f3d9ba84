//! Front page.

mod error;
mod group;
mod stumpff;
mod rotation;
mod rotation_matrix;
mod euler;
mod jacobian;
mod translation;
mod planar;
mod motion;
mod matrix_group;

pub use error::RigidError;
pub use euler::EulerAngles;
pub use group::LieGroup;
pub use jacobian::{
    left_jacobian, left_jacobian_inverse, right_jacobian, right_jacobian_derivative,
    right_jacobian_inverse,
};
pub use matrix_group::{matrix_exponential, matrix_logarithm, null_space};
pub use motion::RigidMotion;
pub use planar::{PlanarMotion, PlanarRotation};
pub use rotation::Rotation;
pub use translation::Translation;
