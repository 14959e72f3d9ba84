//! A Runge-Kutta-Nystrom pair with steps as long as the tolerance allows.
//!
//! ```text
//! t_0 < t_1 < ... < end,      |error of each step| <= tolerance
//! ```
//! The steps follow from the motion: what is kept to rounding is linear momentum alone. Energy and
//! angular momentum drift with the error, steadily, since the method is neither symmetric nor
//! symplectic: it is for accuracy over some thousands of turns, not for the character of a motion
//! over millions.

use std::ops::ControlFlow;

use stationary_calculus::{Covector, Metric, Potential, SizeError, Storage, System};

use super::stages::Tolerated;
use super::step::check_state;
use super::{NystromPair, NystromStages, NystromStep};
use crate::first_order::{ErrorScale, StepTrend, check_finite};
use crate::integrator::zeros;
use crate::{AdaptiveError, Moment, State, StepControl, Tolerance, Work};

/// A step that comes this near to the end takes all that is left, so that no sliver remains.
const NEARLY: f64 = 1.01;
/// The least part of a step that time must resolve: stages lie closer to each other than its ends.
const RESOLVED: f64 = 0.1;

/// The relative tolerance above which an estimate of order 6 or 10 is no longer one.
pub(super) const LOOSEST: f64 = 1e-5;
/// The part of the tolerance that a step may use: a close encounter amplifies its error.
const PART: f64 = 0.1;

/// The pair `T` of `S` stages on a system, with steps of its own choice.
#[derive(Clone, Debug)]
pub struct Nystrom<'s, T, M, P, C, const S: usize> {
    control: StepControl,
    tolerated: Tolerated<C>,
    pub(super) stages: NystromStages<'s, T, M, P, C, S>,
    /// The state before the last step; while a step is tried, the one after it.
    pub(super) other: State<C>,
    /// dV at the start of a step, and at its end.
    pub(super) first: Covector<C>,
    pub(super) last: Covector<C>,
    /// The step proposed for the next attempt, and the errors so far.
    pub(super) h: f64,
    pub(super) trend: StepTrend,
}

impl<'s, T, M, P, C, const S: usize> Nystrom<'s, T, M, P, C, S>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    C: Storage,
{
    /// The method on a system of n freedoms. The tolerance is on configurations and momenta: one
    /// absolute tolerance for all, or 2 n of them, those of the momenta last.
    ///
    /// # Errors
    /// A storage of another size, or another number of tolerances.
    pub fn new(system: &'s System<M, P>, control: StepControl) -> Result<Self, SizeError> {
        let n = system.dim();
        let zero: C = zeros(n)?;
        Ok(Nystrom {
            tolerated: tolerated(&control.tolerance.held(PART, LOOSEST), n)?,
            control,
            stages: NystromStages::new(system)?,
            other: State::new(zero.clone(), Covector(zero.clone())),
            first: Covector(zero.clone()),
            last: Covector(zero),
            h: 0.0,
            trend: StepTrend::new(T::ORDERS.1),
        })
    }

    /// Moves `state` to the time `end`, or until the observer, which sees every accepted step,
    /// breaks off. The bound on the number of steps is one on each run.
    ///
    /// # Errors
    /// Where no step meets the tolerance, and where the state or dV there is not finite; the state is
    /// that after the last good step.
    pub fn run(
        &mut self,
        state: &mut State<C>,
        end: f64,
        mut observe: impl FnMut(NystromStep<'_, NystromStages<'s, T, M, P, C, S>, C>) -> ControlFlow<()>,
    ) -> Result<Work, AdaptiveError> {
        let mut work = Work::default();
        self.check(state)?;
        check_end(state.t, end)?;
        self.begin(state, &mut work)?;
        while state.t < end {
            self.step(state, end, &mut work)?;
            let on = observe(NystromStep {
                number: work.steps,
                before: &self.other,
                after: state,
                first: &self.first,
                stages: &mut self.stages,
                evaluations: &mut work.evaluations,
            });
            self.go_on();
            if on.is_break() {
                break;
            }
        }
        Ok(work)
    }

    /// An error unless the state has the system's size and is finite.
    pub(super) fn check(&self, state: &State<C>) -> Result<(), AdaptiveError> {
        let n = self.stages.system.dim();
        SizeError::check("the configuration's numbers", n, state.q.as_ref().len())?;
        SizeError::check("the momentum's components", n, state.p.components().len())?;
        check_state(state)
    }

    /// Starts from a state: dV there, and a first step. Where dV is not finite all stays as it was.
    pub(super) fn begin(&mut self, state: &State<C>, work: &mut Work) -> Result<(), AdaptiveError> {
        let Nystrom { stages, first, tolerated, control, .. } = self;
        let mut dv = Covector(stages.differential.0.lend());
        stages.differential_at(&state.q, &mut dv);
        work.evaluations += 1;
        let finite = check_finite("dV", state.t, dv.components());
        if finite.is_ok() {
            std::mem::swap(first, &mut dv);
        }
        stages.differential.0.put_back(dv.0);
        finite?;
        self.h = control.begin(stages.first_step(state, first, &tolerated.configuration));
        self.trend = StepTrend::new(T::ORDERS.1);
        Ok(())
    }

    /// Moves `state` by one step that ends at `end` at the latest; the state before it is then in
    /// `other`, and both differentials are known.
    #[inline]
    pub(super) fn step(
        &mut self,
        state: &mut State<C>,
        end: f64,
        work: &mut Work,
    ) -> Result<(), AdaptiveError> {
        let Nystrom { control, tolerated, stages, other: next, first, last, h, trend } = self;
        loop {
            let left = end - state.t;
            let length = if NEARLY * *h >= left { left } else { *h };
            // What is proposed must be resolved; what is left before the end may be any time.
            check_attempt(state, *h, work, control.most_steps)?;
            stages.advance(state, first, length, next);
            work.evaluations += S as u64 - 1;
            let error = stages.error(state, next, length, tolerated);
            let tolerable = error <= 1.0 || control.constant.is_some();
            if !(tolerable && next.check_finite().is_ok()) {
                work.rejected += 1;
                *h = trend.refused(length, error);
                continue;
            }
            work.steps += 1;
            if T::FIRST_SAME_AS_LAST {
                std::mem::swap(last, &mut stages.differential);
            } else {
                stages.differential_at(&next.q, last);
                work.evaluations += 1;
            }
            if length == left {
                next.t = end;
            }
            std::mem::swap(state, next);
            let proposed = control.next(trend.accepted(length, error));
            // A last step that was cut short says little of the next one.
            *h = if length < *h { proposed.max(*h) } else { proposed };
            return Ok(());
        }
    }

    /// The end of the last step is the start of the next.
    #[inline]
    pub(super) fn go_on(&mut self) {
        std::mem::swap(&mut self.first, &mut self.last);
    }
}

fn tolerated<C: Storage>(tolerance: &Tolerance, n: usize) -> Result<Tolerated<C>, SizeError> {
    let absolute = match tolerance.absolute.as_slice() {
        [same] => vec![*same; 2 * n],
        each => each.to_vec(),
    };
    SizeError::check("the tolerances", 2 * n, absolute.len())?;
    let part = |absolute: &[f64]| -> Result<ErrorScale<C>, SizeError> {
        let mut stored: C = zeros(n)?;
        stored.as_mut().copy_from_slice(absolute);
        Ok(ErrorScale { relative: tolerance.relative, absolute: stored })
    };
    Ok(Tolerated { configuration: part(&absolute[..n])?, momentum: part(&absolute[n..])? })
}

/// An error unless the end lies ahead.
pub(super) fn check_end(t: f64, end: f64) -> Result<(), AdaptiveError> {
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
