//! Pairs that pass each other with clearance: proved apart all the way, and so without contact.
//!
//! A gap that is linear over the step takes what flies past for what hits; where bodies move far in
//! a step, [`crate::rigid_bodies_meet`] decides whether they meet on the way. What comes nearer than
//! a small part of the bodies, and what is not decided at the bound, meets. So does what has contacts
//! that stand for another part of the same surface: for one whose own were dropped at a seam, and for
//! one that is level with them, where a body that lands on both is held by all of them. Source: notes
//! 11.1.

use stationary_rigid::LieGroup;

use crate::when::rigid_time_of_impact::{MeetRoom, Swept, meet};
use crate::{Closeness, ColliderIn, ContactIn, DetectorIn, Dimension, RigidPathIn};

/// Intervals looked at before two bodies count as meeting.
const INTERVALS: usize = 100;
/// Distances below this part of the smaller radius are none, and faces of one surface whose heights
/// differ by less are level.
const TOUCHING_DISTANCE: f64 = 1e-6;

/// How bodies move in a step, and what they face.
pub(crate) struct StepMotion<'a, G: Dimension> {
    pub(crate) detector: &'a DetectorIn<G>,
    /// Sorted by their colliders.
    pub(crate) contacts: &'a [ContactIn<G>],
    pub(crate) q: &'a [f64],
    /// Of each freedom.
    pub(crate) velocity: &'a dyn Fn(usize) -> f64,
    pub(crate) h: f64,
}

/// A shape, and how its body moves in the step.
struct Mover<'a, G: Dimension> {
    collider: &'a ColliderIn<G>,
    path: RigidPathIn<G>,
    reach: f64,
}

impl<'a, G: Dimension> StepMotion<'a, G> {
    /// How far any two points of the bodies of two colliders approach at most, m.
    pub(crate) fn closing(&self, pair: [usize; 2]) -> f64 {
        let movers = pair.map(|collider| self.mover(collider));
        let apart = *movers[1].path.way() - *movers[0].path.way();
        let turns = movers.iter().map(|mover| mover.reach * G::spin_speed(mover.path.turn()));
        G::dot(&apart, &apart).sqrt() + turns.sum::<f64>()
    }

    /// Whether the colliders of these contacts may meet, or another part of the surface of one meets
    /// the other while these contacts stand for it.
    pub(crate) fn meets(&self, of_pair: &[ContactIn<G>], room: &mut MeetRoom<G>) -> bool {
        let pair = of_pair[0].id.pair();
        self.may_meet(pair, room)
            || self.detector.beside(pair).any(|other| {
                (!has_contacts(self.contacts, other) || self.is_level(of_pair, other))
                    && self.may_meet(other, room)
            })
    }

    fn mover(&self, collider: usize) -> Mover<'a, G> {
        let collider = &self.detector.colliders()[collider];
        let mut velocity = G::Velocity::default();
        let (mut pose, mut reach) = (G::Motion::identity(), 0.0);
        if let Some(body) = collider.body() {
            (pose, reach) = (G::pose(self.q, body), self.detector.reach_of(body));
            for (k, v) in velocity.as_mut().iter_mut().enumerate() {
                *v = (self.velocity)(G::FREEDOMS * body + k);
            }
        }
        Mover { collider, path: RigidPathIn::of(pose, &velocity, self.h), reach }
    }

    fn may_meet(&self, pair: [usize; 2], room: &mut MeetRoom<G>) -> bool {
        let movers = pair.map(|collider| self.mover(collider));
        let carriers = pair.map(|collider| self.detector.colliders()[collider].body());
        let tolerance = TOUCHING_DISTANCE * self.detector.smaller_radius(carriers);
        let bodies = [0, 1].map(|k| {
            let Mover { collider, path, .. } = &movers[k];
            Swept::new(&collider.shape, &collider.place, path)
        });
        meet(&bodies, Closeness { thickness: 0.0, tolerance }, INTERVALS, room, |_, _| false)
            .is_some()
    }

    /// Whether the collider by which another pair differs from that of some contacts reaches to the
    /// plane of one of them.
    fn is_level(&self, of_pair: &[ContactIn<G>], other: [usize; 2]) -> bool {
        let pair = of_pair[0].id.pair();
        let side = usize::from(other.contains(&pair[0]));
        let Mover { collider, path, .. } = self.mover(other[usize::from(pair.contains(&other[0]))]);
        if G::has_parts(&collider.shape) {
            return true;
        }
        let seen = path.at(0.0).compose(&collider.place);
        of_pair.iter().any(|contact| {
            let outwards = contact.normal * if side == 0 { 1.0 } else { -1.0 };
            let along = G::rotate_back(&G::frame(&seen), &outwards);
            let reach = G::farthest(&collider.shape, 0, &along);
            let height = G::dot(&outwards, &(contact.points[side] - G::translation(&seen)));
            let radius = self.detector.smaller_radius(contact.bodies);
            (reach - height).abs() < TOUCHING_DISTANCE * radius
        })
    }
}

/// Whether some of these contacts, which are sorted, are of a pair of colliders.
pub(crate) fn has_contacts<G: Dimension>(contacts: &[ContactIn<G>], pair: [usize; 2]) -> bool {
    contacts.binary_search_by_key(&pair, |contact| contact.id.pair()).is_ok()
}
