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
pub mod problems;

pub use error::ContactError;
pub use impact::Impact;
pub use inverse_mass::InverseMass;
pub use law::{ImpactFacts, ImpactLaw, ImpactReport, PASSES};
pub use projection::{Projected, project, project_from, residual};
pub use rows::ContactRows;
