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
//! laws ([`ImpactLaw`]). Then, with the feature `3d`, shapes, colliders and the [`Detector`]; and
//! times of impact, whose "never" is a proof, with the filter of a deforming mesh that rests on it
//! ([`MeshFilter`]). Then time: gaps of [`Balls`], their penalty, the three answers to when
//! ([`Impacting`]). Last, rigid bodies that touch ([`TouchingBodies`]): a contact packed for many
//! visits, friction at one of them, islands, sweeps over an island, and impulses kept from step to
//! step.
//!
//! The crate knows nothing of elasticity, of scenes or of files, and which geometry library it asks
//! is known to one border file and the detection behind it.

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
#[cfg(feature = "3d")]
mod convert;
#[cfg(feature = "3d")]
mod shape;
#[cfg(feature = "3d")]
mod collider;
#[cfg(feature = "3d")]
mod contact_point;
#[cfg(feature = "3d")]
mod broad_phase;
#[cfg(feature = "3d")]
mod detection;
mod moving;
mod time_of_impact;
mod swept_boxes;
mod mesh_filter;
mod gaps;
mod penalty;
mod impacting;
#[cfg(feature = "3d")]
mod rigid_contact;
#[cfg(feature = "3d")]
mod friction;
#[cfg(feature = "3d")]
mod islands;
#[cfg(feature = "3d")]
mod sweeps;
#[cfg(feature = "3d")]
mod exact_normals;
#[cfg(feature = "3d")]
mod last_impulses;
#[cfg(feature = "3d")]
mod touching_bodies;
pub mod problems;

#[cfg(feature = "3d")]
pub use collider::{Carrier, Collider};
#[cfg(feature = "3d")]
pub use contact_point::{ContactId, ContactPoint};
#[cfg(feature = "3d")]
pub use detection::{Detector, Overlap, gap_rows};
pub use error::ContactError;
pub use gaps::{Balls, Inequality, Swept, Wall};
pub use impact::Impact;
pub use impacting::{Impacting, ImpactingReport, REST, When};
pub use inverse_mass::InverseMass;
pub use law::{ImpactFacts, ImpactLaw, ImpactReport, PASSES};
pub use mesh_filter::{FilterReport, MeshFilter};
pub use moving::{Closeness, Hit, Moving};
pub use penalty::OneSidedPenalty;
pub use projection::{Projected, project, project_from, residual};
pub use rows::ContactRows;
#[cfg(feature = "3d")]
pub use shape::Shape;
pub use time_of_impact::{edge_meets_edge, particle_meets_triangle};
#[cfg(feature = "3d")]
pub use touching_bodies::{Bodies, Settling, TouchingBodies, TouchingReport};
