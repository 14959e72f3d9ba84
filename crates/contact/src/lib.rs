//! What happens where things touch? Detection, impact and friction, each with its promises measured.

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
mod gaps;
mod penalty;
mod impacting;
mod friction;
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
pub use friction::{Frictional, Staggered};
pub use gaps::{Balls, Inequality, Swept, Wall};
pub use impact::Impact;
pub use impacting::{Impacting, ImpactingReport, REST, When};
pub use inverse_mass::InverseMass;
pub use law::{ImpactFacts, ImpactLaw, ImpactReport, PASSES};
pub use moving::{Closeness, Hit, Moving};
pub use penalty::OneSidedPenalty;
pub use projection::{Projected, project, project_from, residual};
pub use rows::ContactRows;
#[cfg(feature = "3d")]
pub use shape::Shape;
pub use time_of_impact::{edge_meets_edge, particle_meets_triangle};
#[cfg(feature = "3d")]
pub use touching_bodies::{Bodies, TouchingBodies, TouchingReport};
