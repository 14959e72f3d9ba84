//! When two moving rigid bodies meet: "never" is a proof.
//!
//! ```text
//! s(n, t) = min n.x2(t) - max n.x1(t)  <=  distance at t                     any direction n
//! s(n, t + d) >= min(s(n, t), min n.(x2 + d x2') - max n.(x1 + d x1')) - d^2/2 (k1 + k2)
//! ```
//! `x1 x2` points of two convex shapes, `x'` their velocities at t, `k` bounds on their
//! accelerations (see [`RigidPath`]). A minimum over points of functions that are linear in `d` is
//! concave, so that its ends bound it; both ends are farthest points of the shapes, along `m` and
//! along `m + d m x w`, where `m` is `n` in body axes and `w` the turn. From the direction of the
//! closest points at t, this proves an interval free, from its end the next one: conservative
//! advancement, of second order, so that what slides past at a distance e takes steps of order
//! `sqrt(e)`. The closest points come from the geometry library and need not be exact: they only
//! suggest a direction, and no hit is announced unless two points of the shapes are that close. The
//! library's own cast along such motions proves nothing: it passes over some meetings.
//!
//! No hit: the distance exceeds `thickness` at all times. A hit: it is at most `thickness +
//! tolerance` at [`RigidHit::time`], and exceeds `thickness` before. Source: notes 11.1; Mirtich
//! 1996 (conservative advancement).

use nalgebra::Vector3;
use parry3d_f64::query::{ClosestPoints, closest_points};
use stationary_rigid::RigidMotion;

use crate::shapes::convert::{from_vector, pose, vector};
use crate::when::swept_boxes::{SweptBox, overlapping};
use crate::{Closeness, ContactError, RigidPath, Shape};

/// When two rigid bodies meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidHit {
    /// The fraction of the motion before which they are proved apart.
    pub time: f64,
    /// From the first to the second, of length 1, world axes; zero where they overlap.
    pub normal: Vector3<f64>,
    /// A point of each, no farther apart than promised, world axes.
    pub points: [Vector3<f64>; 2],
    /// Intervals proved free.
    pub intervals: usize,
    /// Whether the distance at [`RigidHit::time`] is as promised. Where the search hit its bound it
    /// is not known; that they are apart before still is.
    pub settled: bool,
}

/// A shape with the origin of the body that carries it, and its path.
pub type Mover<'a> = (&'a Shape, &'a RigidPath);

/// Intervals after which what is left counts as a hit.
const INTERVALS: usize = 20_000;
/// Roundings of a coordinate of a moved point, in units of the largest: products with a rotation
/// and a direction, and the rotation's own.
const ROUNDINGS: f64 = 256.0 * f64::EPSILON;
/// A free interval is found within this part of the longest that could be proved.
const GROWTH: f64 = 1.25;

struct Body<'a> {
    shape: &'a Shape,
    path: &'a RigidPath,
    radius: f64,
    acceleration: f64,
}

impl<'a> Body<'a> {
    fn new((shape, path): Mover<'a>) -> Result<Self, ContactError> {
        if !shape.is_bounded_and_convex() {
            return Err(ContactError::NoQuery { first: "a moving body", second: shape.name() });
        }
        let radius = shape.radius();
        Ok(Body { shape, path, radius, acceleration: path.acceleration(radius) })
    }

    /// How far the body reaches along a direction of the world, if every point went on as it moves
    /// at this pose for a time.
    fn farthest(&self, at: &RigidMotion, n: &Vector3<f64>, later: f64) -> f64 {
        let m = at.rotation.rotate_back(n);
        let bent = m + m.cross(self.path.turn()) * later;
        n.dot(&at.translation) + later * self.path.origin_along(at, n) + self.shape.farthest(&bent)
    }
}

/// When two rigid bodies come within the thickness of each other.
///
/// # Errors
/// Shapes that are not bounded and convex, and tolerances below rounding.
pub fn rigid_bodies_meet(
    first: Mover<'_>,
    second: Mover<'_>,
    close: Closeness,
) -> Result<Option<RigidHit>, ContactError> {
    let bodies = [Body::new(first)?, Body::new(second)?];
    let size = |body: &Body<'_>| body.path.largest() + body.radius;
    let rounding = ROUNDINGS * bodies.iter().map(size).fold(0.0, f64::max);
    close.check(4.0 * rounding)?;
    Ok(advance(&bodies, close, rounding))
}

fn advance(bodies: &[Body<'_>; 2], close: Closeness, rounding: f64) -> Option<RigidHit> {
    let Closeness { thickness, tolerance } = close;
    let (mut time, mut last) = (0.0_f64, 1.0_f64);
    for intervals in 0..INTERVALS {
        let poses = [0, 1].map(|k| bodies[k].path.at(time));
        let hit =
            |points, normal, settled| Some(RigidHit { time, normal, points, intervals, settled });
        let [x1, x2] = match closest(bodies, &poses) {
            Some(points) => points,
            None => return hit(poses.map(|pose| pose.translation), Vector3::zeros(), true),
        };
        let Some(n) = (x2 - x1).try_normalize(0.0) else {
            return hit([x1, x2], Vector3::zeros(), true);
        };
        if (x2 - x1).norm() <= thickness + 0.5 * tolerance {
            return hit([x1, x2], n, true);
        }
        let separation = |later| {
            let [far, near] =
                [(0, n), (1, -n)].map(|(k, n)| bodies[k].farthest(&poses[k], &n, later));
            -near - far - rounding
        };
        let now = separation(0.0);
        let bend = 0.5 * (bodies[0].acceleration + bodies[1].acceleration);
        let free = |d: f64| now.min(separation(d)) - bend * d * d > thickness;
        let left = 1.0 - time;
        if free(left) {
            return None;
        }
        let Some(step) = longest(free, last.min(left)) else { return hit([x1, x2], n, false) };
        last = 4.0 * step;
        if time + step <= time {
            return hit([x1, x2], n, false);
        }
        time += step;
    }
    let poses = [0, 1].map(|k| bodies[k].path.at(time));
    let points = closest(bodies, &poses).unwrap_or(poses.map(|pose| pose.translation));
    let normal = Vector3::zeros();
    Some(RigidHit { time, normal, points, intervals: INTERVALS, settled: false })
}

/// About the longest step of which a test holds, not longer than `most`.
fn longest(free: impl Fn(f64) -> bool, most: f64) -> Option<f64> {
    let (mut step, mut too_long) = (most, most * GROWTH);
    while !free(step) {
        too_long = step;
        step *= 0.25;
        if step < f64::EPSILON {
            return None;
        }
    }
    while too_long > GROWTH * step {
        let middle = (step * too_long).sqrt();
        if free(middle) { step = middle } else { too_long = middle }
    }
    Some(step)
}

/// The closest points of two bodies, world axes; none where they overlap.
fn closest(bodies: &[Body<'_>; 2], poses: &[RigidMotion; 2]) -> Option<[Vector3<f64>; 2]> {
    // Seen from the first body, so that nothing is lost far from the origin.
    let origin = poses[0].translation;
    let seen = poses.map(|at| pose(&RigidMotion { translation: at.translation - origin, ..at }));
    let [a, b] = [0, 1].map(|k| &**bodies[k].shape.geometry());
    match closest_points(&seen[0], a, &seen[1], b, f64::MAX) {
        Ok(ClosestPoints::WithinMargin(x1, x2)) => Some([x1, x2].map(|x| from_vector(x) + origin)),
        _ => None,
    }
}

/// Every pair of moving bodies that meets, by number, sorted.
///
/// Pairs whose paths keep them apart by boxes are not looked at: each box holds the ball about the
/// body's origin all the way.
///
/// # Errors
/// [`ContactError::Tolerance`] and [`ContactError::Thickness`]; the others of
/// [`rigid_bodies_meet`] for pairs that come near each other.
pub fn rigid_bodies_that_meet(
    movers: &[Mover<'_>],
    close: Closeness,
) -> Result<Vec<([usize; 2], RigidHit)>, ContactError> {
    close.check(0.0)?;
    let boxed = |(shape, path): &Mover<'_>| {
        let (chord, stray) = path.chord();
        let room = 0.5 * close.thickness + close.tolerance;
        SweptBox::of(&[chord], shape.radius() + stray + room)
    };
    let boxes: Vec<_> = movers.iter().map(boxed).collect();
    let mut hits = Vec::new();
    for (i, j) in overlapping(&boxes, &boxes).into_iter().filter(|(i, j)| i < j) {
        if let Some(hit) = rigid_bodies_meet(movers[i], movers[j], close)? {
            hits.push(([i, j], hit));
        }
    }
    Ok(hits)
}

impl Shape {
    /// Whether it has a farthest point in every direction, and is the hull of those.
    pub(crate) fn is_bounded_and_convex(&self) -> bool {
        self.geometry().as_support_map().is_some()
    }

    /// How far it reaches along a direction of its own axes, of any length.
    pub(crate) fn farthest(&self, direction: &Vector3<f64>) -> f64 {
        let d = vector(direction);
        self.geometry().as_support_map().map_or(f64::INFINITY, |map| {
            match self.geometry().as_ball() {
                Some(ball) => ball.radius * direction.norm(),
                None => map.local_support_point(d).dot(d),
            }
        })
    }

    /// The radius of a ball about the origin that holds it.
    pub(crate) fn radius(&self) -> f64 {
        let ball = self.geometry().compute_local_bounding_sphere();
        from_vector(ball.center).norm() + ball.radius
    }
}
