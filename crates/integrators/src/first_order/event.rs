//! Events: where a function of time and state crosses zero.
//!
//! ```text
//! g(t, y(t)) = 0,      y(t) the polynomial of the step
//! ```
//! A crossing is found from the signs of g at the ends of a step, and at points between them if
//! asked for, and located by a bracketing search: secants on a bracket that halves whenever they do
//! not shrink it enough, so that the number of evaluations is bounded. A step may have several: each search goes
//! on where the last one ended. Two crossings between neighbouring points are not seen: shorten the longest step,
//! or look at more points.

use stationary_calculus::Storage;

use super::{AcceptedStep, AdaptiveError, AdaptiveMethod, Moment};

/// Which crossings count.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From negative to zero or positive.
    Rising,
    /// From positive to zero or negative.
    Falling,
    /// Either.
    Any,
}

impl Direction {
    fn crosses(self, before: f64, after: f64) -> bool {
        let rises = before < 0.0 && after >= 0.0;
        let falls = before > 0.0 && after <= 0.0;
        match self {
            Direction::Rising => rises,
            Direction::Falling => falls,
            Direction::Any => rises || falls,
        }
    }
}

/// A function whose zero crossings are looked for, step by step.
#[derive(Clone, Debug)]
pub struct Event<G, C> {
    function: G,
    direction: Direction,
    points: u32,
    /// Time and value at the end of the step that was looked at last.
    end: Option<(f64, f64)>,
    /// Time and value where the search stands in the step of this number.
    stands: Option<(u64, (f64, f64))>,
    found: Moment<C>,
}

/// Most evaluations of the function for one crossing. Every third at least halves the bracket, so
/// that 60 halvings, which no clock resolves, fit in.
const MOST_EVALUATIONS: u32 = 180;

impl<G: FnMut(f64, &[f64]) -> f64, C: Storage> Event<G, C> {
    /// The crossings of `function(t, y)`, for a state of the size of `like`.
    pub fn new(direction: Direction, like: &Moment<C>, function: G) -> Self {
        Event { function, direction, points: 0, end: None, stands: None, found: like.clone() }
    }

    /// Looks at this many points within each step, too.
    pub fn looking_at(self, points: u32) -> Self {
        Event { points, ..self }
    }

    /// The moment of the last crossing that was found.
    pub fn moment(&self) -> &Moment<C> {
        &self.found
    }

    /// The value at the end of what was looked at; NaN before anything was.
    pub(crate) fn value(&self) -> f64 {
        self.end.map_or(f64::NAN, |end| end.1)
    }

    fn evaluate(&mut self, t: f64, y: &[f64]) -> Result<f64, AdaptiveError> {
        let value = (self.function)(t, y);
        if value.is_nan() { Err(AdaptiveError::EventValue { t, value }) } else { Ok(value) }
    }

    pub(crate) fn begin(&mut self, moment: &Moment<C>) -> Result<f64, AdaptiveError> {
        let value = self.evaluate(moment.t, moment.y.as_ref())?;
        (self.end, self.stands) = (Some((moment.t, value)), None);
        Ok(value)
    }

    fn evaluate_within<A: AdaptiveMethod<C> + ?Sized>(
        &mut self,
        step: &mut AcceptedStep<'_, C, A>,
        t: f64,
    ) -> Result<f64, AdaptiveError> {
        let mut y = self.found.y.lend();
        let value = step.interpolate(t, y.as_mut()).and_then(|()| self.evaluate(t, y.as_ref()));
        self.found = Moment::new(t, y);
        value
    }

    /// Whether the step has a crossing that was not found yet: the first such one then stands in [`Event::moment`],
    /// and the next call with the same step goes on behind it.
    ///
    /// # Errors
    /// [`AdaptiveError::EventValue`] where the function is NaN; those of
    /// [`AcceptedStep::interpolate`].
    pub fn crossing<A: AdaptiveMethod<C> + ?Sized>(
        &mut self,
        step: &mut AcceptedStep<'_, C, A>,
    ) -> Result<bool, AdaptiveError> {
        let (number, from, to) = (step.number(), step.from(), step.to());
        let mut before = match (self.stands, self.end) {
            (Some((of, stands)), _) if of == number => stands,
            (_, Some(end)) if step.goes_on() && end.0 == from => end,
            _ => (from, self.evaluate_within(step, from)?),
        };
        let last = self.evaluate(to, step.moment().y.as_ref())?;
        self.end = Some((to, last));
        for point in 1..=self.points + 1 {
            let part = f64::from(point) / f64::from(self.points + 1);
            let t = if point > self.points { to } else { from + (to - from) * part };
            if t <= before.0 {
                continue;
            }
            let value = if t == to { last } else { self.evaluate_within(step, t)? };
            if self.direction.crosses(before.1, value) {
                self.stands = Some((number, self.locate(step, before, (t, value))?));
                return Ok(true);
            }
            before = (t, value);
        }
        self.stands = Some((number, before));
        Ok(false)
    }

    /// Narrows the bracket to neighbouring times and leaves the later end, where the sign has
    /// changed, in `found`; that end.
    fn locate<A: AdaptiveMethod<C> + ?Sized>(
        &mut self,
        step: &mut AcceptedStep<'_, C, A>,
        mut a: (f64, f64),
        mut b: (f64, f64),
    ) -> Result<(f64, f64), AdaptiveError> {
        let sign = a.1.signum();
        // Weights of the ends: an end that stays put counts half, so that the other one moves next.
        let mut weights = [1.0, 1.0];
        let mut halve_above = 0.5 * (b.0 - a.0);
        for evaluation in 1..=MOST_EVALUATIONS {
            let width = b.0 - a.0;
            let resolution = 2.0 * f64::EPSILON * a.0.abs().max(b.0.abs());
            if width <= resolution || b.1 == 0.0 {
                break;
            }
            let (left, right) = (weights[0] * a.1, weights[1] * b.1);
            let secant = a.0 + width * (left / (left - right));
            let middle = a.0 + 0.5 * width;
            let stuck = evaluation % 3 == 0 && width > halve_above;
            let inside = secant > a.0 && secant < b.0;
            let t = if inside && !stuck {
                secant.clamp(a.0 + 0.5 * resolution, b.0 - 0.5 * resolution)
            } else {
                middle
            };
            if evaluation % 3 == 0 {
                halve_above *= 0.5;
            }
            let value = self.evaluate_within(step, t)?;
            if value * sign > 0.0 {
                (a, weights) = ((t, value), [1.0, 0.5 * weights[1]]);
            } else {
                (b, weights) = ((t, value), [0.5 * weights[0], 1.0]);
            }
        }
        self.evaluate_within(step, b.0)?;
        Ok(b)
    }
}
