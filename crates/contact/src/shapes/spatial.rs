//! Space: bodies with poses, and what their points do.
//!
//! ```text
//! f.x. = (f, c x R^T f) (t., omega),     x. = t. + R (omega x c)                          (10.1)
//! ```
//! See [`Dimension`]. Free motion turns bodies by the variational rotation of 9.5, which keeps
//! their angular momentum.

use nalgebra::{Matrix3, Vector3};
use parry3d_f64::bounding_volume::Aabb;
use parry3d_f64::math::Pose;
use stationary_rigid::{
    Body, BodyMetric, BodySpace, ConstantVelocity, FreeRotation, LieGroup, Poses, RigidMotion,
    Rotation,
};

use crate::detect::facing_points::closest_points;
use crate::detect::narrow_phase::{Manifolds, facing, facing_polytopes};
use crate::detect::ray::{beside, entrance, on_round};
use crate::error::check_finite;
use crate::shapes::convert;
use crate::shapes::dimension::{Answer, Closest, Facing, farthest_of_plane, sealed::Sealed};
use crate::shapes::polytope::Polytope;
use crate::shapes::solid::{Placed, Solid};
use crate::solve::island_solver::IslandSolver;
use crate::{ContactError, Dimension, Shape};

/// The angle of a turn at once, rad: its equation has a solution of its own below pi. What turns
/// farther in a step does so in parts, with the same angular momentum.
const TURN: f64 = 1.5;
/// The most parts of a step's turn.
const MOST_TURNS: f64 = 1e4;

/// Space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Spatial;

impl Sealed for Spatial {}

impl Dimension for Spatial {
    type Vector = Vector3<f64>;
    type Motion = RigidMotion;
    type Shape = Shape;
    type Metric = BodyMetric<Poses>;
    type Space = Poses;
    type Directions = [Vector3<f64>; 3];
    type Stored = [f64; 7];
    type Velocity = [f64; 6];
    type Spin = Vector3<f64>;
    type Frame = Matrix3<f64>;
    type Pose = Pose;
    type Tree = crate::detect::broad_phase::SpatialTree;
    type Room = Manifolds;
    type Solver = IslandSolver<Vector3<f64>, 6, 3>;

    const TRANSLATION: usize = 3;
    const FREEDOMS: usize = 6;
    const STORED: usize = 7;

    #[inline]
    fn pose(q: &[f64], body: usize) -> RigidMotion {
        Poses::pose_at(q, body)
    }

    #[inline]
    fn check(q: &[f64]) -> Result<(), ContactError> {
        Ok(Poses::check(q)?)
    }

    fn check_place(place: &RigidMotion) -> Result<(), ContactError> {
        check_finite("the place of a collider", place.translation.as_slice())?;
        check_finite("the quaternion of a collider", &place.rotation.quaternion())
    }

    #[inline]
    fn apply(pose: &RigidMotion, point: &Vector3<f64>) -> Vector3<f64> {
        pose.apply(point)
    }

    #[inline]
    fn turn(pose: &RigidMotion, direction: &Vector3<f64>) -> Vector3<f64> {
        pose.rotation.rotate(direction)
    }

    #[inline]
    fn dot(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
        a.dot(b)
    }

    #[inline]
    fn directions(n: &Vector3<f64>) -> [Vector3<f64>; 3] {
        let axis = Vector3::ith(n.iamin(), 1.0);
        let first = n.cross(&axis).normalize();
        [*n, first, n.cross(&first)]
    }

    #[inline]
    fn translation(motion: &RigidMotion) -> Vector3<f64> {
        motion.translation
    }

    #[inline]
    fn frame(motion: &RigidMotion) -> Matrix3<f64> {
        motion.rotation.matrix()
    }

    #[inline]
    fn rotate(frame: &Matrix3<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
        frame * direction
    }

    #[inline]
    fn rotate_back(frame: &Matrix3<f64>, direction: &Vector3<f64>) -> Vector3<f64> {
        frame.tr_mul(direction)
    }

    #[inline]
    fn torque(arm: &Vector3<f64>, force: &Vector3<f64>) -> Vector3<f64> {
        arm.cross(force)
    }

    #[inline]
    fn swing(spin: &Vector3<f64>, arm: &Vector3<f64>) -> Vector3<f64> {
        spin.cross(arm)
    }

    #[inline]
    fn parts_of_spin(spin: &Vector3<f64>, normal: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let torsion = normal * normal.dot(spin);
        let across = spin - torsion;
        // Of a small part of a spin that is left by it, rounding is no small part.
        [across - normal * normal.dot(&across), torsion]
    }

    #[inline]
    fn along_spin(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
        a.dot(b)
    }

    #[inline]
    fn spin_speed(spin: &Vector3<f64>) -> f64 {
        spin.norm()
    }

    #[inline]
    fn seen_row(arm: &Vector3<f64>, direction: &Vector3<f64>, seen: &Vector3<f64>) -> [f64; 6] {
        let spin = arm.cross(seen);
        [direction.x, direction.y, direction.z, spin.x, spin.y, spin.z]
    }

    #[inline]
    fn join(frame: &Matrix3<f64>, linear: &Vector3<f64>, spin: &Vector3<f64>) -> [f64; 6] {
        let spin = frame.tr_mul(spin);
        [linear.x, linear.y, linear.z, spin.x, spin.y, spin.z]
    }

    #[inline]
    fn split(frame: &Matrix3<f64>, stored: &[f64; 6]) -> (Vector3<f64>, Vector3<f64>) {
        let [x, y, z, a, b, c] = *stored;
        (Vector3::new(x, y, z), frame * Vector3::new(a, b, c))
    }

    fn scales(metric: &BodyMetric<Poses>) -> Vec<[f64; 6]> {
        let root = |inertia: f64| inertia.sqrt().recip();
        let of = |body: &Body| {
            let (mass, moments) = (root(body.mass()), body.moments().map(root));
            [mass, mass, mass, moments.x, moments.y, moments.z]
        };
        metric.bodies().iter().map(of).collect()
    }

    #[inline]
    fn relative(first: &RigidMotion, second: &RigidMotion) -> RigidMotion {
        let apart = second.translation - first.translation;
        RigidMotion {
            translation: first.rotation.rotate_back(&apart),
            rotation: first.rotation.inverse().compose(&second.rotation),
        }
    }

    #[inline]
    fn apart(first: &RigidMotion, second: &RigidMotion) -> [f64; 2] {
        let [a, b] = [first, second].map(|motion| motion.rotation.quaternion());
        let turned: f64 = a.iter().zip(&b).map(|(a, b)| (a - b) * (a - b)).sum();
        // A quaternion turns by half the angle.
        [(first.translation - second.translation).norm(), 2.0 * turned.sqrt()]
    }

    fn numbers(motion: &RigidMotion) -> [f64; 7] {
        let (t, [w, x, y, z]) = (motion.translation, motion.rotation.quaternion());
        [t.x, t.y, t.z, w, x, y, z]
    }

    fn advance(
        metric: &BodyMetric<Poses>,
        q: &mut [f64],
        v: &[f64],
        p: &mut [f64],
        h: f64,
    ) -> Result<(), ContactError> {
        for (i, body) in metric.bodies().iter().enumerate() {
            let rotation = Poses::pose_at(q, i).rotation;
            let (q, p) = (&mut q[7 * i..][..7], &mut p[6 * i..][..6]);
            let mut momentum = Vector3::new(p[3], p[4], p[5]);
            let mut rotation = rotation;
            // No velocity of the same energy is faster than this.
            let moments = body.moments();
            let fastest = (momentum.dot(&body.angular_velocity(&momentum)) / moments.min()).sqrt();
            let turns = (h * fastest / TURN).ceil().max(1.0);
            if turns > MOST_TURNS {
                return Err(ContactError::Turn { body: i, angle: h * fastest });
            }
            for _ in 0..turns as usize {
                let turned = ConstantVelocity::turn(body, rotation, momentum, h / turns)?;
                (rotation, momentum) = (turned.rotation, turned.momentum);
            }
            q.iter_mut().zip(&v[6 * i..][..3]).for_each(|(q, v)| *q += h * v);
            q[3..].copy_from_slice(&rotation.quaternion());
            p[3..].copy_from_slice(momentum.as_slice());
        }
        Ok(())
    }

    #[inline]
    fn convert(pose: &RigidMotion) -> Pose {
        convert::pose(pose)
    }

    fn name(shape: &Shape) -> &'static str {
        shape.name()
    }

    fn plane(shape: &Shape) -> Option<Vector3<f64>> {
        shape.plane()
    }

    fn reach(shape: &Shape, place: &RigidMotion) -> f64 {
        let ball = shape.geometry().compute_local_bounding_sphere();
        place.apply(&convert::from_vector(ball.center)).norm() + ball.radius
    }

    fn walked(motion: &RigidMotion, velocity: &[f64; 6], time: f64) -> RigidMotion {
        let [x, y, z, a, b, c] = velocity.map(|v| v * time);
        RigidMotion {
            translation: motion.translation + Vector3::new(x, y, z),
            rotation: motion.rotation.compose(&Rotation::exp(Vector3::new(a, b, c))),
        }
    }

    fn closest(
        shapes: [&Shape; 2],
        parts: [u32; 2],
        poses: [&Pose; 2],
        room: &mut Manifolds,
        found: &mut Vec<Facing<Vector3<f64>>>,
    ) -> Option<Closest<Vector3<f64>>> {
        use parry3d_f64::query::{ClosestPoints, closest_points};
        let at =
            |pose: &Pose, point: Vector3<f64>| convert::from_vector(pose * convert::vector(&point));
        let relative = poses[0].inv_mul(poses[1]);
        if facing_polytopes(shapes, parts, &relative, room, found) {
            let nearest = found.iter().min_by(|a, b| a.gap.total_cmp(&b.gap))?;
            let [x1, x2] = nearest.points;
            let normal = poses[0].rotation * convert::vector(&nearest.normal);
            return (nearest.gap > 0.0).then(|| Closest {
                points: [at(poses[0], x1), at(poses[1], x2)],
                normal: Some(convert::from_vector(normal)),
                distance: nearest.gap,
            });
        }
        let apart = |points: [Vector3<f64>; 2]| Closest {
            points,
            normal: None,
            distance: (points[1] - points[0]).norm(),
        };
        // The library's search along simplices takes small hulls and triangles that are apart for ones that meet.
        let searched = |shape: &Shape| {
            shape.curved().is_some() || shape.geometry().as_convex_polyhedron().is_some()
        };
        let meshes = shapes.iter().all(|shape| shape.geometry().as_trimesh().is_some());
        if meshes || shapes.iter().any(|shape| searched(shape)) {
            return closest_of_solids(shapes, parts, poses).map(apart);
        }
        let found = with_part(shapes[0], parts[0], |a| {
            with_part(shapes[1], parts[1], |b| closest_points(poses[0], a, poses[1], b, f64::MAX))
        });
        match found {
            Ok(ClosestPoints::WithinMargin(first, second)) => {
                Some(apart([first, second].map(convert::from_vector)))
            }
            _ => None,
        }
    }

    fn farthest(shape: &Shape, part: u32, direction: &Vector3<f64>) -> f64 {
        if let Some(normal) = shape.plane() {
            return farthest_of_plane(direction.norm(), (direction.normalize() - normal).norm());
        }
        if let Some(solid) = shape.solid() {
            return solid.reach(direction);
        }
        let along = convert::vector(direction);
        with_part(shape, part, |part| match (part.as_ball(), part.as_support_map()) {
            (Some(ball), _) => ball.radius * direction.norm(),
            (None, Some(map)) => map.local_support_point(along).dot(along),
            (None, None) => f64::INFINITY,
        })
    }

    fn parts_within(shape: &Shape, low: &Vector3<f64>, high: &Vector3<f64>, parts: &mut Vec<u32>) {
        parts.clear();
        match shape.geometry().as_trimesh() {
            Some(mesh) => {
                let within = Aabb::new(convert::vector(low), convert::vector(high));
                parts.extend(mesh.bvh().intersect_aabb(&within));
            }
            None => parts.push(0),
        }
    }

    fn has_parts(shape: &Shape) -> bool {
        shape.geometry().as_composite_shape().is_some()
    }

    fn middle(shape: &Shape, part: u32) -> Vector3<f64> {
        convert::from_vector(match shape.geometry().as_trimesh() {
            Some(mesh) => mesh.triangle(part).center(),
            None => shape.geometry().compute_local_aabb().center(),
        })
    }

    fn nearest(shape: &Shape, point: &Vector3<f64>) -> Vector3<f64> {
        if let Some(solid) = shape.curved() {
            return nearest_on(solid, point);
        }
        let there = shape.geometry().project_local_point(convert::vector(point), true);
        convert::from_vector(there.point)
    }

    fn cast(
        shape: &Shape,
        start: &Vector3<f64>,
        direction: &Vector3<f64>,
        longest: f64,
    ) -> Option<(f64, Vector3<f64>)> {
        use parry3d_f64::query::Ray;
        if let Some(solid) = shape.polytope() {
            let plane = |f: usize| {
                let n = solid.faces[f].normal;
                [n.dot(direction), n.dot(&(start - solid.corners[solid.around(f)[0]]))]
            };
            let (t, face) = entrance((0..solid.faces.len()).map(plane), longest)?;
            return Some((t, face.map_or(-direction, |f| solid.faces[f].normal)));
        }
        if let Some(solid) = shape.curved() {
            return on_round(solid, start, direction, longest);
        }
        // Of a ball from beside it on; what else there is has flat faces, which lose nothing.
        let ball = shape.ball_radius();
        let ahead = ball.map_or(0.0, |radius| beside(start.dot(direction), radius));
        let near = start + direction * ahead;
        let ray = Ray::new(convert::vector(&near), convert::vector(direction));
        let rest = longest - ahead;
        let hit = shape.geometry().cast_local_ray_and_get_normal(&ray, rest, true)?;
        let normal = convert::from_vector(hit.normal);
        // A mesh has no inside: its normal looks against the ray.
        let against = if normal.dot(direction) > 0.0 { -normal } else { normal };
        let distance = ahead + hit.time_of_impact;
        let inside = distance == 0.0;
        Some((distance, if inside { -direction } else { against }))
    }

    fn face(
        shapes: [&Shape; 2],
        poses: [&Pose; 2],
        margin: f64,
        room: &mut Manifolds,
        found: &mut Vec<Facing<Vector3<f64>>>,
    ) -> Answer {
        facing(shapes, &poses[0].inv_mul(poses[1]), margin, room, found)
    }
}

/// The closest points of two convex parts, at most one of them a plane, world axes; none where they overlap.
fn closest_of_solids(
    shapes: [&Shape; 2],
    parts: [u32; 2],
    poses: [&Pose; 2],
) -> Option<[Vector3<f64>; 2]> {
    let at =
        |pose: &Pose, point: Vector3<f64>| convert::from_vector(pose * convert::vector(&point));
    if let Some(side) = shapes.iter().position(|shape| shape.plane().is_some()) {
        let (normal, solid) = (shapes[side].plane()?, shapes[1 - side].solid()?);
        let mut placed = Placed::default();
        solid.place(&poses[side].inv_mul(poses[1 - side]), &mut placed);
        let (part, height) = placed.farthest(&-normal);
        let lowest = placed.parts[part].point(&-normal) - normal * placed.rounding;
        let gap = -height - placed.rounding;
        let points = [lowest - normal * gap, lowest].map(|point| at(poses[side], point));
        let [below, above] = points;
        return (gap > 0.0).then_some(if side == 0 { [below, above] } else { [above, below] });
    }
    let mut placed = [Placed::default(), Placed::default()];
    let relative = poses[0].inv_mul(poses[1]);
    for (k, place) in [Pose::IDENTITY, relative].iter().enumerate() {
        match (shapes[k].solid(), shapes[k].geometry().as_trimesh()) {
            (Some(solid), _) => solid.place(place, &mut placed[k]),
            (None, Some(mesh)) => {
                let corners = mesh.triangle(parts[k]);
                let mut triangle = Polytope::triangle();
                let corners = [corners.a, corners.b, corners.c].map(convert::from_vector);
                triangle.set_triangle(corners);
                Solid::polytope(&triangle).place(place, &mut placed[k]);
            }
            (None, None) => return None,
        }
    }
    let [first, second] = &placed;
    Some(closest_points([first, second])?.map(|point| at(poses[0], point)))
}

/// The point of a solid that is closest to a point, which it is where the solid holds it.
fn nearest_on(solid: &Solid, point: &Vector3<f64>) -> Vector3<f64> {
    let mut placed = [Placed::default(), Placed::default()];
    solid.place(&Pose::IDENTITY, &mut placed[0]);
    let there = Pose::from_translation(convert::vector(point));
    Solid::ball(0.0).place(&there, &mut placed[1]);
    closest_points([&placed[0], &placed[1]]).map_or(*point, |[nearest, _]| nearest)
}

/// A convex part of a shape, as the geometry library has it.
fn with_part<T>(
    shape: &Shape,
    part: u32,
    see: impl FnOnce(&dyn parry3d_f64::shape::Shape) -> T,
) -> T {
    match shape.geometry().as_trimesh() {
        Some(mesh) => see(&mesh.triangle(part)),
        None => see(&**shape.geometry()),
    }
}
