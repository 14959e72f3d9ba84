//! Singular positions: whether a step passes one on its branch, and how an error names it.
//!
//! A linkage may go on in several ways where its equations depend on each other. There the iterations towards a
//! feasible configuration are slow, and impulses at both ends of a step that was turned onto another way are not those
//! of one motion.

use stationary_calculus::{Covector, Metric, Potential, Space, Storage};

use super::RattleCore;
use crate::checks::zeros;
use crate::{Constraint, ConstraintError, FreeMotion, Multipliers, equation_name};

/// A place less regular than this part of the most regular one is near one.
pub(super) const NEAR: f64 = 0.2;
/// The same where iterations failed: otherwise the step was too long.
const SINGULAR: f64 = 0.05;
/// The same where a step may have ended without iterations that showed it.
pub(super) const CLOSE: f64 = 1e-3;
/// Impulses at both ends of a step that differ by more than this part of their sum are not of one motion,
/// unless they are less than the second part of the momentum.
const UNLIKE: f64 = 0.2;
const SLIGHT: f64 = 1e-6;
/// An equation with more than this part of the largest share is involved in a dependence.
const INVOLVED: f64 = 0.1;

/// What tells whether a step passes a singular position on its branch.
#[derive(Clone, Debug)]
pub(super) struct Passage<C> {
    /// Whether the iterations of the last drift had to learn.
    pub(super) slow: bool,
    /// The largest regularity that was seen.
    pub(super) typical: f64,
    /// Momenta before the impulses at the start and at the end of a step.
    pub(super) before: Covector<C>,
    pub(super) after: Covector<C>,
}

impl<C: Storage> Passage<C> {
    pub(super) fn new(n: usize) -> Result<Self, ConstraintError> {
        let (before, after) = (Covector(zeros(n)?), Covector(zeros(n)?));
        Ok(Passage { slow: false, typical: 0.0, before, after })
    }

    pub(super) fn see(&mut self, regularity: Option<f64>) {
        self.typical = self.typical.max(regularity.unwrap_or(0.0));
    }

    pub(super) fn is_singular(&self, regularity: Option<f64>) -> bool {
        regularity.is_some_and(|regularity| regularity < SINGULAR * self.typical)
    }

    /// Whether a regularity is that of a place near a singular position; where it is not known, it
    /// may be.
    pub(super) fn is_near(&self, regularity: Option<f64>) -> bool {
        regularity.is_none_or(|regularity| regularity < NEAR * self.typical)
    }
}

impl<M, P, S, K, C, X, F> RattleCore<'_, M, P, S, K, C, X, F>
where
    M: Metric,
    P: Potential,
    S: Space,
    K: Constraint,
    C: Storage,
    X: Multipliers,
    F: FreeMotion<M, S>,
{
    /// An error where a step that begins or ends near a singular position was turned there: its impulses at both
    /// ends are not those of one motion.
    pub(crate) fn check_passage(&mut self) -> Result<(), ConstraintError> {
        let (here, there) = (self.here.solver.regularity(), self.there.solver.regularity());
        let close = there.is_some_and(|there| there < CLOSE * self.passage.typical);
        let near = self.passage.is_near(here) || self.passage.is_near(there);
        if !(close || self.passage.slow && near) {
            return Ok(());
        }
        let RattleCore { passage, before, next, system, displacement: room, .. } = self;
        let metric = system.metric();
        let mut size = |p: &Covector<C>| {
            metric.sharp(p.view(), room.view_mut());
            p.apply(room).abs().sqrt()
        };
        let whole = size(&next.p);
        passage.before.add_scaled(-1.0, before.view());
        passage.after.add_scaled(-1.0, next.p.view());
        let both = size(&passage.before) + size(&passage.after);
        passage.before.add_scaled(-1.0, passage.after.view());
        if size(&passage.before) <= UNLIKE * both + SLIGHT * whole {
            return Ok(());
        }
        Err(self.nearby_position())
    }

    /// The singular position near which a step begins or ends, with the equations that depend on each other there.
    #[cold]
    pub(super) fn nearby_position(&mut self) -> ConstraintError {
        let RattleCore { here, g, scales, .. } = self;
        let g = g.as_mut();
        let (row, ratio) = here.solver.weakest().unwrap_or((0, f64::NAN));
        let mut rows = vec![row];
        g.fill(0.0);
        if let Some(g) = g.get_mut(row) {
            *g = 1.0;
        }
        // Two inverse iterations from the weakest equation.
        let found = (0..2).all(|_| {
            let size = g.iter().fold(0.0_f64, |size, g| size.max(g.abs()));
            g.iter_mut().for_each(|g| *g /= size);
            here.solver.solve(g).is_ok()
        });
        if found && g.iter().all(|g| g.is_finite()) {
            scales.unscale(g, 1.0);
            let most = g.iter().fold(0.0_f64, |most, g| most.max(g.abs()));
            rows = (0..g.len()).filter(|&row| g[row].abs() > INVOLVED * most).collect();
        }
        self.position(ratio, rows)
    }

    #[cold]
    pub(super) fn position(&self, ratio: f64, rows: Vec<usize>) -> ConstraintError {
        let named = |&row: &usize| equation_name(&self.constraint, row);
        let names = rows.iter().map(named).collect::<Vec<_>>().join(", ");
        ConstraintError::SingularPosition { ratio, rows, names }
    }
}
