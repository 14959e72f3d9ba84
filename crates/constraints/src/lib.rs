//! How does a system move when not every configuration is allowed?

mod error;
mod constraint;
mod rows;
mod set;
mod pairing;
mod rods;
mod points;
mod linear;
mod function;
mod surface;
mod feasible;
mod multipliers;
mod dense;
#[cfg(feature = "sparse")]
mod entries;
#[cfg(feature = "sparse")]
mod schur;
#[cfg(feature = "sparse")]
mod saddle;
mod integrator;
mod keeper;
mod embedding;
mod arcsine;
mod penalty;
mod projection;
mod step_and_project;
mod critical_point;
mod hamilton;
mod rattle;
mod breaking;
pub mod problems;

pub use arcsine::ArcsinePendulum;
pub use breaking::Broken;
pub use constraint::{Constraint, Rows, Scale};
pub use critical_point::{CriticalPoint, Kind, critical_point};
pub use dense::{DenseMultipliers, Few};
pub use embedding::{Embedding, Links, Reduced, Sampling, Weight};
pub use error::ConstraintError;
pub use function::{Function, FunctionConstraint};
pub use hamilton::ConstrainedHamilton;
pub use integrator::{ConstrainedIntegrator, ConstrainedReport};
pub use linear::Linear;
pub use multipliers::{Multipliers, Redundancy, Solver};
pub use pairing::Pairing;
pub use penalty::Penalty;
pub use points::FixedPoint;
pub use projection::{Projection, ProjectionReport};
pub use rattle::Rattle;
pub use rods::{Rod, Rods};
#[cfg(feature = "sparse")]
pub use saddle::{Coupled, SaddleMultipliers};
#[cfg(feature = "sparse")]
pub use schur::{Many, SchurMultipliers};
pub use step_and_project::StepAndProject;
pub use surface::{Level, OnLevel};
