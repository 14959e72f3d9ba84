//! Problems with known answers: one definition each for tests, studies and benches.
//!
//! | problem | system | answer |
//! | --- | --- | --- |
//! | [`oscillator`] | a mass on a linear spring | sines and cosines |
//! | [`kepler`] | a planet about a fixed sun, eccentricity e | Kepler's equation |
//! | [`pendulum`] | a rod's angle from hanging | Jacobi's elliptic functions |
//! | [`spring_pendulum`] | a mass on a stiff spring that swings | none: it is there to fail |
//! | [`spring_chain`] | many masses in a row on linear springs | two of its modes |
//! | [`fermi_pasta_ulam`] | springs stiff and soft in turn | none: its adiabatic invariant |
//! | [`henon_heiles`] | a star in a galaxy, regular or chaotic | none: its energy |
//! | [`pleiades`] | seven stars that pass each other closely | the test set's, at t = 3 |
//! | [`three_bodies`] | a sun and two planets | none: it is there for its momenta |
//! | [`van_der_pol`] | a stiff oscillator, first order | 10 digits for mu = 1000 |
//! | [`hires`] | eight reactions, stiff, first order | 10 digits at the end |
//! | [`robertson`] | three reactions, very stiff, first order | 11 digits at the end |
//!
//! [`DoublePendulum`] is a Lagrangian: its mass depends on its configuration, so it is no system.
//! All are dimensionless: masses, lengths and the strength of the field are 1.

mod double_pendulum;
mod fermi_pasta_ulam;
mod henon_heiles;
mod hires;
mod kepler;
mod oscillator;
mod pendulum;
mod pleiades;
mod robertson;
mod spring_chain;
mod spring_pendulum;
mod stiff;
mod three_bodies;
mod van_der_pol;

use std::fmt;

use stationary_calculus::{
    DiagonalMetric, Metric, MetricError, Potential, Readable, SizeError, System,
};

use crate::State;

pub use double_pendulum::DoublePendulum;
pub use fermi_pasta_ulam::{AlternatingSprings, fermi_pasta_ulam};
pub use henon_heiles::{HenonHeilesPotential, henon_heiles};
pub use hires::{HiresField, hires};
pub use kepler::kepler;
pub use oscillator::{Linear, oscillator};
pub use pendulum::{PendulumPotential, pendulum};
pub use pleiades::pleiades;
pub use robertson::{ConstrainedRobertsonField, RobertsonField, constrained_robertson, robertson};
pub use spring_chain::{SpringChain, spring_chain};
pub use spring_pendulum::{TetherPotential, spring_pendulum};
pub use stiff::StiffProblem;
pub use three_bodies::three_bodies;
pub use van_der_pol::{VanDerPolField, van_der_pol};

/// A problem that cannot be stated.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ProblemError {
    /// A parameter outside its range.
    #[error("{name} is {value}; it must be in {range}", value = Readable(value))]
    Parameter {
        /// The parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// The values it may have.
        range: &'static str,
    },
    /// A mass that is not one.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// A metric and a potential of different size.
    #[error(transparent)]
    Size(#[from] SizeError),
}

/// An error unless the parameter is strictly between two numbers.
fn within(
    name: &'static str,
    value: f64,
    range: &'static str,
    open: std::ops::Range<f64>,
) -> Result<(), ProblemError> {
    if value > open.start && value < open.end {
        Ok(())
    } else {
        Err(ProblemError::Parameter { name, value, range })
    }
}

/// The true configuration at a time, where it is known.
pub type Solution<C> = Box<dyn Fn(f64) -> Option<C> + Send + Sync>;

/// A system with initial data, a horizon, and the right answer.
pub struct Problem<M, P, C> {
    /// Its name, with lower-case letters and hyphens.
    pub name: &'static str,
    /// Its metric and potential.
    pub system: System<M, P>,
    /// Where it starts.
    pub initial: State<C>,
    /// The time over which it is asked for, seconds.
    pub horizon: f64,
    /// Its natural unit of time, seconds: a period, or one over a frequency.
    pub period: f64,
    /// Its size, against which errors of a configuration are judged.
    pub scale: f64,
    /// The true configuration at a time.
    pub solution: Solution<C>,
    /// How far the true configuration may itself be off, relative to `scale`.
    pub solution_error: f64,
}

/// A problem of any number of freedoms, each with a mass of its own.
pub type LargeProblem<P> = Problem<DiagonalMetric<Vec<f64>>, P, Vec<f64>>;

/// A problem of N freedoms, each with a mass of its own.
pub type SmallProblem<P, const N: usize> = Problem<DiagonalMetric<[f64; N]>, P, [f64; N]>;

impl<M: Metric, P: Potential, C: AsRef<[f64]>> Problem<M, P, C> {
    /// The energy of a state, joules.
    pub fn energy(&self, state: &State<C>) -> f64 {
        self.system.energy(state.q.as_ref(), state.p.view())
    }

    /// The error of a configuration at a time: the Euclidean distance from the true one relative
    /// to the problem's scale, or `None` where the true one is not known.
    pub fn error(&self, time: f64, q: &C) -> Option<f64> {
        let truth = (self.solution)(time)?;
        let pairs = truth.as_ref().iter().zip(q.as_ref());
        Some(pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt() / self.scale)
    }
}

impl<M, P, C> fmt::Debug for Problem<M, P, C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Problem").field("name", &self.name).finish_non_exhaustive()
    }
}
