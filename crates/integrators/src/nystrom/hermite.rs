//! One accepted step, and the motion within it.
//!
//! ```text
//! q(s) = q + (10 s^3 - 15 s^4 + 6 s^5) (q' - q) + M^-1 (h (v p + v' p') - h^2 (a dV + a' dV'))
//! v = s - 6 s^3 + 8 s^4 - 3 s^5       a = (s^2 - 3 s^3 + 3 s^4 - s^5) / 2
//! v' = -4 s^3 + 7 s^4 - 3 s^5         a' = (s^3 - 2 s^4 + s^5) / 2
//! p(s) = p + (3 s^2 - 2 s^3) (p' - p) - h ((s - 2 s^2 + s^3) dV + (s^3 - s^2) dV')
//! ```
//! `s` the part of the step that has passed, in [0, 1]. Hermite's quintic through configuration,
//! velocity and acceleration at both ends, and his cubic through momentum and force, which cost no
//! evaluation. Their errors are of order 6 and 4 in the step: far larger than those at the ends of
//! the long steps of a method of order 8 or 12. Where that matters, let a run end there instead.

use stationary_calculus::{Covector, Metric, SizeError, Storage, Vector};

use crate::{AdaptiveError, State};

/// A step that was accepted.
#[derive(Debug)]
pub struct NystromStep<'a, M, C> {
    /// The number of steps taken so far.
    pub number: u64,
    /// The state that the step started from, with its time.
    pub before: &'a State<C>,
    /// The state that it led to.
    pub after: &'a State<C>,
    pub(super) differentials: [&'a Covector<C>; 2],
    pub(super) metric: &'a M,
}

impl<M: Metric, C: Storage> NystromStep<'_, M, C> {
    /// Writes the state at time `t` within the step to `state`.
    pub fn at(&self, t: f64, state: &mut State<C>) -> Result<(), AdaptiveError> {
        let (from, to) = (self.before.t, self.after.t);
        if !(from <= t && t <= to) {
            return Err(AdaptiveError::OutsideStep { t, from, to });
        }
        let n = self.metric.dim();
        SizeError::check("the configuration's numbers", n, state.q.as_ref().len())?;
        SizeError::check("the momentum's components", n, state.p.components().len())?;
        let h = to - from;
        let s = (t - from) / h;
        self.configuration(s, h, state);
        self.momentum(s, h, &mut state.p);
        state.t = t;
        Ok(())
    }

    /// q(s); the momentum serves as scratch memory.
    fn configuration(&self, s: f64, h: f64, state: &mut State<C>) {
        let s3 = s * s * s;
        let [dv, dv_after] = self.differentials;
        let (p, p_after) = (&self.before.p, &self.after.p);
        state.p.clear();
        state.p.add_scaled(h * (s - s3 * (6.0 - s * (8.0 - 3.0 * s))), p.view());
        state.p.add_scaled(-h * s3 * (4.0 - s * (7.0 - 3.0 * s)), p_after.view());
        state.p.add_scaled(-0.5 * h * h * s * s * (1.0 - s).powi(3), dv.view());
        state.p.add_scaled(-0.5 * h * h * s3 * (1.0 - s).powi(2), dv_after.view());
        self.metric.sharp(state.p.view(), Vector(state.q.as_mut()));
        let rise = s3 * (10.0 - s * (15.0 - 6.0 * s));
        let ends = self.before.q.as_ref().iter().zip(self.after.q.as_ref());
        for (q, (before, after)) in state.q.as_mut().iter_mut().zip(ends) {
            *q += before + rise * (after - before);
        }
    }

    fn momentum(&self, s: f64, h: f64, p: &mut Covector<C>) {
        let rise = s * s * (3.0 - 2.0 * s);
        let [dv, dv_after] = self.differentials;
        p.clear();
        p.add_scaled(1.0 - rise, self.before.p.view());
        p.add_scaled(rise, self.after.p.view());
        p.add_scaled(-h * s * (1.0 - s).powi(2), dv.view());
        p.add_scaled(h * s * s * (1.0 - s), dv_after.view());
    }
}
