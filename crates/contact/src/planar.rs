//! The plane: bodies with a centre and an angle, and what their points do.
//!
//! ```text
//! f.x. = (f, f.Z R c) (t., theta.),     x. = t. + theta. Z R c,     Z a quarter turn       (7.4)
//! ```
//! See [`Dimension`]. The space is flat, so that free motion is exact: centres straight, angles at
//! their rate.

use nalgebra::Vector2;
use parry2d_f64::math::Pose;
use stationary_calculus::{DiagonalMetric, Flat};
use stationary_rigid::{LieGroup, PlanarMotion, PlanarRotation};

use crate::dimension::{Answer, Facing, sealed::Sealed};
use crate::error::check_finite;
use crate::planar_narrow_phase::{Manifolds, facing};
use crate::{ContactError, Dimension, PlanarShape, planar_convert};

/// The plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Planar;

/// A quarter turn.
fn quarter(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// From a body's centre to a point of it, world axes.
#[inline]
fn lever(q: &[f64], body: usize, arm: &Vector2<f64>) -> Vector2<f64> {
    PlanarRotation::exp(q[3 * body + 2]).rotate(arm)
}

impl Sealed for Planar {}

impl Dimension for Planar {
    type Vector = Vector2<f64>;
    type Motion = PlanarMotion;
    type Shape = PlanarShape;
    type Metric = DiagonalMetric<Vec<f64>>;
    type Space = Flat;
    type Across = [Vector2<f64>; 1];
    type Row = [f64; 3];
    type Pose = Pose;
    type Tree = crate::broad_phase::PlanarTree;
    type Room = Manifolds;

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

    fn across(n: &Vector2<f64>) -> [Vector2<f64>; 1] {
        [quarter(*n)]
    }

    #[inline]
    fn row(q: &[f64], body: usize, arm: &Vector2<f64>, f: &Vector2<f64>) -> [f64; 3] {
        [f.x, f.y, f.dot(&quarter(lever(q, body, arm)))]
    }

    #[inline]
    fn velocity(q: &[f64], v: &[f64], body: usize, arm: &Vector2<f64>) -> Vector2<f64> {
        let [x, y, turning] = [0, 1, 2].map(|f| v[3 * body + f]);
        Vector2::new(x, y) + quarter(lever(q, body, arm)) * turning
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

    fn face(
        shapes: [&PlanarShape; 2],
        poses: [&Pose; 2],
        margin: f64,
        room: &mut Manifolds,
        found: &mut Vec<Facing<Vector2<f64>>>,
    ) -> Answer {
        facing(shapes, &poses[0].inv_mul(poses[1]), margin, room, found)
    }
}
