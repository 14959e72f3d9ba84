//! A Runge-Kutta-Nystrom pair with steps as long as the tolerance allows.
//!
//! ```text
//! t_0 < t_1 < ... < end,      |error of each step| <= tolerance
//! ```
//! The steps follow from the motion: what is kept to rounding is linear momentum alone. Energy and
//! angular momentum drift with the error, steadily, since the method is neither symmetric nor
//! symplectic: it is for accuracy over some thousands of turns, not for the character of a motion
//! over millions.

use std::marker::PhantomData;
use std::ops::ControlFlow;

use stationary_calculus::{Metric, Potential, SizeError, Storage, System, first_non_finite};

use super::stages::Stages;
use super::step_trend::StepTrend;
use super::{NystromPair, NystromStep};
use crate::first_order::ErrorScale;
use crate::{AdaptiveError, Moment, State, StepControl, Work};

/// A step that comes this near to the end takes all that is left, so that no sliver remains.
const NEARLY: f64 = 1.01;
/// The least part of a step that time must resolve: stages lie closer to each other than its ends.
const RESOLVED: f64 = 0.1;

/// The pair `T` of `S` stages on a system, with steps of its own choice.
#[derive(Clone, Debug)]
pub struct Nystrom<'s, T, M, P, C, const S: usize> {
    system: &'s System<M, P>,
    control: StepControl,
    scale: ErrorScale<C>,
    stages: Stages<C, S>,
    pair: PhantomData<T>,
}

impl<'s, T, M, P, C, const S: usize> Nystrom<'s, T, M, P, C, S>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    C: Storage,
{
    /// The method on a system. The tolerance is on configurations, and on what the velocity's error
    /// moves them by within a step.
    pub fn new(system: &'s System<M, P>, control: StepControl) -> Result<Self, SizeError> {
        let n = system.dim();
        let scale = ErrorScale::new(&control.tolerance, n)?;
        Ok(Nystrom { system, scale, control, stages: Stages::new(n)?, pair: PhantomData })
    }

    /// Moves `state` to the time `end`, or until the observer, which sees every accepted step,
    /// breaks off. The bound on the number of steps is one on each run.
    ///
    /// # Errors
    /// Where no step meets the tolerance; the state is that after the last good step.
    pub fn run(
        &mut self,
        state: &mut State<C>,
        end: f64,
        mut observe: impl FnMut(NystromStep<'_, M, C>) -> ControlFlow<()>,
    ) -> Result<Work, AdaptiveError> {
        let mut work = Work::default();
        let Nystrom { system, control, scale, stages, .. } = self;
        check(state, system.dim(), end)?;
        stages.begin(system, &state.q);
        work.evaluations += 1;
        let guess = stages.first_step::<T, M, P>(system, state, scale, end - state.t);
        let mut h = control.begin(guess);
        let mut trend = StepTrend::new(T::ORDERS.1);
        while state.t < end {
            let left = end - state.t;
            let length = if NEARLY * h >= left { left } else { h };
            check_attempt(state, length, &work, control.most_steps)?;
            stages.advance::<T, M, P>(system, state, length);
            work.evaluations += S as u64 - 1;
            let error = stages.error::<T>(state, scale);
            let tolerable = error <= 1.0 || control.constant.is_some();
            if !(tolerable && stages.next.check_finite().is_ok()) {
                work.rejected += 1;
                h = trend.refused(length, error);
                continue;
            }
            work.steps += 1;
            work.evaluations += stages.finish::<T, M, P>(system);
            stages.next.t = if length == left { end } else { state.t + length };
            std::mem::swap(state, &mut stages.next);
            h = control.next(trend.accepted(length, error));
            let step = NystromStep {
                number: work.steps,
                before: &stages.next,
                after: state,
                differentials: [&stages.first, &stages.last],
                metric: system.metric(),
            };
            let on = observe(step);
            std::mem::swap(&mut stages.first, &mut stages.last);
            if on.is_break() {
                break;
            }
        }
        Ok(work)
    }
}

/// An error unless the state has the system's size and is finite, and the end lies ahead of it.
fn check<C: Storage>(state: &State<C>, n: usize, end: f64) -> Result<(), AdaptiveError> {
    let t = state.t;
    let parts = [("the configuration", state.q.as_ref()), ("the momentum", state.p.components())];
    for (what, numbers) in parts {
        SizeError::check("the state's numbers", n, numbers.len())?;
        if let Some(component) = first_non_finite(numbers) {
            return Err(AdaptiveError::NonFinite { what, t, component });
        }
    }
    // The negation catches a time that is not a number.
    if end > t && end.is_finite() { Ok(()) } else { Err(AdaptiveError::End { end, t }) }
}

/// An error where time does not resolve the step or where there were too many.
#[inline]
fn check_attempt<C: Storage>(
    state: &State<C>,
    h: f64,
    work: &Work,
    most: u64,
) -> Result<(), AdaptiveError> {
    let last = || {
        let y = [state.q.as_ref(), state.p.components()].concat();
        Moment::new(state.t, y)
    };
    let steps = work.steps + work.rejected;
    let resolved = state.t + RESOLVED * h > state.t && h > f64::MIN_POSITIVE;
    if !resolved {
        return Err(AdaptiveError::StepTooSmall { step: h, last: last() });
    }
    if steps >= most {
        return Err(AdaptiveError::TooManySteps { steps, last: last() });
    }
    Ok(())
}
