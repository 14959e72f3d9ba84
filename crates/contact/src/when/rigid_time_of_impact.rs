//! When two moving rigid bodies meet: "never" is a proof.
//!
//! ```text
//! s(n, t) = min n.x2(t) - max n.x1(t)  <=  distance at t                     any direction n
//! s(n, t + d) >= min(s(n, t), min n.(x2 + d x2') - max n.(x1 + d x1')) - d^2/2 (k1 + k2)
//! ```
//! `x1 x2` points of two convex parts, `x'` their velocities at t, `k` bounds on their
//! accelerations (see [`RigidPathIn`]). A minimum over points of functions that are linear in `d` is
//! concave, so that its ends bound it; both ends are farthest points of the parts, along `m` and
//! along `m + d m x w`, where `m` is `n` in body axes and `w` the turn. From the direction of the
//! closest points at t, this proves an interval free, from its end the next one: conservative
//! advancement, of second order, so that what slides past at a distance e takes steps of order
//! `sqrt(e)`. The closest points come from the geometry library and need not be exact: they only
//! suggest a direction, and no hit is announced unless two points of the shapes are that close. The
//! library's own cast along such motions proves nothing: it passes over some meetings.
//!
//! A shape that is not convex is its convex parts, each pair on its own; a half-space suggests its
//! own normal, and must not turn.
//!
//! No hit: the distance exceeds `thickness` at all times. A hit: it is at most `thickness +
//! tolerance` at [`RigidHitIn::time`], and exceeds `thickness` before. A world asks here whether what
//! moves far in a step passes with clearance. Source: notes 11.1; Mirtich 1996 (conservative
//! advancement).

use stationary_rigid::LieGroup;

use crate::shapes::dimension::{Closest, Facing};
#[cfg(feature = "3d")]
use crate::when::swept_boxes::{SweptBox, overlapping};
use crate::{Closeness, ContactError, Dimension, RigidPathIn};
#[cfg(feature = "3d")]
use crate::{Moving, RigidPath, Shape, Spatial};

/// When two rigid bodies meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidHitIn<G: Dimension> {
    /// The fraction of the motion before which they are proved apart.
    pub time: f64,
    /// From the first to the second, of length 1, world axes; zero where they overlap.
    pub normal: G::Vector,
    /// A point of each, no farther apart than promised, world axes.
    pub points: [G::Vector; 2],
    /// Intervals proved free.
    pub intervals: usize,
    /// Whether the distance at [`RigidHitIn::time`] is as promised. Where the search hit its bound it
    /// is not known; that they are apart before still is.
    pub settled: bool,
}

/// When two rigid bodies of space meet.
#[cfg(feature = "3d")]
pub type RigidHit = RigidHitIn<Spatial>;
/// When two rigid bodies of the plane meet.
#[cfg(feature = "2d")]
pub type PlanarHit = RigidHitIn<crate::Planar>;

/// A shape with the centre of the body that carries it, and its path.
pub type MoverIn<'a, G> = (&'a <G as Dimension>::Shape, &'a RigidPathIn<G>);

/// Intervals after which what is left counts as a hit.
const INTERVALS: usize = 20_000;
/// Roundings of a coordinate of a moved point, in units of the largest: products with a rotation
/// and a direction, and the rotation's own.
const ROUNDINGS: f64 = 256.0 * f64::EPSILON;
/// What a tolerance is larger than, in such roundings.
const LEAST_TOLERANCE: f64 = 4.0;
/// A free interval is found within this part of the longest that could be proved.
const GROWTH: f64 = 1.25;

/// A shape at a place of a body that moves.
pub(crate) struct Swept<'a, G: Dimension> {
    shape: &'a G::Shape,
    place: &'a G::Motion,
    path: &'a RigidPathIn<G>,
    /// Of a ball about the body's centre that holds the shape; what has no end and does not turn
    /// needs none.
    radius: f64,
    turns: bool,
}

impl<'a, G: Dimension> Swept<'a, G> {
    pub(crate) fn new(shape: &'a G::Shape, place: &'a G::Motion, path: &'a RigidPathIn<G>) -> Self {
        let turns = G::spin_speed(path.turn()) > 0.0;
        let radius = match (G::plane(shape), turns) {
            (None, _) => G::reach(shape, place),
            (Some(_), false) => 0.0,
            (Some(_), true) => f64::INFINITY,
        };
        Swept { shape, place, path, radius, turns }
    }

    fn largest(&self) -> f64 {
        self.path.largest() + self.radius
    }

    /// How far a part reaches along a direction of the world, if every point went on as it moves at
    /// this pose for a time.
    fn farthest(&self, part: u32, at: &G::Motion, n: &G::Vector, later: f64) -> f64 {
        let m = G::rotate_back(&G::frame(at), n);
        let bent = m - G::swing(self.path.turn(), &m) * later;
        let centre = G::translation(at) + *self.path.way() * later;
        let own = G::rotate_back(&G::frame(self.place), &bent);
        G::dot(n, &centre)
            + G::dot(&bent, &G::translation(self.place))
            + G::farthest(self.shape, part, &own)
    }

    /// Its convex parts that come near the other one on the way.
    fn parts_near(&self, other: &Self, room: f64, parts: &mut Vec<u32>) {
        let reach = other.radius + room;
        let whole =
            if self.turns || G::plane(other.shape).is_some() { f64::INFINITY } else { reach };
        let seen = self.path.at(0.0).compose(self.place).inverse();
        let start = G::translation(&other.path.at(0.0));
        let way = *other.path.way() - *self.path.way();
        let ends = [G::apply(&seen, &start), G::apply(&seen, &(start + way))];
        let (mut low, mut high) = (ends[0], ends[0]);
        for k in 0..G::TRANSLATION {
            low[k] = ends[0][k].min(ends[1][k]) - whole;
            high[k] = ends[0][k].max(ends[1][k]) + whole;
        }
        G::parts_within(self.shape, &low, &high, parts);
    }
}

/// Room for a search: the parts of both shapes, and what the queries between them need.
pub(crate) struct MeetRoom<G: Dimension> {
    parts: [Vec<u32>; 2],
    queries: Queries<G>,
}

/// Room for queries of closest points.
pub(crate) struct Queries<G: Dimension> {
    shapes: G::Room,
    found: Vec<Facing<G::Vector>>,
}

impl<G: Dimension> Default for MeetRoom<G> {
    fn default() -> Self {
        let queries = Queries { shapes: G::Room::default(), found: Vec::new() };
        MeetRoom { parts: Default::default(), queries }
    }
}

impl<G: Dimension> std::fmt::Debug for MeetRoom<G> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("MeetRoom").field("parts", &self.parts).finish_non_exhaustive()
    }
}

/// When two rigid bodies come within the thickness of each other.
///
/// # Errors
/// [`ContactError::NoQuery`] for a half-space that turns and for two half-spaces;
/// [`ContactError::Tolerance`] below rounding; [`ContactError::Thickness`].
pub fn rigid_bodies_meet<G: Dimension>(
    first: MoverIn<'_, G>,
    second: MoverIn<'_, G>,
    close: Closeness,
) -> Result<Option<RigidHitIn<G>>, ContactError> {
    let here = G::Motion::identity();
    let bodies = [first, second].map(|(shape, path)| Swept::<G>::new(shape, &here, path));
    let planes = bodies.iter().filter(|body| G::plane(body.shape).is_some()).count();
    if planes == 2 || bodies.iter().any(|body| body.radius.is_infinite()) {
        let [first, second] = [0, 1].map(|k| G::name(bodies[k].shape));
        return Err(ContactError::NoQuery { first, second });
    }
    close.check(LEAST_TOLERANCE * rounding(&bodies))?;
    Ok(meet(&bodies, close, INTERVALS, &mut MeetRoom::default(), |_, _| false))
}

fn rounding<G: Dimension>(bodies: &[Swept<G>; 2]) -> f64 {
    ROUNDINGS * bodies.iter().map(Swept::largest).fold(0.0, f64::max)
}

/// The first meeting of any two convex parts, but for those that are known to leave each other; a hit
/// where the tolerance is below rounding.
pub(crate) fn meet<G: Dimension>(
    bodies: &[Swept<G>; 2],
    close: Closeness,
    most: usize,
    room: &mut MeetRoom<G>,
    leaving: impl Fn(&[u32; 2], &mut Queries<G>) -> bool,
) -> Option<RigidHitIn<G>> {
    let [a, b] = bodies;
    let MeetRoom { parts: [of_a, of_b], queries } = room;
    let near = close.thickness + close.tolerance;
    a.parts_near(b, near, of_a);
    b.parts_near(a, near, of_b);
    let mut first: Option<RigidHitIn<G>> = None;
    for &i in of_a.iter() {
        for &j in of_b.iter() {
            if leaving(&[i, j], queries) {
                continue;
            }
            let hit = advance(bodies, [i, j], close, most, queries);
            let sooner = |hit: &RigidHitIn<G>| first.is_none_or(|first| hit.time < first.time);
            if let Some(hit) = hit.filter(sooner) {
                first = Some(hit);
            }
        }
    }
    first
}

/// Whether two convex parts that are within `touch` of each other at the start leave: are farther apart than
/// that at the end, or have kept half of their distance, and have no less on the way; also of what follows these
/// paths up to a deviation that is zero at both ends, and at most `bend s (1 - s)` between.
///
/// ```text
/// n(s) = (1 - s) n0 + s n1,   |n(s)| <= 1           n0 n1 the directions of the closest points at 0 and 1
/// n(s).(x2 - x1)(s) >= (1 - s) d0 + s (min n1.(x2 + x2') - max n1.(x1 + x1')) - (k1 + k2)/2 s^2
///                      - s (1 - s) (|n1 - n0| |x2' - x1'| + bend)
/// ```
/// The direction turns with the faces and edges that touch: along one that stays, the far end of a face that
/// turns would come towards the other part.
pub(crate) fn leaves<G: Dimension>(
    bodies: &[Swept<G>; 2],
    parts: [u32; 2],
    touch: f64,
    bend: f64,
    queries: &mut Queries<G>,
) -> bool {
    let poses = [0, 1].map(|k| bodies[k].path.at(0.0));
    let Some(here) = closest(bodies, parts, &poses, queries) else { return false };
    if !(here.distance > 0.0 && here.distance <= touch) {
        return false;
    }
    let ends = [0, 1].map(|k| bodies[k].path.at(1.0));
    let Some(there) = closest(bodies, parts, &ends, queries) else { return false };
    let n = direction(bodies, &ends, &there);
    let turned = n - direction(bodies, &poses, &here);
    let far = bodies[0].farthest(parts[0], &poses[0], &n, 1.0);
    let near = -bodies[1].farthest(parts[1], &poses[1], &(n * -1.0), 1.0);
    let turned = G::dot(&turned, &turned).sqrt();
    let turning = if turned > 0.0 { turned * fastest(bodies) } else { 0.0 };
    let after = near - far - rounding(bodies) - bend - turning - acceleration(bodies);
    after > touch || after >= 0.5 * here.distance
}

/// How far the points of two bodies move past each other at most, if they go on as they start.
fn fastest<G: Dimension>(bodies: &[Swept<G>; 2]) -> f64 {
    let way = *bodies[1].path.way() - *bodies[0].path.way();
    let spins = bodies.iter().filter(|body| body.turns);
    let spins: f64 = spins.map(|body| body.radius * G::spin_speed(body.path.turn())).sum();
    G::dot(&way, &way).sqrt() + spins
}

/// Half of how fast two parts can bend towards each other.
fn acceleration<G: Dimension>(bodies: &[Swept<G>; 2]) -> f64 {
    bodies.iter().map(|body| 0.5 * body.path.acceleration(body.radius)).sum()
}

fn advance<G: Dimension>(
    bodies: &[Swept<G>; 2],
    parts: [u32; 2],
    close: Closeness,
    most: usize,
    queries: &mut Queries<G>,
) -> Option<RigidHitIn<G>> {
    let Closeness { thickness, tolerance } = close;
    let rounding = rounding(bodies);
    let bend = acceleration(bodies);
    let nowhere = G::Vector::default();
    let (mut time, mut last) = (0.0_f64, 1.0_f64);
    for intervals in 0..most {
        let poses = [0, 1].map(|k| bodies[k].path.at(time));
        let hit =
            |points, normal, settled| Some(RigidHitIn { time, normal, points, intervals, settled });
        let Some(closest) = closest(bodies, parts, &poses, queries) else {
            return hit(poses.map(|pose| G::translation(&pose)), nowhere, true);
        };
        let Closest { points: [x1, x2], distance, .. } = closest;
        if !(distance > 0.0 && distance.is_finite()) {
            return hit([x1, x2], nowhere, true);
        }
        let n = direction(bodies, &poses, &closest);
        if distance <= thickness + 0.5 * tolerance {
            return hit([x1, x2], n, true);
        }
        let separation = |later| {
            let far = bodies[0].farthest(parts[0], &poses[0], &n, later);
            let near = -bodies[1].farthest(parts[1], &poses[1], &(n * -1.0), later);
            near - far - rounding
        };
        let now = separation(0.0);
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
    let points = closest(bodies, parts, &poses, queries).map(|closest| closest.points);
    let points = points.unwrap_or(poses.map(|pose| G::translation(&pose)));
    Some(RigidHitIn { time, normal: nowhere, points, intervals: most, settled: false })
}

/// From the first to the second: the normal of the one that is a half-space, or that of the closest points.
fn direction<G: Dimension>(
    bodies: &[Swept<G>; 2],
    poses: &[G::Motion; 2],
    closest: &Closest<G::Vector>,
) -> G::Vector {
    let of_plane = (0..2).find_map(|k| {
        let normal = G::plane(bodies[k].shape)?;
        let seen = G::turn(&poses[k], &G::turn(bodies[k].place, &normal));
        Some(if k == 0 { seen } else { seen * -1.0 })
    });
    let [x1, x2] = closest.points;
    of_plane.or(closest.normal).unwrap_or((x2 - x1) * closest.distance.recip())
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

/// The closest points of two parts, world axes; none where they overlap.
fn closest<G: Dimension>(
    bodies: &[Swept<G>; 2],
    parts: [u32; 2],
    poses: &[G::Motion; 2],
    queries: &mut Queries<G>,
) -> Option<Closest<G::Vector>> {
    // Seen from the first body, so that nothing is lost far from the origin.
    let seen = G::relative(&poses[0], &poses[1]);
    let seen = [G::convert(bodies[0].place), G::convert(&seen.compose(bodies[1].place))];
    let shapes = [bodies[0].shape, bodies[1].shape];
    let Queries { shapes: room, found } = queries;
    let closest = G::closest(shapes, parts, [&seen[0], &seen[1]], room, found)?;
    let [x1, x2] = closest.points;
    let apart = x2 - x1;
    let length = G::dot(&apart, &apart).sqrt();
    let by_points = (length > 0.0).then(|| apart * length.recip());
    Some(Closest {
        points: closest.points.map(|point| G::apply(&poses[0], &point)),
        normal: closest.normal.or(by_points).map(|normal| G::turn(&poses[0], &normal)),
        distance: closest.distance,
    })
}

/// Every pair of moving bodies that meets, by number, sorted.
///
/// Pairs whose paths keep them apart by boxes are not looked at: each box holds the ball about the
/// body's centre all the way.
///
/// # Errors
/// [`ContactError::NoQuery`] for a shape without end; [`ContactError::Tolerance`] and
/// [`ContactError::Thickness`]; the others of [`rigid_bodies_meet`] for pairs that come near each
/// other.
#[cfg(feature = "3d")]
pub fn rigid_bodies_that_meet(
    movers: &[MoverIn<'_, Spatial>],
    close: Closeness,
) -> Result<Vec<([usize; 2], RigidHit)>, ContactError> {
    close.check(0.0)?;
    let boxed = |&(shape, path): &(&Shape, &RigidPath)| {
        let start = path.at(0.0);
        let chord = Moving { start: start.translation, end: path.at(1.0).translation };
        let room = 0.5 * close.thickness + close.tolerance;
        match shape.plane() {
            Some(_) => Err(ContactError::NoQuery { first: "a moving body", second: shape.name() }),
            None => {
                let reach = Spatial::reach(shape, &LieGroup::identity());
                Ok(SweptBox::of(&[chord], reach + room))
            }
        }
    };
    let boxes: Vec<_> = movers.iter().map(boxed).collect::<Result<_, _>>()?;
    let mut hits = Vec::new();
    for (i, j) in overlapping(&boxes, &boxes).into_iter().filter(|(i, j)| i < j) {
        if let Some(hit) = rigid_bodies_meet(movers[i], movers[j], close)? {
            hits.push(([i, j], hit));
        }
    }
    Ok(hits)
}
