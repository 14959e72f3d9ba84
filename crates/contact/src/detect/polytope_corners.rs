//! Two convex solids with flat faces that are closest at corners and edges: each is looked at.
//!
//! ```text
//! n ~ x2 - x1,   or what of it is across an edge e,   or e1 x e2        whichever separates farther
//! ```
//! Of a short way from one point to the other rounding leaves no direction; the edges keep theirs.

use nalgebra::Vector3;
use parry3d_f64::math::Pose;
use parry3d_f64::shape::PackedFeatureId;

use crate::detect::polytope_axes::{Seen, across_both, separation};
use crate::shapes::convert::{from_vector, vector};
use crate::shapes::dimension::Facing;
use crate::shapes::polytope::Edge;

type V = Vector3<f64>;

/// A way at a smaller sine to an edge lies along it.
const LENGTHWISE: f64 = 1e-10;
/// Distances that differ by less than this part of the sizes are the same.
const ROUNDING: f64 = 1e-15;
/// Points face each other along a direction that is off the way between them by this part of the sizes.
const ACROSS: f64 = 1e-12;

/// The name of an edge between two corners: a feature's name has room for 30 bits, and no solid that is
/// looked at here has 2^15 corners (`narrow_phase.rs`).
pub(crate) fn edge_name(corners: [usize; 2]) -> u32 {
    PackedFeatureId::edge(pair_name(corners)).0
}

pub(crate) fn pair_name([from, to]: [usize; 2]) -> u32 {
    ((from << 15) | to) as u32
}

/// The points of two lines along edges that are closest.
pub(crate) fn between([own, others]: [&[V]; 2], [one, other]: [Edge; 2]) -> [V; 2] {
    let (p, q) = (own[one.corners[0]], others[other.corners[0]]);
    let (d, e) = (own[one.corners[1]] - p, others[other.corners[1]] - q);
    let across = d.cross(&e);
    let r = q - p;
    let s = r.cross(&e).dot(&across) / across.norm_squared();
    let t = r.cross(&d).dot(&across) / across.norm_squared();
    [p + d * s, q + e * t]
}

/// A corner or a place of an edge of each solid, closest to each other of these two features.
struct Pair {
    points: [V; 2],
    features: [u32; 2],
    /// The edges of which they are, or end.
    along: [Option<V>; 2],
}

impl Pair {
    fn distance(&self) -> f64 {
        (self.points[1] - self.points[0]).norm()
    }

    /// The unit direction along which the solids are farthest apart: that of the way from one to the other, or
    /// what of it is across an edge, which rounding of a short way does not show; and how far they are.
    fn direction(&self, both: [Seen<'_>; 2]) -> Option<(V, f64)> {
        let way = (self.points[1] - self.points[0]).try_normalize(0.0)?;
        let across = |e: &V| (way - e * (e.dot(&way) / e.norm_squared())).try_normalize(LENGTHWISE);
        let of_both = match self.along {
            [Some(e), Some(f)] => across_both(&e, &f).map(|n| n * n.dot(&way).signum()),
            _ => None,
        };
        let across = self.along.iter().flatten().filter_map(across);
        let sizes = both[0].solid.size + both[1].solid.size;
        // Beside the closest, what separates farther may look elsewhere.
        let along = |n: &V| {
            let off = self.points[1] - self.points[0];
            (off - n * off.dot(n)).norm() <= ACROSS * sizes
        };
        let all = [way].into_iter().chain(across).chain(of_both).filter(along);
        all.map(|n| (n, separation(both, &n))).max_by(|x, y| x.1.total_cmp(&y.1))
    }
}

/// Appends the closest of corners and edges, of solids that are apart, beside what has been found
/// farther apart.
pub(crate) fn by_corners(
    both: [Seen<'_>; 2],
    back: &Pose,
    slack: f64,
    [least, margin]: [f64; 2],
    found: &mut Vec<Facing<V>>,
) {
    let mut closest = f64::INFINITY;
    for_each_corner_and_edge(both, |pair| closest = closest.min(pair.distance()));
    if closest >= least {
        return;
    }
    let first = found.len();
    for_each_corner_and_edge(both, |pair| {
        let gap = pair.distance();
        // Two corners are met along each of their edges.
        let known = |f: &Facing<V>| f.features == pair.features;
        if gap <= (closest + slack).min(margin)
            && !found[first..].iter().any(known)
            && let Some((normal, _)) = pair.direction(both)
        {
            let [x1, x2] = pair.points;
            let points = [x1, from_vector(back * vector(&x2))];
            found.push(Facing { parts: [0, 0], features: pair.features, points, normal, gap });
        }
    });
}

/// The closest corners and edges of two solids, the unit direction between them along which these are farthest
/// apart, and how far; none where they meet. Of those that are as close the one whose direction parts them most.
pub(crate) fn closest(both: [Seen<'_>; 2]) -> Option<([V; 2], V, f64)> {
    let mut least = f64::INFINITY;
    for_each_corner_and_edge(both, |pair| least = least.min(pair.distance()));
    let slack = ROUNDING * (both[0].solid.size + both[1].solid.size);
    let mut best: Option<([V; 2], V, f64)> = None;
    for_each_corner_and_edge(both, |pair| {
        if pair.distance() <= least + slack
            && let Some((normal, separation)) = pair.direction(both)
            && best.is_none_or(|(_, _, best)| separation > best)
        {
            best = Some((pair.points, normal, separation));
        }
    });
    best
}

/// Each corner of one solid with the closest point of each edge of the other, and each two edges
/// that are closest between their ends.
fn for_each_corner_and_edge([a, b]: [Seen<'_>; 2], mut visit: impl FnMut(Pair)) {
    let name = |edge: &Edge, t: f64| {
        let [from, to] = edge.corners;
        match t {
            0.0 => PackedFeatureId::vertex(from as u32).0,
            1.0 => PackedFeatureId::vertex(to as u32).0,
            _ => edge_name(edge.corners),
        }
    };
    let along = |seen: &Seen<'_>, edge: &Edge| {
        let [from, to] = edge.corners.map(|c| seen.corners[c]);
        to - from
    };
    let nearest = |seen: &Seen<'_>, edge: &Edge, x: &V| {
        let (from, way) = (seen.corners[edge.corners[0]], along(seen, edge));
        let t = ((x - from).dot(&way) / way.norm_squared()).clamp(0.0, 1.0);
        (from + way * t, name(edge, t))
    };
    for (k, &x2) in b.corners.iter().enumerate() {
        for edge in &a.solid.edges {
            let (x1, feature) = nearest(&a, edge, &x2);
            let features = [feature, PackedFeatureId::vertex(k as u32).0];
            visit(Pair { points: [x1, x2], features, along: [Some(along(&a, edge)), None] });
        }
    }
    for (k, &x1) in a.corners.iter().enumerate() {
        for edge in &b.solid.edges {
            let (x2, feature) = nearest(&b, edge, &x1);
            let features = [PackedFeatureId::vertex(k as u32).0, feature];
            visit(Pair { points: [x1, x2], features, along: [None, Some(along(&b, edge))] });
        }
    }
    for one in &a.solid.edges {
        for other in &b.solid.edges {
            let points = between([a.corners, b.corners], [*one, *other]);
            let within = |x: &V, from: &V, way: &V| {
                let t = (x - from).dot(way) / way.norm_squared();
                t > 0.0 && t < 1.0
            };
            let ways = [along(&a, one), along(&b, other)];
            let starts = [a.corners[one.corners[0]], b.corners[other.corners[0]]];
            if (0..2).all(|k| within(&points[k], &starts[k], &ways[k])) {
                let features = [name(one, 0.5), name(other, 0.5)];
                visit(Pair { points, features, along: ways.map(Some) });
            }
        }
    }
}
