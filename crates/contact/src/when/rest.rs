//! What rests at an instant, and a step in which it goes on resting while all else flies.
//!
//! ```text
//! u = dg v,   w = dg (P a - a),   u^2 <= 2 eps l w        a bounce lower than eps l: rest
//! v~ = P (v - h/2 M^-1 dV(q)),    q' = q + h v~           P keeps what rests from closing     (11.1)
//! v' = P (v~ - h/2 M^-1 dV(q'))
//! ```
//! `u` how fast a gap opens, m/s; `a = -M^-1 dV` accelerations; `P` the inelastic projection that knows the gaps that
//! rest; `w` what it takes from a gap's acceleration, m/s^2, so that a ball rests on another that rests, and two that
//! fall side by side do not; `l` the length that the gap is a difference of ([`Swept::sizes`]), m, and `eps`
//! [`REST_HEIGHT`]. What no resting gap reaches moves by Stormer-Verlet, as if nothing rested: an exact parabola in
//! a uniform field.

use stationary_calculus::{Metric, Potential, Vector};
use stationary_integrators::{Integrator, State};

use crate::error::check_finite;
use crate::impact::projection::{project, project_onto};
use crate::when::impacting::{Impacting, Seen, TOUCHING, sum};
use crate::{ContactError, GapImpulses, Impact, Swept};

/// Bounces lower than this part of the length that their gap is a difference of ([`Swept::sizes`]) are rest.
pub const REST_HEIGHT: f64 = 1e-12;

/// The gaps that rest at one configuration.
#[derive(Debug)]
pub(super) struct Resting {
    pub(super) gaps: Vec<usize>,
    impact: Impact,
}

/// Where half a kick and a drift lead, how fast, and the impulses of what rests.
pub(super) struct HeldPlace {
    pub(super) q: Vec<f64>,
    v: Vector<Vec<f64>>,
    impulses: Vec<f64>,
}

impl Resting {
    /// Nothing.
    pub(super) fn none() -> Self {
        Resting { gaps: Vec::new(), impact: Impact::empty() }
    }
}

impl<M: Metric, P: Potential, K: Swept> Impacting<'_, M, P, K> {
    /// What rests for the time that is left, and whether anything else that touches comes on.
    pub(super) fn at_rest(
        &self,
        state: &State<Vec<f64>>,
        left: f64,
        sizes: &[f64],
    ) -> Result<(Resting, bool), ContactError> {
        let gaps = self.gaps.gaps(state.t, &state.q);
        let near = self.near(state, sizes);
        if near.is_empty() {
            return Ok((Resting::none(), false));
        }
        let impact = self.impact_at(state, &near, 0.0)?;
        let (v, increment) = (self.velocity(&state.p), self.increment(state, left));
        // No law takes less for an approach, and what holds what rests is no nearer to zero.
        let unfelt = impact.rounding(v.view()).max(impact.rounding(increment.view()));
        let rates: Vec<f64> =
            (0..near.len()).map(|i| impact.relative_velocity(i, v.view())).collect();
        let (mut slow, none) = ((0..near.len()).collect::<Vec<_>>(), vec![0.0; near.len()]);
        let pressed_by = loop {
            let mut pushed = increment.clone();
            let impulses = project_onto(&impact, &slow, &none, pushed.view_mut())?.impulses;
            let pressed_by = |i: usize| impulses[i] * impact.compliance(i) * left;
            let bounds = slow.len();
            slow.retain(|&i| {
                let low = REST_HEIGHT * sizes[near[i]];
                let way = rates[i] * left;
                rates[i].abs() <= unfelt || way * way <= 2.0 * low * pressed_by(i)
            });
            if slow.len() == bounds {
                break (0..near.len()).map(pressed_by).collect::<Vec<_>>();
            }
        };
        // What presses less moves nothing that can be told from rounding.
        let rests = |i: usize| pressed_by[i] > TOUCHING * sizes[near[i]];
        let comes = |i: usize| {
            gaps[near[i]] <= TOUCHING * sizes[near[i]] && rates[i] < -unfelt && !rests(i)
        };
        let arrives = (0..near.len()).any(comes);
        let resting: Vec<usize> = (0..near.len()).filter(|&i| rests(i)).map(|i| near[i]).collect();
        let impact = self.impact_at(state, &resting, 0.0)?;
        Ok((Resting { gaps: resting, impact }, arrives))
    }

    /// Where what rests and what flies is after a time, how fast, and the impulses of what rests.
    pub(super) fn held_place(
        &self,
        state: &State<Vec<f64>>,
        h: f64,
        resting: &Resting,
    ) -> Result<HeldPlace, ContactError> {
        let mut v = sum(&self.velocity(&state.p), &self.increment(state, 0.5 * h));
        let impulses = project(&resting.impact, v.view_mut())?.impulses;
        let mut q = state.q.clone();
        Vector(&mut q[..]).add_scaled(h, v.view());
        Ok(HeldPlace { q, v, impulses })
    }

    /// A step of Stormer-Verlet in which what rests does not close.
    pub(super) fn free_step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        resting: &Resting,
        sizes: &[f64],
        seen: Seen<'_>,
    ) -> Result<(), ContactError> {
        if resting.gaps.is_empty() {
            self.verlet.step(state, h)?;
            return Ok(());
        }
        let HeldPlace { q, v, impulses } = self.held_place(state, h, resting)?;
        let (time, gaps) = (state.t, &resting.gaps);
        seen(GapImpulses { time, q: &state.q, gaps, impulses: &impulses });
        (state.q, state.t) = (q, state.t + h);
        let mut v = sum(&v, &self.increment(state, 0.5 * h));
        let mut still = self.near(state, sizes);
        still.retain(|gap| resting.gaps.contains(gap));
        let impulses = project(&self.impact_at(state, &still, 0.0)?, v.view_mut())?.impulses;
        let (time, q, gaps) = (state.t, &state.q, &still);
        seen(GapImpulses { time, q, gaps, impulses: &impulses });
        self.system.metric().flat(v.view(), state.p.view_mut());
        check_finite("the configuration", &state.q)?;
        check_finite("the momentum", &state.p.0)
    }

    /// The gaps lower than a bounce at rest: of an impact, all of these touch.
    pub(super) fn near(&self, state: &State<Vec<f64>>, sizes: &[f64]) -> Vec<usize> {
        let gaps = self.gaps.gaps(state.t, &state.q);
        (0..gaps.len()).filter(|&gap| gaps[gap] <= REST_HEIGHT * sizes[gap]).collect()
    }
}
