//! The parts of an island that are not settled yet, each settled on its own.
//!
//! ```text
//! sweep over the island,   U = { i : a body of i is one of j's, |dx_j| > s },   sweep over U,   ..
//! where that would take long: each part of U that hangs together by x_j > 0:
//!     sweeps and proximal steps, the other impulses kept
//! sweep over the contacts of the bodies of parts;   and again
//! ```
//! `x_j` the impulse of a contact, `dx_j` what the last sweep changed there and `s` what counts as
//! settled, as velocities (m/s). What happens in a heap happens in places: where a box has just
//! landed. Each takes as many sweeps as it needs, and what it does to its surroundings, or to
//! contacts that did not push, the next sweep over all that touch its bodies shows: descent by blocks of
//! coordinates. At the end all conditions of the island are looked at, and those that are not met are swept
//! next. Source: Bertsekas and Tsitsiklis 1989.

use crate::solve::islands::Islands;
use crate::solve::rigid_contact::RigidContact;
use crate::solve::sweeps::{Goal, Island, SYSTEM_COST, Sweeps};

/// The most sweeps over a part before what is around it is looked at again.
const ROUND: usize = 8;

/// The parts of one island.
#[derive(Debug, Default)]
pub(crate) struct UnsettledParts<const F: usize, const D: usize> {
    /// The number of each body within the island; of what does not move, that of its bodies.
    number: Vec<usize>,
    /// The bodies of each contact by these numbers.
    ends: Vec<[usize; 2]>,
    /// Which bodies have changed; what does not move never has.
    changed: Vec<bool>,
    /// The contacts that are swept over, in ascending order.
    around: Vec<usize>,
    /// Those of them that push, and how they hang together.
    chosen: Vec<usize>,
    parts: Islands,
    part: Part<F, D>,
    /// How far the conditions are from being met at the end, m/s, if that was looked at and is enough.
    pub(crate) left: Option<[f64; 2]>,
}

/// A part, as an island of its own.
#[derive(Debug, Default)]
struct Part<const F: usize, const D: usize> {
    contacts: Vec<RigidContact<F, D>>,
    bodies: Vec<usize>,
    x: Vec<[f64; D]>,
}

impl<const F: usize, const D: usize> UnsettledParts<F, D> {
    /// Sweeps over an island and settles its parts in turn, until it has settled, for at most as
    /// much work as `bound` sweeps; says how many contacts were relaxed, and how many sparse systems
    /// were solved.
    pub(crate) fn settle(
        &mut self,
        sweeps: &mut Sweeps<F, D>,
        island: Island<F, D>,
        x: &mut [[f64; D]],
        goal: Goal,
        bound: usize,
    ) -> [usize; 2] {
        let Goal { change: settled, residual, .. } = goal;
        let (n, mut relaxed, mut solved) = (x.len(), 0, 0);
        let work = |relaxed: usize, solved: usize| relaxed.div_ceil(n) + SYSTEM_COST * solved;
        let mut last = f64::INFINITY;
        self.left = None;
        self.number_bodies(island, sweeps.w.len() - 1);
        self.take_all();
        // Systems of a part count as if they were of the whole island: there is a bound all the same.
        while work(relaxed, solved) < bound {
            let change = sweeps.sweep_of(&self.around, island, x);
            relaxed += self.around.len();
            if change.fastest <= settled {
                // Small changes have added up: what is not met is swept next, and what is around it.
                if residual == f64::INFINITY {
                    break;
                }
                let left = sweeps.look_at(island, x);
                if left.iter().all(|left| *left <= residual) {
                    self.left = Some(left);
                    break;
                }
                self.take_all();
                self.look_around(&sweeps.changes, residual);
                last = f64::INFINITY;
                continue;
            }
            self.look_around(&sweeps.changes, settled);
            let together = goal.is_within(goal.together, &change, last);
            last = change.energy;
            // The last sweep is one that shows what parts do to each other.
            let most = ROUND.min(bound.saturating_sub(work(relaxed, solved) + 1));
            if together || most == 0 {
                continue;
            }
            last = f64::INFINITY;
            self.find(x);
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

    /// Numbers the bodies of an island, of so many.
    fn number_bodies(&mut self, island: Island<F, D>, bodies: usize) {
        let UnsettledParts { number, ends, changed, .. } = self;
        let still = island.bodies.len();
        // What does not move comes behind all bodies; what is in other islands is asked for by none.
        number.resize(bodies + 1, still);
        number[bodies] = still;
        island.bodies.iter().enumerate().for_each(|(i, &body)| number[body] = i);
        ends.clear();
        ends.extend(island.contacts.iter().map(|contact| contact.bodies.map(|b| number[b])));
        changed.clear();
        changed.resize(still + 1, false);
    }

    /// All contacts are swept over.
    fn take_all(&mut self) {
        self.around.clear();
        self.around.extend(0..self.ends.len());
    }

    /// Finds all contacts of bodies of those that the last sweep has changed by more than what counts as settled.
    fn look_around(&mut self, changes: &[f64], settled: f64) {
        self.changed.fill(false);
        for place in (0..changes.len()).filter(|&place| changes[place] > settled) {
            self.mark(self.around[place]);
        }
        self.gather();
    }

    /// The bodies of a contact have changed.
    fn mark(&mut self, contact: usize) {
        let UnsettledParts { ends, changed, .. } = self;
        let still = changed.len() - 1;
        ends[contact].into_iter().for_each(|body| changed[body] |= body < still);
    }

    /// Lists all contacts of bodies that have changed.
    fn gather(&mut self) {
        let UnsettledParts { ends, changed, around, .. } = self;
        around.clear();
        around.resize(ends.len(), 0);
        let mut n = 0;
        for (i, [a, b]) in ends.iter().enumerate() {
            around[n] = i;
            n += usize::from(changed[*a] | changed[*b]);
        }
        around.truncate(n);
    }

    /// Finds the parts, and what is around them.
    fn find(&mut self, x: &[[f64; D]]) {
        let UnsettledParts { ends, changed, around, chosen, parts, .. } = self;
        chosen.clear();
        chosen.extend(around.iter().filter(|&&i| x[i] != [0.0; D]));
        parts.find(changed.len() - 1, chosen.iter().map(|&member| ends[member]));
        (0..self.chosen.len()).for_each(|k| self.mark(self.chosen[k]));
        self.gather();
    }
}

#[cfg(all(test, feature = "3d"))]
mod tests {
    use nalgebra::Vector3;
    use stationary_rigid::{Body, BodyMetric};

    use super::*;
    use crate::solve::body_state::BodyState;
    use crate::solve::rigid_contact::Directions;
    use crate::{ContactId, ContactPoint, Dimension, Spatial};

    const SETTLED: f64 = 1e-9;
    const BOUND: usize = 10_000;

    /// Settles a row of bodies of 1 kg, each touching the next, which have these velocities along
    /// it, and checks those that they have after; says how many contacts were relaxed, and how many
    /// sparse systems were solved.
    fn settle(
        before: &[f64],
        expected: &[f64],
        settle: impl Fn(&mut Sweeps<6, 3>, Island<6, 3>, &mut [[f64; 3]]) -> [usize; 2],
    ) -> [usize; 2] {
        let body = Body::new(1.0, [1.0; 3]).unwrap();
        let rest = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0].repeat(before.len());
        let along: Vec<f64> = before.iter().flat_map(|v| [*v, 0.0, 0.0, 0.0, 0.0, 0.0]).collect();
        let scale = Spatial::scales(&BodyMetric::new(vec![body]))[0];
        let state = |number| BodyState::<Spatial>::new(number, scale, &rest, &along);
        let states: Vec<_> = (0..before.len()).map(state).collect();
        let contact = |first: usize| {
            let point = ContactPoint {
                id: ContactId { colliders: [0, 1], parts: [0; 2], features: [0; 2] },
                bodies: [Some(first), Some(first + 1)],
                gap: 0.0,
                normal: Vector3::x(),
                points: [Vector3::zeros(); 2],
                arms: [Vector3::zeros(); 2],
                restitution: 0.0,
                friction: 0.0,
            };
            let mut contact = RigidContact::NONE;
            let directions = Spatial::directions(&point.normal);
            contact.set(&point, &Directions::of(directions, &point, &states), 0.0, &states);
            contact
        };
        let contacts: Vec<_> = (0..before.len() - 1).map(contact).collect();
        let bodies: Vec<_> = (0..before.len()).collect();
        let island = Island { contacts: &contacts, bodies: &bodies };
        let (mut sweeps, mut x) = (Sweeps::default(), vec![[0.0; 3]; contacts.len()]);
        sweeps.start(bodies.len());
        let work = settle(&mut sweeps, island, &mut x);
        for ((before, w), expected) in before.iter().zip(&sweeps.w).zip(expected) {
            let found = before + scale[0] * w[0];
            assert!((found - expected).abs() < 1e-6, "{found} {expected}");
        }
        work
    }

    fn by_parts(before: &[f64], expected: &[f64]) -> [usize; 2] {
        settle(before, expected, |sweeps, island, x| {
            UnsettledParts::default().settle(sweeps, island, x, Goal::moving(SETTLED), BOUND)
        })
    }

    #[test]
    fn what_happens_at_one_end_of_a_row_is_settled_there() {
        // All of them part, but for the last three, which meet.
        let mut before: Vec<f64> = (0..200).map(f64::from).collect();
        before[197..].copy_from_slice(&[1002.0, 1000.0, 995.0]);
        let mut after = before.clone();
        after[197..].fill(999.0);
        let [relaxed, solved] = by_parts(&before, &after);
        let whole = settle(&before, &after, |sweeps, island, x| {
            sweeps.alternate(island, x, Goal::moving(SETTLED), BOUND)
        });
        assert!(solved == 0 && whole[1] > 0, "{solved} {whole:?}");
        assert!(3 * relaxed < 2 * whole[0], "{relaxed} {whole:?}");
    }

    #[test]
    fn a_part_is_settled_between_neighbours_that_push() {
        // One pushes all the others; what is unsettled at last is a part of the row.
        let mut before = [0.0; 40];
        before[0] = 40.0;
        let [_, solved] = by_parts(&before, &[1.0; 40]);
        // Where a part does not know what its neighbours push, it takes two thousand.
        assert!(solved < 100, "{solved}");
    }

    #[test]
    fn impulses_that_give_energy_are_shortened_until_they_give_none() {
        // At 2 N s the two have changed their velocities: all of the energy is there again.
        settle(&[2.0, 0.0], &[0.0, 2.0], |sweeps, island, x| {
            x[0][0] = 2.2;
            sweeps.push(island, x);
            let part = sweeps.part_without_energy(island, x, &[0.0], &[0]).unwrap();
            sweeps.shorten(island, x, part);
            assert_eq!(sweeps.part_without_energy(island, x, &[0.0], &[0]), None);
            [0; 2]
        });
    }
}
