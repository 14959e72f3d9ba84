//! What a run with steps of its own choice costs, and what can go wrong in it.

use crate::StepError;

/// What a run cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct AdaptiveCost {
    /// Steps that the state went through.
    pub steps: u64,
    /// Steps that were tried and were too long.
    pub refused: u64,
    /// Differentials of the potential evaluated.
    pub differentials: u64,
}

/// A run that could not be finished; the state is that after the last good step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step}, from t = {time} s: {failure}")]
pub struct AdaptiveError {
    /// The step that failed, counted from 1.
    pub step: u64,
    /// The time at which it began, seconds: that of the last good state.
    pub time: f64,
    /// Why it failed.
    pub failure: AdaptiveFailure,
}

/// Why a run could not be finished.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdaptiveFailure {
    /// The state cannot be stepped from.
    #[error(transparent)]
    State(#[from] StepError),
    /// Runs go forward in time.
    #[error("the end is at t = {0} s, which must be finite and not lie in the past")]
    End(f64),
    /// A step so short that time no longer resolves it.
    #[error("the tolerance asks for a step below {step} s, which time does not resolve")]
    Resolution {
        /// The step that was not taken, seconds.
        step: f64,
    },
    /// The bound on the number of steps.
    #[error("{0} steps did not reach the end")]
    Steps(u64),
}
