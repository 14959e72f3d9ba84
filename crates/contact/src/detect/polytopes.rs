//! Two convex solids with flat faces: where they face each other.
//!
//! ```text
//! s(n) = min n.x2 - max n.x1          n = +n1, -n2, e1 x e2/|e1 x e2|
//! ```
//! `n1 n2` the normals of both solids' faces, `e1 e2` their edges. Overlapping solids leave each
//! other on the shortest way along the `n` of the largest `s`; of solids apart it is the distance,
//! unless a corner is closest to a corner or to an edge, and then those are looked at one by one (`polytope_corners.rs`).
//!
//! The face that looks along `n` bounds the polygon of the other solid's face that looks back.
//! All lengths are compared with the sizes of the pair.

use nalgebra::Vector3;
use parry3d_f64::math::Pose;
use parry3d_f64::shape::PackedFeatureId;

use crate::detect::facing_points::nearest;
use crate::detect::polytope_axes::{Seen, Source, farthest};
use crate::detect::polytope_corners::{between, by_corners, closest, edge_name, pair_name};
use crate::shapes::convert::{from_vector, vector};
use crate::shapes::dimension::Facing;
use crate::shapes::polytope::{Edge, Polytope};
use crate::shapes::solid::Part;

type V = Vector3<f64>;
type Found = Vec<Facing<V>>;

/// Room for the second solid as the first sees it, and for polygons.
#[derive(Default)]
pub(crate) struct Room {
    corners: Vec<V>,
    normals: Vec<V>,
    polygon: Vec<Corner>,
    cut: Vec<Corner>,
}

/// A corner of a polygon that is being cut.
#[derive(Clone, Copy)]
struct Corner {
    place: V,
    /// Its name on the solid whose face bounds, and on the other.
    names: [u32; 2],
    /// The side that leaves it: of the bounded polygon, or of the bounding one.
    side: Side,
}

#[derive(Clone, Copy)]
enum Side {
    Own(u32),
    Bound(u32),
}

/// Later directions must be better by this part of the sizes, so that rounding does not choose.
const TIE: f64 = 1e-13;
/// Points outside of a face by this part of the sizes are on its border: no more than gaps may be off by.
const BORDER: f64 = 1e-12;
/// What is outside of a side by less than this part of the border is on the side: rounding.
pub(crate) const ON_SIDE: f64 = 1e-3;
/// Corners and edges are as close as the closest within this part of the sizes.
const AS_CLOSE: f64 = 1e-9;
/// Points off an edge by less than this part of the sizes are on it.
const ON_EDGE: f64 = 4e-12;
/// Distances below this part of the sizes are rounding, and have no direction.
const WIDE: f64 = 1e-13;
/// Points this part of the sizes farther apart than they need be are not the closest.
const SHORT: f64 = 1e-13;
/// Faces that look along an axis of edges, by cosine, and are bounded by each other.
const ALONG: f64 = 0.9;

/// Appends where a convex solid and a half-space face each other: every corner that is near.
pub(crate) fn facing_plane(
    solid: &Polytope,
    place: &Pose,
    normal: &V,
    margin: f64,
    mut append: impl FnMut(u32, V, V, f64),
) {
    for (k, corner) in solid.corners.iter().enumerate() {
        let there = from_vector(place * vector(corner));
        let gap = there.dot(normal);
        if gap <= margin {
            append(PackedFeatureId::vertex(k as u32).0, *corner, there - normal * gap, gap);
        }
    }
}

/// Appends where two convex solids face each other.
pub(crate) fn facing(
    solids: [&Polytope; 2],
    relative: &Pose,
    margin: f64,
    room: &mut Room,
    found: &mut Found,
) {
    let [first, second] = solids;
    let Room { corners, normals, polygon, cut } = room;
    corners.clear();
    corners.extend(second.corners.iter().map(|c| from_vector(relative * vector(c))));
    normals.clear();
    normals.extend(second.faces.iter().map(|f| from_vector(relative.rotation * vector(&f.normal))));
    let back = relative.inverse();
    let own: &[V] = &first.corners;
    // The first's normals are gathered behind the second's: one list holds both.
    let split = normals.len();
    normals.extend(first.faces.iter().map(|face| face.normal));
    let (second_normals, first_normals) = normals.split_at(split);
    let a = Seen { solid: first, corners: own, normals: first_normals };
    let b = Seen { solid: second, corners, normals: second_normals };
    let size = first.size.min(second.size);
    let Some(axis) = farthest(a, b, TIE * first.size.max(second.size), margin) else { return };
    let n = axis.normal;
    let start = found.len();
    let mut append = |names: [u32; 2], x1: V, x2: V, n: V, gap: f64| {
        if gap <= margin {
            let points = [x1, from_vector(back * vector(&x2))];
            found.push(Facing { parts: [0, 0], features: names, points, normal: n, gap });
        }
    };
    let mut least = f64::INFINITY;
    match axis.from {
        Source::First(face) => {
            let other = b.facing(&-n, TIE * size);
            bound([a, b], [face, other], &n, BORDER * size, polygon, cut);
            for corner in polygon.iter() {
                let gap = (corner.place - a.corners[first.around(face)[0]]).dot(&n);
                least = least.min(gap);
                append(corner.names, corner.place - n * gap, corner.place, n, gap);
            }
        }
        Source::Second(face) => {
            let other = a.facing(&n, TIE * size);
            bound([b, a], [face, other], &n, BORDER * size, polygon, cut);
            for corner in polygon.iter() {
                let gap = (b.corners[second.around(face)[0]] - corner.place).dot(&n);
                least = least.min(gap);
                let [bounding, bounded] = corner.names;
                append([bounded, bounding], corner.place, corner.place + n * gap, n, gap);
            }
        }
        Source::Edges(one, other) => {
            let met = crossing([a, b], [one, other], &n, axis.separation);
            // Beside the ends of edges that are apart, the corners may be farther apart than the lines.
            let are_closest = |points: &[V; 2]| {
                let wide = axis.separation > WIDE * size;
                !wide || apart([a, b], [one, other], points) <= axis.separation + SHORT * size
            };
            if let Some([x1, x2]) = met.filter(are_closest) {
                least = axis.separation;
                let names = [one, other].map(|edge| edge_name(edge.corners));
                append(names, x1, x2, n, least);
            }
            // What lies along a face of the other may turn onto it within a step.
            let faces = [a.facing(&n, TIE * size), b.facing(&-n, TIE * size)];
            let tilts = [a.normals[faces[0]].dot(&n), -b.normals[faces[1]].dot(&n)];
            if tilts[0].max(tilts[1]) > ALONG {
                let side = usize::from(tilts[1] > tilts[0]);
                let (seen, to) = ([a, b], [n, -n][side]);
                let bounding = [seen[side], seen[1 - side]];
                let of_pair = [faces[side], faces[1 - side]];
                bound(bounding, of_pair, &to, BORDER * size, polygon, cut);
                let (normal, start) =
                    (bounding[0].normals[of_pair[0]], bounding[0].solid.around(of_pair[0])[0]);
                for corner in polygon.iter() {
                    let above = corner.place - bounding[0].corners[start];
                    let gap = above.dot(&normal) / tilts[side];
                    let mut names = corner.names;
                    let mut points = [corner.place - to * gap, corner.place];
                    names.swap(0, side);
                    points.swap(0, side);
                    append(names, points[0], points[1], n, gap);
                }
            }
        }
    }
    let of_face = !matches!(axis.from, Source::Edges(..));
    let missed = found.len() == start || of_face && least > axis.separation + SHORT * size;
    if axis.separation > WIDE * size && least > axis.separation + SHORT * size {
        by_corners([a, b], &back, AS_CLOSE * size, [least, margin], found);
    } else if missed && axis.separation <= margin {
        // Rounding left no polygon, or cut off what reaches farthest: of that, or of all, the points that are best
        // across the separation.
        let gap = axis.separation;
        let off = |[x1, x2]: &[V; 2]| (x2 - x1 - n * gap).norm();
        let met = |level: f64| {
            let ends = [(a, n), (b, -n)].map(|(seen, n): (Seen<'_>, V)| -> Vec<Part> {
                let reach = seen.reach(&n) - level;
                let far = seen.corners.iter().filter(|corner| corner.dot(&n) >= reach);
                far.copied().map(Part::Point).collect()
            });
            nearest([&ends[0], &ends[1]], &n, &(n * gap), first.size + second.size)
        };
        let all = [met(AS_CLOSE * size), met(f64::INFINITY)].into_iter();
        let all = all.chain(closest([a, b]).map(|(points, ..)| points));
        let best = all.min_by(|x, y| off(x).total_cmp(&off(y)));
        let Some([x1, x2]) = best else { return };
        let features = [PackedFeatureId::face(0).0; 2];
        let points = [x1, from_vector(back * vector(&x2))];
        found.push(Facing { parts: [0, 0], features, points, normal: n, gap });
    }
}

/// Where two edges cross as seen along a direction between them, across the separation; none beside either.
pub(crate) fn crossing(
    [a, b]: [Seen<'_>; 2],
    [one, other]: [Edge; 2],
    n: &V,
    separation: f64,
) -> Option<[V; 2]> {
    let border = BORDER * a.solid.size.min(b.solid.size);
    let [x1, x2] = between([a.corners, b.corners], [one, other]);
    let ends = ends_of([a, b], [one, other]);
    // Along nearly parallel edges the place is rounding, across them it is not.
    let x1 = if on_edge(&x2, ends[1], border) { x2 - n * separation } else { x1 };
    let x2 = x1 + n * separation;
    let slack = ON_EDGE * (a.solid.size + b.solid.size);
    (on_edge(&x1, ends[0], slack) && on_edge(&x2, ends[1], slack)).then_some([x1, x2])
}

fn ends_of([a, b]: [Seen<'_>; 2], [one, other]: [Edge; 2]) -> [[V; 2]; 2] {
    [one.corners.map(|c| a.corners[c]), other.corners.map(|c| b.corners[c])]
}

/// How far apart the places of two edges are that are closest to these points.
fn apart(seen: [Seen<'_>; 2], edges: [Edge; 2], [x1, x2]: &[V; 2]) -> f64 {
    let [first, second] = ends_of(seen, edges);
    (nearest_on_edge(x2, second) - nearest_on_edge(x1, first)).norm()
}

/// Whether a point is on an edge, or off it by no more than a distance.
fn on_edge(x: &V, ends: [V; 2], slack: f64) -> bool {
    (x - nearest_on_edge(x, ends)).norm() <= slack
}

fn nearest_on_edge(x: &V, [from, to]: [V; 2]) -> V {
    let along = to - from;
    let t = ((x - from).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
    from + along * t
}

/// Puts each point on the first side of a polygon that it is outside of by no more than a border. What is beside two
/// sides may be far beyond the corner between them: the other one cuts it.
pub(crate) fn put_on_border<'a, N>(
    points: impl Iterator<Item = &'a mut V>,
    sides: impl Iterator<Item = (N, V, V)> + Clone,
    border: f64,
) {
    for point in points {
        let mut outside =
            sides.clone().map(|(_, start, outward)| ((*point - start).dot(&outward), outward));
        if let Some((d, outward)) = outside.find(|(d, _)| *d > 0.0 && *d <= border) {
            *point -= outward * d;
        }
    }
}

/// Cuts the second's face to what lies, seen along `n`, within the first's.
fn bound(
    [one, other]: [Seen<'_>; 2],
    [bounding, bounded]: [usize; 2],
    n: &V,
    border: f64,
    polygon: &mut Vec<Corner>,
    cut: &mut Vec<Corner>,
) {
    let face = PackedFeatureId::face(bounding as u32).0;
    let back = PackedFeatureId::face(bounded as u32).0;
    polygon.clear();
    polygon.extend(other.solid.around(bounded).iter().map(|&c| Corner {
        place: other.corners[c],
        names: [face, PackedFeatureId::vertex(c as u32).0],
        side: Side::Own(c as u32),
    }));
    let around = one.solid.around(bounding);
    let turned = one.normals[bounding].dot(n).signum();
    let sides = (0..around.len()).filter_map(|k| {
        let [start, end] = [k, (k + 1) % around.len()].map(|k| one.corners[around[k]]);
        let outward = ((end - start).cross(n) * turned).try_normalize(0.0)?;
        Some((around[k], start, outward))
    });
    put_on_border(polygon.iter_mut().map(|corner| &mut corner.place), sides.clone(), border);
    // Again for what crossed a side after it had been beside another.
    for (from, start, outward) in sides.clone().chain(sides) {
        let outside = |c: &Corner| (c.place - start).dot(&outward);
        let near = |d: f64| d <= ON_SIDE * border;
        cut.clear();
        for (i, here) in polygon.iter().enumerate() {
            let next = &polygon[(i + 1) % polygon.len()];
            let (d, e) = (outside(here), outside(next));
            let (inside, stays) = (near(d), near(e));
            if inside {
                cut.push(*here);
            }
            if inside != stays {
                let place = here.place + (next.place - here.place) * (d / (d - e)).clamp(0.0, 1.0);
                let names = match here.side {
                    Side::Own(side) => {
                        [PackedFeatureId::edge(from as u32).0, PackedFeatureId::edge(side).0]
                    }
                    Side::Bound(before) => {
                        [PackedFeatureId::vertex(pair_name([before as usize, from])).0, back]
                    }
                };
                let side = if inside { Side::Bound(from as u32) } else { here.side };
                cut.push(Corner { place, names, side });
            }
        }
        std::mem::swap(polygon, cut);
    }
}
