//! The impacts of a step: what closes its gap, and what that brings to close.
//!
//! ```text
//! contact i hits where   g_i + h dg_i (v + k) < 0   and   dg_i v < -max(2 |dg_i k|, still)
//! ```
//! `g` gaps (m), `v` the velocity before the kick `k` (m/s), `h` the step (s). Approach of the order of
//! a kick is rest and has no restitution. A contact that an impact brings to approach takes part in it:
//! the law is applied again to it and to those that hit before, each with its own restitution, until no
//! contact is added. So a row of balls that touch passes a blow on, and a stack at rest stays at rest.

use stationary_calculus::Vector;

use crate::{ContactError, ContactRows, Impact, ImpactLaw, ImpactReport, InverseMass};

/// Approach below this part of the largest velocity or kick is rest: gaps have rounding of their
/// own, which a short step turns into velocity.
const STILL: f64 = 1e-9;
/// What of it may be left by an impact: velocities after a step have the rounding of its kick, beside
/// which the impacts of what all but rests are smaller still.
const LEFT: f64 = 1e-3;

/// Contacts about to be stepped over.
pub(crate) struct ImpactRounds<'a> {
    pub(crate) rows: &'a ContactRows,
    pub(crate) mass: &'a InverseMass,
    pub(crate) law: ImpactLaw,
    pub(crate) kick: &'a Vector<Vec<f64>>,
    pub(crate) h: f64,
}

impl ImpactRounds<'_> {
    /// Applies the impacts to the velocity before the kick. `gap` and `restitution` are those of a
    /// contact; `seen` is shown each impact, the contacts in it and what the law did.
    pub(crate) fn apply(
        &self,
        gap: impl Fn(usize) -> f64,
        restitution: impl Fn(usize) -> f64,
        v: &mut Vector<Vec<f64>>,
        mut seen: impl FnMut(&Impact, &[usize], &ImpactReport, &Vector<Vec<f64>>),
    ) -> Result<(), ContactError> {
        let count = self.rows.len();
        let mut closing: Vec<usize> = Vec::new();
        // Each round adds a contact.
        for _ in 0..count {
            let fastest = |v: &Vector<Vec<f64>>| v.0.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
            let still = STILL * (fastest(v) + fastest(self.kick));
            let hits = |&i: &usize| {
                let (own, by_kick) =
                    (self.rows.along(i, v.view()), self.rows.along(i, self.kick.view()));
                gap(i) + self.h * (own + by_kick) < 0.0 && own < -(2.0 * by_kick.abs()).max(still)
            };
            let new: Vec<usize> =
                (0..count).filter(|i| !closing.contains(i)).filter(hits).collect();
            if !new.iter().any(|&i| restitution(i) > 0.0) {
                break;
            }
            closing.extend(new);
            closing.sort_unstable();
            let own = closing.iter().map(|&i| restitution(i)).collect();
            let impact = Impact::new(self.rows.reordered(&closing), self.mass, own)?;
            let done = self.law.apply_down_to(&impact, LEFT * still, v.view_mut())?;
            seen(&impact, &closing, &done, v);
        }
        Ok(())
    }
}
