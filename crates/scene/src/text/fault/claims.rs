//! What is wrong with claims.

use stationary_calculus::Readable;

/// What is wrong with claims.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ClaimFault {
    /// A claim of what is not written down.
    #[error("a claim is about one of the scene's `observables`; add this one to them")]
    ClaimOfUnobserved,
    /// A claim is about one thing.
    #[error("a claim is `of` an observable, or of the time of an `event`; give one of them")]
    OfOrEvent,
    /// A claim without a number.
    #[error("this claim needs a number: what it `is`")]
    NothingClaimed,
    /// A key of a claim that would not be looked at.
    #[error("`{0}` has no meaning in this claim")]
    UnusedInClaim(&'static str),
    /// A number is claimed of one component.
    #[error("this observable has {0} components; a claim of a number needs the `component` of one")]
    NoComponent(usize),
    /// A band that holds nothing.
    #[error("the band is {}; it must be 0 or above", Readable(.0))]
    NegativeBand(f64),
    /// A time to which the scene does not run.
    #[error(
        "the claim is of time {time}; the scene runs from 0 to {horizon}",
        time = Readable(time), horizon = Readable(horizon)
    )]
    ClaimBeyond {
        /// The time.
        time: f64,
        /// The horizon.
        horizon: f64,
    },
    /// A time at which nothing is written down.
    #[error(
        "there is no sample at time {time}; the nearest is at {nearest}",
        time = Readable(time), nearest = Readable(nearest)
    )]
    ClaimBetweenSamples {
        /// The time.
        time: f64,
        /// That of the nearest sample.
        nearest: f64,
    },
    /// An event that cannot happen.
    #[error("nothing in this scene leads to a `{0}`")]
    NoSuchEvent(String),
}
