//! What can go wrong in a step and in a simulation.

use stationary_calculus::{NewtonError, Readable, SizeError, Unsolvable};

/// A step that could not be taken; the state is as it was before.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StepError {
    /// Steps go forward in time by a finite amount.
    #[error("the step is {} s; it must be positive and finite", Readable(.0))]
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
    /// A discrete Lagrangian does not determine the next configuration from the momentum.
    #[error("the discrete Legendre transform is singular: q and p do not determine the next q")]
    SingularLegendreTransform,
    /// Steps are counted forward, and each moves the time.
    #[error(
        "there are {density} steps a second; it must be a positive number that moves the time",
        density = Readable(density)
    )]
    Density {
        /// Steps a second.
        density: f64,
    },
    /// Saved numbers that no run of this method on this system leaves behind.
    #[error("the saved state does not fit: {0}")]
    Saved(&'static str),
    /// The equation of an implicit step was not solved.
    #[error("the implicit step was not solved: {0}")]
    Newton(#[from] NewtonError),
    /// A step starts and ends at a time.
    #[error("a step would start or end at the time {} s; it must be finite", Readable(.0))]
    Time(f64),
    /// A step starts at a configuration of the system's space.
    #[error(
        "number {number} is where the state stops being a configuration of its space: quaternions \
         have length 1"
    )]
    Configuration {
        /// The first such number.
        number: usize,
    },
}

/// A simulation that could not be finished; the state is that after the last good step.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("step {step}, from t = {time} s: {source}", time = Readable(time))]
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
    #[error("the step is {} s; it must be positive and finite", Readable(.0))]
    Step(f64),
    /// A horizon lies ahead.
    #[error("the duration is {} s; it must be positive and finite", Readable(.0))]
    Duration(f64),
    /// Steps are counted one by one.
    #[error(
        "{duration} s is {steps} steps of {step} s, more than can be counted",
        duration = Readable(duration), steps = Readable(steps), step = Readable(step)
    )]
    TooMany {
        /// The duration, seconds.
        duration: f64,
        /// The step, seconds.
        step: f64,
        /// Their quotient.
        steps: f64,
    },
    /// The duration must be a whole number of steps.
    #[error(
        "{duration} s is {steps} steps of {step} s, which is not a whole number",
        duration = Readable(duration), steps = Readable(steps), step = Readable(step)
    )]
    NotWhole {
        /// The duration, seconds.
        duration: f64,
        /// The step, seconds.
        step: f64,
        /// Their quotient.
        steps: f64,
    },
}

/// More steps of a horizon are said to have been taken than it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("a horizon of {steps} steps cannot be resumed after {done} of them")]
pub struct ResumeError {
    /// The steps that are to have been taken.
    pub done: u64,
    /// The steps that there are.
    pub steps: u64,
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

/// A force that is not what it says.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ForceError {
    /// Drag takes energy away.
    #[error(
        "the drag of freedom {freedom} is {coefficient}; it must be finite and not negative",
        coefficient = Readable(coefficient)
    )]
    Drag {
        /// The freedom.
        freedom: usize,
        /// Its coefficient, N s/m.
        coefficient: f64,
    },
    /// A bump has a place and a width.
    #[error(
        "a bump from {start} s for {width} s; the width must be positive, both finite",
        start = Readable(start), width = Readable(width)
    )]
    Bump {
        /// Where it starts, seconds.
        start: f64,
        /// How long it lasts, seconds.
        width: f64,
    },
}

/// An action that is not defined, or a path on which it is not stationary.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ActionError {
    /// A path has at least one step.
    #[error("the action has no steps")]
    NoSteps,
    /// Steps go forward in time by a finite amount.
    #[error("step {step} is {h} s; it must be positive and finite", h = Readable(h))]
    Step {
        /// The first such step, counted from 0.
        step: usize,
        /// Its length, seconds.
        h: f64,
    },
    /// The path does not belong to the action.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// The guess is not a path.
    #[error("point {point} of the path is not finite, first at freedom {freedom}")]
    NonFinite {
        /// The first such point, counted from 0.
        point: usize,
        /// Its first such freedom.
        freedom: usize,
    },
    /// No stationary path was found near the guess.
    #[error("no stationary path was found: {0}")]
    Newton(#[from] NewtonError),
    /// The action has no definite kind of stationary point.
    #[error("the ends are conjugate on the path that was found: {0}")]
    Conjugate(Unsolvable),
}

/// Impulses that cannot be given, or a simulation that could not be finished.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ImpulseError {
    /// An impulse does not belong to the system.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// An impulse is not finite.
    #[error("impulse {index} is not finite, first at freedom {freedom}")]
    NonFinite {
        /// The impulse, counted from 0.
        index: usize,
        /// Its first such freedom.
        freedom: usize,
    },
    /// No step begins at an impulse or contains it.
    #[error(
        "impulse {index} is at {time} s, outside of [{start} s, {end} s)",
        time = Readable(time), start = Readable(start), end = Readable(end)
    )]
    OutsideTheHorizon {
        /// The impulse, counted from 0.
        index: usize,
        /// Its time, seconds.
        time: f64,
        /// When the horizon starts, seconds.
        start: f64,
        /// When it ends, seconds.
        end: f64,
    },
    /// Impulses come in ascending order.
    #[error(
        "impulse {index} is at {time} s, before the one at {last} s that precedes it",
        time = Readable(time), last = Readable(last)
    )]
    Unsorted {
        /// The impulse, counted from 0.
        index: usize,
        /// Its time, seconds.
        time: f64,
        /// The time of the one before, seconds.
        last: f64,
    },
    /// A step failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
}

/// A parameter of a method outside its range.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{name} is {value}; it must be in {range}", value = Readable(value))]
pub struct ParameterError {
    /// The parameter.
    pub name: &'static str,
    /// Its value.
    pub value: f64,
    /// The values it may have.
    pub range: &'static str,
}

impl ParameterError {
    pub(crate) fn check(
        name: &'static str,
        value: f64,
        range: &'static str,
        inside: bool,
    ) -> Result<(), ParameterError> {
        if inside { Ok(()) } else { Err(ParameterError { name, value, range }) }
    }
}
