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

use stationary_calculus::{Metric, Potential, SizeError, Storage, System};

use super::stages::Stages;
use super::step_control::StepControl;
use super::{NystromPair, NystromStep};
use crate::integrator::check_size;
use crate::{AdaptiveCost, AdaptiveError, AdaptiveFailure, State, Tolerance};

/// Attempts in one run, unless the caller sets another bound.
const MOST_STEPS: u64 = 100_000_000;
/// A step that comes this near to the end takes all that is left, so that no sliver remains.
const NEARLY: f64 = 1.01;
/// The least part of a step that time must resolve: stages lie closer to each other than its ends.
const RESOLVED: f64 = 0.1;

/// The pair `T` of `S` stages on a system, with step control.
#[derive(Clone, Debug)]
pub struct Nystrom<'s, T, M, P, C, const S: usize> {
    system: &'s System<M, P>,
    tolerance: Tolerance,
    most_steps: u64,
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
    pub fn new(system: &'s System<M, P>, tolerance: Tolerance) -> Result<Self, SizeError> {
        let stages = Stages::new(system.dim())?;
        Ok(Nystrom { system, tolerance, most_steps: MOST_STEPS, stages, pair: PhantomData })
    }

    /// The same with a bound on the steps that one run may try.
    pub fn with_most_steps(self, most_steps: u64) -> Self {
        Nystrom { most_steps, ..self }
    }

    /// Moves `state` to the time `end`, or until the observer, which sees every accepted step,
    /// breaks off.
    ///
    /// # Errors
    /// Where no step meets the tolerance; the state is that after the last good step.
    pub fn run(
        &mut self,
        state: &mut State<C>,
        end: f64,
        mut observe: impl FnMut(NystromStep<'_, M, C>) -> ControlFlow<()>,
    ) -> Result<AdaptiveCost, AdaptiveError> {
        let mut cost = AdaptiveCost::default();
        let Nystrom { system, tolerance, stages, .. } = self;
        check(state, system.dim(), end)?;
        stages.begin(system, &state.q);
        cost.differentials += 1;
        let mut control = StepControl::new(T::ORDERS.1);
        let mut h = stages.first_step::<T, M, P>(system, state, tolerance, end - state.t);
        while state.t < end {
            let left = end - state.t;
            let length = if NEARLY * h >= left { left } else { h };
            check_attempt(state.t, length, &cost, self.most_steps)?;
            stages.advance::<T, M, P>(system, state, length);
            cost.differentials += S as u64 - 1;
            let error = stages.error::<T>(state, tolerance);
            if !(error <= 1.0 && stages.next.check_finite().is_ok()) {
                cost.refused += 1;
                h = control.refused(length, error);
                continue;
            }
            cost.steps += 1;
            cost.differentials += stages.finish::<T, M, P>(system);
            stages.next.t = if length == left { end } else { state.t + length };
            std::mem::swap(state, &mut stages.next);
            h = control.accepted(length, error);
            let step = NystromStep {
                number: cost.steps,
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
        Ok(cost)
    }
}

/// An error unless the state has the system's size, is finite and does not lie beyond the end.
fn check<C: Storage>(state: &State<C>, n: usize, end: f64) -> Result<(), AdaptiveError> {
    let fail = |failure| AdaptiveError { step: 1, time: state.t, failure };
    check_size(state, n).map_err(|error| fail(error.into()))?;
    state.check_finite().map_err(|error| fail(error.into()))?;
    if !(end >= state.t && end.is_finite()) {
        return Err(fail(AdaptiveFailure::End(end)));
    }
    Ok(())
}

/// An error where time does not resolve the step or where there were too many.
#[inline]
fn check_attempt(t: f64, h: f64, cost: &AdaptiveCost, most: u64) -> Result<(), AdaptiveError> {
    let failure = if t + RESOLVED * h <= t || !h.is_finite() {
        AdaptiveFailure::Resolution { step: h }
    } else if cost.steps + cost.refused >= most {
        AdaptiveFailure::Steps(most)
    } else {
        return Ok(());
    };
    Err(AdaptiveError { step: cost.steps + 1, time: t, failure })
}
