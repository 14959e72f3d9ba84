//! The velocity filter: a step of symplectic Euler that overlaps nothing.
//!
//! ```text
//! v~ = v - h M^-1 dV,   if q + h v~ would overlap: impact, then q + h v                    (11.4, 3)
//! ```
//! Its impact acts on the velocity before the step's own increment, so that no bounce gains energy, and where
//! all approach is of the order of an increment there is no restitution, so that what rests does not rattle.
//! What would still overlap ahead is held by the projection with `dg v >= -g/h`: gaps are used up, not crossed;
//! and where even that overlaps, bodies stay where they were proved free. Source: notes 10.3, 11.4.

use stationary_calculus::{Metric, Potential, Vector};
use stationary_integrators::State;

use crate::error::check_finite;
use crate::impact::projection::project_biased;
use crate::when::impacting::{Impacting, ImpactingReport, Seen, TOUCHING, sum};
use crate::{ContactError, GapImpulses, Impact, Swept};

/// Rounds in which the filter looks for contacts that its own impacts bring about.
const ROUNDS: usize = 100;

impl<M: Metric, P: Potential, K: Swept> Impacting<'_, M, P, K> {
    /// One step of the velocity filter.
    pub(super) fn filtered(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        report: &mut ImpactingReport,
        seen: Seen<'_>,
    ) -> Result<(), ContactError> {
        let mut before = self.velocity(&state.p);
        let increment = self.increment(state, h);
        let mut contacts = Vec::new();
        for _ in 0..ROUNDS {
            let ahead = self.ahead(state, h, &sum(&before, &increment));
            if ahead.is_empty() || !unite(&mut contacts, ahead) {
                break;
            }
            let rows = self.gaps.rows(state.t, &state.q, &contacts);
            // What rests passes an impact on with all its restitution.
            let bounces = |i: usize| {
                let by_increment = rows.along(i, increment.view()).abs();
                rows.along(i, before.view()).abs() > 2.0 * by_increment
            };
            let own = if (0..rows.len()).any(bounces) { self.restitution } else { 0.0 };
            let impact = Impact::new(rows.clone(), &self.mass, vec![own; rows.len()])?;
            let done = self.law.apply(&impact, before.view_mut())?;
            report.impacts += usize::from(done.passes > 0);
            report.last_impact = state.t;
            let (time, q, gaps) = (state.t, &state.q, &contacts);
            seen(GapImpulses { time, q, gaps, impulses: &done.impulses });
        }
        let mut v = sum(&before, &increment);
        let mut held = Vec::new();
        for _ in 0..ROUNDS {
            let ahead = self.ahead(state, h, &v);
            if ahead.is_empty() {
                break;
            }
            unite(&mut contacts, ahead);
            v = sum(&before, &increment);
            let gaps = self.gaps.gaps(state.t, &state.q);
            let bias: Vec<f64> = contacts.iter().map(|&i| gaps[i].max(0.0) / h).collect();
            let rows = self.gaps.rows(state.t, &state.q, &contacts);
            let impact = Impact::new(rows, &self.mass, vec![0.0; contacts.len()])?;
            held = project_biased(&impact, &bias, v.view_mut())?.impulses;
        }
        if !held.is_empty() {
            let (time, q, gaps) = (state.t, &state.q, &contacts);
            seen(GapImpulses { time, q, gaps, impulses: &held });
        }
        self.system.metric().flat(v.view(), state.p.view_mut());
        report.held = !self.ahead(state, h, &v).is_empty();
        if !report.held {
            Vector(&mut state.q[..]).add_scaled(h, v.view());
        }
        check_finite("the configuration", &state.q)
    }

    /// The gaps that a step along v would close.
    fn ahead(&self, state: &State<Vec<f64>>, h: f64, v: &Vector<Vec<f64>>) -> Vec<usize> {
        let way: Vec<f64> = v.0.iter().map(|v| h * v).collect();
        let end: Vec<f64> = state.q.iter().zip(&way).map(|(q, d)| q + d).collect();
        let now = self.gaps.gaps(state.t, &state.q);
        let lowest = self.gaps.lowest(&state.q, Vector(&way));
        let sizes = self.gaps.sizes(&[&state.q, &end]);
        let sinks = |&i: &usize| lowest[i] < now[i].min(0.0) - TOUCHING * sizes[i];
        (0..now.len()).filter(sinks).collect()
    }
}

/// Adds to a sorted list what is not in it; says whether anything was.
fn unite(list: &mut Vec<usize>, more: Vec<usize>) -> bool {
    let before = list.len();
    list.extend(more);
    list.sort_unstable();
    list.dedup();
    list.len() > before
}
