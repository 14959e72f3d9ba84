//! What a step took and gave, J, and what is left of each gap at its end.

use stationary_calculus::Potential;

use crate::solve::body_state::BodyState;
use crate::world::lifting::PENETRATION_CORRECTION;
use crate::world::memory::Memory;
use crate::world::painleve::{Painleve, painleve};
use crate::{ContactIn, Dimension, World, WorldReport};

impl<G: Dimension, P: Potential> World<G, P> {
    /// Energies, and what is left of each gap at the end of the step.
    pub(super) fn account(&mut self, contacts: &[ContactIn<G>], h: f64, report: &mut WorldReport) {
        let Memory { v, before, states, after, mean, impulses, hits, lift_bias, .. } =
            &mut self.memory;
        let of = |v: &[f64], body: usize| {
            let mut velocity = G::Velocity::default();
            velocity.as_mut().copy_from_slice(&v[G::FREEDOMS * body..][..G::FREEDOMS]);
            G::split(&states[body].frame, &velocity)
        };
        after.clear();
        after.extend((0..states.len()).map(|body| of(&v.0, body)));
        mean.clear();
        mean.extend(after.iter().enumerate().map(|(body, &(x, w))| {
            let (x0, w0) = of(&before.0, body);
            ((x + x0) * 0.5, (w + w0) * 0.5)
        }));
        let at = |of: &[(G::Vector, G::Spin)], contact: &ContactIn<G>, side: usize| {
            point_velocity(contact, side, states, of)
        };
        lift_bias.clear();
        for ((contact, impulse), hit) in contacts.iter().zip(impulses.iter()).zip(hits.iter()) {
            let rate = at(after, contact, 1) - at(after, contact, 0);
            let part = if contact.gap < 0.0 { PENETRATION_CORRECTION } else { 1.0 };
            lift_bias.push(G::dot(&rate, &contact.normal) + part * contact.gap / h);
            let whole = *impulse + *hit;
            if whole == G::Vector::default() {
                continue;
            }
            let pushed = G::dot(impulse, &contact.normal);
            let rate = at(mean, contact, 1) - at(mean, contact, 0);
            report.impact_energy -= pushed * G::dot(&rate, &contact.normal);
            report.friction_energy -= G::dot(&(*impulse - contact.normal * pushed), &rate);
            for (side, sign) in [(0, 1.0), (1, -1.0)] {
                if contact.bodies[side].is_some_and(|body| !states[body].moves()) {
                    let velocity = at(after, contact, side) * sign;
                    report.work += G::dot(&whole, &velocity);
                    report.impact_energy += G::dot(hit, &velocity);
                }
            }
        }
    }

    /// By how much the second point of a contact of the last step is faster than the first at its end, m/s, and what of
    /// that obstacles are.
    pub(crate) fn rate_at(&self, contact: &ContactIn<G>) -> [G::Vector; 2] {
        let Memory { states, after, .. } = &self.memory;
        let of_side = |side: usize, counts: &dyn Fn(usize) -> bool| match contact.bodies[side] {
            Some(body) if counts(body) => point_velocity(contact, side, states, after),
            _ => G::Vector::default(),
        };
        let rate = |counts: &dyn Fn(usize) -> bool| of_side(1, counts) - of_side(0, counts);
        [rate(&|_| true), rate(&|body| self.is_obstacle(body))]
    }

    /// The contact that slides in Painleve's paradox, if one does.
    pub(super) fn painleve(&self, contacts: &[ContactIn<G>]) -> Option<Painleve> {
        let Memory { states, impulses, hits, start, .. } = &self.memory;
        let along = |i: usize| G::dot(&(impulses[i] + hits[i]), &contacts[i].normal);
        let radius = |body: usize| self.detector.reach_of(body);
        painleve(contacts, |i| along(i) > 0.0, states, radius, &start.0)
    }

    /// The kinetic energy of what impulses move, J.
    pub(super) fn kinetic_energy(&self) -> f64 {
        let Memory { v, scales, .. } = &self.memory;
        let scales = scales.iter().flat_map(|scale| scale.as_ref());
        let moving = v.0.iter().zip(scales).filter(|(_, scale)| **scale > 0.0);
        moving.map(|(v, scale)| 0.5 * (v / scale) * (v / scale)).sum()
    }
}

/// The velocity of a contact's point, given those of bodies in world axes, m/s; zero of what is fixed.
pub(super) fn point_velocity<G: Dimension>(
    contact: &ContactIn<G>,
    side: usize,
    states: &[BodyState<G>],
    velocities: &[(G::Vector, G::Spin)],
) -> G::Vector {
    contact.bodies[side].map_or_else(G::Vector::default, |body| {
        let (x, w) = velocities[body];
        x + G::swing(&w, &(contact.points[side] - states[body].centre))
    })
}
