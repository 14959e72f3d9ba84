//! Sweeps over the contacts of an island, each relaxed in turn, and between them steps of the
//! proximal-point method for all at once.
//!
//! ```text
//! x <- sweep(x),   e = 1.5 (|dx|^2/|x|^2)^1/2,    x <- proximal step (x, e),    x <- sweep(x), ...
//! ```
//! `x` the impulses of the island, `|.|` in the norm of their compliance, `dx` what a sweep
//! changes. Sweeps tell who pushes, sticks and slides, and how far the conditions are from being
//! met, but carry far only slowly: a column that rocks takes hundreds of them. Proximal steps carry
//! far at once (see [`Proximal`]), the farther the closer `x` is already. The last sweep is taken
//! as it is, so that no impulse pulls and no friction exceeds its reach.

use crate::proximal::Proximal;
use crate::rigid_contact::{RigidContact, Six};

/// The compliance that a proximal step adds to a row: its part of what a sweep changes, and the
/// least and the largest, relative to the row's own.
const SOFT: f64 = 1.5;
const SOFTEST: f64 = 0.05;
const FIRMEST: f64 = 1e-6;

/// What one contact changes last, others feel by no more than so many times that.
const FELT: f64 = 30.0;
/// A proximal step helps if the next sweep changes no more than this part of the energy of the one
/// before; if it does not, as where it has come down to rounding, some sweeps follow without.
const HELPS: f64 = 0.25;
/// The most sweeps that follow.
const PATIENCE: usize = 512;

/// Scaled velocities of all bodies, and the memory of the sweeps.
#[derive(Debug, Default)]
pub(crate) struct Sweeps {
    /// The scaled change of each body's velocity, and zeros for what does not move.
    pub(crate) w: Vec<Six>,
    proximal: Proximal,
}

/// One island: its contacts, and its bodies by their numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Island<'a> {
    pub(crate) contacts: &'a [RigidContact],
    pub(crate) bodies: &'a [usize],
}

/// What a sweep changed.
struct Change {
    /// The most at one contact, as a velocity, m/s.
    fastest: f64,
    /// Of all, J, and relative to that of the impulses.
    energy: f64,
    part: f64,
}

impl Sweeps {
    /// So many bodies whose velocities are as they were.
    pub(crate) fn start(&mut self, bodies: usize) {
        self.w.clear();
        self.w.resize(bodies + 1, [0.0; 6]);
    }

    /// Gives the bodies of an island impulses.
    pub(crate) fn push(&mut self, island: Island, x: &[[f64; 3]]) {
        island.contacts.iter().zip(x).for_each(|(contact, x)| contact.push(x, &mut self.w));
    }

    /// How far the normal conditions and Coulomb's law of an island are from being met, m/s.
    pub(crate) fn residuals(&self, island: Island, x: &[[f64; 3]]) -> [f64; 2] {
        let one = |(contact, x): (&RigidContact, _)| contact.residuals(x, &self.w);
        let worst = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.max(c), b.max(d)];
        island.contacts.iter().zip(x).map(one).fold([0.0; 2], worst)
    }

    fn is_met(&self, island: Island, x: &[[f64; 3]], by: f64) -> bool {
        self.residuals(island, x).iter().all(|&left| left <= by)
    }

    /// Sweeps over an island until none of its contacts changes a velocity by more than `settled`,
    /// nor is off by much more, at most `bound` times; says how many times, and how many sparse
    /// systems were solved.
    pub(crate) fn settle(
        &mut self,
        island: Island,
        x: &mut [[f64; 3]],
        settled: f64,
        bound: usize,
    ) -> [usize; 2] {
        let (mut solved, mut last) = (0, f64::INFINITY);
        // Sweeps to come without a step, and after the next step that does not help; whether the
        // last sweep came after a step.
        let (mut wait, mut patience, mut stepped) = (0, 1, false);
        for sweep in 1..=bound {
            let Change { fastest, energy, part } = self.sweep(island, x);
            let done = fastest <= settled && self.is_met(island, x, FELT * settled);
            if done || sweep == bound {
                return [sweep, solved];
            }
            if stepped && energy > HELPS * last {
                (wait, patience) = (patience, (2 * patience).min(PATIENCE));
            }
            last = energy;
            stepped = wait == 0;
            if !stepped {
                wait -= 1;
                continue;
            }
            let soft = (SOFT * part).clamp(FIRMEST, SOFTEST);
            solved += self.proximal.step(island, [soft, energy], x, &mut self.w);
        }
        [bound, solved]
    }

    /// Relaxes each contact once.
    fn sweep(&mut self, island: Island, x: &mut [[f64; 3]]) -> Change {
        let (mut fastest, mut energy, mut whole) = (0.0_f64, 0.0, 0.0);
        let square = |roots: [f64; 3]| roots.iter().map(|root| root * root).sum::<f64>();
        for (contact, x) in island.contacts.iter().zip(x) {
            let change = contact.relax(x, &mut self.w);
            fastest = fastest.max(contact.speed(&change));
            energy += square(contact.root(&change));
            whole += square(contact.root(x));
        }
        // Where nothing pushes there is nothing to change either.
        let part = if whole > 0.0 { (energy / whole).sqrt() } else { 0.0 };
        Change { fastest, energy, part }
    }
}
