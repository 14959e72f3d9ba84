//! Front page.

mod error;
mod group;
mod stumpff;
mod translation;
mod planar;
mod rotation;
mod rotation_matrix;
mod euler;
mod jacobian;
mod motion;
mod matrix_group;
mod body;
mod mass_properties;
mod polygon;
mod surface_mass;
mod space;
mod metric;
mod weight;
mod body_spring;
mod point_force;
mod elliptic;
mod free_top;
mod symmetric_top;
mod kovalevskaya;
mod step;
mod free_rotation;
mod variational;
mod axis_rotations;
mod exact_rotation;
mod lie_verlet;
mod munthe_kaas;
mod renormalized_euler;
mod method;
pub mod problems;

pub use axis_rotations::AxisRotations;
pub use body::{Body, PrincipalFrame};
pub use body_spring::{Attachment, BodySpring};
pub use error::RigidError;
pub use euler::EulerAngles;
pub use exact_rotation::ExactRotation;
pub use free_rotation::{FreeRotation, Turned};
pub use free_top::FreeTop;
pub use group::LieGroup;
pub use jacobian::{
    left_jacobian, left_jacobian_inverse, right_jacobian, right_jacobian_derivative,
    right_jacobian_inverse,
};
pub use kovalevskaya::KovalevskayaTop;
pub use lie_verlet::LieVerlet;
pub use mass_properties::{PlanarMass, SpatialMass};
pub use matrix_group::{matrix_exponential, matrix_logarithm, null_space};
pub use method::BodyMethod;
pub use metric::{BodyMetric, BodyMotion, spatial_angular_momentum};
pub use motion::RigidMotion;
pub use munthe_kaas::MuntheKaas4;
pub use planar::{PlanarMotion, PlanarRotation};
pub use point_force::{Wrench, apply_impulse, force_at_point};
pub use polygon::polygon_mass;
pub use renormalized_euler::RenormalizedEuler;
pub use rotation::Rotation;
pub use space::{BodySpace, Orientations, Poses};
pub use surface_mass::{surface_mass, turned_outward};
pub use symmetric_top::{SymmetricTop, tilt};
pub use translation::Translation;
pub use variational::ConstantVelocity;
pub use weight::{Free, PointMass, Weight};
