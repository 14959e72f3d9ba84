//! Impacts of a step: what would close its gap, by the law of the world.

use stationary_calculus::Potential;

use crate::impact::rounds::ImpactRounds;
use crate::world::memory::Memory;
use crate::{ContactError, ContactIn, ContactRows, Dimension, World, WorldReport, gap_rows};

impl<G: Dimension, P: Potential> World<G, P> {
    /// Impacts of what would close its gap in this step.
    pub(super) fn impacts(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let Memory { v, increment, hits, joints, .. } = &mut self.memory;
        let (rows, mut across) = (gap_rows(contacts, q), ContactRows::new());
        let of = |read: fn(&ContactIn<G>) -> f64| contacts.iter().map(read).collect::<Vec<_>>();
        let friction = of(|contact| contact.friction);
        if friction.iter().any(|&friction| friction > 0.0) {
            contacts.iter().for_each(|contact| contact.push_tangents(q, &mut across));
        }
        let rounds = ImpactRounds {
            rows: &rows,
            across: &across,
            gap: &of(|contact| contact.gap),
            restitution: &of(|contact| contact.restitution),
            friction: &friction,
            mass: &self.mass,
            joints,
            law: self.law,
            increment,
            h,
        };
        let given = rounds.apply(v)?;
        report.impacts = given.passes;
        report.settled &= given.converged;
        report.impact_residual = given.left;
        let mut friction = given.friction.iter();
        for ((contact, hit), normal) in contacts.iter().zip(hits).zip(given.normal) {
            let mut across = G::Vector::default();
            for (tangent, &impulse) in contact.tangents().zip(&mut friction) {
                across = across + tangent * impulse;
            }
            // What rounding leaves of friction without a normal impulse is none.
            let length = G::dot(&across, &across).sqrt();
            let bound = contact.friction * normal.max(0.0);
            let part = if length > bound { bound / length } else { 1.0 };
            *hit = contact.normal * normal + across * part;
        }
        Ok(())
    }
}
