//! Which contacts a step looks at: how far bodies move, and what passes with clearance.

use stationary_calculus::Potential;

use crate::solve::body_state::speed;
use crate::world::clearance::{StepMotion, has_contacts};
use crate::world::memory::Memory;
use crate::{ContactIn, Dimension, World};

/// Gaps up to this part of a body's radius are looked at even where nothing moves.
const SPECULATIVE_MARGIN: f64 = 1e-6;
/// A body that an impulse takes this part of its radius farther than was looked at may have missed
/// a contact: the step is solved again.
const MISSED: f64 = 1e-3;
/// Pairs that move less than this part of the smaller radius against each other have gaps that are
/// nearly linear over the step.
const NONLINEAR_MOTION: f64 = 0.1;

impl<G: Dimension, P: Potential> World<G, P> {
    /// How far each body moves in a step.
    pub(super) fn find_reach(&mut self, h: f64) {
        let Memory { start, increment, reach, joints, .. } = &mut self.memory;
        let f = G::FREEDOMS;
        // Joints take bodies farther even where nothing hits.
        let margin = if joints.rows() > 0 { MISSED } else { SPECULATIVE_MARGIN };
        let bodies = start.0.chunks_exact(f).zip(increment.0.chunks_exact(f)).enumerate();
        reach.clear();
        reach.extend(bodies.map(|(body, (v, increment))| {
            let far = self.detector.reach_of(body);
            let speeds = speed::<G>(v, far) + speed::<G>(increment, far);
            h * speeds + margin * self.detector.radius_of(body)
        }));
    }

    /// Widens the reach of what has become much faster; says whether there is any.
    pub(super) fn widen_reach(&mut self, h: f64) -> bool {
        let Memory { v, reach, joints, .. } = &mut self.memory;
        let missed = if joints.rows() > 0 { 0.0 } else { MISSED };
        let mut widened = false;
        for (body, (v, reach)) in v.0.chunks_exact(G::FREEDOMS).zip(reach).enumerate() {
            let way = h * speed::<G>(v, self.detector.reach_of(body));
            if way > *reach + missed * self.detector.radius_of(body) {
                *reach = 1.5 * way;
                widened = true;
            }
        }
        widened
    }

    /// Drops the contacts of pairs that move far in the step and pass each other with clearance.
    pub(super) fn drop_passing(&mut self, contacts: &mut Vec<ContactIn<G>>, q: &[f64], h: f64) {
        let Memory { start, increment, passing, meeting, room, reach, .. } = &mut self.memory;
        let velocity = |freedom: usize| start.0[freedom] + increment.0[freedom];
        let detector = &self.detector;
        let motion = StepMotion { detector, contacts, q, velocity: &velocity, h };
        for of_pair in contacts.chunk_by(ContactIn::same_pair) {
            let pair = of_pair[0].id.pair();
            let bodies = || of_pair[0].bodies.into_iter().flatten();
            let far = NONLINEAR_MOTION * self.detector.smaller_radius(of_pair[0].bodies);
            let clear = bodies().map(|body| reach[body]).sum::<f64>() > far
                && motion.closing(pair) > far
                && !meeting.contains(&pair)
                && of_pair.iter().all(|contact| contact.gap > 0.0)
                && !motion.meets(of_pair, room);
            if clear {
                passing.extend_from_slice(of_pair);
            }
        }
        if !passing.is_empty() {
            contacts.retain(|contact| !has_contacts(passing, contact.id.pair()));
        }
    }

    /// Finds pairs that seemed to pass each other and meet with the velocities of now; says whether
    /// there are any.
    pub(super) fn find_meeting(&mut self, q: &[f64], h: f64) -> bool {
        let Memory { v, passing, meeting, room, .. } = &mut self.memory;
        let velocity = |freedom: usize| v.0[freedom];
        let (detector, contacts) = (&self.detector, self.kept.found());
        let motion = StepMotion { detector, contacts, q, velocity: &velocity, h };
        let before = meeting.len();
        for of_pair in passing.chunk_by(ContactIn::same_pair) {
            if motion.meets(of_pair, room) {
                meeting.push(of_pair[0].id.pair());
            }
        }
        meeting.len() > before
    }
}
