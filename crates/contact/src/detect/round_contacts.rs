//! Contact points of two convex solids of which one is round.
//!
//! ```text
//! gap at u = (z2(u) - z1(u)) n - r1 - r2          u across n, where what is flat on both overlaps
//! ```
//! Along the normal of [`separate`](super::separation::separate) each solid shows a polygon (a face,
//! the disc of a circle), a segment (a side of a cylinder or cone, the axis of a capsule, an edge) or
//! a point. Seen along the normal, polygons are cut to what they share, and so is a segment in front
//! of a polygon; the ends of segments that are nearly parallel are asked for one by one, each with a
//! normal of its own. Where none of these is as close as the solids, the closest points are a contact
//! of their own. A disc is eight of its circle's points and the one that reaches farthest, and so a
//! cylinder stands as on its circle.

use nalgebra::Vector3;
use parry3d_f64::math::Pose;

use crate::detect::facing_points::facing_points;
use crate::detect::polytopes::{ON_SIDE, put_on_border};
use crate::detect::separation::{MET, Separation, separate, separate_point};
use crate::detect::straight::Straight;
use crate::shapes::convert::{from_vector, vector};
use crate::shapes::dimension::Facing;
use crate::shapes::polytope::Polytope;
use crate::shapes::solid::{Form, Part, Placed, Solid, across, around};

type V = Vector3<f64>;
type Found = Vec<Facing<V>>;

/// Points of a circle that stand for its disc.
const AROUND: u32 = 8;
/// What looks along the normal by this cosine may lie on something.
const ALONG: f64 = 0.9;
/// Segments at a smaller sine to each other lie along each other.
const PARALLEL: f64 = 1e-2;
/// Gaps within this part of the size of the least are the least.
const LEAST: f64 = 1e-13;
/// Points outside of a polygon by this part of the size are on its border.
const BORDER: f64 = 1e-12;
/// Discs whose normal is this close to the contact's, in radians, lie on what they touch.
const FLAT_SINE: f64 = 1e-7;
/// The name of the closest points of solids that lie nowhere on each other.
const CLOSEST: u32 = u32::MAX;

/// A convex solid, and its faces where it has flat ones alone.
#[derive(Clone, Copy)]
pub(crate) struct Body<'a> {
    pub(crate) solid: &'a Solid,
    pub(crate) polytope: Option<&'a Polytope>,
}

/// Room for placed solids and polygons.
#[derive(Default)]
pub(crate) struct Room {
    placed: [Placed; 2],
    shown: [Shown; 2],
    cut: Vec<Corner>,
    straight: Straight,
}

/// A corner of what a solid shows, and its name.
#[derive(Clone, Copy, Debug)]
struct Corner {
    place: V,
    names: [u32; 2],
}

/// What a solid shows along a direction: a point, a segment or a polygon.
#[derive(Default)]
struct Shown {
    corners: Vec<Corner>,
    /// The normal of a polygon.
    normal: V,
    /// The centre and radius of the disc that it stands for.
    disc: Option<(V, f64)>,
}

impl Shown {
    /// Its point that is closest, seen along a direction, to another one.
    fn closest(&self, to: &V, n: &V) -> Option<V> {
        let seen = |v: V| v - n * v.dot(n);
        if let Some((centre, radius)) = self.disc {
            let way = seen(to - centre);
            let length = way.norm();
            return Some(centre + if length > radius { way * (radius / length) } else { way });
        }
        let count = self.corners.len();
        let side = |k: usize| {
            let [from, end] = [k, (k + 1) % count].map(|k| self.corners[k].place);
            let along = seen(end - from);
            let square = along.norm_squared();
            let t = if square > 0.0 { seen(to - from).dot(&along) / square } else { 0.0 };
            from + (end - from) * t.clamp(0.0, 1.0)
        };
        let far = |v: &V| seen(v - to).norm();
        (0..count).map(side).min_by(|v, w| far(v).total_cmp(&far(w)))
    }
}

/// Appends where two convex solids face each other.
pub(crate) fn facing(
    bodies: [Body<'_>; 2],
    relative: &Pose,
    margin: f64,
    room: &mut Room,
    found: &mut Found,
) {
    let Room { placed, shown, cut, straight } = room;
    let [first, second] = placed;
    bodies[0].solid.place(&Pose::IDENTITY, first);
    bodies[1].solid.place(relative, second);
    let there = match straight.direction(bodies, [first, second]) {
        Some(there) if there.gap > margin => return,
        Some(there) => there,
        None => match separate([first, second], margin) {
            Some(there) => there,
            None => return,
        },
    };
    let n = there.normal;
    let size = first.size.min(second.size);
    let scale = first.size + second.size + (second.centre - first.centre).norm();
    let back = relative.inverse();
    let start = found.len();
    let mut append = |names: [u32; 2], points: [V; 2], n: V, gap: f64| {
        if gap <= margin {
            let points = [points[0], from_vector(back * vector(&points[1]))];
            found.push(Facing { parts: [0, 0], features: names, points, normal: n, gap });
        }
    };
    let [one, other] = shown;
    show(bodies[0], first, &Pose::IDENTITY, &n, one);
    show(bodies[1], second, relative, &-n, other);
    let radii = [first.rounding, second.rounding];
    let mut pair = |x1: V, x2: V, names: [u32; 2]| {
        let gap = (x2 - x1).dot(&n) - radii[0] - radii[1];
        append(names, [x1 + n * radii[0], x2 - n * radii[1]], n, gap);
    };
    match (one.corners.len(), other.corners.len()) {
        (3.., 2..) => {
            let tilt = one.normal.dot(&n);
            clip(one, &other.corners, &n, BORDER * size, cut);
            for corner in cut.iter() {
                let up = (corner.place - one.corners[0].place).dot(&one.normal) / tilt;
                let names = [corner.names[1], corner.names[0]];
                pair(corner.place - n * up, corner.place, names);
            }
        }
        (2.., 3..) => {
            let tilt = -other.normal.dot(&n);
            clip(other, &one.corners, &n, BORDER * size, cut);
            for corner in cut.iter() {
                let up = (corner.place - other.corners[0].place).dot(&other.normal) / tilt;
                pair(corner.place, corner.place + n * up, corner.names);
            }
        }
        (2, 2) => along_each_other([first, second], [one, other], &n, &mut append),
        _ => {}
    }
    let least = found[start..].iter().map(|facing| facing.gap).fold(f64::INFINITY, f64::min);
    if least > there.gap + LEAST * scale {
        let separation = there.gap + radii[0] + radii[1];
        // Two discs, or a disc and a polygon, share the point of one that is closest to the centre.
        let flat = |shown: &Shown| shown.disc.filter(|_| shown.normal.cross(&n).norm() < FLAT_SINE);
        let level = |at: &V, reach: f64| (at.dot(&n) - reach).abs() <= BORDER * scale;
        let ends = [first.farthest(&n).1, -second.farthest(&-n).1];
        let on_disc = |at: V, shown: &Shown, (centre, radius): (V, f64)| {
            let way = at - centre;
            let within = (way - n * way.dot(&n)).norm() <= radius;
            within && way.dot(&shown.normal).abs() <= MET * scale
        };
        let shared = match (flat(one), flat(other)) {
            _ if there.met.is_some() => None,
            (Some(disc), _) => other
                .closest(&disc.0, &n)
                .map(|at| [at - n * separation, at])
                .filter(|[on, at]| level(at, ends[1]) && on_disc(*on, one, disc)),
            (None, Some(disc)) => one
                .closest(&disc.0, &n)
                .map(|at| [at, at + n * separation])
                .filter(|[at, on]| level(at, ends[0]) && on_disc(*on, other, disc)),
            (None, None) => None,
        };
        let closest = match shared {
            Some(points) => (points, n, separation),
            None => {
                let facing = facing_points([first, second], &there);
                (facing.points, facing.normal, facing.separation)
            }
        };
        let ([x1, x2], normal, separation) = closest;
        let gap = separation - radii[0] - radii[1];
        let points =
            [x1 + normal * radii[0], from_vector(back * vector(&(x2 - normal * radii[1])))];
        let features = [CLOSEST, CLOSEST];
        found.push(Facing { parts: [0, 0], features, points, normal, gap });
    }
}

/// Says which points of a solid face a half-space through the origin, on the solid and above it by
/// which gap: the solid as the half-space sees it.
pub(crate) fn facing_plane(
    body: Body<'_>,
    place: &Pose,
    normal: &V,
    room: &mut Room,
    mut say: impl FnMut(u32, V, f64),
) {
    let Room { placed, shown, .. } = room;
    let ([placed, _], [shown, _]) = (placed, shown);
    body.solid.place(place, placed);
    show(body, placed, place, &-normal, shown);
    let back = place.inverse();
    for corner in &shown.corners {
        let on = corner.place - normal * placed.rounding;
        say(corner.names[0], from_vector(back * vector(&on)), on.dot(normal));
    }
}

/// What a solid shows along a direction.
fn show(body: Body<'_>, placed: &Placed, pose: &Pose, n: &V, shown: &mut Shown) {
    shown.corners.clear();
    shown.disc = None;
    let corners = &mut shown.corners;
    let mut add = |place: V, name: u32| corners.push(Corner { place, names: [name, 0] });
    let farthest = |k: usize| placed.parts[k].point(n);
    match (&body.solid.form, placed.axis) {
        (Form::Smooth, _) | (_, None) if body.polytope.is_none() => add(farthest(0), 0),
        (Form::Segment, Some(axis)) => {
            // The ends of a capsule are told apart wherever it looks.
            if axis.dot(n).abs() < 1.0 - ALONG * ALONG {
                add(farthest(0), 0);
                add(farthest(1), 1);
            } else {
                let end = placed.farthest(n).0;
                add(farthest(end), end as u32);
            }
        }
        (Form::Cylinder, Some(axis)) => {
            let up = axis.dot(n);
            let end = usize::from(up > 0.0);
            if up.abs() > ALONG {
                shown.normal = axis * up.signum();
                shown.disc = disc(&placed.parts[end], pose, n, end as u32, &mut add);
            } else if 1.0 - up * up > ALONG * ALONG {
                add(farthest(0), 100);
                add(farthest(1), 101);
            } else {
                add(farthest(end), 100 + end as u32);
            }
        }
        (Form::Cone, Some(axis)) => {
            let up = axis.dot(n);
            let [Part::Circle { centre, radius, .. }, Part::Point(apex)] = placed.parts[..] else {
                return;
            };
            // The normal of the side below a direction: its sine and cosine to the base.
            let height = (apex - centre).norm();
            let side = up * radius + (1.0 - up * up).max(0.0).sqrt() * height;
            if -up > ALONG {
                shown.normal = -axis;
                shown.disc = disc(&placed.parts[0], pose, n, 0, &mut add);
            } else if side > ALONG * radius.hypot(height) {
                add(farthest(0), 100);
                add(apex, 101);
            } else {
                let end = placed.farthest(n).0;
                add(farthest(end), 100 + end as u32);
            }
        }
        _ => {
            let Some(polytope) = body.polytope else { return };
            flat(polytope, placed, n, shown);
        }
    }
}

/// A face, an edge or a corner of a solid with flat faces.
fn flat(polytope: &Polytope, placed: &Placed, n: &V, shown: &mut Shown) {
    let point = |k: usize| match placed.parts[k] {
        Part::Point(p) => p,
        Part::Circle { centre, .. } | Part::Ellipsoid { centre, .. } => centre,
    };
    let (end, reach) = placed.farthest(n);
    let near = |k: &usize| placed.parts[*k].reach(n) >= reach - BORDER * placed.size;
    let looks = |f: &usize| placed.faces[*f].dot(n);
    let at_end = |f: &usize| polytope.around(*f).iter().any(near);
    let face = (0..placed.faces.len())
        .filter(|f| looks(f) > ALONG && at_end(f))
        .max_by(|f, g| looks(f).total_cmp(&looks(g)));
    if let Some(face) = face {
        shown.normal = placed.faces[face];
        let corner = |&k: &usize| Corner { place: point(k), names: [k as u32, 0] };
        shown.corners.extend(polytope.around(face).iter().map(corner));
        return;
    }
    let slope = |[from, to]: [usize; 2]| {
        let along = point(to) - point(from);
        along.dot(n).abs() / along.norm()
    };
    let edge = polytope
        .edges
        .iter()
        .map(|edge| edge.corners)
        .filter(|corners| corners.iter().any(near) && slope(*corners) < 1.0 - ALONG * ALONG)
        .min_by(|a, b| slope(*a).total_cmp(&slope(*b)));
    let ends = edge.map_or(vec![end], Vec::from);
    shown.corners.extend(ends.iter().map(|&k| Corner { place: point(k), names: [k as u32, 0] }));
}

/// The points of a circle that stand for its disc, and the one that reaches farthest, in their order
/// around the axis.
fn disc(
    circle: &Part,
    pose: &Pose,
    n: &V,
    end: u32,
    add: &mut impl FnMut(V, u32),
) -> Option<(V, f64)> {
    let &Part::Circle { centre, axis, radius } = circle else { return None };
    // Fixed on the body.
    let from = from_vector(pose.rotation * vector(&V::x()));
    let farthest = circle.point(n) - centre;
    let angle = axis.cross(&from).dot(&farthest).atan2(from.dot(&farthest));
    let step = std::f64::consts::TAU / f64::from(AROUND);
    let place = angle.rem_euclid(std::f64::consts::TAU) / step;
    // Where the circle lies across the direction none reaches farthest.
    let stands_out = farthest.norm() > 0.5 * radius
        && (place - place.round()).abs() > 1e-6
        && across(n, &axis).norm() > 1e-15;
    let name = |k: u32| 16 * (1 + end) + k;
    for (k, point) in around(&centre, &axis, &from, radius, AROUND).into_iter().enumerate() {
        add(point, name(k as u32));
        if stands_out && place.floor() as usize == k {
            add(centre + farthest, name(AROUND));
        }
    }
    Some((centre, radius))
}

/// Cuts corners to what lies, seen along `n`, within a polygon.
fn clip(bound: &Shown, corners: &[Corner], n: &V, border: f64, cut: &mut Vec<Corner>) {
    cut.clear();
    cut.extend_from_slice(corners);
    let mut next = Vec::with_capacity(corners.len() + bound.corners.len());
    let around = &bound.corners;
    let (middle, count) = (around.iter().map(|c| c.place).sum::<V>(), around.len());
    let middle = middle / count as f64;
    let sides = (0..count).filter_map(|k| {
        let [start, end] = [k, (k + 1) % count].map(|k| around[k].place);
        let outward = (end - start).cross(n).try_normalize(0.0)?;
        Some((around[k].names[0], start, outward * (start - middle).dot(&outward).signum()))
    });
    put_on_border(cut.iter_mut().map(|corner| &mut corner.place), sides.clone(), border);
    // Again for what crossed a side after it had been beside another.
    for (from, start, outward) in sides.clone().chain(sides) {
        let outside = |c: &Corner| (c.place - start).dot(&outward);
        let stays = |d: f64| d <= ON_SIDE * border;
        next.clear();
        let closed = cut.len() > 2;
        for (i, here) in cut.iter().enumerate() {
            let d = outside(here);
            if stays(d) {
                next.push(*here);
            }
            if i + 1 == cut.len() && !closed {
                continue;
            }
            let after = &cut[(i + 1) % cut.len()];
            let e = outside(after);
            if stays(d) != stays(e) {
                let t = (d / (d - e)).clamp(0.0, 1.0);
                let place = here.place + (after.place - here.place) * t;
                let side = 1000 + 64 * from;
                next.push(Corner { place, names: [here.names[0], side] });
            }
        }
        std::mem::swap(cut, &mut next);
    }
}

/// Appends the ends of two segments that lie along each other, each with what faces it.
fn along_each_other(
    placed: [&Placed; 2],
    shown: [&Shown; 2],
    n: &V,
    append: &mut impl FnMut([u32; 2], [V; 2], V, f64),
) {
    let ends = shown.map(|shown| [shown.corners[0], shown.corners[1]]);
    let along = ends.map(|[from, to]| {
        let along = to.place - from.place;
        along - n * along.dot(n)
    });
    let lengths = along.map(|along| along.norm());
    if along[0].cross(&along[1]).norm() > PARALLEL * lengths[0] * lengths[1] {
        return;
    }
    for side in [0, 1] {
        let other = 1 - side;
        for end in ends[side] {
            let from = end.place - ends[other][0].place;
            let t = from.dot(&along[other]) / (lengths[other] * lengths[other]);
            if !(-BORDER..=1.0 + BORDER).contains(&t) {
                continue;
            }
            let point = Placed {
                parts: vec![Part::Point(end.place)],
                centre: end.place,
                rounding: placed[side].rounding,
                size: placed[side].size,
                ..Placed::default()
            };
            let pair = if side == 0 { [&point, placed[1]] } else { [placed[0], &point] };
            let Separation { gap, normal, points } = separate_point(pair, side, n);
            if normal.dot(n) < ALONG {
                continue;
            }
            let mut names = [2000, 2000];
            names[side] = end.names[0];
            append(names, points, normal, gap);
        }
    }
}
