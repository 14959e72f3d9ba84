//! Which contacts a step looks at: how far bodies move, what passes with clearance, and what nobody foresaw.
//!
//! ```text
//! r_a = h (|v_a| + |dv_a|) + 1e-6 R_a,   g <= r_a + r_b           what is looked at
//! |h v_a| > r_a + h e/2:   r_a <- 3/2 |h v_a|
//! max (-n.(v_2 - v_1) - max(g, 0)/h)                              over what comes within reach
//! ```
//! `v_a` the speed of the fastest point of body `a` (m/s), before the step above and after it, with what lifts it out
//! of overlap, below; `dv_a` the velocity increment, `R_a` its radius (m), `e` what is left of the conditions of what
//! was looked at (m/s). A body that an impulse or a lift makes faster than was foreseen may close gaps that nobody
//! looked at: by how much at most is a part of the residual, or the step is solved again.

use stationary_calculus::Potential;

use crate::solve::body_state::speed;
use crate::world::accounts::point_velocity;
use crate::world::clearance::{StepMotion, has_contacts};
use crate::world::memory::Memory;
use crate::{ContactError, ContactIn, Dimension, World};

/// Gaps up to this part of a body's radius are looked at even where nothing moves.
const SPECULATIVE_MARGIN: f64 = 1e-6;
/// The same where joints take bodies farther even though nothing hits.
const JOINTED_MARGIN: f64 = 1e-3;
/// How much farther than a body goes is looked at where it is faster than was foreseen: it may become faster still.
const WIDENED: f64 = 1.5;
/// Pairs that move less than this part of the smaller radius against each other have gaps that are
/// nearly linear over the step.
const NONLINEAR_MOTION: f64 = 0.1;

impl<G: Dimension, P: Potential> World<G, P> {
    /// How far each body moves in a step.
    pub(super) fn find_reach(&mut self, h: f64) {
        let Memory { start, increment, reach, joints, .. } = &mut self.memory;
        let f = G::FREEDOMS;
        let margin = if joints.rows() > 0 { JOINTED_MARGIN } else { SPECULATIVE_MARGIN };
        let bodies = start.0.chunks_exact(f).zip(increment.0.chunks_exact(f)).enumerate();
        reach.clear();
        reach.extend(bodies.map(|(body, (v, increment))| {
            let far = self.detector.reach_of(body);
            let speeds = speed::<G>(v, far) + speed::<G>(increment, far);
            h * speeds + margin * self.detector.radius_of(body)
        }));
    }

    /// How fast the fastest contact closes that nobody looked at, m/s, if faster than what is `left` of those that
    /// were: of what is faster than was foreseen, whose reach is widened.
    pub(super) fn unseen(&mut self, q: &[f64], h: f64, left: f64) -> Result<f64, ContactError> {
        let World { detector, kept, memory, .. } = self;
        let Memory {
            v, lift, reach, states, after, lifted, passing, unseen, widened, joints, ..
        } = memory;
        widened.clear();
        // Where nothing pushes nothing is faster than was foreseen, and no velocity of a point is known.
        if kept.found().is_empty() && joints.rows() == 0 {
            return Ok(0.0);
        }
        let moved = v.0.chunks_exact(G::FREEDOMS).zip(lift.0.chunks_exact(G::FREEDOMS));
        for (body, ((v, lift), reach)) in moved.zip(reach.iter_mut()).enumerate() {
            let far = detector.reach_of(body);
            let way = h * (speed::<G>(v, far) + speed::<G>(lift, far));
            // Two that go no farther than this beyond their reach close no faster than what is left.
            let farther = way > *reach + 0.5 * left * h;
            if farther {
                *reach = WIDENED * way;
            }
            widened.push(farther);
        }
        if !widened.contains(&true) {
            return Ok(0.0);
        }
        let seen = kept.take_found();
        kept.put_back(std::mem::take(unseen));
        let detected = kept.detect_of(detector, states, q, reach, |body| widened[body]);
        *unseen = kept.take_found();
        let of_lift = lift.0.chunks_exact(G::FREEDOMS).zip(states.iter());
        lifted.clear();
        lifted.extend(of_lift.zip(after.iter()).map(|((lift, state), &(x, w))| {
            let mut own = G::Velocity::default();
            own.as_mut().copy_from_slice(lift);
            let (up, turn) = G::split(&state.frame, &own);
            (x + up, w + turn)
        }));
        let looked_at = |contact: &ContactIn<G>| {
            let moves = |&body: &usize| states[body].moves();
            seen.binary_search_by_key(&contact.id, |seen| seen.id).is_ok()
                || has_contacts(passing, contact.id.pair())
                || !contact.bodies.iter().flatten().any(moves)
        };
        let closes = |contact: &ContactIn<G>| {
            let [a, b] = [0, 1].map(|side| point_velocity(contact, side, states, lifted));
            -G::dot(&(b - a), &contact.normal) - contact.gap.max(0.0) / h
        };
        let fresh = unseen.iter().filter(|contact| !looked_at(contact));
        let fastest = fresh.map(closes).fold(0.0, f64::max);
        kept.put_back(seen);
        detected.map(|()| fastest)
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
