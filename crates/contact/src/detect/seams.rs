//! Seams: edges between parts of one surface, at which nothing can catch.
//!
//! ```text
//! x = p + e n,     |x - q| < (1 - 1e-9) e          p is not the closest point of what the carrier holds
//! ```
//! `p` a contact point on one part and `n` its normal, away from that part; `q` the point of all
//! parts that the same carrier holds that is closest to `x`; `e` a small part of the other body's
//! size. Of two shapes that are apart `p` is closest to everything in front of it along `n`; where
//! a neighbour is closer, as it is to what looks sideways out of the edge between two tiles or two
//! triangles in a plane, the contact is the neighbour's. A normal of a face that is not covered a
//! little farther inside belongs to a wall that stands on the neighbour, and stays. So does what
//! overlaps by more than rounding: there it may be the only way out.
//!
//! Half-spaces are nobody's neighbours. Source: the Voronoi regions of features, Mirtich 1998.

use stationary_rigid::LieGroup;

use crate::detect::broad_phase::BoxTree;
use crate::shapes::dimension::Facing;
use crate::{Carrier, ColliderIn, Dimension};

/// How far in front of a contact point one looks, as a part of the size.
const PROBE: f64 = 1e-4;
/// How far inside of a face one looks whether that is covered too, as a part of the size.
const INSIDE: f64 = 1e-3;
/// Distances that are shorter by this part are shorter.
const SHORTER: f64 = 1e-9;
/// Overlaps below this part of the size, and distances between neighbours, are rounding.
const ROUNDING: f64 = 1e-6;

/// The colliders next to each on the same carrier; itself among them where it has parts.
#[derive(Debug)]
pub(crate) struct Seams(Vec<Vec<usize>>);

impl Seams {
    pub(crate) fn of<G: Dimension>(colliders: &[ColliderIn<G>]) -> Self {
        let has_parts = |i: usize| G::has_parts(&colliders[i].shape);
        let itself = |i: usize| has_parts(i).then_some(i).into_iter().collect();
        let mut next: Vec<Vec<usize>> = (0..colliders.len()).map(itself).collect();
        let mut shared: Vec<usize> =
            (0..colliders.len()).filter(|&i| G::plane(&colliders[i].shape).is_none()).collect();
        let of = |i: &usize| match colliders[*i].carrier {
            Carrier::World => 0,
            Carrier::Body(body) => body + 1,
        };
        shared.sort_by_key(of);
        for held in shared.chunk_by(|i, j| of(i) == of(j)).filter(|held| held.len() > 1) {
            let mut tree = G::Tree::default();
            tree.fit(held.iter().map(|&i| {
                let ColliderIn { shape, place, .. } = &colliders[i];
                (shape, G::convert(place), ROUNDING * G::reach(shape, &G::Motion::identity()))
            }));
            tree.each_pair(|a, b| {
                next[held[a]].push(held[b]);
                next[held[b]].push(held[a]);
            });
        }
        next.iter_mut().for_each(|next| next.sort_unstable());
        Seams(next)
    }

    /// Whether a collider has neighbours or parts at all.
    pub(crate) fn at(&self, collider: usize) -> bool {
        !self.0[collider].is_empty()
    }

    /// Whether what two colliders face each other with is a neighbour's of the one on a side, for
    /// bodies of a size.
    pub(crate) fn cover<G: Dimension>(
        &self,
        colliders: &[ColliderIn<G>],
        pair: [usize; 2],
        side: usize,
        facing: &Facing<G::Vector>,
        normal: &G::Vector,
        size: f64,
    ) -> bool {
        let (own, part) = (&colliders[pair[side]], facing.parts[side]);
        // In the axes of the carrier.
        let point = G::apply(&own.place, &facing.points[side]);
        let covered = |point: &G::Vector| {
            let probe = *point + *normal * (PROBE * size);
            self.0[pair[side]].iter().any(|&other| {
                distance::<G>(&colliders[other], &probe) < (1.0 - SHORTER) * PROBE * size
            })
        };
        if facing.gap < -ROUNDING * size || !covered(&point) {
            return false;
        }
        let middle = G::apply(&own.place, &G::middle(&own.shape, part));
        let inwards = middle - point;
        let along = inwards - *normal * G::dot(&inwards, normal);
        let length = G::dot(&along, &along).sqrt();
        if length < INSIDE * size {
            return true;
        }
        let inside = point + along * (INSIDE * size / length);
        let on_face = distance::<G>(own, &inside) < SHORTER * size;
        !on_face || covered(&inside)
    }
}

/// How far a point is from a collider, in the axes of the carrier.
fn distance<G: Dimension>(collider: &ColliderIn<G>, point: &G::Vector) -> f64 {
    let place = collider.place.inverse();
    let apart = G::nearest(&collider.shape, &G::apply(&place, point)) - G::apply(&place, point);
    G::dot(&apart, &apart).sqrt()
}
