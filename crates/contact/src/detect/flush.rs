//! Faces that all but lie on each other: the direction between two solids, and their points there.
//!
//! ```text
//! z1(u) = c1 + a.u over U,   z2(u) = c2 + b.u over W        heights along n of what each shows, u across n
//! z2 - z1 least over U and W:   a - b = mu + nu              mu, nu outward normals of U and W there, at u*
//! n + (mu - a)                                               along which both reach farthest at u*
//! ```
//! Turned by less than a circle's farthest point can follow, values are equal to rounding, and say no direction;
//! where the faces meet is well known. With the new direction `U` and `W` are seen anew, until the points lie
//! across the separation. Source: the optimality conditions of the least gap over what two flat faces share.

use nalgebra::{Matrix2, Vector2, Vector3};

use crate::shapes::solid::{Part, Placed};

type V = Vector3<f64>;
type U = Vector2<f64>;

/// What is turned against the direction by less than this, radians, lies along it.
const FLUSH: f64 = 1e-2;
/// Slopes that differ by less than this are rounding.
const SAME: f64 = 1e-14;
/// Times that the faces are seen anew.
const ROUNDS: usize = 8;
/// Points outside by this part of the sizes are on the border.
const BORDER: f64 = 1e-15;
/// Corners that fall short of a face by this part of the size are its.
const LEVEL: f64 = 1e-11;
/// Points outside by more than this part of the sizes are outside: of rims that all but coincide rounding finds
/// crossings anywhere.
const ROUNDING: f64 = 1e-13;
/// Weights of normals that fall short of zero by this part of the slope are zero.
const SLACK: f64 = 1e-12;

/// Points that face each other across the separation along a direction.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Met {
    pub(crate) separation: f64,
    pub(crate) normal: V,
    pub(crate) points: [V; 2],
    /// How far the points are from being across the separation, m.
    pub(crate) off: f64,
}

/// What a solid shows along a direction, seen along it.
struct Face {
    outline: Outline,
    /// Its height above the origin, and how it grows.
    height: f64,
    slope: U,
}

enum Outline {
    Disc(Disc),
    /// In their order around it; one or two are a corner or an edge.
    Polygon(Vec<U>),
}

/// `|squash (u - centre)| <= radius`.
struct Disc {
    centre: U,
    squash: Matrix2<f64>,
    radius: f64,
}

/// Where two solids that lie nearly flush on each other face each other to within `off`, beginning with a direction
/// that is close.
pub(crate) fn flush(solids: [&Placed; 2], start: V, off: f64) -> Option<Met> {
    let [a, b] = solids;
    let met = |normal: V, points: [V; 2]| {
        let separation = -b.farthest(&-normal).1 - a.farthest(&normal).1;
        let off = (points[1] - points[0] - normal * separation).norm();
        Met { separation, normal, points, off }
    };
    let mut n = start;
    for _ in 0..ROUNDS {
        let (next, [x1, x2]) = step(solids, &n)?;
        let found = met(next, [x1, x2]);
        if found.off <= off {
            return Some(found);
        }
        // A corner above a rim holds the direction between what each of them asks for.
        if found.separation > 0.0 {
            let onto = [[Some(x1), on_disc(b, &-n, &x1)], [on_disc(a, &n, &x2), Some(x2)]];
            for points in onto {
                let [Some(x1), Some(x2)] = points else { continue };
                let Some(way) = (x2 - x1).try_normalize(0.0) else { continue };
                let found = met(way, [x1, x2]);
                if found.off <= off {
                    return Some(found);
                }
            }
        }
        n = next;
    }
    None
}

/// A better direction, and the points between which the gap along this one is least.
fn step([a, b]: [&Placed; 2], n: &V) -> Option<(V, [V; 2])> {
    let first = n.cross(&V::ith(n.iamin(), 1.0)).normalize();
    let frame = [first, n.cross(&first), *n];
    let (one, other) = (Face::of(a, n, &frame)?, Face::of(b, &-n, &frame)?);
    let size = a.size + b.size;
    let outlines = [&one.outline, &other.outline];
    let (u, mu) = least(outlines, one.slope - other.slope, BORDER * size)?;
    if outlines.iter().any(|outline| outline.outside(&u) > ROUNDING * size) {
        return None;
    }
    let turn = mu - one.slope;
    let normal = (n + first * turn.x + frame[1] * turn.y).normalize();
    let lift = |face: &Face| first * u.x + frame[1] * u.y + n * (face.height + face.slope.dot(&u));
    Some((normal, [lift(&one), lift(&other)]))
}

/// The disc that a solid shows along a direction: its centre, axis and radius.
fn disc(solid: &Placed, n: &V) -> Option<(V, V, f64)> {
    match solid.parts[solid.farthest(n).0] {
        Part::Circle { centre, axis, radius } if axis.cross(n).norm() < FLUSH => {
            Some((centre, axis * axis.dot(n).signum(), radius))
        }
        _ => None,
    }
}

/// The point of the disc that a solid shows along a direction that is closest to a point.
fn on_disc(solid: &Placed, n: &V, x: &V) -> Option<V> {
    let (centre, axis, radius) = disc(solid, n)?;
    let way = x - centre;
    let across = way - axis * way.dot(&axis);
    let length = across.norm();
    Some(centre + if length > radius { across * (radius / length) } else { across })
}

impl Face {
    /// What a solid shows along a direction, in a frame whose last axis is up.
    fn of(solid: &Placed, n: &V, [e, f, up]: &[V; 3]) -> Option<Self> {
        let seen = |x: &V| U::new(x.dot(e), x.dot(f));
        let flat = |outline: Outline, normal: &V, at: &V| {
            let slope = -seen(normal) / normal.dot(up);
            Face { outline, height: at.dot(up) - slope.dot(&seen(at)), slope }
        };
        if let Some((centre, axis, radius)) = disc(solid, n) {
            let disc = Disc { centre: seen(&centre), squash: squash(&seen(&axis)), radius };
            return Some(flat(Outline::Disc(disc), &axis, &centre));
        }
        let k = solid.farthest(n).0;
        let top = solid.parts[k].point(n);
        let points = (0..solid.parts.len()).filter(|&j| j != k).map(|j| solid.parts[j].point(n));
        let level = |x: &V| (x - top).dot(n).abs() < FLUSH * (x - top).norm();
        let mut corners: Vec<V> = points.filter(level).collect();
        let looks = |f: &&V| f.cross(n).norm() < FLUSH && f.dot(n) > 0.0;
        let face = solid.faces.iter().filter(looks).max_by(|f, g| f.dot(n).total_cmp(&g.dot(n)));
        if let Some(normal) = face {
            corners.push(top);
            let reach = corners.iter().map(|x| x.dot(normal)).fold(f64::NEG_INFINITY, f64::max);
            corners.retain(|x| x.dot(normal) >= reach - LEVEL * solid.size);
            let middle = corners.iter().map(seen).sum::<U>() / corners.len() as f64;
            let mut outline: Vec<U> = corners.iter().map(seen).collect();
            let angle = |u: &U| (u.y - middle.y).atan2(u.x - middle.x);
            outline.sort_by(|u, v| angle(u).total_cmp(&angle(v)));
            return Some(flat(Outline::Polygon(outline), normal, &corners[0]));
        }
        // The way that falls least is an edge: across a narrow face others are longer.
        let fall = |x: &V| (top - x).dot(n) / (top - x).norm();
        let end = corners.iter().min_by(|x, y| fall(x).total_cmp(&fall(y)));
        let (outline, slope) = match end {
            None => (vec![seen(&top)], U::zeros()),
            Some(end) => {
                let (rise, way) = ((end - top).dot(up), seen(end) - seen(&top));
                (vec![seen(&top), seen(end)], way * (rise / way.norm_squared()))
            }
        };
        let height = top.dot(up) - slope.dot(&seen(&top));
        Some(Face { outline: Outline::Polygon(outline), height, slope })
    }
}

/// What makes the outline of a disc round again that is seen along a direction in which its axis leans.
fn squash(lean: &U) -> Matrix2<f64> {
    let square = lean.norm_squared();
    if square == 0.0 {
        return Matrix2::identity();
    }
    // 1/cos - 1 without losing digits.
    let cosine = (1.0 - square).max(0.0).sqrt();
    Matrix2::identity() + lean * lean.transpose() * (1.0 / (cosine * (1.0 + cosine)))
}

impl Disc {
    fn outward(&self, u: &U) -> U {
        (self.squash * (self.squash * (u - self.centre))).try_normalize(0.0).unwrap_or_default()
    }
}

impl Outline {
    /// Its point that is farthest along a direction.
    fn extreme(&self, p: &U) -> Option<U> {
        match self {
            Outline::Disc(Disc { centre, squash, radius }) => {
                let inverse = squash.try_inverse()?;
                Some(centre + inverse * (inverse * p).try_normalize(0.0)? * *radius)
            }
            Outline::Polygon(corners) => {
                corners.iter().max_by(|u, v| u.dot(p).total_cmp(&v.dot(p))).copied()
            }
        }
    }

    /// How far a point is outside.
    fn outside(&self, u: &U) -> f64 {
        match self {
            Outline::Disc(Disc { centre, squash, radius }) => {
                (squash * (u - centre)).norm() - radius
            }
            Outline::Polygon(corners) if corners.len() > 2 => sides(corners)
                .map(|[from, to]| (u - from).dot(&right(&(to - from))))
                .fold(f64::NEG_INFINITY, f64::max),
            Outline::Polygon(corners) => {
                let (from, to) = (corners[0], corners[corners.len() - 1]);
                let (way, along) = (u - from, to - from);
                let square = along.norm_squared();
                let t = if square > 0.0 { (way.dot(&along) / square).clamp(0.0, 1.0) } else { 0.0 };
                (way - along * t).norm()
            }
        }
    }
}

/// The sides of a polygon, or of an edge the one there is.
fn sides(corners: &[U]) -> impl Iterator<Item = [U; 2]> {
    let count = if corners.len() > 2 { corners.len() } else { corners.len() - 1 };
    (0..count).map(move |k| [corners[k], corners[(k + 1) % corners.len()]])
}

/// The unit vector to the right of a way, out of what lies to its left.
fn right(way: &U) -> U {
    U::new(way.y, -way.x).try_normalize(0.0).unwrap_or_default()
}

/// The point of what two outlines share that is farthest along `p`, and the part of `p` that the first holds.
fn least([one, other]: [&Outline; 2], p: U, border: f64) -> Option<(U, U)> {
    if p.norm() < SAME {
        return None;
    }
    if let Some(u) = one.extreme(&p).filter(|u| other.outside(u) <= border) {
        return Some((u, p));
    }
    if let Some(u) = other.extreme(&p).filter(|u| one.outside(u) <= border) {
        return Some((u, U::zeros()));
    }
    match (one, other) {
        (Outline::Disc(one), Outline::Disc(other)) => rims(one, other).into_iter().find_map(|u| {
            let [mu, _] = held(&p, [one.outward(&u), other.outward(&u)], [false; 2])?;
            Some((u, mu))
        }),
        (Outline::Disc(disc), Outline::Polygon(corners)) => {
            let (u, [mu, _]) = rim_and_side(disc, corners, &p)?;
            Some((u, mu))
        }
        (Outline::Polygon(corners), Outline::Disc(disc)) => {
            let (u, [_, mu]) = rim_and_side(disc, corners, &p)?;
            Some((u, mu))
        }
        (Outline::Polygon(one), Outline::Polygon(other)) => {
            let edges = [one, other].map(|corners| corners.len() == 2);
            sides(one).find_map(|[from, to]| {
                sides(other).find_map(|[start, end]| {
                    let ways = [to - from, end - start];
                    let along = Matrix2::from_columns(&[ways[0], -ways[1]]);
                    let at = along.try_inverse()? * (start - from);
                    if !(at.min() >= 0.0 && at.max() <= 1.0) {
                        return None;
                    }
                    let [mu, _] = held(&p, ways.each_ref().map(right), edges)?;
                    Some((from + ways[0] * at.x, mu))
                })
            })
        }
    }
}

/// Where a rim and a side cross that hold `p` together, and the part of each.
fn rim_and_side(disc: &Disc, corners: &[U], p: &U) -> Option<(U, [U; 2])> {
    sides(corners).find_map(|[from, to]| {
        let (way, along) = (disc.squash * (from - disc.centre), disc.squash * (to - from));
        let (square, half) = (along.norm_squared(), way.dot(&along));
        let root = (half * half - square * (way.norm_squared() - disc.radius * disc.radius)).sqrt();
        [-half - root, -half + root].into_iter().find_map(|t| {
            let t = t / square;
            if !(0.0..=1.0).contains(&t) {
                return None;
            }
            let u = from + (to - from) * t;
            let parts =
                held(p, [disc.outward(&u), right(&(to - from))], [false, corners.len() == 2])?;
            Some((u, parts))
        })
    })
}

/// The parts of a vector along two outward normals, neither inwards; either way along those of an edge.
fn held(p: &U, [a, b]: [U; 2], edges: [bool; 2]) -> Option<[U; 2]> {
    let weights = Matrix2::from_columns(&[a, b]).try_inverse()? * p;
    let slack = -SLACK * p.norm();
    let outwards = (0..2).all(|k| edges[k] || weights[k] >= slack);
    outwards.then(|| [a * weights.x, b * weights.y])
}

/// Where two rims cross: as circles first, then as they are.
fn rims(one: &Disc, other: &Disc) -> Vec<U> {
    let Some(back) = one.squash.try_inverse() else { return Vec::new() };
    let (centre, squash) = (one.squash * (other.centre - one.centre), other.squash * back);
    let (d, r, s) = (centre.norm(), one.radius, other.radius);
    let x = (d * d + r * r - s * s) / (2.0 * d);
    let y = (r * r - x * x).sqrt();
    if !(d > 0.0 && y.is_finite()) {
        return Vec::new();
    }
    let along = centre / d;
    let crossings = [y, -y].map(|y| {
        let mut v = along * x + U::new(-along.y, along.x) * y;
        let value = |v: &U| {
            U::new(v.norm_squared() - r * r, (squash * (v - centre)).norm_squared() - s * s)
        };
        for _ in 0..3 {
            let rows = [v.transpose(), (squash * squash * (v - centre)).transpose()];
            let Some(inverse) = (Matrix2::from_rows(&rows) * 2.0).try_inverse() else { break };
            let next = v - inverse * value(&v);
            if value(&next).norm() >= value(&v).norm() {
                break;
            }
            v = next;
        }
        one.centre + back * v
    });
    crossings.to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use parry3d_f64::math::{Pose, Rotation, Vector};
    use stationary_measure::SplitMix64;

    use crate::detect::facing_points::facing_points;
    use crate::detect::separation::separate;
    use crate::shapes::polytope::Polytope;
    use crate::shapes::solid::Solid;

    /// Cylinders, cones, boxes and capsules laid on each other, leaning by 1e-2 to 1e-14: the direction is the best
    /// there is near it, and the points on both face each other along it.
    #[test]
    fn solids_that_all_but_lie_on_each_other_face_each_other_to_rounding() {
        let mut random = SplitMix64::new(11);
        for case in 0..1_500 {
            let mut uniform = || 0.5 * (random.symmetric() + 1.0);
            let mut shape = |disc: bool| {
                let (half, radius) = (0.1 + uniform(), 0.1 + uniform());
                match (if disc { 2.0 } else { 4.0 } * uniform()) as usize {
                    // Each with its height below the origin.
                    0 => (Solid::cylinder(half, radius), half),
                    1 => (Solid::cone(half, radius), half),
                    2 => {
                        (Solid::polytope(&Polytope::cuboid([radius, radius, half]).unwrap()), half)
                    }
                    _ => (Solid::capsule(half, radius), half + radius),
                }
            };
            let ((lower, _), (upper, _)) = (shape(true), shape(false));
            let below = Pose {
                rotation: Rotation::from_axis_angle(Vector::X, std::f64::consts::PI),
                translation: Vector::ZERO,
            };
            let lean = 10_f64.powf(-2.0 - 12.0 * uniform());
            let lying = matches!(upper.form, crate::shapes::solid::Form::Segment);
            let base = if lying { std::f64::consts::FRAC_PI_2 } else { 0.0 };
            let mut symmetric = || 2.0 * uniform() - 1.0;
            let turned =
                Rotation::from_scaled_axis(Vector::new(symmetric(), symmetric(), 0.0) * lean)
                    * Rotation::from_axis_angle(Vector::Y, base);
            let (mut a, mut b) = (Placed::default(), Placed::default());
            lower.place(&below, &mut a);
            let mut pose = Pose { rotation: turned, translation: Vector::ZERO };
            upper.place(&pose, &mut b);
            let lift = a.farthest(&V::z()).1 + b.farthest(&-V::z()).1;
            let apart = if symmetric() > 0.0 { 0.1 * symmetric() } else { lean * symmetric() };
            pose.translation = Vector::new(0.5 * symmetric(), 0.5 * symmetric(), lift + apart);
            upper.place(&pose, &mut b);
            let direction = separate([&a, &b], f64::INFINITY).unwrap();
            let found = facing_points([&a, &b], &direction);
            let [x1, x2] = found.points;
            let off = (x2 - x1 - found.normal * found.separation).norm();
            assert!(off < 1e-12, "{case}: {off:e}, leaning by {lean:e}");
            for (solid, x, n) in [(&a, x1, found.normal), (&b, x2, -found.normal)] {
                // No point of a solid reaches farther, along the direction and those beside it.
                for _ in 0..20 {
                    let aside = V::new(symmetric(), symmetric(), symmetric());
                    let n = (n + aside * symmetric().powi(8)).normalize();
                    assert!(x.dot(&n) <= solid.farthest(&n).1 + 1e-12, "{case}: outside");
                }
            }
        }
    }

    /// A thin plate on its narrow side, which leans: along the direction what is level with a corner is an edge, and
    /// the way across the narrow side, which is longer, falls by more than the disc is tilted.
    #[test]
    fn the_edge_of_a_thin_plate_faces_a_disc_where_it_crosses_the_rim() {
        let (mut disc, mut plate) = (Placed::default(), Placed::default());
        Solid::cylinder(1.0, 0.2).place(&Pose::IDENTITY, &mut disc);
        let shape = Solid::polytope(&Polytope::cuboid([0.01, 1.0, 1.0]).unwrap());
        for tilt in [1e-4, 1e-6, 1e-8, 1e-9, 1e-10, 1e-11] {
            let turned = Rotation::from_axis_angle(Vector::X, tilt)
                * Rotation::from_axis_angle(Vector::Y, 0.06);
            // Above the disc, its edge beside the middle.
            let edge = turned * Vector::new(0.01, 0.0, -1.0);
            let translation = Vector::new(0.1, 0.0, 1.001) - edge;
            shape.place(&Pose { rotation: turned, translation }, &mut plate);
            let direction = separate([&disc, &plate], f64::INFINITY).unwrap();
            let found = facing_points([&disc, &plate], &direction);
            let [x1, x2] = found.points;
            let off = (x2 - x1 - found.normal * found.separation).norm();
            let rim = -(0.2_f64.powi(2) - 0.1_f64.powi(2)).sqrt();
            let [own, other] = [x1.y - rim, x2.y - rim];
            assert!(off < 1e-15, "{tilt:e}: {off:e}");
            assert!(own.abs().max(other.abs()) < 2.0 * tilt + 1e-6, "{tilt:e}: {own:e} {other:e}");
        }
    }
}
