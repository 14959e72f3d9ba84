//! Impacts of a step: what would close its gap, by the law of the world.

use stationary_calculus::Potential;

use crate::impact::rounds::ImpactRounds;
use crate::impact::touching::Touching;
use crate::world::memory::Memory;
use crate::{ContactError, ContactIn, Dimension, World, WorldReport};

impl<G: Dimension, P: Potential> World<G, P> {
    /// Impacts of what would close its gap in this step.
    pub(super) fn impacts(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        h: f64,
        report: &mut WorldReport,
    ) -> Result<(), ContactError> {
        let Memory { v, increment, hits, jointed, touching, .. } = &mut self.memory;
        touching.fill(contacts, q, |contact| contact.gap);
        let Touching { contacts: met, rows, across, gap, restitution, friction } = &*touching;
        let rounds = ImpactRounds {
            contacts: met,
            rows,
            across,
            gap,
            restitution,
            friction,
            mass: &self.mass,
            joints: &jointed.measured,
            law: self.law,
            increment,
            h,
        };
        // In most steps nothing hits, and impulses need no room.
        if !rounds.hits(v) {
            return Ok(());
        }
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
