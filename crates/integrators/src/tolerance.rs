//! The error that a user tolerates in a step, absolute and relative.
//!
//! ```text
//! |error_i| <= absolute + relative max(|y_i|, |y'_i|)        for every number y_i of the state
//! ```
//! The error is the estimate for one step, not the error at the end, which is a sum of what is left
//! of all of them: halving it is a matter of trying.

/// What is tolerated, valid by construction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    relative: f64,
    absolute: f64,
}

/// A tolerance that no step can meet, or that is not a number.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ToleranceError {
    /// It must be a number from 0 below 1.
    #[error("the relative tolerance is {0}; it must be at least 0 and below 1")]
    Relative(f64),
    /// It must be finite and not negative.
    #[error("the absolute tolerance is {0}; it must be at least 0 and finite")]
    Absolute(f64),
    /// At least one of them must be there.
    #[error("both tolerances are 0, which no step can meet")]
    Zero,
}

impl Tolerance {
    /// A tolerance relative to the numbers of the state, and an absolute one in their unit.
    pub fn new(relative: f64, absolute: f64) -> Result<Self, ToleranceError> {
        if !(0.0..1.0).contains(&relative) {
            return Err(ToleranceError::Relative(relative));
        }
        if !(absolute >= 0.0 && absolute.is_finite()) {
            return Err(ToleranceError::Absolute(absolute));
        }
        if relative == 0.0 && absolute == 0.0 {
            return Err(ToleranceError::Zero);
        }
        Ok(Tolerance { relative, absolute })
    }

    /// What is tolerated of a number that is `before` and `after` a step.
    #[inline]
    pub fn of(&self, before: f64, after: f64) -> f64 {
        self.absolute + self.relative * before.abs().max(after.abs())
    }
}
