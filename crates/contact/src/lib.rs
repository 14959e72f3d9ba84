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
//! distance of chords > e + s/4;   off = |S(h) - S(h/2)^2|  flights, steps chosen by error   (11.4)
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
//! Reading order: differentials of gaps ([`ContactRows`]), the inverse mass ([`InverseMass`]), an
//! [`Impact`] and one contact of it; the inelastic projection ([`project`]), solved exactly; the
//! laws ([`ImpactLaw`]). Rows of all laws, equalities and limits of joints beside contacts, between
//! whatever answers to impulses ([`Response`], [`RowsSolver`]): semismooth Newton, Lemke's pivots, an interior
//! point. Then the plane and space, by the
//! features `2d` and `3d`: what they are to contact ([`Dimension`]), shapes (balls, capsules, cylinders,
//! cones, ellipsoids, boxes, hulls, polygons, half-spaces and meshes), colliders and detection, the same
//! text for both ([`PlanarDetector`], [`Detector`]), which is asked for rays, closest points, overlaps and what
//! sensors feel too; and times of impact, whose "never" is a proof, of particles
//! and edges, of rigid bodies ([`rigid_bodies_meet`]), with the filter of a deforming mesh that
//! rests on it ([`MeshFilter`]). Then time: gaps of [`Balls`], their penalty, the three answers to
//! when ([`Impacting`]). Last, a [`World`], the front door for scenes: bodies of either dimension,
//! their shapes, and what happens, with joints, their limits and their friction ([`JointRows`]), under
//! forces beside those of the potential ([`World::step_under`]). Its one solver: a contact packed for many
//! visits, friction at one of them, islands, the exact projection of small ones, sweeps over the others with
//! sparse systems between them, their parts each on its own, impulses and contact points kept from step to
//! step, what rests on them, what overlaps lifted. Two more ways in time use its laws: impacts at their instant
//! between flights of order 2 or 4, for few bodies ([`EventDriven`]), and steps chosen by their error
//! ([`ErrorControlled`]).
//!
//! The crate knows nothing of elasticity, of scenes or of files, and which geometry library it asks
//! is known to one border file a dimension and the detection behind it.

mod error;
mod coupled;
mod impact;
#[cfg(any(feature = "2d", feature = "3d"))]
mod shapes;
#[cfg(any(feature = "2d", feature = "3d"))]
mod detect;
mod when;
#[cfg(any(feature = "2d", feature = "3d"))]
mod solve;
#[cfg(any(feature = "2d", feature = "3d"))]
mod world;
#[cfg(any(feature = "2d", feature = "3d"))]
mod order;
pub mod problems;

pub use coupled::coupled_rows::RowsMethod;
pub use coupled::response::{FactorResponse, Response, SideBySide};
pub use coupled::rows_solver::{COUPLED_ROWS, RowsReport, RowsSolver};
#[cfg(feature = "3d")]
pub use detect::contact_point::ContactPoint;
#[cfg(feature = "2d")]
pub use detect::contact_point::PlanarContactPoint;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use detect::contact_point::{ContactId, ContactIn};
#[cfg(feature = "3d")]
pub use detect::detection::Detector;
#[cfg(feature = "2d")]
pub use detect::detection::PlanarDetector;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use detect::detection::{DetectorIn, Overlap, gap_rows};
#[cfg(feature = "2d")]
pub use detect::queries::PlanarRayHit;
#[cfg(feature = "3d")]
pub use detect::queries::RayHit;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use detect::queries::RayHitIn;
pub use error::ContactError;
pub use impact::Impact;
pub use impact::inverse_mass::InverseMass;
pub use impact::law::{ImpactFacts, ImpactLaw, ImpactReport, PASSES};
pub use impact::projection::{Projected, project, project_from, residual};
pub use impact::rows::ContactRows;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use order::error_controlled::{ErrorControlled, ErrorControlledReport, STEPS};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use order::event::{Event, EventKind};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use order::event_driven::{EVENTS, EventDriven, EventDrivenReport, SKIN};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use order::flight::{Flies, FlightOrder};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use order::flight_forces::{FlightForces, StageEnd};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use order::step_forces::StepForces;
#[cfg(feature = "3d")]
pub use shapes::collider::Collider;
#[cfg(feature = "2d")]
pub use shapes::collider::PlanarCollider;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use shapes::collider::{Carrier, ColliderIn};
#[cfg(any(feature = "2d", feature = "3d"))]
pub use shapes::dimension::Dimension;
#[cfg(feature = "2d")]
pub use shapes::planar::Planar;
#[cfg(feature = "2d")]
pub use shapes::planar_shape::PlanarShape;
#[cfg(feature = "3d")]
pub use shapes::shape::Shape;
#[cfg(feature = "3d")]
pub use shapes::spatial::Spatial;
pub use when::choice::When;
pub use when::gaps::{Balls, FixedBall, Inequality, Swept, Wall};
pub use when::impacting::{GapImpulses, Impacting, ImpactingReport};
pub use when::mesh_filter::{FilterReport, MeshFilter};
pub use when::moving::{Closeness, Hit, Moving};
pub use when::penalty::OneSidedPenalty;
pub use when::rest::REST_HEIGHT;
#[cfg(feature = "2d")]
pub use when::rigid_path::PlanarPath;
#[cfg(feature = "3d")]
pub use when::rigid_path::RigidPath;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use when::rigid_path::RigidPathIn;
#[cfg(feature = "2d")]
pub use when::rigid_time_of_impact::PlanarHit;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use when::rigid_time_of_impact::{MoverIn, RigidHitIn, rigid_bodies_meet};
#[cfg(feature = "3d")]
pub use when::rigid_time_of_impact::{RigidHit, rigid_bodies_that_meet};
pub use when::time_of_impact::{edge_meets_edge, particle_meets_triangle};
#[cfg(feature = "2d")]
pub use world::PlanarWorld;
#[cfg(feature = "3d")]
pub use world::SpatialWorld;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use world::joints::{JointRows, Kept};
#[cfg(feature = "2d")]
pub use world::masonry::Arch;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use world::painleve::Painleve;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use world::push_apart::push_apart;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use world::report::WorldReport;
#[cfg(any(feature = "2d", feature = "3d"))]
pub use world::{BodiesIn, Touch, World};
