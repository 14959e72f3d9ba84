//! The narrow phase in the plane: where two shapes face each other, and how far apart they are.
//!
//! ```text
//! s = max over the edges' normals n of both (min n.x2 - max n.x1)       convex polygons
//! ```
//! Convex polygons that overlap leave each other on the shortest way along that normal, and where
//! the corner that reaches farthest lies in front of the edge, `s` is their distance too. Else two
//! corners are closest. The edge and the one that faces it are clipped against each other, and so
//! matching edges keep both ends, whatever rounding does. Pieces of other polygons are looked at
//! pair by pair. A capsule is its segment and a radius, a disc its centre and a radius: gaps are those of
//! the segment or the point (`outline_point.rs`), less the radius. Before a half-plane every corner that is
//! near has a contact.

use nalgebra::Vector2;
use parry2d_f64::math::{Pose, Vector};
use parry2d_f64::query::details::clip_segment_segment_with_normal;
use parry2d_f64::shape::PackedFeatureId;

use crate::PlanarShape;
use crate::detect::outline_point::{Feature, Nearest, nearest};
use crate::shapes::dimension::{Answer, Facing};
use crate::shapes::outline::Outline;
use crate::shapes::planar_convert::{from_vector, vector};

type Found = Vec<Facing<Vector2<f64>>>;

/// Appends where two shapes face each other.
pub(crate) fn facing(
    shapes: [&PlanarShape; 2],
    relative: &Pose,
    margin: f64,
    found: &mut Found,
) -> Answer {
    let [a, b] = shapes.map(PlanarShape::cores);
    let back = relative.inverse();
    let rounding = shapes.map(PlanarShape::rounding);
    let round = rounding[0] + rounding[1];
    if let Some(side) = (0..2).find(|&k| shapes[k].plane().is_some())
        && !shapes[1 - side].cores().is_empty()
    {
        facing_plane(shapes, side, relative, margin, found);
        return Answer::Now;
    }
    if a.is_empty() || b.is_empty() {
        return Answer::None;
    }
    let first_found = found.len();
    for (i, first) in a.iter().enumerate() {
        for (j, second) in b.iter().enumerate() {
            let pair = Pair { first, second, there: *relative, back, parts: [i as u32, j as u32] };
            pair.append(margin + round, found);
        }
    }
    round_off(&mut found[first_found..], rounding, &back);
    Answer::Now
}

/// Finds where two convex parts with corners or round ends face each other, however far apart; says whether
/// they are such parts.
pub(crate) fn facing_parts(
    shapes: [&PlanarShape; 2],
    parts: [u32; 2],
    relative: &Pose,
    found: &mut Found,
) -> bool {
    found.clear();
    let [first, second] = [0, 1].map(|k| shapes[k].cores().get(parts[k] as usize));
    let (Some(first), Some(second)) = (first, second) else { return false };
    let back = relative.inverse();
    Pair { first, second, there: *relative, back, parts }.append(f64::INFINITY, found);
    round_off(found, shapes.map(PlanarShape::rounding), &back);
    true
}

/// Takes the radii of round ends from gaps between outlines.
fn round_off(found: &mut [Facing<Vector2<f64>>], radii: [f64; 2], back: &Pose) {
    let round = radii[0] + radii[1];
    if round == 0.0 {
        return;
    }
    for facing in found {
        facing.gap -= round;
        facing.points[0] += facing.normal * radii[0];
        let own = from_vector(back.rotation * vector(&facing.normal));
        facing.points[1] -= own * radii[1];
    }
}

/// Appends where a half-plane, the shape `side`, and what has corners or round ends face each other: every corner
/// that is near.
fn facing_plane(
    shapes: [&PlanarShape; 2],
    side: usize,
    relative: &Pose,
    margin: f64,
    found: &mut Found,
) {
    let Some(normal) = shapes[side].plane() else { return };
    let (n, solid) = (vector(&normal), shapes[1 - side]);
    let place = if side == 0 { *relative } else { relative.inverse() };
    let (own, radius) = (place.rotation.inverse() * n, solid.rounding());
    for (part, core) in solid.cores().iter().enumerate() {
        for (k, &point) in core.points().iter().enumerate() {
            let there = place * point;
            let height = there.dot(n);
            let gap = height - radius;
            if gap > margin {
                continue;
            }
            let points = [there - n * height, point - own * radius].map(from_vector);
            let facing =
                Facing { parts: [0, part as u32], features: [0, corner(k)], points, normal, gap };
            found.push(match side {
                0 => facing,
                _ => Facing {
                    parts: [part as u32, 0],
                    features: [corner(k), 0],
                    points: [points[1], points[0]],
                    normal: from_vector(-own),
                    gap,
                },
            });
        }
    }
}

/// Two convex polygons, everything seen from the first.
struct Pair<'a> {
    first: &'a Outline,
    second: &'a Outline,
    there: Pose,
    back: Pose,
    parts: [u32; 2],
}

/// Swaps the sides of what two outlines face each other with, the second of which sees the first at a place.
fn turn_round(facing: &mut Facing<Vector2<f64>>, place: &Pose) {
    facing.parts.swap(0, 1);
    facing.features.swap(0, 1);
    facing.points.swap(0, 1);
    facing.normal = from_vector(place.rotation * -vector(&facing.normal));
}

/// The distance of the farthest corner from the origin.
fn size(outline: &Outline) -> f64 {
    outline.points().iter().map(|p| p.length_squared()).fold(0.0, f64::max).sqrt()
}

/// A normal along which polygons are apart.
#[derive(Clone, Copy)]
struct Axis {
    separation: f64,
    /// The edge that it is the normal of.
    edge: usize,
}

/// The second polygon's axis is taken only where it is better by this part of its size, so that
/// edges that match are not taken now from one side and now from the other.
const BETTER: f64 = 1e-12;
/// Lengths that are rounding, relative to the sizes of the polygons and the distance between them.
const ROUNDING: f64 = 1e-13;

impl Pair<'_> {
    fn append(&self, margin: f64, found: &mut Found) {
        if let [_] = self.second.points() {
            return self.append_before_point(margin, found);
        }
        if let [_] = self.first.points() {
            let seen = Pair {
                first: self.second,
                second: self.first,
                there: self.back,
                back: self.there,
                parts: [self.parts[1], self.parts[0]],
            };
            let start = found.len();
            seen.append_before_point(margin, found);
            return found[start..].iter_mut().for_each(|facing| turn_round(facing, &self.there));
        }
        let Some(own) = best_axis(self.first, self.second, &self.there, margin) else { return };
        let Some(other) = best_axis(self.second, self.first, &self.back, margin) else { return };
        let sizes = [size(self.first), size(self.second)];
        let rounding = ROUNDING * (sizes[0] + sizes[1] + self.there.translation.length());
        let first = found.len();
        let of_second = other.separation > own.separation + BETTER * sizes[0].min(sizes[1]);
        let (axis, normal) = match of_second {
            true => (other, self.there.rotation * -self.second.normals()[other.edge]),
            false => (own, self.first.normals()[own.edge]),
        };
        if of_second {
            let facing = edge_along(self.first, normal);
            self.clip(facing, axis.edge, normal, margin, found);
        } else {
            let facing = edge_along(self.second, self.back.rotation * -normal);
            self.clip(axis.edge, facing, normal, margin, found);
        }
        let deepest = found[first..].iter().map(|f| f.gap).fold(f64::INFINITY, f64::min);
        if deepest <= axis.separation + rounding.max(BETTER * sizes[0].min(sizes[1])) {
            return;
        }
        let Corners { distance, numbers } = self.closest_corners();
        // Segments on one line are apart along it, which the normal of neither says.
        let segments = [self.first, self.second].iter().all(|outline| outline.points().len() == 2);
        let least = if segments { -rounding } else { 0.0 };
        if axis.separation > least && distance > rounding {
            // What was found is between points of both, and so no closer than they are.
            if distance < deepest.min(margin) {
                self.append_corners(distance, numbers, found);
            }
        } else {
            // Corner meets corner, and the way from one to the other is rounding.
            self.append_corner(axis, normal, of_second, found);
        }
    }

    /// Appends where the first outline faces the second, a point.
    fn append_before_point(&self, margin: f64, found: &mut Found) {
        let at = self.there.translation;
        let rounding = ROUNDING * (size(self.first) + at.length());
        let Nearest { place, normal, distance, on } = nearest(self.first, at, rounding);
        if distance > margin {
            return;
        }
        let feature = match on {
            Feature::Side(side) => face(side),
            Feature::Corner(k) => corner(k),
        };
        let (features, points) = ([feature, corner(0)], [place, Vector::ZERO].map(from_vector));
        let normal = from_vector(normal);
        found.push(Facing { parts: self.parts, features, points, normal, gap: distance });
    }

    /// Clips an edge of each against the other along a normal.
    fn clip(&self, edge: usize, facing: usize, normal: Vector, margin: f64, found: &mut Found) {
        let own = ends(self.first, edge);
        let other = ends(self.second, facing).map(|p| self.there * p);
        let both = clip_segment_segment_with_normal((own[0], own[1]), (other[0], other[1]), normal);
        let Some((start, end)) = both else { return };
        for (p1, p2, feature1, feature2) in [start, end] {
            let gap = (p2 - p1).dot(normal);
            if gap <= margin {
                let features =
                    [name(self.first, edge, feature1), name(self.second, facing, feature2)];
                let points = [from_vector(p1), from_vector(self.back * p2)];
                let normal = from_vector(normal);
                found.push(Facing { parts: self.parts, features, points, normal, gap });
            }
        }
    }

    /// The corners of both that are closest.
    fn closest_corners(&self) -> Corners {
        let mut closest = Corners { distance: f64::INFINITY, numbers: [0, 0] };
        for (j, p2) in self.second.points().iter().enumerate() {
            let p2 = self.there * *p2;
            for (i, p1) in self.first.points().iter().enumerate() {
                let distance = (p2 - *p1).length();
                if distance < closest.distance {
                    closest = Corners { distance, numbers: [i, j] };
                }
            }
        }
        closest
    }

    /// Two corners are closest: appends them.
    fn append_corners(&self, gap: f64, [i, j]: [usize; 2], found: &mut Found) {
        let (own, other) = (self.first.points()[i], self.second.points()[j]);
        found.push(Facing {
            parts: self.parts,
            features: [corner(i), corner(j)],
            points: [own, other].map(from_vector),
            normal: from_vector((self.there * other - own) / gap),
            gap,
        });
    }

    /// Appends the corner of one polygon that reaches farthest towards the edge of the other.
    fn append_corner(&self, axis: Axis, normal: Vector, of_second: bool, found: &mut Found) {
        let gap = axis.separation;
        let (points, features) = match of_second {
            true => {
                let at = farthest(self.first, normal);
                let own = self.first.points()[at];
                ([own, self.back * (own + normal * gap)], [corner(at), face(axis.edge)])
            }
            false => {
                let at = farthest(self.second, self.back.rotation * -normal);
                let other = self.second.points()[at];
                ([self.there * other - normal * gap, other], [face(axis.edge), corner(at)])
            }
        };
        let (points, normal) = (points.map(from_vector), from_vector(normal));
        found.push(Facing { parts: self.parts, features, points, normal, gap });
    }
}

/// Two corners, one of each polygon.
struct Corners {
    distance: f64,
    numbers: [usize; 2],
}

/// The normal of an edge of a polygon along which another is farthest from it; none where that is
/// more than `margin`.
fn best_axis(polygon: &Outline, other: &Outline, there: &Pose, margin: f64) -> Option<Axis> {
    let mut best = Axis { separation: f64::NEG_INFINITY, edge: 0 };
    for (edge, normal) in polygon.normals().iter().enumerate() {
        let own = there.rotation.inverse() * *normal;
        let nearest = other.points().iter().map(|p| own.dot(*p)).fold(f64::INFINITY, f64::min);
        let offset = (there.translation - polygon.points()[edge]).dot(*normal);
        let separation = nearest + offset;
        if separation > margin {
            return None;
        }
        if separation > best.separation {
            best = Axis { separation, edge };
        }
    }
    Some(best)
}

/// The edge whose normal is most along a direction.
fn edge_along(polygon: &Outline, direction: Vector) -> usize {
    let mut best = (f64::NEG_INFINITY, 0);
    for (edge, normal) in polygon.normals().iter().enumerate() {
        let along = normal.dot(direction);
        if along > best.0 {
            best = (along, edge);
        }
    }
    best.1
}

/// The corner that reaches farthest along a direction.
fn farthest(polygon: &Outline, direction: Vector) -> usize {
    let mut best = (f64::NEG_INFINITY, 0);
    for (corner, point) in polygon.points().iter().enumerate() {
        let along = point.dot(direction);
        if along > best.0 {
            best = (along, corner);
        }
    }
    best.1
}

fn ends(polygon: &Outline, edge: usize) -> [Vector; 2] {
    let points = polygon.points();
    [points[edge], points[(edge + 1) % points.len()]]
}

fn corner(corner: usize) -> u32 {
    PackedFeatureId::vertex(corner as u32).0
}

fn face(edge: usize) -> u32 {
    PackedFeatureId::face(edge as u32).0
}

/// The name of an end of an edge (0 and 2), or of the edge itself (1).
fn name(polygon: &Outline, edge: usize, end: usize) -> u32 {
    match end {
        1 => face(edge),
        end => corner((edge + end / 2) % polygon.points().len()),
    }
}
