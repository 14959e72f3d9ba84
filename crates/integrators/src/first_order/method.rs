//! A method that chooses its own steps.
//!
//! ```text
//! (t, y) -> (t + h, y + ...),    h such that the error of the step is tolerable
//! ```
//! The method owns its moment: it never leaves the last accepted one, whatever fails. Between steps
//! it is data, a list of numbers that [`AdaptiveMethod::save`] hands out and
//! [`AdaptiveMethod::load`] takes back; from there it goes on to the same bits.

use stationary_calculus::{SizeError, Storage, first_non_finite};

use super::{AdaptiveError, FirstOrderFacts, Saved};

/// A state `y` at a time `t`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Moment<C> {
    /// The time, seconds.
    pub t: f64,
    /// The state, n numbers.
    pub y: C,
}

impl<C> Moment<C> {
    /// The state `y` at the time `t`.
    pub fn new(t: f64, y: C) -> Self {
        Moment { t, y }
    }
}

impl<C: Storage> Moment<C> {
    pub(crate) fn check(&self, n: usize) -> Result<(), AdaptiveError> {
        SizeError::check("the state's numbers", n, self.y.as_ref().len())?;
        if !self.t.is_finite() {
            return Err(AdaptiveError::NonFinite { what: "the time", t: self.t, component: 0 });
        }
        check_finite("the state", self.t, self.y.as_ref())
    }

    pub(crate) fn to_vec(&self) -> Moment<Vec<f64>> {
        Moment::new(self.t, self.y.as_ref().to_vec())
    }
}

pub(crate) fn check_finite(
    what: &'static str,
    t: f64,
    numbers: &[f64],
) -> Result<(), AdaptiveError> {
    match first_non_finite(numbers) {
        Some(component) => Err(AdaptiveError::NonFinite { what, t, component }),
        None => Ok(()),
    }
}

/// What a method has done since it was made.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps accepted.
    pub steps: u64,
    /// Steps rejected, for their error or because their equation was not solved.
    pub rejected: u64,
    /// Evaluations of f, those for differences and for dense output included.
    pub evaluations: u64,
    /// Jacobians.
    pub jacobians: u64,
    /// Factorizations of n x n matrices; a complex one counts as one.
    pub factorizations: u64,
    /// Newton iterations, each with as many solves as there are factored matrices.
    pub iterations: u64,
    /// Steps at which an explicit method's stability, not its accuracy, seemed to bound the step;
    /// it looks at one step in sixteen.
    pub stiff: u64,
}

/// Counts beyond are not whole in the numbers that are saved.
const MOST: u64 = 1 << 53;

impl Work {
    /// Visits every count; see [`AdaptiveMethod::visit`].
    pub(crate) fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        for count in [
            &mut self.steps,
            &mut self.rejected,
            &mut self.evaluations,
            &mut self.jacobians,
            &mut self.factorizations,
            &mut self.iterations,
            &mut self.stiff,
        ] {
            let mut number = *count as f64;
            visit(&mut number);
            *count = (number as u64).min(MOST);
        }
    }
}

/// A method bound to a field, standing at a moment.
pub trait AdaptiveMethod<C: Storage> {
    /// What is known of the method.
    fn facts(&self) -> FirstOrderFacts;

    /// The last good moment.
    fn moment(&self) -> &Moment<C>;

    /// What was done so far.
    fn work(&self) -> &Work;

    /// Takes one step that does not lead beyond `end`, and meets `end` exactly where it can.
    ///
    /// # Errors
    /// [`AdaptiveError::End`] unless `end` is finite and lies ahead;
    /// [`AdaptiveError::TooManySteps`]; [`AdaptiveError::StepTooSmall`] where no step that the
    /// clock resolves is accepted.
    fn step(&mut self, end: f64) -> Result<(), AdaptiveError>;

    /// The beginning of the last step, or `None` before the first one and after a restart.
    fn last_begin(&self) -> Option<f64>;

    /// Writes the state at a time within the last step: at its end the moment itself, before that
    /// what the step's own polynomial says. What is written is finite; after an error it is of no use.
    ///
    /// # Errors
    /// A time outside of the last step, an output of another size, and a state that is not finite:
    /// where f overflows between steps, or a step was taken whatever its error.
    fn interpolate(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        let last = self.moment();
        check_inside(self.last_begin(), last.t, t, (y, last.y.as_ref().len()))?;
        if t == last.t {
            y.copy_from_slice(last.y.as_ref());
        } else {
            self.write_inside(t, y)?;
        }
        check_finite("the state within the step", t, y)
    }

    /// Writes the state at a time before the last moment and not before the last step; there is one.
    #[doc(hidden)]
    fn write_inside(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError>;

    /// Goes on from another moment: after an impulse, a switch, an event.
    ///
    /// # Errors
    /// [`AdaptiveError::Size`] for a state of another size; [`AdaptiveError::NonFinite`] for a
    /// time, a state or f there.
    fn restart(&mut self, moment: &Moment<C>) -> Result<(), AdaptiveError>;

    /// Visits, in a fixed order, every number on which the next steps depend.
    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64));

    /// Checks the numbers after a visit that changed them, and recomputes what follows from them.
    ///
    /// # Errors
    /// [`AdaptiveError::NonFinite`] and [`AdaptiveError::Saved`] for numbers that no run leaves
    /// behind.
    fn settle(&mut self) -> Result<(), AdaptiveError>;

    /// Everything on which the next steps depend.
    fn save(&mut self) -> Saved {
        let mut numbers = Vec::new();
        self.visit(&mut |number| numbers.push(*number));
        Saved { method: self.facts().name.to_owned(), numbers }
    }

    /// Takes over what the same method on the same field had saved, or stays as it is.
    ///
    /// # Errors
    /// Another method's name, and numbers that no run leaves behind.
    fn load(&mut self, saved: &Saved) -> Result<(), AdaptiveError> {
        if saved.method != self.facts().name {
            return Err(AdaptiveError::Saved("it is another method's"));
        }
        let before = self.save();
        if before.numbers.len() != saved.numbers.len() {
            return Err(AdaptiveError::Saved("it has another number of numbers"));
        }
        if let Some(slot) = first_non_finite(&saved.numbers) {
            return Err(AdaptiveError::SavedNumber { slot, value: saved.numbers[slot] });
        }
        self.assign(&saved.numbers);
        let settled = self.settle().and_then(|()| self.check_read_back(saved));
        if settled.is_err() {
            self.assign(&before.numbers);
            self.settle()?;
        }
        settled
    }

    /// An error where a number reads back as another: half an order, a negative count.
    #[doc(hidden)]
    fn check_read_back(&mut self, saved: &Saved) -> Result<(), AdaptiveError> {
        let now = self.save().numbers;
        let differs = |(now, saved): (&f64, &f64)| now.to_bits() != saved.to_bits();
        match now.iter().zip(&saved.numbers).position(differs) {
            Some(slot) => Err(AdaptiveError::SavedNumber { slot, value: saved.numbers[slot] }),
            None => Ok(()),
        }
    }

    /// Overwrites the visited numbers, in order.
    #[doc(hidden)]
    fn assign(&mut self, numbers: &[f64]) {
        let mut numbers = numbers.iter();
        self.visit(&mut |number| {
            if let Some(saved) = numbers.next() {
                *number = *saved;
            }
        });
    }
}

/// An error unless `t` lies in the last step and `y` has the size of the state.
fn check_inside(
    from: Option<f64>,
    to: f64,
    t: f64,
    (y, n): (&[f64], usize),
) -> Result<(), AdaptiveError> {
    SizeError::check("the output's numbers", n, y.len())?;
    let from = from.unwrap_or(to);
    if from <= t && t <= to { Ok(()) } else { Err(AdaptiveError::OutsideStep { t, from, to }) }
}
