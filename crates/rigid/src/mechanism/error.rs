//! What a mechanism cannot be asked.

use stationary_calculus::{LeastNormError, Readable, SizeError};

/// A question about a mechanism without an answer.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MechanismError {
    /// Singular values that fall off without a gap: no rank is right.
    #[error(
        "no clear rank: singular values {above:e} and {below:e} of the largest have no gap between them"
    )]
    RankUnclear {
        /// The last that counts, relative to the largest.
        above: f64,
        /// The first that does not.
        below: f64,
    },
    /// No closed pose near the guess.
    #[error(
        "no closed pose near the guess: {name} stays open by {gap:e}, where no motion closes all"
    )]
    NotAssembled {
        /// The equation that is open most, counted from 0.
        row: usize,
        /// The same with the name of its joint.
        name: String,
        /// By how much, metres or radians.
        gap: f64,
    },
    /// The iterations reached their bound on the way to a closed pose.
    #[error("no closed pose after {iterations} iterations: {name} is open by {gap:e}")]
    TooFar {
        /// How many there were.
        iterations: u32,
        /// The equation that is open most, counted from 0.
        row: usize,
        /// The same with the name of its joint.
        name: String,
        /// By how much, metres or radians.
        gap: f64,
    },
    /// Equations that no accelerations and forces satisfy.
    #[error(
        "the equations contradict each other here: {residual:e} of their terms is left with the best \
         accelerations and forces"
    )]
    Contradictory {
        /// What is left of them, relative to their terms.
        residual: f64,
    },
    /// A drive whose speed jumps has no acceleration then.
    #[error(
        "{name} is driven with a speed that jumps at {t} s: ask before or after it",
        t = Readable(t)
    )]
    RateJumps {
        /// The equation, counted from 0.
        row: usize,
        /// The same with the name of what drives it.
        name: String,
        /// The time, seconds.
        t: f64,
    },
    /// A pose that no forces of the joints hold.
    #[error("the pose is no equilibrium: {residual:e} of its forces is left")]
    NotAtRest {
        /// What is left of the forces, relative to them.
        residual: f64,
    },
    /// A number that is not finite.
    #[error("{what}: number {index} is {value}; it must be finite")]
    NonFinite {
        /// What holds it.
        what: &'static str,
        /// Its place.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Something has the wrong size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// The singular values were not found.
    #[error(transparent)]
    LeastNorm(#[from] LeastNormError),
}

pub(super) fn check_finite(what: &'static str, numbers: &[f64]) -> Result<(), MechanismError> {
    match stationary_calculus::first_non_finite(numbers) {
        Some(index) => Err(MechanismError::NonFinite { what, index, value: numbers[index] }),
        None => Ok(()),
    }
}
