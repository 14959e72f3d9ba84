//! Detection: every contact point of some bodies within a margin, in an order of its own.
//!
//! ```text
//! boxes that overlap  ->  contact points with gap <= margin                                 (11.1)
//! ```
//! Broad phase by a hierarchy of boxes, narrow phase by the geometry library's separating axes and
//! clipping (boxes), Gilbert-Johnson-Keerthi and expanding polytopes (other convex solids). Contact
//! points are computed afresh from the poses each time: nothing is carried over from the step
//! before, so that a gap is what the poses say and not what a cache remembers. They come sorted by
//! their identifiers. Source: notes 11.1.
//!
//! Matching faces of boxes keep their corners; those of other convex solids, off by no more than
//! rounding, may lose one for a step.

use nalgebra::Vector3;
use parry3d_f64::math::Pose;
use parry3d_f64::query::{ContactManifold, DefaultQueryDispatcher, PersistentQueryDispatcher};
use parry3d_f64::shape::SharedShape;
use stationary_calculus::SizeError;
use stationary_rigid::{BodySpace, LieGroup, Poses, RigidMotion};

use crate::broad_phase::BroadPhase;
use crate::convert::{from_vector, pose};
use crate::{Carrier, Collider, ContactError, ContactId, ContactPoint, ContactRows};

/// Colliders, and the memory that finding their contacts takes.
pub struct Detector {
    colliders: Vec<Collider>,
    bodies: usize,
    radii: Vec<f64>,
    wide: Vec<Option<WideBox>>,
    broad: BroadPhase,
    placed: Vec<RigidMotion>,
    poses: Vec<Pose>,
    pairs: Vec<(usize, usize)>,
    manifolds: Vec<ContactManifold<(), ()>>,
    contacts: Vec<ContactPoint>,
}

impl std::fmt::Debug for Detector {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Detector").field("colliders", &self.colliders).finish_non_exhaustive()
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

impl Detector {
    /// A detector of contacts between these colliders of `bodies` bodies.
    pub fn new(colliders: Vec<Collider>, bodies: usize) -> Result<Self, ContactError> {
        for (i, collider) in colliders.iter().enumerate() {
            collider.check(i)?;
            if let Some(body) = collider.body().filter(|&body| body >= bodies) {
                let what = "the body of a collider";
                return Err(SizeError { what, expected: bodies, got: body }.into());
            }
        }
        Ok(Detector {
            radii: radii(&colliders, bodies),
            wide: colliders.iter().map(WideBox::of).collect(),
            broad: BroadPhase::new(&colliders),
            placed: vec![RigidMotion::identity(); colliders.len()],
            poses: vec![Pose::identity(); colliders.len()],
            pairs: Vec::new(),
            manifolds: vec![ContactManifold::new()],
            contacts: Vec::new(),
            colliders,
            bodies,
        })
    }

    /// The colliders.
    pub fn colliders(&self) -> &[Collider] {
        &self.colliders
    }

    /// The radius of a ball about a body's centre that holds all its shapes, m.
    pub fn radius(&self, body: usize) -> f64 {
        self.radii[body]
    }

    /// What [`Detector::detect`] found last, to be given back by [`Detector::put_back`].
    pub(crate) fn take_contacts(&mut self) -> Vec<ContactPoint> {
        std::mem::take(&mut self.contacts)
    }

    /// Reuses the memory of contacts that are no longer needed.
    pub(crate) fn put_back(&mut self, contacts: Vec<ContactPoint>) {
        self.contacts = contacts;
    }

    /// The pairs of colliders that the last broad phase could not rule out.
    pub fn candidates(&self) -> &[(usize, usize)] {
        &self.pairs
    }

    /// The broad phase alone: how many pairs it leaves.
    pub fn broad_phase(&mut self, q: &[f64], margin: f64) -> Result<usize, ContactError> {
        self.place(q)?;
        self.broad.pairs(&self.colliders, &self.poses, margin, &mut self.pairs);
        Ok(self.pairs.len())
    }

    /// The contact points of bodies at the poses `q` whose gap is at most `margin`.
    pub fn detect(&mut self, q: &[f64], margin: f64) -> Result<&[ContactPoint], ContactError> {
        self.broad_phase(q, margin)?;
        self.contacts.clear();
        for k in 0..self.pairs.len() {
            let (a, b) = self.pairs[k];
            self.meet([a, b], margin)?;
        }
        Ok(&self.contacts)
    }

    /// The pairs that overlap by more than `depth`, the deepest point of each.
    pub fn overlaps(&mut self, q: &[f64], depth: f64) -> Result<Vec<Overlap>, ContactError> {
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

    /// An error where bodies overlap by more than `depth`.
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

    fn place(&mut self, q: &[f64]) -> Result<(), ContactError> {
        SizeError::check("the poses' numbers", 7 * self.bodies, q.len())?;
        Poses::check(q)?;
        for (i, collider) in self.colliders.iter().enumerate() {
            self.placed[i] = match collider.carrier {
                Carrier::World => collider.place,
                Carrier::Body(body) => Poses::pose(q, body).compose(&collider.place),
            };
            self.poses[i] = pose(&self.placed[i]);
        }
        Ok(())
    }

    fn meet(&mut self, pair: [usize; 2], margin: f64) -> Result<(), ContactError> {
        let [a, b] = pair.map(|i| self.colliders[i].shape.geometry());
        // Where two boxes meet, the second is looked at a little larger.
        let wide = self.wide[pair[1]].as_ref().filter(|_| a.as_cuboid().is_some());
        let b = wide.map_or(b, |wide| &wide.geometry);
        let relative = self.poses[pair[0]].inv_mul(&self.poses[pair[1]]);
        self.manifolds.truncate(1);
        if let Some(manifold) = self.manifolds.first_mut() {
            manifold.clear();
            (manifold.subshape1, manifold.subshape2) = (0, 0);
        }
        if a.as_composite_shape().is_some() || b.as_composite_shape().is_some() {
            self.manifolds.clear();
        }
        DefaultQueryDispatcher
            .contact_manifolds(&relative, &**a, &**b, margin, &mut self.manifolds, &mut None)
            .map_err(|_| {
                let [first, second] = pair.map(|i| self.colliders[i].shape.name());
                ContactError::NoQuery { first, second }
            })?;
        let first = self.contacts.len();
        let size: f64 =
            pair.iter().filter_map(|&i| self.colliders[i].body()).map(|b| self.radii[b]).sum();
        let near = (COINCIDENT * size).powi(2);
        for manifold in &self.manifolds {
            let narrower = wide.map_or(0.0, |wide| wide.excess(manifold.local_n2));
            for point in manifold.points.iter().filter(|p| p.dist + narrower <= margin) {
                let local = [from_vector(point.local_p1), from_vector(point.local_p2)];
                let features = [point.fid1.0, point.fid2.0];
                let parts = [manifold.subshape1, manifold.subshape2];
                let id = ContactId { colliders: pair.map(|i| i as u32), parts, features };
                let normal = from_vector(manifold.local_n1);
                let contact = self.point(id, local, normal, point.dist + narrower);
                let same = |other: &ContactPoint| coincide(other, &contact, near);
                match self.contacts[first..].iter().position(same) {
                    None => self.contacts.push(contact),
                    Some(place) if contact.gap < self.contacts[first + place].gap => {
                        self.contacts[first + place] = contact;
                    }
                    Some(_) => {}
                }
            }
        }
        // Pairs come sorted; so do the contacts, once those of each pair are.
        self.contacts[first..].sort_by_key(|contact| contact.id);
        Ok(())
    }

    fn point(
        &self,
        id: ContactId,
        local: [Vector3<f64>; 2],
        normal: Vector3<f64>,
        gap: f64,
    ) -> ContactPoint {
        let pair = id.colliders.map(|c| c as usize);
        let [first, second] = pair.map(|i| &self.colliders[i]);
        let points = [0, 1].map(|k| self.placed[pair[k]].apply(&local[k]));
        let bodies = [first.body(), second.body()];
        let arm = |k: usize| match bodies[k] {
            Some(_) => self.colliders[pair[k]].place.apply(&local[k]),
            None => points[k],
        };
        ContactPoint {
            id,
            bodies,
            gap,
            normal: self.placed[pair[0]].rotation.rotate(&normal),
            points,
            arms: [arm(0), arm(1)],
            restitution: first.restitution.min(second.restitution),
            friction: (first.friction * second.friction).sqrt(),
        }
    }
}

/// A box made larger by a hair on all sides.
///
/// Clipping one face against another of the same size, off by no more than rounding, may lose
/// corners altogether, and a stack that loses a corner for a step jumps. A hair breaks the tie;
/// what it takes from the gap is known exactly, and is given back.
struct WideBox {
    geometry: SharedShape,
    hair: f64,
}

/// The hair, relative to the smallest half size.
const HAIR: f64 = 1e-9;

impl WideBox {
    fn of(collider: &Collider) -> Option<Self> {
        let half = collider.shape.geometry().as_cuboid()?.half_extents;
        let hair = HAIR * half.min_element();
        let geometry = SharedShape::cuboid(half.x + hair, half.y + hair, half.z + hair);
        Some(WideBox { geometry, hair })
    }

    /// How much farther the larger box reaches along a direction of its own axes.
    fn excess(&self, direction: parry3d_f64::math::Vector) -> f64 {
        self.hair * direction.abs().element_sum()
    }
}

/// For each body the radius of a ball about its centre that holds all its shapes.
fn radii(colliders: &[Collider], bodies: usize) -> Vec<f64> {
    let mut radii = vec![0.0_f64; bodies];
    for collider in colliders {
        if let Some(body) = collider.body() {
            let ball = collider.shape.geometry().compute_local_bounding_sphere();
            let centre = collider.place.apply(&from_vector(ball.center));
            radii[body] = radii[body].max(centre.norm() + ball.radius);
        }
    }
    radii
}

/// Points closer to each other than this part of the bodies' radii are one: a corner that meets a
/// corner is found from both sides.
const COINCIDENT: f64 = 1e-7;

fn coincide(a: &ContactPoint, b: &ContactPoint, near: f64) -> bool {
    (a.points[1] - b.points[1]).norm_squared() < near && a.normal.dot(&b.normal) > 1.0 - COINCIDENT
}

/// The differentials of the gaps of some contact points, one row each.
pub fn gap_rows(contacts: &[ContactPoint], q: &[f64]) -> ContactRows {
    let mut rows = ContactRows::with_room(contacts.len(), 12 * contacts.len());
    contacts.iter().for_each(|contact| contact.push_row(q, &mut rows));
    rows
}
