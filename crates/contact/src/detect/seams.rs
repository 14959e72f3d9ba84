//! Seams: edges between parts of one surface, at which nothing can catch.
//!
//! ```text
//! x = p + e n,     |x - q| < e,   q != p           p is not the closest point of what the carrier holds
//! ```
//! `p` a contact point on one part and `n` its normal, away from that part; `q` the point of all
//! parts that the same carrier holds that is closest to `x`; `e` a small part of the other body's
//! size. Of two shapes that are apart `p` is closest to everything in front of it along `n`; where
//! a neighbour is closer, as it is to what looks sideways out of the edge between two tiles or two
//! triangles in a plane, the contact is the neighbour's. A normal of a face that is not covered a
//! little farther inside belongs to a wall that stands on the neighbour, and stays. So does the end of a line or a
//! polygon of contacts that is not covered a little farther along: that of what hangs in a hole, at whose
//! corners each side would leave it to the next. And so does what overlaps by more than rounding: there it may be
//! the only way out.
//! Of a mesh without neighbours the deepest contact stays whatever the rest do: the gap of what it is nearest to.
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
/// Roundings of a distance, in units of the coordinates of its ends: what they may hide is not shorter.
const ROUNDINGS: f64 = 64.0 * f64::EPSILON;
/// A normal that is turned by more than this, radians, leans: out of an edge, or from a face.
const LEANS: f64 = 1e-6;
/// Overlaps below this part of the size, and distances between neighbours, are rounding.
const ROUNDING: f64 = 1e-6;

/// Colliders that share a surface.
#[derive(Debug)]
pub(crate) struct Seams {
    /// Those next to each on the same carrier; itself among them where it has parts.
    next: Vec<Vec<usize>>,
    /// The least of those that hang together with each.
    surface: Vec<usize>,
}

impl Seams {
    pub(crate) fn of<G: Dimension>(colliders: &[ColliderIn<G>]) -> Self {
        let has_parts = |i: usize| G::has_parts(&colliders[i].shape);
        let itself = |i: usize| has_parts(i).then_some(i).into_iter().collect();
        let mut next: Vec<Vec<usize>> = (0..colliders.len()).map(itself).collect();
        let solid = |&i: &usize| G::plane(&colliders[i].shape).is_none() && !colliders[i].sensor;
        let mut shared: Vec<usize> = (0..colliders.len()).filter(solid).collect();
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
        let mut surface: Vec<usize> = (0..next.len()).collect();
        for first in 0..next.len() {
            let mut open = if surface[first] == first { vec![first] } else { Vec::new() };
            while let Some(here) = open.pop() {
                open.extend(next[here].iter().copied().filter(|&there| surface[there] > first));
                next[here].iter().for_each(|&there| surface[there] = surface[there].min(first));
            }
        }
        Seams { next, surface }
    }

    /// Whether a collider has neighbours or parts at all.
    pub(crate) fn at(&self, collider: usize) -> bool {
        !self.next[collider].is_empty()
    }

    /// Whether a collider's own parts are the only neighbours that there are.
    pub(crate) fn alone(&self, collider: usize) -> bool {
        self.next[collider] == [collider]
    }

    /// Whether two colliders are parts of one surface.
    pub(crate) fn join(&self, one: usize, other: usize) -> bool {
        self.surface[one] == self.surface[other]
    }

    /// Whether what two colliders face each other with is a neighbour's of the one on a side, for
    /// bodies of a size; beside all that they face each other with. Of neighbours that are not `felt`, which the
    /// other one passes through, nothing is covered.
    pub(crate) fn cover<G: Dimension>(
        &self,
        colliders: &[ColliderIn<G>],
        (pair, side): ([usize; 2], usize),
        (facing, all): (usize, &[Facing<G::Vector>]),
        normal: &G::Vector,
        size: f64,
        felt: impl Fn(usize) -> bool,
    ) -> bool {
        let facing = &all[facing];
        let (own, part) = (&colliders[pair[side]], facing.parts[side]);
        // In the axes of the carrier.
        let point = G::apply(&own.place, &facing.points[side]);
        let far = length::<G>(&point);
        let probe = |point: &G::Vector| *point + *normal * (PROBE * size);
        let (shorter, rounding) = ((1.0 - SHORTER) * PROBE * size, ROUNDINGS * far);
        let next = &self.next[pair[side]];
        let covered = |point: &G::Vector| {
            let seen = probe(point);
            next.iter().filter(|&&other| felt(other)).any(|&other| {
                let nearest = nearest::<G>(&colliders[other], &seen);
                let (off, away) =
                    (length::<G>(&(nearest - seen)), length::<G>(&(nearest - *point)));
                let leans = off < PROBE * size && away > LEANS * PROBE * size + rounding;
                leans || off < shorter - rounding
            })
        };
        if facing.gap < -ROUNDING * size || !covered(&point) {
            return false;
        }
        // Along to another contact of the same normal, where the normal is one of its own part.
        let goes_on = |other: &Facing<G::Vector>| {
            let same = G::dot(&other.normal, &facing.normal) > 1.0 - SHORTER;
            let way = G::apply(&own.place, &other.points[side]) - point;
            let width = length::<G>(&way);
            if other.parts != facing.parts || !same || width < INSIDE * size {
                return false;
            }
            let along = point + way * (INSIDE * size / width);
            distance::<G>(own, &probe(&along)) > shorter - rounding && !covered(&along)
        };
        if all.iter().any(goes_on) {
            return false;
        }
        let middle = G::apply(&own.place, &G::middle(&own.shape, part));
        let inwards = middle - point;
        let along = inwards - *normal * G::dot(&inwards, normal);
        let width = length::<G>(&along);
        if width < INSIDE * size {
            return true;
        }
        let inside = point + along * (INSIDE * size / width);
        // What a normal that leans out of an edge is turned from lies in front of its own shape.
        let on_face = distance::<G>(own, &inside) < SHORTER * size + rounding
            && distance::<G>(own, &probe(&inside)) > (1.0 - LEANS) * PROBE * size - rounding;
        !on_face || covered(&inside)
    }
}

/// How far a point is from a collider, in the axes of the carrier.
fn distance<G: Dimension>(collider: &ColliderIn<G>, point: &G::Vector) -> f64 {
    length::<G>(&(nearest::<G>(collider, point) - *point))
}

/// The point of a collider that is closest to a point, in the axes of the carrier.
fn nearest<G: Dimension>(collider: &ColliderIn<G>, point: &G::Vector) -> G::Vector {
    let there = G::nearest(&collider.shape, &G::apply(&collider.place.inverse(), point));
    G::apply(&collider.place, &there)
}

fn length<G: Dimension>(v: &G::Vector) -> f64 {
    G::dot(v, v).sqrt()
}
