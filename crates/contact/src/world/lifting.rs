//! Lifting out of overlap: positions alone, a part of each overlap in a step.

use stationary_calculus::Potential;

use crate::solve::body_state::speed;
use crate::solve::island_solver::{Overlaps, SolvesIslands};
use crate::world::islands::has_joints;
use crate::world::memory::Memory;
use crate::world::tolerances::{LARGE, Settled};
use crate::{ContactError, ContactIn, DetectorIn, Dimension, World};

/// The part of an overlap by which a step lifts: all of it at once would overshoot where gaps are
/// not linear.
pub(super) const PENETRATION_CORRECTION: f64 = 0.2;
/// The part of the worst approach to which lifting is settled.
const LIFT_TOLERANCE: f64 = 1e-2;
/// A lift takes no body farther than this part of its radius in a step: beyond it gaps are not linear, and
/// nobody has looked.
const LIFT_REACH: f64 = 0.05;

impl<G: Dimension, P: Potential> World<G, P> {
    /// Velocities of positions that lift what overlaps.
    pub(super) fn lift(
        &mut self,
        contacts: &[ContactIn<G>],
        q: &[f64],
        limits: Settled,
        h: f64,
    ) -> Result<(), ContactError> {
        let Memory { states, lift_bias, lift_least, islands, solver, lift, with_joints, v, .. } =
            &mut self.memory;
        let (f, detector) = (G::FREEDOMS, &self.detector);
        let fastest = |bodies: &[usize]| {
            let of = |&body: &usize| speed::<G>(&v.0[f * body..][..f], detector.radius_of(body));
            bodies.iter().map(of).fold(0.0, f64::max)
        };
        // No gap ends below what it was, nor below zero.
        let of_pile = self.tolerance.is_none() && contacts.len() > LARGE;
        lift_least.clear();
        lift_least.extend(contacts.iter().map(|c| PENETRATION_CORRECTION * c.gap.min(0.0) / h));
        with_joints.clear();
        for (members, bodies) in islands.iter() {
            if has_joints(members, contacts.len()) {
                with_joints.extend(members.iter().filter(|&&i| i < contacts.len()));
                continue;
            }
            let settled = if of_pile { limits.lifted(fastest(bodies)) } else { limits.enough };
            let worst = members.iter().map(|&i| -lift_bias[i]).fold(0.0, f64::max);
            let overlaps = |&i: &usize| contacts[i].gap < 0.0 && lift_bias[i] < -settled;
            if !members.iter().any(overlaps) {
                continue;
            }
            let goal = settled.max(LIFT_TOLERANCE * worst);
            let overlaps =
                Overlaps { points: contacts, bias: lift_bias, least: lift_least, states, of_pile };
            solver.lift([members, bodies], overlaps, goal)?;
            for &body in bodies {
                let (scale, change) = (states[body].scale.as_ref(), solver.change(body).as_ref());
                let own = &mut lift.0[f * body..][..f];
                own.iter_mut().zip(scale.iter().zip(change)).for_each(|(own, (a, b))| *own = a * b);
            }
            let part = lifted_part(detector, bodies.iter().copied(), &lift.0, h);
            for &body in bodies {
                lift.0[f * body..][..f].iter_mut().for_each(|lift| *lift *= part);
            }
        }
        if self.memory.joints.rows() > 0 {
            self.lift_jointed(contacts, q, limits.enough, h)?;
        }
        Ok(())
    }
}

/// The part of a lift that takes none of these bodies far: what is squeezed would go where gaps are not
/// linear and nobody has looked. Bodies without a shape have no gaps.
pub(crate) fn lifted_part<G: Dimension>(
    detector: &DetectorIn<G>,
    bodies: impl Iterator<Item = usize>,
    lift: &[f64],
    h: f64,
) -> f64 {
    let part = |body: usize| {
        let radius = detector.radius_of(body);
        let way = h * speed::<G>(&lift[G::FREEDOMS * body..][..G::FREEDOMS], radius);
        if way > LIFT_REACH * radius { LIFT_REACH * radius / way } else { 1.0 }
    };
    bodies.filter(|&body| detector.radius_of(body) > 0.0).map(part).fold(1.0, f64::min)
}
