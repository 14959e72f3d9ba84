//! The parts of an island that are not settled yet, each settled on its own.
//!
//! ```text
//! sweep over the island,   U = { i : a body of i is one of j's, |dx_j| > s }
//! each connected part of U: sweeps and proximal steps, the other impulses kept;   and again
//! ```
//! `dx_j` what the sweep changed at a contact and `s` what counts as settled, as velocities (m/s).
//! What happens in a heap happens in places: where a box has just landed. Each takes as many sweeps
//! as it needs, and what it does to its surroundings the next sweep over the whole island shows:
//! descent by blocks of coordinates. Source: Bertsekas and Tsitsiklis 1989.

use crate::islands::Islands;
use crate::rigid_contact::RigidContact;
use crate::sweeps::{Goal, Island, Sweeps, WORTH};

/// The most sweeps over a part before the whole island is looked at again.
const ROUND: usize = 8;

/// The parts of one island.
#[derive(Debug, Default)]
pub(crate) struct UnsettledParts {
    /// The number of each body within the island; of what does not move, that of its bodies.
    number: Vec<usize>,
    /// Whether a contact of each of its bodies is not settled.
    unsettled: Vec<bool>,
    /// The contacts of those bodies, and how they hang together.
    chosen: Vec<usize>,
    parts: Islands,
    part: Part,
}

/// A part, as an island of its own.
#[derive(Debug, Default)]
struct Part {
    contacts: Vec<RigidContact>,
    bodies: Vec<usize>,
    x: Vec<[f64; 3]>,
}

impl UnsettledParts {
    /// Sweeps over an island and settles its parts in turn, until it has settled, for at most as
    /// much work as `bound` sweeps; says how many contacts were relaxed, and how many sparse systems
    /// were solved.
    pub(crate) fn settle(
        &mut self,
        sweeps: &mut Sweeps,
        island: Island,
        x: &mut [[f64; 3]],
        settled: f64,
        bound: usize,
    ) -> [usize; 2] {
        let goal = Goal { change: settled, alone: WORTH };
        let (n, mut relaxed, mut solved) = (x.len(), 0, 0);
        while relaxed < bound * n {
            let change = sweeps.sweep(island, x);
            relaxed += n;
            if sweeps.has_settled(&change, island, x, settled) {
                break;
            }
            // The last sweep is over the whole island.
            let most = ROUND.min(bound.saturating_sub(relaxed.div_ceil(n) + 1));
            if most == 0 {
                continue;
            }
            self.find(island, sweeps, settled);
            let UnsettledParts { chosen, parts, part, .. } = self;
            for (members, bodies) in parts.iter() {
                let members = members.iter().map(|&member| chosen[member]);
                part.contacts.clear();
                part.contacts.extend(members.clone().map(|i| island.contacts[i]));
                part.bodies.clear();
                part.bodies.extend(bodies.iter().map(|&body| island.bodies[body]));
                part.x.clear();
                part.x.extend(members.clone().map(|i| x[i]));
                let own = Island { contacts: &part.contacts, bodies: &part.bodies };
                let [taken, systems] = sweeps.alternate(own, &mut part.x, goal, most);
                relaxed += taken;
                solved += systems;
                members.zip(&part.x).for_each(|(i, own)| x[i] = *own);
            }
        }
        [relaxed, solved]
    }

    /// Finds the parts after a sweep.
    fn find(&mut self, island: Island, sweeps: &Sweeps, settled: f64) {
        let still = island.bodies.len();
        self.number.clear();
        self.number.resize(sweeps.w.len(), still);
        for (number, &body) in island.bodies.iter().enumerate() {
            self.number[body] = number;
        }
        let number = |contact: &RigidContact| contact.bodies.map(|body| self.number[body]);
        self.unsettled.clear();
        self.unsettled.resize(still + 1, false);
        for (contact, &change) in island.contacts.iter().zip(&sweeps.changes) {
            if change > settled {
                number(contact).into_iter().for_each(|body| self.unsettled[body] = true);
            }
        }
        self.unsettled[still] = false;
        let unsettled = |i: &usize| number(&island.contacts[*i]).iter().any(|&b| self.unsettled[b]);
        self.chosen.clear();
        self.chosen.extend((0..island.contacts.len()).filter(unsettled));
        let of = |member: usize| number(&island.contacts[self.chosen[member]]);
        self.parts.find(still, of, self.chosen.len());
    }
}
