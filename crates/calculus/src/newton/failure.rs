//! How Newton's method fails: why, and with the residuals on the way there.

use std::fmt;

use crate::{SizeError, Unsolvable};

/// Why a solve failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NewtonFailure {
    /// The bound on the iterations was reached.
    NotConverged,
    /// No step length lets the energy or the residual fall.
    Stalled,
    /// The linearized equation was not solved.
    Unsolvable(Unsolvable),
    /// The residual at the initial guess, or a Newton step, is not finite at this unknown.
    NonFinite(usize),
    /// The energy falls without end.
    Unbounded,
    /// The tolerance is this; it must be zero or positive.
    Tolerance(f64),
    /// The unknowns, the memory or the equation have another size.
    Size(SizeError),
}

impl fmt::Display for NewtonFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NewtonFailure::NotConverged => f.write_str("reached its bound on the iterations"),
            NewtonFailure::Stalled => f.write_str("found no step that makes progress"),
            NewtonFailure::Unsolvable(why) => write!(f, "stopped: {why}"),
            NewtonFailure::NonFinite(i) => write!(f, "met a non-finite number at unknown {i}"),
            NewtonFailure::Unbounded => f.write_str("follows an energy that falls without end"),
            NewtonFailure::Tolerance(tolerance) => {
                write!(f, "was given a tolerance of {tolerance}; it must be zero or positive")
            }
            NewtonFailure::Size(error) => write!(f, "was given wrong sizes: {error}"),
        }
    }
}

/// A failed solve, with the size of the residual at each iterate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("Newton's method {failure}; the residual was {}", Course(&self.history))]
pub struct NewtonError {
    /// What failed.
    pub failure: NewtonFailure,
    /// The residual's size at the initial guess and after each step.
    pub history: Vec<f64>,
}

/// Where residuals began and where they ended.
struct Course<'a>(&'a [f64]);

impl fmt::Display for Course<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            [] => f.write_str("never computed"),
            [only] => write!(f, "{only:.1e}"),
            [first, .., last] => {
                write!(f, "{first:.1e} at first, {last:.1e} after {} steps", self.0.len() - 1)
            }
        }
    }
}
