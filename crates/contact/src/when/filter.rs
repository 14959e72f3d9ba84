//! The velocity filter: a step of symplectic Euler that overlaps nothing.
//!
//! ```text
//! v~ = v - h M^-1 dV,   if q + h v~ would overlap: impact, then q + h v                    (11.4, 3)
//! ```
//! Its impact acts on the velocity before the step's own increment, so that no bounce gains energy, and where
//! all approach is of the order of an increment there is no restitution, so that what rests does not rattle.
//! What would still overlap ahead is held by the projection with `dg v >= -g/h`: gaps are used up, not crossed;
//! and where even that overlaps, bodies stay where they were proved free.
//!
//! Between two walls that are nearer than a step is long no velocity bounces off both: a step in which things
//! that face each other close is made in halves, and those in halves, until they close one after the other.
//! Source: notes 10.3, 11.4.

use stationary_calculus::{Metric, Potential, Vector};
use stationary_integrators::State;

use crate::error::check_finite;
use crate::impact::projection::{project, project_biased};
use crate::when::impacting::{Impacting, ImpactingReport, Seen, TOUCHING, sum};
use crate::{ContactError, GapImpulses, Impact, Swept};

/// Rounds in which the filter looks for contacts that its own impacts bring about.
const ROUNDS: usize = 100;
/// How often a step is halved at most.
const HALVINGS: u32 = 10;

impl<M: Metric, P: Potential, K: Swept> Impacting<'_, M, P, K> {
    /// One step of the velocity filter, in halves where things bounce to and fro within it.
    pub(super) fn filtered(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        report: &mut ImpactingReport,
        seen: Seen<'_>,
    ) -> Result<(), ContactError> {
        self.filtered_in_halves(state, h, HALVINGS, report, seen)
    }

    fn filtered_in_halves(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        halvings: u32,
        report: &mut ImpactingReport,
        seen: Seen<'_>,
    ) -> Result<(), ContactError> {
        if self.filtered_once(state, h, halvings == 0, report, seen)? {
            return Ok(());
        }
        let (begin, half) = (state.t, 0.5 * h);
        self.filtered_in_halves(state, half, halvings - 1, report, seen)?;
        state.t = begin + half;
        self.filtered_in_halves(state, half, halvings - 1, report, seen)
    }

    /// The whole step at once; unless it is the `last` resort says whether it could be made, and if not all is
    /// as it was.
    fn filtered_once(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        last: bool,
        report: &mut ImpactingReport,
        seen: Seen<'_>,
    ) -> Result<bool, ContactError> {
        let mut before = self.velocity(&state.p);
        let increment = self.increment(state, h);
        let mut contacts = Vec::new();
        let mut given: Vec<(Vec<usize>, Vec<f64>)> = Vec::new();
        let mut impacts = 0;
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
            let done = match self.law.apply(&impact, before.view_mut()) {
                Err(ContactError::NotConverged { .. }) if !last => return Ok(false),
                done => done?,
            };
            let hit = |&(i, contact): &(usize, &usize)| {
                done.impulses[i] > 0.0 && was_hit(&given, *contact)
            };
            let again: Vec<usize> =
                contacts.iter().enumerate().filter(hit).map(|(i, _)| i).collect();
            if !last && own > 0.0 && is_squeezed(&impact, &again) {
                return Ok(false);
            }
            impacts += usize::from(done.passes > 0);
            given.push((contacts.clone(), done.impulses));
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
            given.push((contacts, held));
        }
        for (gaps, impulses) in &given {
            seen(GapImpulses { time: state.t, q: &state.q, gaps, impulses });
        }
        report.impacts += impacts;
        if impacts > 0 {
            report.last_impact = state.t;
        }
        self.system.metric().flat(v.view(), state.p.view_mut());
        let stays = !self.ahead(state, h, &v).is_empty();
        report.held |= stays;
        if !stays {
            Vector(&mut state.q[..]).add_scaled(h, v.view());
        }
        check_finite("the configuration", &state.q)?;
        Ok(true)
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

/// Whether an earlier impact gave a contact an impulse.
fn was_hit(given: &[(Vec<usize>, Vec<f64>)], contact: usize) -> bool {
    let hit = |(gaps, impulses): &(Vec<usize>, Vec<f64>)| {
        gaps.binary_search(&contact).is_ok_and(|i| impulses[i] > 0.0)
    };
    given.iter().any(hit)
}

/// Of the velocity that a contact's own impulse brings the others leave less than this part, if it is squeezed.
const SQUEEZED: f64 = 1e-2;

/// Whether one of these contacts cannot open, or hardly; what no projection tells of counts as free to.
fn is_squeezed(impact: &Impact, contacts: &[usize]) -> bool {
    contacts.iter().any(|&contact| {
        let mut opening = Vector(vec![0.0; impact.freedoms()]);
        impact.push(contact, 1.0, opening.view_mut());
        project(impact, opening.view_mut()).is_ok()
            && impact.relative_velocity(contact, opening.view())
                < SQUEEZED * impact.compliance(contact)
    })
}

/// Adds to a sorted list what is not in it; says whether anything was.
fn unite(list: &mut Vec<usize>, more: Vec<usize>) -> bool {
    let before = list.len();
    list.extend(more);
    list.sort_unstable();
    list.dedup();
    list.len() > before
}
