//! An island of contacts, to rounding: its rows all at once, by Newton's method.
//!
//! ```text
//! u = W x + o         W of the island's contacts, o their rates before any impulse
//! ```
//! `x` impulses (N s), `u` rates (m/s); the laws and the method are those of [`CoupledRows`]. Only
//! impulses that leave less than those before, measured from velocities, are kept, and where none do
//! all is as it was.

use stationary_constraints::RowLaw;

use crate::coupled::coupled_rows::CoupledRows;
use crate::solve::island_solver::IMPULSE_ROUNDING;
use crate::solve::sweeps::{Island, Sweeps};

/// What is left relative to the fastest rate before any impulse that is rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// Steps of a refinement, each from the velocities that the last has left.
pub(crate) const REFINEMENTS: usize = 3;

/// The memory of a polish.
#[derive(Debug, Default)]
pub(crate) struct Polish<const D: usize> {
    rows: CoupledRows,
    before: Vec<[f64; D]>,
    impulses: Vec<f64>,
}

impl<const D: usize> Polish<D> {
    /// Changes the impulses of an island until no more than rounding is left, if it can and the island
    /// has no more than `most` contacts, at least to what is `enough` (m/s); says how many systems it solved.
    pub(crate) fn polish<const F: usize>(
        &mut self,
        sweeps: &mut Sweeps<F, D>,
        island: Island<F, D>,
        x: &mut [[f64; D]],
        (most, enough): (usize, f64),
    ) -> usize {
        self.solve(sweeps, island, x, most, |rows, x| rows.solve_by_sets(x, enough).systems)
    }

    /// The same by the sets that more and more sweeps lead to.
    pub(crate) fn persist<const F: usize>(
        &mut self,
        sweeps: &mut Sweeps<F, D>,
        island: Island<F, D>,
        x: &mut [[f64; D]],
        (most, enough): (usize, f64),
    ) -> usize {
        self.solve(sweeps, island, x, most, |rows, x| rows.solve(x, enough).systems)
    }

    fn solve<const F: usize>(
        &mut self,
        sweeps: &mut Sweeps<F, D>,
        island: Island<F, D>,
        x: &mut [[f64; D]],
        most: usize,
        solve: impl FnOnce(&mut CoupledRows, &mut [f64]) -> usize,
    ) -> usize {
        let worst = |left: [f64; 2]| left[0].max(left[1]);
        let offsets = island.contacts.iter().flat_map(|contact| contact.offset);
        let settled = ROUNDING * offsets.fold(0.0_f64, |most, rate| most.max(rate.abs()));
        let left = worst(sweeps.residuals(island, x));
        if island.contacts.len() > most || left <= settled || left.is_nan() {
            return 0;
        }
        self.start(island, x);
        let solved = solve(&mut self.rows, &mut self.impulses);
        x.iter_mut().flatten().zip(&self.impulses).for_each(|(x, found)| *x = *found);
        sweeps.refresh(island, x);
        if worst(sweeps.residuals(island, x)) > left {
            x.copy_from_slice(&self.before);
            sweeps.refresh(island, x);
        }
        solved
    }

    /// Newton's steps whose rates come from velocities, not from impulses: where masses differ much the rounding
    /// of large impulses is in the velocities of what is light alone, and that of what is heavy is known far
    /// better. Says how many systems it solved.
    pub(crate) fn refine<const F: usize>(
        &mut self,
        sweeps: &mut Sweeps<F, D>,
        island: Island<F, D>,
        x: &mut [[f64; D]],
    ) -> usize {
        let worst = |left: [f64; 2]| left[0].max(left[1]);
        let left = worst(sweeps.residuals(island, x));
        self.start(island, x);
        sweeps.refresh(island, x);
        let mut solved = 0;
        while solved < REFINEMENTS {
            let rates = island.contacts.iter().flat_map(|contact| contact.rates(&sweeps.w));
            if !self.rows.refine(&mut self.impulses, rates) {
                break;
            }
            x.iter_mut().flatten().zip(&self.impulses).for_each(|(x, found)| *x = *found);
            sweeps.refresh(island, x);
            solved += 1;
        }
        let pushed = island.contacts.iter().zip(x.iter()).map(|(contact, x)| contact.speed(x));
        let rounding = IMPULSE_ROUNDING * pushed.fold(0.0, f64::max);
        let after = worst(sweeps.residuals(island, x));
        if after.is_nan() || after > left.max(rounding) {
            x.copy_from_slice(&self.before);
            sweeps.refresh(island, x);
        }
        solved
    }

    /// Remembers where it starts, and the rows of all contacts.
    fn start<const F: usize>(&mut self, island: Island<F, D>, x: &[[f64; D]]) {
        self.before.clear();
        self.before.extend_from_slice(x);
        self.impulses.clear();
        self.impulses.extend(x.iter().flatten());
        self.rows.clear();
        for contact in island.contacts {
            self.rows.push(RowLaw::Cone(contact.friction), contact.offset);
        }
        let contacts = island.contacts;
        self.rows.couple(|i, compliances| {
            for (j, w) in (i..).zip(compliances) {
                *w = contacts[i / D].joint_compliance(i % D, &contacts[j / D], j % D);
            }
        });
    }
}
