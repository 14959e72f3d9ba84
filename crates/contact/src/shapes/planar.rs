//! The plane: bodies with a centre and an angle, and what their points do.
//!
//! ```text
//! f.x. = (f, f.Z R c) (t., theta.),     x. = t. + theta. Z R c,     Z a quarter turn       (7.4)
//! ```
//! See [`Dimension`]. The space is flat, so that free motion is exact: centres straight, angles at
//! their rate.

use nalgebra::Vector2;
use parry2d_f64::math::Pose;
use stationary_calculus::{DiagonalMetric, Flat, array};
use stationary_rigid::{LieGroup, PlanarMotion, PlanarRotation};

use crate::detect::planar_narrow_phase::{facing, facing_parts};
use crate::detect::ray::{beside, entrance};
use crate::error::check_finite;
use crate::shapes::dimension::{Answer, Closest, Facing, farthest_of_plane, sealed::Sealed};
use crate::shapes::planar_convert;
use crate::solve::island_solver::IslandSolver;
use crate::{ContactError, Dimension, PlanarShape};

/// The plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Planar;

/// A quarter turn.
fn quarter(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

impl Sealed for Planar {}

impl Dimension for Planar {
    type Vector = Vector2<f64>;
    type Motion = PlanarMotion;
    type Shape = PlanarShape;
    type Metric = DiagonalMetric<Vec<f64>>;
    type Space = Flat;
    type Directions = [Vector2<f64>; 2];
    type Stored = [f64; 3];
    type Velocity = [f64; 3];
    type Spin = f64;
    type Frame = PlanarRotation;
    type Pose = Pose;
    type Tree = crate::detect::broad_phase::PlanarTree;
    type Room = ();
    type Solver = IslandSolver<Vector2<f64>, 3, 2>;

    const TRANSLATION: usize = 2;
    const FREEDOMS: usize = 3;
    const STORED: usize = 3;

    #[inline]
    fn pose(q: &[f64], body: usize) -> PlanarMotion {
        let [x, y, angle] = [0, 1, 2].map(|k| q[3 * body + k]);
        PlanarMotion { translation: Vector2::new(x, y), rotation: PlanarRotation::exp(angle) }
    }

    fn check(q: &[f64]) -> Result<(), ContactError> {
        check_finite("the pose", q)
    }

    fn check_place(place: &PlanarMotion) -> Result<(), ContactError> {
        check_finite("the place of a collider", place.translation.as_slice())?;
        check_finite("the angle of a collider", &[place.rotation.log()])
    }

    #[inline]
    fn apply(pose: &PlanarMotion, point: &Vector2<f64>) -> Vector2<f64> {
        pose.apply(point)
    }

    #[inline]
    fn turn(pose: &PlanarMotion, direction: &Vector2<f64>) -> Vector2<f64> {
        pose.rotation.rotate(direction)
    }

    #[inline]
    fn dot(a: &Vector2<f64>, b: &Vector2<f64>) -> f64 {
        a.dot(b)
    }

    #[inline]
    fn directions(n: &Vector2<f64>) -> [Vector2<f64>; 2] {
        [*n, quarter(*n)]
    }

    #[inline]
    fn translation(motion: &PlanarMotion) -> Vector2<f64> {
        motion.translation
    }

    #[inline]
    fn frame(motion: &PlanarMotion) -> PlanarRotation {
        motion.rotation
    }

    #[inline]
    fn rotate(frame: &PlanarRotation, direction: &Vector2<f64>) -> Vector2<f64> {
        frame.rotate(direction)
    }

    #[inline]
    fn rotate_back(frame: &PlanarRotation, direction: &Vector2<f64>) -> Vector2<f64> {
        frame.rotate_back(direction)
    }

    #[inline]
    fn torque(arm: &Vector2<f64>, force: &Vector2<f64>) -> f64 {
        force.dot(&quarter(*arm))
    }

    #[inline]
    fn swing(spin: &f64, arm: &Vector2<f64>) -> Vector2<f64> {
        quarter(*arm) * *spin
    }

    #[inline]
    fn parts_of_spin(spin: &f64, _: &Vector2<f64>) -> [f64; 2] {
        [*spin, 0.0]
    }

    #[inline]
    fn along_spin(a: &f64, b: &f64) -> f64 {
        a * b
    }

    #[inline]
    fn spin_speed(spin: &f64) -> f64 {
        spin.abs()
    }

    #[inline]
    fn seen_row(arm: &Vector2<f64>, direction: &Vector2<f64>, seen: &Vector2<f64>) -> [f64; 3] {
        [direction.x, direction.y, Self::torque(arm, seen)]
    }

    #[inline]
    fn join(_: &PlanarRotation, linear: &Vector2<f64>, spin: &f64) -> [f64; 3] {
        [linear.x, linear.y, *spin]
    }

    #[inline]
    fn split(_: &PlanarRotation, stored: &[f64; 3]) -> (Vector2<f64>, f64) {
        (Vector2::new(stored[0], stored[1]), stored[2])
    }

    fn scales(metric: &DiagonalMetric<Vec<f64>>) -> Vec<[f64; 3]> {
        let root = |inertia: &[f64]| array(|f| inertia[f].sqrt().recip());
        metric.masses().chunks_exact(3).map(root).collect()
    }

    #[inline]
    fn relative(first: &PlanarMotion, second: &PlanarMotion) -> PlanarMotion {
        PlanarMotion {
            translation: first.rotation.rotate_back(&(second.translation - first.translation)),
            rotation: first.rotation.inverse().compose(&second.rotation),
        }
    }

    #[inline]
    fn apart(first: &PlanarMotion, second: &PlanarMotion) -> [f64; 2] {
        let turned = first.rotation.inverse().compose(&second.rotation).angle();
        [(first.translation - second.translation).norm(), turned.abs()]
    }

    fn numbers(motion: &PlanarMotion) -> [f64; 3] {
        [motion.translation.x, motion.translation.y, motion.rotation.angle()]
    }

    fn advance(
        _metric: &DiagonalMetric<Vec<f64>>,
        q: &mut [f64],
        v: &[f64],
        _p: &mut [f64],
        h: f64,
    ) -> Result<(), ContactError> {
        q.iter_mut().zip(v).for_each(|(q, v)| *q += h * v);
        Ok(())
    }

    #[inline]
    fn convert(pose: &PlanarMotion) -> Pose {
        planar_convert::pose(pose)
    }

    fn name(shape: &PlanarShape) -> &'static str {
        shape.name()
    }

    fn plane(shape: &PlanarShape) -> Option<Vector2<f64>> {
        shape.plane()
    }

    fn reach(shape: &PlanarShape, place: &PlanarMotion) -> f64 {
        let ball = shape.geometry().compute_local_bounding_sphere();
        place.apply(&planar_convert::from_vector(ball.center)).norm() + ball.radius
    }

    fn walked(motion: &PlanarMotion, velocity: &[f64; 3], time: f64) -> PlanarMotion {
        let [x, y, angle] = velocity.map(|v| v * time);
        PlanarMotion {
            translation: motion.translation + Vector2::new(x, y),
            rotation: motion.rotation.compose(&PlanarRotation::exp(angle)),
        }
    }

    fn closest(
        shapes: [&PlanarShape; 2],
        parts: [u32; 2],
        poses: [&Pose; 2],
        _: &mut (),
        found: &mut Vec<Facing<Vector2<f64>>>,
    ) -> Option<Closest<Vector2<f64>>> {
        use parry2d_f64::query::{ClosestPoints, closest_points};
        let at = |pose: &Pose, point: Vector2<f64>| {
            planar_convert::from_vector(*pose * planar_convert::vector(&point))
        };
        if facing_parts(shapes, parts, &poses[0].inv_mul(poses[1]), found) {
            let nearest = found.iter().min_by(|a, b| a.gap.total_cmp(&b.gap))?;
            let [x1, x2] = nearest.points;
            let normal = poses[0].rotation * planar_convert::vector(&nearest.normal);
            return (nearest.gap > 0.0).then(|| Closest {
                points: [at(poses[0], x1), at(poses[1], x2)],
                normal: Some(planar_convert::from_vector(normal)),
                distance: nearest.gap,
            });
        }
        let [a, b] = [0, 1].map(|k| part(shapes[k], parts[k]));
        match closest_points(poses[0], a, poses[1], b, f64::MAX) {
            Ok(ClosestPoints::WithinMargin(first, second)) => {
                let points = [first, second].map(planar_convert::from_vector);
                let distance = (points[1] - points[0]).norm();
                Some(Closest { points, normal: None, distance })
            }
            _ => None,
        }
    }

    fn farthest(shape: &PlanarShape, number: u32, direction: &Vector2<f64>) -> f64 {
        if let Some(normal) = shape.plane() {
            return farthest_of_plane(direction.norm(), (direction.normalize() - normal).norm());
        }
        let (part, along) = (part(shape, number), planar_convert::vector(direction));
        match (part.as_ball(), part.as_support_map()) {
            (Some(ball), _) => ball.radius * direction.norm(),
            (None, Some(map)) => map.local_support_point(along).dot(along),
            (None, None) => f64::INFINITY,
        }
    }

    fn parts_within(
        shape: &PlanarShape,
        _low: &Vector2<f64>,
        _high: &Vector2<f64>,
        parts: &mut Vec<u32>,
    ) {
        // Polygons have few.
        parts.clear();
        parts.extend(0..shape.convex_pieces().len().max(1) as u32);
    }

    fn has_parts(shape: &PlanarShape) -> bool {
        shape.convex_pieces().len() > 1
    }

    fn middle(shape: &PlanarShape, part: u32) -> Vector2<f64> {
        planar_convert::from_vector(match shape.convex_pieces().get(part as usize) {
            Some(piece) => {
                let corners = piece.points();
                corners.iter().sum::<parry2d_f64::math::Vector>() / corners.len() as f64
            }
            None => shape.geometry().compute_local_aabb().center(),
        })
    }

    fn nearest(shape: &PlanarShape, point: &Vector2<f64>) -> Vector2<f64> {
        let there = shape.geometry().project_local_point(planar_convert::vector(point), true);
        planar_convert::from_vector(there.point)
    }

    fn cast(
        shape: &PlanarShape,
        start: &Vector2<f64>,
        direction: &Vector2<f64>,
        longest: f64,
    ) -> Option<(f64, Vector2<f64>)> {
        use parry2d_f64::query::{Ray, RayCast};
        let (o, d) = (planar_convert::vector(start), planar_convert::vector(direction));
        let mut first: Option<(f64, Vector2<f64>)> = None;
        let mut offer = |t: f64, n: Option<Vector2<f64>>| {
            if first.is_none_or(|(least, _)| t < least) {
                first = Some((t, n.filter(|_| t > 0.0).unwrap_or(-direction)));
            }
        };
        let round = shape.rounding();
        for core in shape.cores() {
            // Of a capsule the two long sides, and its ends as planes: the discs there follow.
            let (points, normals) = (core.points(), core.normals());
            let sides = (0..normals.len()).map(|k| [points[k] + normals[k] * round, normals[k]]);
            let planes: Vec<_> = match points {
                [from, to] => sides.chain([[*from, *from - *to], [*to, *to - *from]]).collect(),
                _ => sides.collect(),
            };
            let cut = planes.iter().map(|[a, n]| [n.dot(d), n.dot(o - *a)]);
            if points.len() > 1
                && let Some((t, face)) = entrance(cut, longest)
            {
                let normal = |k: usize| planar_convert::from_vector(planes[k][1]).normalize();
                offer(t, face.map(normal));
            }
            let ends = points.iter().filter(|_| round > 0.0);
            for end in ends {
                let disc = parry2d_f64::shape::Ball::new(round);
                // From beside it on, where places have the digits that their squares need.
                let ahead = beside((o - *end).dot(d), round);
                let ray = Ray::new(o - *end + d * ahead, d);
                let rest = longest - ahead;
                if let Some(hit) = disc.cast_local_ray_and_get_normal(&ray, rest, true) {
                    offer(
                        ahead + hit.time_of_impact,
                        Some(planar_convert::from_vector(hit.normal)),
                    );
                }
            }
        }
        if shape.cores().is_empty()
            && let Some(hit) =
                shape.geometry().cast_local_ray_and_get_normal(&Ray::new(o, d), longest, true)
        {
            offer(hit.time_of_impact, Some(planar_convert::from_vector(hit.normal)));
        }
        first
    }

    fn face(
        shapes: [&PlanarShape; 2],
        poses: [&Pose; 2],
        margin: f64,
        _: &mut (),
        found: &mut Vec<Facing<Vector2<f64>>>,
    ) -> Answer {
        facing(shapes, &poses[0].inv_mul(poses[1]), margin, found)
    }
}

/// A convex part of a shape, as the geometry library has it.
fn part(shape: &PlanarShape, number: u32) -> &dyn parry2d_f64::shape::Shape {
    match shape.convex_pieces().get(number as usize) {
        Some(piece) => piece,
        None => &**shape.geometry(),
    }
}
