//! One accepted step, and the motion within it.
//!
//! ```text
//! state(t) = the end of a step of t - t_before seconds from the state before
//! ```
//! A step of the same pair from the same start, only shorter: its error is below that of the whole
//! step, which the tolerance holds. A polynomial through what is known at both ends is no match for
//! steps this long: Hermite's quintic is off by 6e-5 where the ends are good to 2e-13. What it costs
//! is the evaluations of a step for each moment that is asked for.

use stationary_calculus::{Covector, Metric, Potential, SizeError, Storage};

use super::{NystromPair, NystromStages};
use crate::{AdaptiveError, State};

/// A step that was accepted; `W` computes what lies within it.
#[derive(Debug)]
pub struct NystromStep<'a, W, C> {
    /// The number of steps taken so far.
    pub number: u64,
    /// The state that the step started from, with its time.
    pub before: &'a State<C>,
    /// The state that it led to.
    pub after: &'a State<C>,
    /// dV at its start.
    pub(super) first: &'a Covector<C>,
    pub(super) stages: &'a mut W,
    pub(super) evaluations: &'a mut u64,
}

impl<T, M, P, C, const S: usize> NystromStep<'_, NystromStages<'_, T, M, P, C, S>, C>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    C: Storage,
{
    /// Writes the state at time `t` within the step to `state`.
    ///
    /// # Errors
    /// A time outside of the step, a state of another size, and a force that is not finite.
    pub fn at(&mut self, t: f64, state: &mut State<C>) -> Result<(), AdaptiveError> {
        let n = self.before.q.as_ref().len();
        SizeError::check("the configuration's numbers", n, state.q.as_ref().len())?;
        SizeError::check("the momentum's components", n, state.p.components().len())?;
        let ends = [self.before, self.after];
        *self.evaluations += within(self.stages, ends, self.first, t, state)?;
        Ok(())
    }
}

/// Writes the state at `t` between two others, and returns how often dV was evaluated.
pub(super) fn within<T, M, P, C, const S: usize>(
    stages: &mut NystromStages<'_, T, M, P, C, S>,
    [before, after]: [&State<C>; 2],
    first: &Covector<C>,
    t: f64,
    state: &mut State<C>,
) -> Result<u64, AdaptiveError>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    C: Storage,
{
    let (from, to) = (before.t, after.t);
    if !(from <= t && t <= to) {
        return Err(AdaptiveError::OutsideStep { t, from, to });
    }
    for end in [before, after] {
        if t == end.t {
            state.clone_from(end);
            return Ok(0);
        }
    }
    stages.advance(before, first, t - from, state);
    state.t = t;
    check_state(state)?;
    Ok(S as u64 - 1)
}

/// An error unless a state is finite.
pub(super) fn check_state<C: Storage>(state: &State<C>) -> Result<(), AdaptiveError> {
    use crate::first_order::check_finite;
    check_finite("the configuration", state.t, state.q.as_ref())?;
    check_finite("the momentum", state.t, state.p.components())
}
