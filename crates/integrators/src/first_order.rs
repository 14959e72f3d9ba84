//! First-order systems: the shape that chemistry and control come in, and mechanics can be put in.
//!
//! ```text
//! y' = f(t, y)      or      M y' = f(t, y)
//! ```
//! `y` n numbers, `t` seconds, `M` a constant n x n matrix that may be singular. A right-hand side
//! is a [`VectorField`]; mechanics is one instance ([`MechanicalField`]). The methods choose their
//! own steps from a [`Tolerance`], know what lies within their last step, and are data between
//! steps: what is saved goes on to the same bits.
//!
//! | method | for | mass matrix |
//! | --- | --- | --- |
//! | [`DormandPrince853`] | smooth motion, many digits | none |
//! | [`DormandPrince54`] | smooth motion, a few digits | none |
//! | [`RadauIia5`] | stiff systems, index-1 constraints | any |
//! | [`BackwardDifferences`] | stiff systems, costly factorizations | any |
//!
//! Nothing here is symplectic: over long times a mechanical system drifts.

mod backward_differences;
mod dormand_prince;
mod dormand_prince_54;
mod error;
mod error_scale;
mod event;
mod facts;
mod first_step;
mod global_error;
mod integrate;
mod linearization;
mod lu;
mod mechanical;
mod method;
mod output;
mod radau;
mod saved;
mod step_control;
mod step_trend;
mod stiffness;
mod vector_field;

pub use backward_differences::BackwardDifferences;
pub use dormand_prince::DormandPrince853;
pub use dormand_prince_54::DormandPrince54;
pub use error::{AdaptiveError, ControlError};
pub(crate) use error_scale::ErrorScale;
pub use event::{Direction, Event};
pub use facts::FirstOrderFacts;
pub(crate) use first_step::CLOCK;
pub use global_error::{EstimatedMoment, integrate_with_error};
pub use integrate::{AcceptedStep, Outcome, integrate, integrate_to_event};
pub use mechanical::MechanicalField;
pub(crate) use method::check_finite;
pub use method::{AdaptiveMethod, Moment, Work};
pub use output::OutputTimes;
pub use radau::RadauIia5;
pub use saved::Saved;
pub use step_control::{StepControl, Tolerance};
pub(crate) use step_trend::StepTrend;
pub use vector_field::{FunctionField, Jacobian, VectorField};
