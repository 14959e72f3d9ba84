//! What happens where things touch? Detection, impact, resting contact and friction, each promise
//! measured.
//!
//! ```text
//! g(q) >= 0,   u = dg v                                 gaps, and how fast they close     (11.2)
//! v+ = v- - (1 + c) u/d M^-1 dg^T,   d = dg M^-1 dg^T   one contact                     (11.4.2)
//! for each i in order; or all at once                   Gauss-Seidel, Jacobi              (11.5)
//! min 1/2 |v - v-|^2_M,   dg v >= 0                     the inelastic projection        (11.5.1)
//! v+ = v= + c (v= - v-),   of what approaches           generalized reflections
//! boxes that overlap -> near features -> g, dg          detection                         (11.1)
//! F(t, u, v) = 0,   0 <= t <= 1                         times of impact                   (11.1)
//! V = k/2 min(g, 0)^2,   h sqrt(k d) < 2                the penalty                       (11.3)
//! after overlap, at the instant, before                 when an impulse is given          (11.4)
//! |beta| <= mu lambda, against sliding                  Coulomb's friction
//! ```
//! `q` a configuration, `v` a velocity, `M` the metric, `g` gaps in metres with sparse
//! differentials `dg`, `c` the restitution (separating over approaching speed, 0 to 1), `lambda`
//! normal and `beta` friction impulses in newton seconds, `mu` the friction. The numbers name
//! sections of the notes.
//!
//! ```
//! use stationary_calculus::Vector;
//! use stationary_contact::{ImpactLaw, problems::newtons_cradle};
//!
//! let cradle = newtons_cradle(5, 2); // two of five balls arrive at 1 m/s
//! let mut v = Vector(cradle.velocity.clone());
//! ImpactLaw::GeneralizedReflections.apply(&cradle.impact()?, v.view_mut())?;
//! for (v, expected) in v.0.iter().zip([0.0, 0.0, 0.0, 1.0, 1.0]) {
//!     assert!((v - expected).abs() < 1e-14);
//! }
//! # Ok::<(), stationary_contact::ContactError>(())
//! ```
//!
//! Reading order: differentials of gaps ([`ContactRows`]), one over the mass ([`InverseMass`]), an
//! [`Impact`] and one contact of it; the inelastic projection ([`project`]), solved exactly; the
//! laws ([`ImpactLaw`]). Then the plane and space, by the features `2d` and `3d`: what they are to
//! contact ([`Dimension`]), shapes, colliders and detection, the same text for both
//! ([`PlanarDetector`], [`Detector`]); and times of impact, whose "never" is a proof, of particles
//! and edges, of rigid bodies ([`rigid_bodies_meet`]), with the filter of a deforming mesh that
//! rests on it ([`MeshFilter`]). Then time: gaps of [`Balls`], their penalty, the three answers to
//! when ([`Impacting`]). A [`World`] is the front door for scenes: bodies of either dimension,
//! their shapes, and what happens, solved exactly. Last, many bodies of space that touch
//! ([`TouchingBodies`]): a contact packed for many visits, friction at one of them, islands, sweeps
//! over an island with sparse systems between them, its parts each on its own, impulses and contact
//! points kept from step to step, what rests on them; and bodies that overlap, pushed apart.
//!
//! The crate knows nothing of elasticity, of scenes or of files, and which geometry library it asks
//! is known to one border file a dimension and the detection behind it.

mod error;
mod rows;
mod inverse_mass;
mod impact;
mod passive_set;
mod projection;
mod gauss_seidel;
mod jacobi;
mod reflection;
mod law;
#[cfg(any(feature = "2d", feature = "3d"))]
mod dimension;
#[cfg(feature = "2d")]
mod planar;
#[cfg(feature = "3d")]
mod spatial;
#[cfg(feature = "2d")]
mod planar_convert;
#[cfg(feature = "3d")]
mod convert;
#[cfg(feature = "2d")]
mod planar_shape;
#[cfg(feature = "3d")]
mod shape;
#[cfg(any(feature = "2d", feature = "3d"))]
mod collider;
#[cfg(any(feature = "2d", feature = "3d"))]
mod contact_point;
#[cfg(any(feature = "2d", feature = "3d"))]
mod broad_phase;
#[cfg(feature = "2d")]
mod planar_narrow_phase;
#[cfg(feature = "3d")]
mod box_axes;
#[cfg(feature = "3d")]
mod narrow_phase;
#[cfg(any(feature = "2d", feature = "3d"))]
mod detection;
mod moving;
mod time_of_impact;
mod swept_boxes;
#[cfg(feature = "3d")]
mod rigid_path;
#[cfg(feature = "3d")]
mod rigid_time_of_impact;
mod mesh_filter;
mod gaps;
mod penalty;
mod impacting;
#[cfg(any(feature = "2d", feature = "3d"))]
mod impact_rounds;
#[cfg(feature = "3d")]
mod rigid_contact;
#[cfg(feature = "3d")]
mod friction;
#[cfg(feature = "3d")]
mod settling;
#[cfg(feature = "3d")]
mod islands;
#[cfg(feature = "3d")]
mod block_cholesky;
#[cfg(feature = "3d")]
mod proximal;
#[cfg(feature = "3d")]
mod sweeps;
#[cfg(feature = "3d")]
mod unsettled_parts;
#[cfg(feature = "3d")]
mod exact_normals;
#[cfg(feature = "3d")]
mod island_solver;
#[cfg(any(feature = "2d", feature = "3d"))]
mod last_impulses;
#[cfg(feature = "3d")]
mod kept_contacts;
#[cfg(feature = "3d")]
mod resting;
#[cfg(feature = "3d")]
mod touching_bodies;
#[cfg(any(feature = "2d", feature = "3d"))]
mod row_friction;
#[cfg(any(feature = "2d", feature = "3d"))]
mod world;
#[cfg(any(feature = "2d", feature = "3d"))]
mod push_apart;
#[cfg(feature = "2d")]
mod masonry;
pub mod problems;

#[cfg(feature = "3d")]
pub use collider::Collider;
#[cfg(feature = "2d")]
pub use collider::PlanarCollider;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use collider::{Carrier, ColliderIn};
#[cfg(feature = "3d")]
pub use contact_point::ContactPoint;
#[cfg(feature = "2d")]
pub use contact_point::PlanarContactPoint;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use contact_point::{ContactId, ContactIn};
#[cfg(feature = "3d")]
pub use detection::Detector;
#[cfg(feature = "2d")]
pub use detection::PlanarDetector;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use detection::{DetectorIn, Overlap, gap_rows};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use dimension::Dimension;
pub use error::ContactError;
pub use gaps::{Balls, FixedBall, Inequality, Swept, Wall};
pub use impact::Impact;
pub use impacting::{GapImpulses, Impacting, ImpactingReport, REST, When};
pub use inverse_mass::InverseMass;
pub use law::{ImpactFacts, ImpactLaw, ImpactReport, PASSES};
#[cfg(feature = "2d")]
pub use masonry::Arch;
pub use mesh_filter::{FilterReport, MeshFilter};
pub use moving::{Closeness, Hit, Moving};
pub use penalty::OneSidedPenalty;
#[cfg(feature = "2d")]
pub use planar::Planar;
#[cfg(feature = "2d")]
pub use planar_shape::PlanarShape;
pub use projection::{Projected, project, project_from, residual};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use push_apart::push_apart;
#[cfg(feature = "3d")]
pub use rigid_path::RigidPath;
#[cfg(feature = "3d")]
pub use rigid_time_of_impact::{Mover, RigidHit, rigid_bodies_meet, rigid_bodies_that_meet};
pub use rows::ContactRows;
#[cfg(feature = "3d")]
pub use settling::{Settling, TouchingReport};
#[cfg(feature = "3d")]
pub use shape::Shape;
#[cfg(feature = "3d")]
pub use spatial::Spatial;
pub use time_of_impact::{edge_meets_edge, particle_meets_triangle};
#[cfg(feature = "3d")]
pub use touching_bodies::{Bodies, TouchingBodies};
#[cfg(feature = "2d")]
pub use world::PlanarWorld;
#[cfg(feature = "3d")]
pub use world::SpatialWorld;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use world::{BodiesIn, Touch, World, WorldReport};
