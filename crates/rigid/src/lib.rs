//! How does a body turn, and what does its motion keep? Lie groups and rigid motion that never
//! drifts.
//!
//! ```text
//! m = rho V,   c = f / V,   I = tr(C) 1 - C,   m c = sum m_k c_k  mass, centre, inertia    (7.2, 7.3)
//! g exp(s log(g^-1 k)),   Ad_g v,   [v, w]                       straight paths                (8.2)
//! d/dt exp(theta) = exp(theta) [T(theta) theta.]                 angular velocity              (9.3)
//! I w. + w x I w = -dV,   R. = R [w]                             Euler's equations             (9.4)
//! T(-h w')^-T I w' = T(h w)^-T I w - h dV,   R' = R exp(h w)     made discrete                 (9.5)
//! p <- p - J^T A,  free motion,  p <- p - J^T B,   g = 0, J v = 0   joints                (6.5, 9.2)
//! J = <P, v> + <a, t x P + R m>                                  momentum maps                 (8.3)
//! F dx = (F, c x R^T F)                                          forces at points             (10.1)
//! p <- p + h/2 F,  free motion,  p <- p + h/2 F                  forces under every stepper   (10.1)
//! M(q) v. = tau - C(q, v)                                        trees in joint coordinates
//! ```
//! `V f C` the moments of a shape of density `rho`, `g k` motions, `v w` directions in body axes,
//! `theta` axis times angle, `R` an orientation, `w` the angular velocity and `I` the inertia in
//! body axes, `dV` the differential of the potential in body axes (minus the torque), `h` the step;
//! `A B` impulses of joints `g`, with differential `J`; `P m` linear and angular momenta, `F` a
//! force; `q v` coordinates and speeds of joints, `M` their mass matrix, `tau C` their forces and what
//! velocities and weight take of them. The numbers name sections of the notes.
//!
//! ```
//! use stationary_rigid::{BodyMethod, Poses, problems::tumbling_box, spatial_angular_momentum};
//!
//! let tumbling = tumbling_box()?;
//! let mut state = tumbling.initial.clone();
//! let mut method = BodyMethod::VariationalRotation.integrator(&tumbling.system)?;
//! for _ in 0..500 {
//!     method.step(&mut state, 0.01)?;
//! }
//! let momentum = |state| spatial_angular_momentum::<Poses>(state);
//! assert!((momentum(&state)? - momentum(&tumbling.initial)?).norm() < 1e-14);
//! assert!((tumbling.energy(&state) / tumbling.energy(&tumbling.initial) - 1.0).abs() < 2e-5);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: what a Lie group is ([`LieGroup`]), the groups from translations to motions of
//! space, and the differential of exp; mass properties of shapes, and the [`Body`] that is left of
//! them, of round solids in closed form ([`Body::solid_cylinder`] and others);
//! where bodies are ([`Poses`], [`Orientations`]), the metric that is constant in their axes,
//! potentials, forces and joints on them, in space and in the plane, what drives and limits joints,
//! questions to a mechanism that stands still ([`mobility`], [`assemble`], [`instant`], [`linearize`]),
//! and the symmetries that they may have; the free top in closed form, and heavy tops; then free rotation by three maps, kicked
//! in [`LieVerlet`], held by joints in `constraints`' RATTLE along [`FreeBodies`], Munthe-Kaas and
//! what games do for contrast; many free bodies in a [`BodyStore`]; [`BodyMethod`], which names
//! them all; [`tree`], where bodies are told by their joints' coordinates; and [`problems`].
//!
//! Orientations are unit quaternions, scalar first, and never leave the group. Nothing here is an
//! Euler angle but [`EulerAngles`], for reading. The crate knows nothing of contact or of files.

mod error;
mod group;
mod stumpff;
mod twofold;
mod translation;
mod planar;
mod rotation;
mod rotation_matrix;
mod euler;
mod jacobian;
mod motion;
mod matrix_group;
mod body;
mod round_bodies;
mod mass_properties;
mod space;
mod metric;
mod weight;
mod body_spring;
mod pose_potential;
mod point_force;
mod body_forces;
mod joint;
mod mechanism;
mod planar_weight;
mod planar_joint;
mod four_bar;
mod symmetry;
mod elliptic;
mod free_top;
mod symmetric_top;
mod kovalevskaya;
mod step;
mod free_rotation;
mod variational;
mod axis_rotations;
mod exact_rotation;
mod body_store;
mod free_bodies;
mod lie_verlet;
mod munthe_kaas;
mod renormalized_euler;
mod method;
pub mod tree;
pub mod problems;

pub use axis_rotations::AxisRotations;
pub use body::{Body, PrincipalFrame};
pub use body_forces::BodyForces;
pub use body_spring::{Attachment, BodySpring};
pub use body_store::BodyStore;
pub use error::RigidError;
pub use euler::EulerAngles;
pub use exact_rotation::ExactRotation;
pub use four_bar::FourBar;
pub use free_bodies::FreeBodies;
pub use free_rotation::{FreeRotation, Turned};
pub use free_top::FreeTop;
pub use group::LieGroup;
pub use jacobian::{
    left_jacobian, left_jacobian_inverse, right_jacobian, right_jacobian_derivative,
    right_jacobian_inverse,
};
pub use joint::{
    Along, Drive, DrivenCoordinate, Joint, JointCoordinate, JointEnd, JointFault, JointFriction,
    JointKind, JointLimits, JointName, PrescribedCoordinate, Schedule, Steady, TorsionSpring,
};
pub use kovalevskaya::KovalevskayaTop;
pub use lie_verlet::LieVerlet;
pub use mass_properties::{PlanarMass, SpatialMass};
pub use matrix_group::{matrix_exponential, matrix_logarithm, null_space};
pub use mechanism::{
    Assembly, Instant, Linearization, MechanismError, Mobility, assemble, instant, linearize,
    mobility,
};
pub use method::BodyMethod;
pub use metric::{BodyMetric, BodyMotion, spatial_angular_momentum};
pub use motion::RigidMotion;
pub use munthe_kaas::MuntheKaas4;
pub use planar::{PlanarMotion, PlanarRotation};
pub use planar_joint::{PlanarCoordinate, PlanarDrive, PlanarEnd, PlanarJoint, PlanarJointKind};
pub use planar_weight::PlanarWeight;
pub use point_force::{Wrench, apply_impulse, force_at_point};
pub use pose_potential::{PoseEnergy, PoseOf, PosePotential};
pub use renormalized_euler::RenormalizedEuler;
pub use rotation::Rotation;
pub use space::{BodySpace, Orientations, Poses};
pub use symmetric_top::{SymmetricTop, tilt};
pub use symmetry::{Carried, PlanarCarried, Spun};
pub use translation::Translation;
pub use variational::ConstantVelocity;
pub use weight::{Free, PointMass, Weight};
