//! Detection: every contact point of some bodies within a margin, in an order of its own.
//!
//! ```text
//! boxes that overlap  ->  contact points with gap <= margin                                 (11.1)
//! ```
//! Broad phase by a hierarchy of boxes, narrow phase by where two shapes face each other; see the two
//! files of that name. Contact points are computed afresh from the poses each time: nothing is
//! carried over from the step before, so that a gap is what the poses say and not what a cache
//! remembers; steps of many bodies keep some of them elsewhere, and say what they keep. They come
//! sorted by their identifiers. Source: notes 11.1.

use std::collections::{BTreeMap, BTreeSet};

use stationary_calculus::SizeError;
use stationary_rigid::LieGroup;

use crate::detect::broad_phase::BroadPhase;
use crate::detect::seams::Seams;
use crate::shapes::collider::check_surface;
use crate::shapes::dimension::{Answer, Facing};
use crate::{Carrier, ColliderIn, ContactError, ContactIn, ContactRows, Dimension};

/// Colliders, and the memory that finding their contacts takes.
pub struct DetectorIn<G: Dimension> {
    pub(super) colliders: Vec<ColliderIn<G>>,
    /// Restitution and friction of pairs that have their own.
    pub(super) surfaces: BTreeMap<[usize; 2], [f64; 2]>,
    /// Pairs that pass through each other.
    pub(super) passing: BTreeSet<[usize; 2]>,
    /// Lengths of rolling and of torsional friction of pairs that have them, m.
    rolling: BTreeMap<[usize; 2], [f64; 2]>,
    bodies: usize,
    radii: Vec<f64>,
    /// Which bodies carry a half-space.
    endless: Vec<bool>,
    broad: BroadPhase<G>,
    seams: Seams,
    pub(super) placed: Vec<G::Motion>,
    pub(super) poses: Vec<G::Pose>,
    /// How much larger than each collider its box is, m.
    margins: Vec<f64>,
    pairs: Vec<(usize, usize)>,
    pub(super) room: G::Room,
    pub(super) facing: Vec<Facing<G::Vector>>,
    /// Their numbers, sorted by what they are called.
    order: Vec<usize>,
    /// Which of these are a neighbour's.
    covered: Vec<bool>,
    contacts: Vec<ContactIn<G>>,
}

/// Detection in space.
#[cfg(feature = "3d")]
pub type Detector = DetectorIn<crate::Spatial>;
/// Detection in the plane.
#[cfg(feature = "2d")]
pub type PlanarDetector = DetectorIn<crate::Planar>;

impl<G: Dimension> std::fmt::Debug for DetectorIn<G> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("DetectorIn").field("colliders", &self.colliders).finish_non_exhaustive()
    }
}

/// Two bodies that overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Overlap {
    /// The colliders.
    pub colliders: [usize; 2],
    /// How deep, m.
    pub depth: f64,
}

impl<G: Dimension> DetectorIn<G> {
    /// A detector of contacts between these colliders of `bodies` bodies.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a collider whose place is not finite;
    /// [`ContactError::Restitution`] and [`ContactError::Friction`] out of range, with the number of
    /// the collider; [`ContactError::Size`] for a collider on a body that is not there;
    /// [`ContactError::NoQuery`] for two half-spaces of which a body carries one.
    pub fn new(colliders: Vec<ColliderIn<G>>, bodies: usize) -> Result<Self, ContactError> {
        for (i, collider) in colliders.iter().enumerate() {
            collider.check(i)?;
            if let Some(body) = collider.body().filter(|&body| body >= bodies) {
                let what = "the body of a collider";
                return Err(SizeError { what, expected: bodies, got: body }.into());
            }
        }
        let planes = colliders.iter().filter(|collider| G::plane(&collider.shape).is_some());
        let (mut first, mut moving) = (None, false);
        for plane in planes {
            moving |= plane.body().is_some();
            if let Some(name) = first.replace(G::name(&plane.shape))
                && moving
            {
                return Err(ContactError::NoQuery { first: name, second: G::name(&plane.shape) });
            }
        }
        let identity = G::Motion::identity();
        let (radii, endless) = radii(&colliders, bodies);
        Ok(DetectorIn {
            radii,
            endless,
            surfaces: BTreeMap::new(),
            passing: BTreeSet::new(),
            rolling: BTreeMap::new(),
            broad: BroadPhase::new(&colliders),
            seams: Seams::of(&colliders),
            placed: vec![identity; colliders.len()],
            poses: vec![G::convert(&identity); colliders.len()],
            margins: Vec::new(),
            pairs: Vec::new(),
            room: G::Room::default(),
            facing: Vec::new(),
            order: Vec::new(),
            covered: Vec::new(),
            contacts: Vec::new(),
            colliders,
            bodies,
        })
    }

    /// The same with a restitution and a friction of their own for a pair of colliders.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a collider that is not there; [`ContactError::Restitution`] and
    /// [`ContactError::Friction`] out of range, with the number of the first collider.
    pub fn with_pair(
        mut self,
        colliders: [usize; 2],
        restitution: f64,
        friction: f64,
    ) -> Result<Self, ContactError> {
        let pair = self.pair(colliders)?;
        check_surface(colliders[0], restitution, friction)?;
        self.surfaces.insert(pair, [restitution, friction]);
        Ok(self)
    }

    /// The same, but that two colliders pass through each other.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a collider that is not there.
    pub fn without_pair(mut self, colliders: [usize; 2]) -> Result<Self, ContactError> {
        let pair = self.pair(colliders)?;
        self.passing.insert(pair);
        Ok(self)
    }

    /// A pair in its order.
    pub(super) fn pair(&self, colliders: [usize; 2]) -> Result<[usize; 2], ContactError> {
        let there = self.colliders.len();
        if let Some(&got) = colliders.iter().find(|&&collider| collider >= there) {
            return Err(SizeError { what: "a collider of a pair", expected: there, got }.into());
        }
        let [a, b] = colliders;
        Ok([a.min(b), a.max(b)])
    }

    /// The same with rolling and torsional friction of a pair of colliders: moments up to these
    /// lengths (m) times the normal impulse, across the normal and along it.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a collider that is not there; [`ContactError::Rolling`] for a length
    /// that is negative or not finite.
    pub fn with_rolling(
        mut self,
        colliders: [usize; 2],
        rolling: f64,
        torsion: f64,
    ) -> Result<Self, ContactError> {
        let pair = self.pair(colliders)?;
        let bad = |length: &f64| !(*length >= 0.0 && length.is_finite());
        if let Some(&length) = [rolling, torsion].iter().find(|length| bad(length)) {
            return Err(ContactError::Rolling { colliders, length });
        }
        match rolling.max(torsion) > 0.0 {
            true => self.rolling.insert(pair, [rolling, torsion]),
            false => self.rolling.remove(&pair),
        };
        Ok(self)
    }

    /// The lengths of rolling and of torsional friction of a pair, m.
    pub(crate) fn rolling(&self, pair: [usize; 2]) -> Option<[f64; 2]> {
        self.rolling.get(&pair).copied()
    }

    /// The colliders.
    pub fn colliders(&self) -> &[ColliderIn<G>] {
        &self.colliders
    }

    /// How many bodies there are.
    pub fn bodies(&self) -> usize {
        self.bodies
    }

    /// The radius of a ball about a body's centre that holds all its shapes but half-spaces, m.
    ///
    /// # Errors
    /// [`ContactError::Size`] for a body that is not there.
    pub fn radius(&self, body: usize) -> Result<f64, ContactError> {
        let there = self.bodies;
        self.radii.get(body).copied().ok_or_else(|| {
            SizeError { what: "the body of a radius", expected: there, got: body }.into()
        })
    }

    /// The same of a body that is there.
    #[inline]
    pub(crate) fn radius_of(&self, body: usize) -> f64 {
        self.radii[body]
    }

    /// How far from a body's centre its shapes reach, m: by so much times a turn they move.
    #[inline]
    pub(crate) fn reach_of(&self, body: usize) -> f64 {
        if self.endless[body] { f64::MAX } else { self.radii[body] }
    }

    /// The smaller radius of those bodies that have one, m; infinite where none has.
    #[inline]
    pub(crate) fn smaller_radius(&self, bodies: [Option<usize>; 2]) -> f64 {
        let radii = bodies.into_iter().flatten().map(|body| self.radii[body]);
        radii.filter(|&radius| radius > 0.0).fold(f64::INFINITY, f64::min)
    }

    /// Other pairs near each other by which the surface of one collider of a pair faces the other.
    pub(crate) fn beside(&self, pair: [usize; 2]) -> impl Iterator<Item = [usize; 2]> {
        let same = |one: usize, other: usize| one != other && self.seams.join(one, other);
        let beside = move |a: usize, b: usize| {
            let [first, second] = pair;
            (a == first && same(b, second))
                || (b == first && same(a, second))
                || (a == second && same(b, first))
                || (b == second && same(a, first))
        };
        self.pairs.iter().filter(move |&&(a, b)| beside(a, b)).map(|&(a, b)| [a, b])
    }

    /// The pairs of colliders that the last broad phase could not rule out.
    pub fn candidates(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// The broad phase alone: how many pairs it leaves.
    ///
    /// # Errors
    /// [`ContactError::Margin`] where that is negative or not finite; [`ContactError::Size`] unless
    /// `q` holds the poses of all bodies; where one is not finite [`ContactError::NonFinite`] in the
    /// plane and [`ContactError::Rigid`] in space, there also for a quaternion whose length is not 1.
    pub fn broad_phase(&mut self, q: &[f64], margin: f64) -> Result<usize, ContactError> {
        if !(margin >= 0.0 && margin.is_finite()) {
            return Err(ContactError::Margin(margin));
        }
        self.find_candidates(q, |_| 0.5 * margin)?;
        Ok(self.pairs.len())
    }

    /// The pairs of colliders that are no farther apart than the reach of what carries them, which is
    /// NaN where a speed is too large for a number.
    pub(crate) fn find_candidates(
        &mut self,
        q: &[f64],
        reach: impl Fn(Option<usize>) -> f64,
    ) -> Result<(), ContactError> {
        self.place(q)?;
        self.margins.clear();
        self.margins.extend(self.colliders.iter().map(|collider| reach(collider.body())));
        if let Some(index) = self.margins.iter().position(|m| m.is_nan()) {
            let (what, value) = ("the reach of colliders", self.margins[index]);
            return Err(ContactError::NonFinite { what, index, value });
        }
        let (placed, poses) = (&self.placed, &self.poses);
        self.broad.pairs(&self.colliders, placed, poses, &self.margins, &mut self.pairs);
        let Self { pairs, passing, colliders, .. } = self;
        pairs.retain(|&(a, b)| touch(colliders, passing, [a, b]));
        Ok(())
    }

    /// The contact points of bodies at the poses `q` whose gap is at most `margin`.
    ///
    /// # Errors
    /// Those of [`DetectorIn::broad_phase`]; [`ContactError::NoQuery`] for two shapes that come
    /// near and between which there is no query.
    pub fn detect(&mut self, q: &[f64], margin: f64) -> Result<&[ContactIn<G>], ContactError> {
        self.broad_phase(q, margin)?;
        self.contacts.clear();
        for k in 0..self.pairs.len() {
            let (a, b) = self.pairs[k];
            let placed = [self.placed[a], self.placed[b]];
            self.meet([a, b], placed, [self.poses[a], self.poses[b]], margin)?;
        }
        Ok(&self.contacts)
    }

    /// The pairs that overlap by more than `depth`, the deepest point of each.
    ///
    /// # Errors
    /// [`ContactError::Depth`] where that is negative or not finite; those of
    /// [`DetectorIn::detect`].
    pub fn overlaps(&mut self, q: &[f64], depth: f64) -> Result<Vec<Overlap>, ContactError> {
        if !(depth >= 0.0 && depth.is_finite()) {
            return Err(ContactError::Depth(depth));
        }
        let mut overlaps: Vec<Overlap> = Vec::new();
        for contact in self.detect(q, 0.0)?.iter().filter(|contact| -contact.gap > depth) {
            let colliders = contact.id.colliders.map(|c| c as usize);
            match overlaps.last_mut().filter(|last| last.colliders == colliders) {
                Some(last) => last.depth = last.depth.max(-contact.gap),
                None => overlaps.push(Overlap { colliders, depth: -contact.gap }),
            }
        }
        Ok(overlaps)
    }

    /// Checks that no bodies overlap by more than `depth`.
    ///
    /// # Errors
    /// [`ContactError::Overlap`] where they do, with the colliders of the deepest pair; those of
    /// [`DetectorIn::overlaps`].
    pub fn check_free(&mut self, q: &[f64], depth: f64) -> Result<(), ContactError> {
        let overlaps = self.overlaps(q, depth)?;
        let deepest = overlaps.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        match deepest {
            None => Ok(()),
            Some(worst) => Err(ContactError::Overlap {
                count: overlaps.len(),
                first: worst.colliders[0],
                second: worst.colliders[1],
                depth: worst.depth,
            }),
        }
    }

    pub(super) fn place(&mut self, q: &[f64]) -> Result<(), ContactError> {
        SizeError::check("the poses' numbers", G::STORED * self.bodies, q.len())?;
        G::check(q)?;
        for (i, collider) in self.colliders.iter().enumerate() {
            self.placed[i] = match collider.carrier {
                Carrier::World => collider.place,
                Carrier::Body(body) => G::pose(q, body).compose(&collider.place),
            };
            self.poses[i] = G::convert(&self.placed[i]);
        }
        Ok(())
    }

    /// The contact points of one pair, sorted, with its first body at the origin and its second at
    /// this pose; all in the axes of the first. Also what is known of them.
    pub(crate) fn meet_alone(
        &mut self,
        pair: [usize; 2],
        relative: &G::Motion,
        margin: f64,
    ) -> Result<(Answer, &[ContactIn<G>]), ContactError> {
        let [first, second] = pair.map(|i| self.colliders[i].place);
        let placed = [first, relative.compose(&second)];
        let poses = [G::convert(&placed[0]), G::convert(&placed[1])];
        self.contacts.clear();
        let answer = self.meet(pair, placed, poses, margin)?;
        Ok((answer, &self.contacts))
    }

    fn meet(
        &mut self,
        pair: [usize; 2],
        placed: [G::Motion; 2],
        poses: [G::Pose; 2],
        margin: f64,
    ) -> Result<Answer, ContactError> {
        let shapes = pair.map(|i| &self.colliders[i].shape);
        self.facing.clear();
        let poses = [&poses[0], &poses[1]];
        let answer = G::face(shapes, poses, margin, &mut self.room, &mut self.facing);
        if answer == Answer::None {
            let [first, second] = shapes.map(G::name);
            return Err(ContactError::NoQuery { first, second });
        }
        self.drop_at_seams(pair, &placed);
        let first = self.contacts.len();
        let size: f64 =
            pair.iter().filter_map(|&i| self.colliders[i].body()).map(|b| self.radii[b]).sum();
        let near = (COINCIDENT * size).powi(2);
        let met = self.met(pair, &placed);
        let Self { facing, order, contacts, .. } = self;
        order.clear();
        order.extend(0..facing.len());
        order.sort_unstable_by_key(|&k| (facing[k].parts, facing[k].features, k));
        for contact in order.iter().map(|&k| met.point(&facing[k])) {
            // Pairs come sorted; so do the contacts, as those of each pair are.
            let same = |other: &ContactIn<G>| coincide(other, &contact, near);
            match contacts[first..].iter().position(same) {
                Some(place) if contact.gap >= contacts[first + place].gap => continue,
                Some(place) => drop(contacts.remove(first + place)),
                None => {}
            }
            contacts.push(contact);
        }
        Ok(answer)
    }

    /// Drops what is not felt because it is at an edge between parts of one surface.
    fn drop_at_seams(&mut self, pair: [usize; 2], placed: &[G::Motion; 2]) {
        let Self { seams, colliders, passing, facing, covered, radii, .. } = self;
        let radii = pair.iter().filter_map(|&i| colliders[i].body()).map(|body| radii[body]);
        let size = radii.filter(|&radius| radius > 0.0).fold(f64::INFINITY, f64::min);
        for side in [0, 1].into_iter().filter(|&side| seams.at(pair[side])) {
            let own = &colliders[pair[side]];
            let felt = |other: usize| touch(colliders, passing, [other, pair[1 - side]]);
            // From the axes of the first collider to those of this side's carrier.
            let seen = own.place.compose(&placed[side].inverse()).compose(&placed[0]);
            covered.clear();
            covered.extend((0..facing.len()).map(|k| {
                let outwards = facing[k].normal * if side == 0 { 1.0 } else { -1.0 };
                let normal = G::turn(&seen, &outwards);
                seams.cover(colliders, (pair, side), (k, facing), &normal, size, felt)
            }));
            // Of one mesh the least gap is nobody else's: where many directions are as good, each part may choose
            // one that seems a neighbour's.
            let gaps = || facing.iter().map(|facing| facing.gap).zip(&*covered).enumerate();
            let least = gaps().min_by(|(_, (g, _)), (_, (h, _))| g.total_cmp(h));
            if seams.alone(pair[side])
                && let Some((deepest, (least, true))) = least
                && let as_deep = least + (-least).max(AS_DEEP * size)
                && !gaps().any(|(_, (gap, &covered))| !covered && gap <= as_deep)
            {
                covered[deepest] = false;
            }
            let mut stays = covered.iter().map(|covered| !covered);
            facing.retain(|_| stays.next().unwrap_or(true));
        }
    }
}

/// Whether two colliders have contacts with each other: they are no sensors, in each other's groups, and have not
/// been told to pass through each other.
fn touch<G: Dimension>(
    colliders: &[ColliderIn<G>],
    passing: &BTreeSet<[usize; 2]>,
    [a, b]: [usize; 2],
) -> bool {
    let (first, second) = (&colliders[a], &colliders[b]);
    let solid = !first.sensor && !second.sensor;
    solid && first.meets(second) && !passing.contains(&[a.min(b), a.max(b)])
}

/// Of each body, that of a ball about its centre that holds its shapes, and whether it carries one without end, of
/// which the ball knows nothing.
fn radii<G: Dimension>(colliders: &[ColliderIn<G>], bodies: usize) -> (Vec<f64>, Vec<bool>) {
    let (mut radii, mut endless) = (vec![0.0_f64; bodies], vec![false; bodies]);
    for collider in colliders {
        let Some(body) = collider.body() else { continue };
        match G::plane(&collider.shape) {
            Some(_) => endless[body] = true,
            None => radii[body] = radii[body].max(G::reach(&collider.shape, &collider.place)),
        }
    }
    (radii, endless)
}

/// Points closer to each other than this part of the bodies' radii are one: a corner that meets a
/// corner is found from both sides.
const COINCIDENT: f64 = 1e-7;
/// Gaps within this part of the size are as large.
const AS_DEEP: f64 = 1e-12;

#[inline]
fn coincide<G: Dimension>(a: &ContactIn<G>, b: &ContactIn<G>, near: f64) -> bool {
    let apart = a.points[1] - b.points[1];
    G::dot(&apart, &apart) < near && G::dot(&a.normal, &b.normal) > 1.0 - COINCIDENT
}

/// The differentials of the gaps of some contact points, one row each.
pub fn gap_rows<G: Dimension>(contacts: &[ContactIn<G>], q: &[f64]) -> ContactRows {
    let mut rows = ContactRows::with_room(contacts.len(), 2 * G::FREEDOMS * contacts.len());
    contacts.iter().for_each(|contact| contact.push_row(q, &mut rows));
    rows
}

#[cfg(all(test, feature = "2d"))]
mod tests {
    use super::*;
    use crate::{PlanarCollider, PlanarShape};

    #[test]
    fn a_reach_that_is_no_number_is_refused() {
        let disc = || PlanarShape::disc(0.5).unwrap();
        let bodies = vec![PlanarCollider::on_body(0, disc()), PlanarCollider::on_body(1, disc())];
        let mut detector = PlanarDetector::new(bodies, 2).unwrap();
        let reach = |body: Option<usize>| if body == Some(1) { f64::NAN } else { 1.0 };
        let refused = detector.find_candidates(&[0.0; 6], reach).unwrap_err();
        assert!(matches!(refused, ContactError::NonFinite { index: 1, .. }), "{refused}");
        detector.find_candidates(&[0.0; 6], |_| 1.0).unwrap();
        assert_eq!(detector.candidates(), [(0, 1)]);
    }
}
