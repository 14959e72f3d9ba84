//! What can go wrong in a run that chooses its own steps.

use stationary_calculus::{Readable, SizeError};

use super::Moment;

/// Settings that no run can obey.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ControlError {
    /// A relative tolerance below rounding or so large that it asks for nothing.
    #[error("the relative tolerance is {}; it must be at least 1e-14 and below 1", Readable(.0))]
    Relative(f64),
    /// An absolute tolerance that is not a size.
    #[error(
        "the absolute tolerance of component {component} is {value}; it must be positive and finite",
        value = Readable(value)
    )]
    Absolute {
        /// The first such component.
        component: usize,
        /// Its tolerance.
        value: f64,
    },
    /// Steps go forward in time by a finite amount.
    #[error("the step is {} s; it must be positive and finite", Readable(.0))]
    Step(f64),
    /// A run takes steps.
    #[error("the bound on the number of steps is 0")]
    NoSteps,
}

/// A run that could not go on; the method stays at the last good moment.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AdaptiveError {
    /// A number of unknowns, of tolerances or of the storage that does not match.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// The method takes y' = f(t, y) only.
    #[error("{method} takes no mass matrix")]
    MassMatrix {
        /// The method.
        method: &'static str,
    },
    /// An order that the method does not have.
    #[error("the highest order is {got}; it must be from 1 to {highest}")]
    Order {
        /// The order asked for.
        got: usize,
        /// The highest that there is.
        highest: usize,
    },
    /// The state to start from, or f there, is not finite.
    #[error(
        "{what} is not finite at t = {t} s, first in component {component}",
        t = Readable(t)
    )]
    NonFinite {
        /// What is not finite.
        what: &'static str,
        /// The time, seconds.
        t: f64,
        /// The first such component.
        component: usize,
    },
    /// Time runs forward.
    #[error(
        "the end {end} s does not lie ahead of t = {t} s",
        end = Readable(end), t = Readable(t)
    )]
    End {
        /// The end asked for, seconds.
        end: f64,
        /// Where the method stands, seconds.
        t: f64,
    },
    /// No step that the clock resolves meets the tolerance: a singularity, or a jump.
    #[error("the step shrank to {step:e} s at t = {} s, which the clock does not resolve", Readable(&last.t))]
    StepTooSmall {
        /// The step that was refused, seconds.
        step: f64,
        /// The last good moment.
        last: Moment<Vec<f64>>,
    },
    /// More steps than the caller allows.
    #[error("{steps} steps were tried, and t = {} s is as far as they led", Readable(&last.t))]
    TooManySteps {
        /// Accepted and rejected steps together.
        steps: u64,
        /// The last good moment.
        last: Moment<Vec<f64>>,
    },
    /// Dense output knows the last step only.
    #[error(
        "t = {t} s lies outside the last step, from {from} s to {to} s",
        t = Readable(t), from = Readable(from), to = Readable(to)
    )]
    OutsideStep {
        /// The time asked for, seconds.
        t: f64,
        /// The beginning of the last step.
        from: f64,
        /// Its end.
        to: f64,
    },
    /// Times of output that do not ascend.
    #[error("output time {place} is {t} s; the times must be finite and ascend", t = Readable(t))]
    OutputTimes {
        /// Its place in the list, counted from 0.
        place: usize,
        /// The time.
        t: f64,
    },
    /// A function of the event that is not a number.
    #[error(
        "the event's function is {value} at t = {t} s",
        value = Readable(value), t = Readable(t)
    )]
    EventValue {
        /// The time, seconds.
        t: f64,
        /// The value.
        value: f64,
    },
    /// The event that the caller waited for did not happen.
    #[error(
        "the event's function went from {first} to {last} without the crossing asked for until t = {end} s",
        first = Readable(first), last = Readable(last), end = Readable(end)
    )]
    NoEvent {
        /// The value at the start.
        first: f64,
        /// The value at the end.
        last: f64,
        /// The end, seconds.
        end: f64,
    },
    /// A saved number that is not finite, or is none that its place can hold.
    #[error(
        "saved number {slot} is {value}, which no run of this method leaves there",
        value = Readable(value)
    )]
    SavedNumber {
        /// Its place, counted from 0.
        slot: usize,
        /// The number.
        value: f64,
    },
    /// Saved numbers that no run of this method on this field leaves behind.
    #[error("the saved state does not fit: {0}")]
    Saved(&'static str),
}
