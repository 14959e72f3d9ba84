//! Trees of bodies in the coordinates of their joints: as many numbers as there are freedoms.
//!
//! ```text
//! G = F J(q),     S = dJ/dq         each body hangs by one joint from its parent, or the world
//! V = X V_p + S v,    A = X A_p + S v. + c                velocities and accelerations, outward
//! f = I A + b + sum X^T f,    tau = S^T f                 forces, inward: inverse dynamics
//! v. = M^-1 (tau - C)                                     forward dynamics, without ever forming M
//! -D1 L(q, q') = p,    p' = D2 L(q, q')                   a step that conserves momenta
//! ```
//! `F G` the joint's frames on the parent and on the body, `J` the joint's motion, `q` its
//! coordinates and `v` its speeds; `V A f` velocity, acceleration and force of a body, linear part
//! first, `X` the shift from the parent's centre to the body's, `c b` what velocities add, `I` the
//! inertia, `M` the mass matrix, `tau` the forces of the joints, `p` their momenta, `L` the discrete
//! Lagrangian. All but the mass matrix itself takes time in proportion to the number of bodies.
//! Coordinates are metres and radians, a ball's four a quaternion (scalar first).
//!
//! Spatial vectors are in world axes about each body's centre of mass. So shifts are the only
//! transforms, a body's own inertia has no mixed part, and places far from the origin lose no digits.
//!
//! ```
//! use nalgebra::Vector3;
//! use stationary_rigid::tree::{TreeBuilder, TreeMotion, TreeForces};
//! use stationary_rigid::{Body, JointKind, LieGroup, RigidMotion, Rotation};
//!
//! let at = |x, z| RigidMotion { translation: Vector3::new(x, 0.0, z), rotation: Rotation::identity() };
//! let (bar, hinge) = (Body::solid_box(1.0, [0.02, 0.02, 0.5])?, JointKind::Hinge { axis: Vector3::y() });
//! let mut builder = TreeBuilder::default();
//! let upper = builder.hang(None, hinge, [at(0.0, 0.0), at(0.0, 0.5)], bar);
//! builder.hang(Some(upper), hinge, [at(0.0, -0.5), at(0.0, 0.5)], bar);
//!
//! let tree = builder.build()?;
//! let weight = TreeForces::weight(&tree, Vector3::z() * -9.81)?;
//! let mut motion = TreeMotion::new(tree);
//! motion.place(&[0.3, -0.2], &[0.0, 1.0])?;
//! let mut acceleration = [0.0; 2];
//! motion.forward_dynamics(&weight, &mut acceleration)?;
//! let mut torque = [1.0; 2];
//! motion.inverse_dynamics(&weight, &acceleration, &mut torque)?;
//! assert!(torque.iter().all(|torque| torque.abs() < 1e-12));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: errors; twists, wrenches and inertias; [`JointKind`](crate::JointKind); [`Tree`] and its builder;
//! [`TreeMotion`] with its kinematics; [`TreeForces`]; inverse and forward dynamics, the mass
//! matrix, energy and momenta; [`TreeLoops`], which close loops by a few rows; [`TreeDrive`], by which a joint follows a schedule; then [`TreeField`] for
//! the adaptive methods and [`TreeVariational`], the fixed step of open trees. Source: Featherstone,
//! Rigid Body Dynamics Algorithms (2008), chapters 4 to 8; notes 9.5 for the step.

mod error;
mod spatial;
mod inertia;
mod joint;
mod builder;
mod motion;
mod kinematics;
mod forces;
mod inverse_dynamics;
mod forward_dynamics;
mod mass_matrix;
mod invariants;
mod loops;
mod prescribed;
mod field;
mod bilinear;
mod driven;
mod variational;

pub use builder::{Tree, TreeBuilder};
pub use error::{Joining, TreeError};
pub use field::TreeField;
pub use forces::TreeForces;
pub use loops::TreeLoops;
pub use motion::TreeMotion;
pub use prescribed::TreeDrive;
pub use variational::TreeVariational;
