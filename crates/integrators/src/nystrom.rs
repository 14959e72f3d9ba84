//! Runge-Kutta-Nystrom methods of high order, with steps of their own choice.
//!
//! ```text
//! q.. = -M^-1 dV(q)
//! ```
//! Where forces do not depend on velocity, a method can go straight for the configuration, and
//! needs far fewer evaluations than a Runge-Kutta method of its order: the methods of this crate
//! for an accurate orbit. [`Nystrom8`] is cheapest for errors down to about 1e-5, [`Nystrom12`] below.
//!
//! ```
//! use std::ops::ControlFlow;
//! use stationary_integrators::{Nystrom12, Tolerance, problems::kepler};
//!
//! let planet = kepler(0.9)?;
//! let mut state = planet.initial.clone();
//! let mut nystrom = Nystrom12::new(&planet.system, Tolerance::new(1e-12, 1e-12)?.into())?;
//! let work = nystrom.run(&mut state, planet.horizon, |_| ControlFlow::Continue(()))?;
//! assert!(planet.error(state.t, &state.q).unwrap() < 1e-9);
//! assert!(work.evaluations < 10_000);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The tolerance is on configurations and momenta, each in its own unit; a step may use a tenth of
//! it, and one looser than 1e-5 is held as 1e-5. [`NystromMethod`] is a pair as one
//! [`AdaptiveMethod`](crate::AdaptiveMethod) among the others, with events, output times, saving and
//! loading.
//!
//! Not for the metric of a configuration that moves on a curved space, nor for stiff systems: the
//! steps would have to resolve the fastest oscillation.

mod method;
mod pair;
mod pair_8_6;
mod pair_12_10;
mod solver;
mod stages;
mod step;

pub use method::{NystromMethod, NystromMethod8, NystromMethod12};
pub use pair::NystromPair;
pub use pair_8_6::Pair8;
pub use pair_12_10::Pair12;
pub use solver::Nystrom;
pub use stages::NystromStages;
pub use step::NystromStep;

/// The pair of order 8: eight evaluations a step.
pub type Nystrom8<'s, M, P, C> = Nystrom<'s, Pair8, M, P, C, 9>;
/// The pair of order 12: seventeen evaluations a step.
pub type Nystrom12<'s, M, P, C> = Nystrom<'s, Pair12, M, P, C, 17>;
