//! Resting contact and friction with the moments of rolling friction, where any pair has them.
//!
//! ```text
//! islands that are small enough       impulses and moments at once, from their rows
//! others, and where that fails        moments for given impulses, and the other way round, by turns
//! ```
//! Rows are those of [`RollingRows`](crate::solve::rolling_rows::RollingRows), turns those of
//! [`ContactMoments`](crate::solve::rolling::ContactMoments). Where all laws are met no energy is gained; where nothing
//! settles, what the rows left is taken if it is less than what the turns left, and moments that would give energy are
//! dropped.

use stationary_calculus::Potential;

use crate::solve::rolling::{Taken, Turns};
use crate::world::memory::Memory;
use crate::world::tolerances::{LARGE, Settled};
use crate::{ContactError, ContactIn, Dimension, World, WorldReport};

impl<G: Dimension, P: Potential> World<G, P> {
    /// Resting contact and friction, and moments where any pair has them; says what counts as settled.
    pub(super) fn rest_rolling(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
        report: &mut WorldReport,
    ) -> Result<Settled, ContactError> {
        // Of velocities before any impulse: moments may be large, and cancel.
        let limits = self.settled(contacts, h);
        let Memory { v, increment, free, weight, moments, rolling, .. } = &mut self.memory;
        if !moments.start(contacts, &self.detector) {
            self.rest(contacts, q, (h, limits), report)?;
            return Ok(limits);
        }
        rolling.start();
        free.copy_from(v.view());
        weight.copy_from(increment.view());
        let change = if contacts.len() > LARGE { limits.enough } else { limits.finest };
        let start = *report;
        let (mut turns, mut last) = (Turns::default(), false);
        loop {
            let (relaxed, solved) = (report.relaxed, report.solved);
            *report = WorldReport { relaxed, solved, ..start };
            let (off, taken) = self.rest_under_moments(contacts, q, (h, limits), report)?;
            let fits = off <= limits.reached(change);
            let Memory { v, increment, weight, moments, rolling, states, impulses, .. } =
                &mut self.memory;
            let met = fits && (report.settled || !taken.gains);
            let about_contacts = turns.about_contacts;
            // Rows leave less than turns do.
            let turns_help =
                rolling.misses_some(moments.moments.len()) || rolling.left().is_infinite();
            let over = !met && (!turns_help || turns.end_with(off));
            let better = rolling.left() < off.max(report.residual).max(report.coulomb);
            if last || met || (over && !better && !taken.gains) {
                increment.copy_from(weight.view());
                report.settled &= fits;
                report.coulomb = report.coulomb.max(off);
                report.friction_energy += taken.friction;
                report.work += taken.work;
                return Ok(limits);
            }
            match (over, better) {
                (false, _) => moments.turn(about_contacts, contacts, impulses, states, &v.0),
                (true, true) => rolling.insist(),
                (true, false) => moments.drop_all(),
            }
            last = over;
        }
    }

    /// Impulses for the moments that there are, or both; says how far these are from what is theirs then, m/s, and what
    /// they take.
    fn rest_under_moments(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        (h, limits): (f64, Settled),
        report: &mut WorldReport,
    ) -> Result<(f64, Taken), ContactError> {
        let Memory { v, increment, free, weight, moments, rolling, states, .. } = &mut self.memory;
        rolling.count();
        v.copy_from(free.view());
        increment.copy_from(weight.view());
        moments.add(contacts, states, &mut v.0);
        moments.add(contacts, states, &mut increment.0);
        self.rest(contacts, q, (h, limits), report)?;
        let Memory { v, before, moments, states, impulses, .. } = &mut self.memory;
        let off = moments.off(contacts, impulses, states, &v.0);
        Ok((off, moments.energy(contacts, states, [&before.0, &v.0])))
    }
}
