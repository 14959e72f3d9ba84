//! Which method, and which step? The cheapest run that keeps an observable within a tolerance, by
//! measurement.
//!
//! ```text
//! error = max_t |x(t) - x*(t)| / scale        over the whole way, x* confirmed by another kind of method
//! work  = max(steps, differentials + energies) + w Hessians
//! min work   over all families and rungs that were run, with   error <= tolerance
//! ```
//! `x` the observable, `t` the time, `w` the work of a Hessian with its factorization, in differentials.
//!
//! ```
//! use std::time::Duration;
//! use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};
//! use stationary_choose::{MeasuredRuns, Motion, answer, picture};
//! use stationary_integrators::State;
//!
//! struct Duffing; // V(q) = q^4 / 4 - q^2 / 2: two wells
//! impl Potential for Duffing {
//!     fn dim(&self) -> usize { 1 }
//!     fn energy(&self, q: &[f64]) -> f64 { 0.25 * q[0].powi(4) - 0.5 * q[0] * q[0] }
//!     fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) { dv.0[0] += q[0].powi(3) - q[0]; }
//!     fn add_hessian(&self, q: &[f64], h: &mut impl Sink) { h.add_symmetric(&[0], &[3.0 * q[0] * q[0] - 1.0]); }
//! }
//! let system = System::new(DiagonalMetric::new([1.0])?, Duffing)?;
//! let start = State::new(vec![0.1], Covector(vec![0.0]));
//! let motion = Motion::new(&system, start, 20.0, |state| vec![state.q[0]])?;
//! let mut runs = MeasuredRuns::new(&motion, Duration::from_secs(60))?;
//! let answer = answer(&mut runs, 1e-4)?;
//! println!("{answer}"); // the choice, runners-up, failures, and the reference that they were judged by
//! let chart = picture(&answer)?;
//! assert!(answer.choice().is_some() && chart.starts_with("<svg"));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Reading order: what can be run in many ways ([`Experiment`], with its [`Ladder`] of families and rungs,
//! and what a run leaves, a [`Record`]); the two that are ready-made: the [`Motion`] of any system and the
//! [`Flow`] of any first-order field; the [`MeasuredRuns`], in which no rung is run twice; the [`Reference`], the
//! [`LadderSearch`], and the look over the whole way ([`Moments`], [`Look`], [`Seen`]); the
//! [`Answer`]. Last what the search is measured against: [`exhaustive`] runs every rung that could be cheaper.
//!
//! The crate knows no scene and opens no file. What it cannot see is on its page: an observable that a bad
//! method keeps for free (what else is off stands beside the choice), and the truth of the potential.

mod error;
mod ladder;
mod samples;
mod experiment;
mod watch;
mod measured;
mod grid;
mod look;
mod track;
mod effort;
mod measured_runs;
mod reference;
mod ladder_search;
mod way;
mod seen;
mod verify;
mod agreement;
mod closer;
mod confirm;
mod refinement;
mod search;
mod answer;
mod charted;
mod picture;
mod exhaustive;
mod dense_output;
mod motion;
mod flow;

pub use answer::{Answer, Row, Verdict};
pub use charted::charted;
pub use effort::{Effort, Purpose};
pub use error::QuestionError;
pub use exhaustive::{Found, exhaustive};
pub use experiment::{Experiment, Record};
pub use flow::Flow;
pub use grid::{Moments, inside, is_at, own_parts, until};
pub use ladder::{
    At, Family, Finer, Kind, Ladder, MOMENTS, SAMPLES, Scale, Setting, adaptive_steps, equal_steps,
    numbers_of_steps, powers, samples, work_of_step,
};
pub use ladder_search::{Judgement, LadderSearch, judge};
pub use look::Look;
pub use measured::{Course, End, Failure, Foresight, Measured, StopRule, counted};
pub use measured_runs::MeasuredRuns;
pub use motion::Motion;
pub use picture::{chart, picture};
pub use reference::{Extrapolated, Reference, preferred};
pub use refinement::{MeshError, Refined};
pub use samples::{Energies, Samples};
pub use search::{answer, refer};
pub use seen::{PlaceOff, Seen};
pub use verify::{Doubt, way_error};
pub use watch::Watch;
