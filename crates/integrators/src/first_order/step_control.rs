//! How exact a run is to be, and how long its steps may get.
//!
//! ```text
//! |error of component i in a step|  <~  absolute_i + relative |y_i|
//! ```
//! in the root mean square over all components. The error at the end is that of all steps together,
//! carried along by the flow from where each was made: it is proportional to the tolerance, not bounded
//! by it. A component that falls far below its absolute tolerance and grows again is then that of another
//! motion, so let the absolute tolerance be below the least that matters. Radau, BDF and the
//! Nystrom pairs hold parts of it, and all hold a loose one as a tighter one, as their pages say.

use stationary_calculus::Storage;

use super::{AdaptiveError, ControlError, Moment, Work};

/// The error that a step may make.
#[derive(Clone, Debug, PartialEq)]
pub struct Tolerance {
    pub(crate) relative: f64,
    pub(crate) absolute: Vec<f64>,
}

/// Below this a relative tolerance asks for more than rounding allows.
const ROUNDING: f64 = 1e-14;

impl Tolerance {
    /// The same absolute tolerance for every component.
    ///
    /// # Errors
    /// Those of [`Tolerance::componentwise`].
    pub fn new(relative: f64, absolute: f64) -> Result<Self, ControlError> {
        Tolerance::componentwise(relative, vec![absolute])
    }

    /// An absolute tolerance for each component, in its own unit.
    ///
    /// # Errors
    /// [`ControlError::Relative`] unless that is at least 1e-14 and below 1;
    /// [`ControlError::Absolute`] for the first one that is not positive and finite.
    pub fn componentwise(relative: f64, absolute: Vec<f64>) -> Result<Self, ControlError> {
        if !(ROUNDING..1.0).contains(&relative) {
            return Err(ControlError::Relative(relative));
        }
        let wrong = absolute.iter().position(|&value| !(value > 0.0 && value.is_finite()));
        if let Some(component) = wrong {
            return Err(ControlError::Absolute { component, value: absolute[component] });
        }
        Ok(Tolerance { relative, absolute })
    }

    /// What a step may use: a part of this tolerance. A relative tolerance looser than `loosest` is
    /// held as that, the absolute ones with it; none is held finer than rounding allows.
    pub(crate) fn held(&self, part: f64, loosest: f64) -> Tolerance {
        let asked = self.relative;
        let part = part * (loosest / asked).min(1.0);
        self.scaled(part.max((ROUNDING / asked).min(1.0)))
    }

    /// A tolerance this many times as large.
    pub(crate) fn scaled(&self, factor: f64) -> Tolerance {
        let absolute = self.absolute.iter().map(|absolute| factor * absolute).collect();
        Tolerance { relative: factor * self.relative, absolute }
    }

    /// The relative tolerance.
    pub fn relative(&self) -> f64 {
        self.relative
    }
}

/// How steps are chosen.
#[derive(Clone, Debug, PartialEq)]
pub struct StepControl {
    pub(crate) tolerance: Tolerance,
    pub(crate) first: Option<f64>,
    pub(crate) longest: f64,
    pub(crate) constant: Option<f64>,
    pub(crate) most_steps: u64,
}

/// Steps that a run may try unless the caller says otherwise.
const MOST_STEPS: u64 = 1_000_000;

impl From<Tolerance> for StepControl {
    fn from(tolerance: Tolerance) -> Self {
        StepControl {
            tolerance,
            first: None,
            longest: f64::INFINITY,
            constant: None,
            most_steps: MOST_STEPS,
        }
    }
}

impl StepControl {
    /// Starts with a step of `h` seconds instead of one guessed from f.
    ///
    /// # Errors
    /// [`ControlError::Step`] unless `h` is positive and finite.
    pub fn first_step(self, h: f64) -> Result<Self, ControlError> {
        Ok(StepControl { first: Some(positive(h)?), ..self })
    }

    /// Takes no step longer than `h` seconds; only one that ends at the end may be a hundredth longer, so that no
    /// sliver is left.
    ///
    /// # Errors
    /// [`ControlError::Step`] unless `h` is positive and finite.
    pub fn longest_step(self, h: f64) -> Result<Self, ControlError> {
        Ok(StepControl { longest: positive(h)?, ..self })
    }

    /// Takes every step `h` seconds long, whatever its error, unless its equation has no solution. One that ends at
    /// the end is as long as what is left, at most a hundredth longer. The tolerance still governs the solution of implicit steps.
    ///
    /// # Errors
    /// [`ControlError::Step`] unless `h` is positive and finite.
    pub fn constant_step(self, h: f64) -> Result<Self, ControlError> {
        Ok(StepControl { constant: Some(positive(h)?), ..self })
    }

    /// Gives up after this many accepted and rejected steps.
    ///
    /// # Errors
    /// [`ControlError::NoSteps`] for none.
    pub fn most_steps(self, steps: u64) -> Result<Self, ControlError> {
        match steps {
            0 => Err(ControlError::NoSteps),
            most_steps => Ok(StepControl { most_steps, ..self }),
        }
    }
}

fn positive(h: f64) -> Result<f64, ControlError> {
    if h > 0.0 && h.is_finite() { Ok(h) } else { Err(ControlError::Step(h)) }
}

/// A step to try: its length and the time at which it ends.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Attempt {
    pub(crate) h: f64,
    pub(crate) to: f64,
}

impl StepControl {
    /// The next step from `moment`, proposed to be `h` long, that ends at `end` at the latest.
    #[inline]
    pub(crate) fn attempt<C: Storage>(
        &self,
        moment: &Moment<C>,
        h: f64,
        end: f64,
        work: &Work,
    ) -> Result<Attempt, AdaptiveError> {
        let t = moment.t;
        // The negation catches an end that is not a number.
        if !(end > t && end.is_finite()) {
            return Err(AdaptiveError::End { end, t });
        }
        let steps = work.steps + work.rejected;
        if steps >= self.most_steps {
            return Err(AdaptiveError::TooManySteps { steps, last: moment.to_vec() });
        }
        if !(0.1 * h > f64::EPSILON * t.abs() && h > f64::MIN_POSITIVE) {
            return Err(AdaptiveError::StepTooSmall { step: h, last: moment.to_vec() });
        }
        // A remainder of a hundredth of a step is not worth a step of its own.
        if t + 1.01 * h >= end {
            return Ok(Attempt { h: end - t, to: end });
        }
        Ok(Attempt { h, to: t + h })
    }

    /// The step to begin with: the caller's, or `guess`.
    pub(crate) fn begin(&self, guess: f64) -> f64 {
        self.constant.or(self.first).unwrap_or(guess).min(self.longest)
    }

    /// The step to go on with, where the error asks for `h`.
    #[inline]
    pub(crate) fn next(&self, h: f64) -> f64 {
        self.constant.unwrap_or(h.min(self.longest))
    }
}
