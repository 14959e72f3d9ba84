//! What can go wrong in a step and in a simulation.

use stationary_calculus::{NewtonError, SizeError};

/// A step that could not be taken; the state is as it was before.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Steps go forward in time by a finite amount.
    #[error("the step is {0} s; it must be positive and finite")]
    Step(f64),
    /// The state does not belong to the system.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// The step leads to a configuration that is not finite.
    #[error("the configuration is not finite after the step, first at freedom {freedom}")]
    NonFiniteConfiguration {
        /// The first such freedom.
        freedom: usize,
    },
    /// The step leads to a momentum that is not finite.
    #[error("the momentum is not finite after the step, first at freedom {freedom}")]
    NonFiniteMomentum {
        /// The first such freedom.
        freedom: usize,
    },
    /// The equation of an implicit step was not solved.
    #[error("the implicit step was not solved: {0}")]
    Newton(#[from] NewtonError),
}

/// A simulation that could not be finished; the state is that after the last good step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step}, from t = {time} s: {source}")]
pub struct SimulationError {
    /// The step that failed, counted from 1.
    pub step: u64,
    /// The time at which it began, seconds.
    pub time: f64,
    /// Why it failed.
    pub source: StepError,
}

/// A horizon that is not a number of steps.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum HorizonError {
    /// Steps go forward in time by a finite amount.
    #[error("the step is {0} s; it must be positive and finite")]
    Step(f64),
    /// A horizon lies ahead.
    #[error("the duration is {0} s; it must be positive and finite")]
    Duration(f64),
    /// Steps are counted one by one.
    #[error("{duration} s is {steps} steps of {step} s, more than can be counted")]
    TooMany {
        /// The duration, seconds.
        duration: f64,
        /// The step, seconds.
        step: f64,
        /// Their quotient.
        steps: f64,
    },
    /// The duration must be a whole number of steps.
    #[error("{duration} s is {steps} steps of {step} s, which is not a whole number")]
    NotWhole {
        /// The duration, seconds.
        duration: f64,
        /// The step, seconds.
        step: f64,
        /// Their quotient.
        steps: f64,
    },
}

/// A study that could not be made.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum StudyError {
    /// The horizon is not a number of steps.
    #[error(transparent)]
    Horizon(#[from] HorizonError),
    /// The storage does not have the system's size.
    #[error(transparent)]
    Size(#[from] SizeError),
}
