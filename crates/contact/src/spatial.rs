//! Space: bodies with poses, and what their points do.
//!
//! ```text
//! f.x. = (f, c x R^T f) (t., omega),     x. = t. + R (omega x c)                          (10.1)
//! ```
//! See [`Dimension`]. Free motion turns bodies by the variational rotation of 9.5, which keeps
//! their angular momentum.

use nalgebra::Vector3;
use parry3d_f64::math::Pose;
use stationary_rigid::{
    BodyMetric, BodySpace, ConstantVelocity, FreeRotation, Poses, RigidMotion, force_at_point,
};

use crate::dimension::{Answer, Facing, sealed::Sealed};
use crate::error::check_finite;
use crate::narrow_phase::{Manifolds, facing};
use crate::{ContactError, Dimension, Shape, convert};

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
    type Across = [Vector3<f64>; 2];
    type Row = [f64; 6];
    type Pose = Pose;
    type Tree = crate::broad_phase::SpatialTree;
    type Room = Manifolds;

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
    fn across(n: &Vector3<f64>) -> [Vector3<f64>; 2] {
        let axis = Vector3::ith(n.iamin(), 1.0);
        let first = n.cross(&axis).normalize();
        [first, n.cross(&first)]
    }

    #[inline]
    fn row(q: &[f64], body: usize, arm: &Vector3<f64>, direction: &Vector3<f64>) -> [f64; 6] {
        let wrench = force_at_point(&Poses::pose_at(q, body), arm, *direction);
        let (f, t) = (wrench.force, wrench.torque);
        [f.x, f.y, f.z, t.x, t.y, t.z]
    }

    #[inline]
    fn velocity(q: &[f64], v: &[f64], body: usize, arm: &Vector3<f64>) -> Vector3<f64> {
        let v = &v[6 * body..][..6];
        let turning = Vector3::new(v[3], v[4], v[5]).cross(arm);
        Vector3::new(v[0], v[1], v[2]) + Poses::pose_at(q, body).rotation.rotate(&turning)
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
            let momentum = Vector3::new(p[3], p[4], p[5]);
            let turned = ConstantVelocity::turn(body, rotation, momentum, h)?;
            q.iter_mut().zip(&v[6 * i..][..3]).for_each(|(q, v)| *q += h * v);
            q[3..].copy_from_slice(&turned.rotation.quaternion());
            p[3..].copy_from_slice(turned.momentum.as_slice());
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
