//! What acts on bodies and no potential gives: dampers, actuators, motors, loads.
//!
//! ```text
//! between points   f(t, l, l') u on end 2, -f u on end 1       l = |x_2 - x_1|,  u along it     N
//! about an axis    m(t, a, a') n on end 2, -m n on end 1       a the turn of end 2 about n    N m
//! at a point       F(t, x, x')                                 x = T + R c                      N
//! on a body        m(t, R, w)                                  w the angular velocity         N m
//! F(q, v) = sum J^T f,      power = <F, u> = sum f J u         virtual work                (10.1.2)
//! ```
//! `x R w` in world axes, `c` in body axes; seconds, metres, radians. Laws are functions of time, place
//! and velocity; a damper is the law `-c l'`, a motor by torque a constant, one by speed `c (w - a')` with
//! a torque as large as it needs, or a [`Drive`](crate::Drive). A turn is known up to whole ones: `a`
//! lies within half a turn of zero. Where points meet, the line between them is that of their relative
//! velocity.
//!
//! What acts between two bodies adds nothing to their momenta. Each thing has a work of its own, under
//! the number that adding it returned. How a law changes with velocity, which implicit kicks need to
//! converge fast, is a difference of two of its values. Source: notes 10.1.

use std::fmt;
use std::marker::PhantomData;
use std::sync::Arc;

use nalgebra::{Matrix3, SMatrix, SVector, Vector1, Vector3};
use stationary_calculus::{Covector, Force, Sink, Vector};

use crate::body_spring::Attachment;
use crate::error::check_finite;
use crate::joint::{Local, Placed, along, pair_freedoms, unit};
use crate::point_force::{add_wrench, force_at_point};
use crate::space::pose_or_none;
use crate::{BodySpace, JointEnd, JointName, LieGroup, RigidError, RigidMotion, Rotation, Wrench};

/// A force along a line or a torque about an axis, of time, coordinate and rate.
type Law = Arc<dyn Fn(f64, f64, f64) -> f64 + Send + Sync>;
/// A force of time, place and velocity.
type PlaceLaw = Arc<dyn Fn(f64, Vector3<f64>, Vector3<f64>) -> Vector3<f64> + Send + Sync>;
/// A torque of time, orientation and angular velocity.
type TurnLaw = Arc<dyn Fn(f64, Rotation, Vector3<f64>) -> Vector3<f64> + Send + Sync>;

#[derive(Clone)]
enum Acting {
    Line { ends: [Attachment; 2], law: Law },
    Axis { ends: [JointEnd; 2], axes: [Vector3<f64>; 4], law: Law },
    Point { body: usize, point: Vector3<f64>, law: PlaceLaw },
    Turn { body: usize, law: TurnLaw },
}

/// A velocity is moved by this part of itself to see how a law changes, or by this part of one unit where it is
/// zero or nothing is seen.
const DIFFERENCE: f64 = 1e-6;
/// A change of a law by less than this part of it may be rounding.
const SEEN: f64 = 1e-8;
/// How much farther a velocity is moved where the change may be rounding.
const FARTHER: f64 = 1e3;

/// Things that act on bodies: a [`Force`] of their poses and velocities.
#[derive(Clone)]
pub struct BodyForces<S> {
    bodies: usize,
    acting: Vec<Acting>,
    space: PhantomData<S>,
}

impl<S> fmt::Debug for BodyForces<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "BodyForces({} things on {} bodies)", self.acting.len(), self.bodies)
    }
}

/// A body's velocity: that of its centre (world axes) and the angular one (body axes).
#[derive(Clone, Copy)]
struct Velocity {
    linear: Vector3<f64>,
    angular: Vector3<f64>,
}

impl Velocity {
    /// No numbers of a body that `v` does not hold.
    fn of<S: BodySpace>(v: &[f64], body: usize) -> Self {
        let own = v.get(S::FREEDOMS.saturating_mul(body)..).and_then(|v| v.get(..S::FREEDOMS));
        let Some(v) = own else {
            let none = Vector3::repeat(f64::NAN);
            return Velocity { linear: none, angular: none };
        };
        let linear = if S::TRANSLATION == 0 { Vector3::zeros() } else { three(v) };
        Velocity { linear, angular: three(&v[S::TRANSLATION..]) }
    }

    fn power(&self, wrench: &Wrench) -> f64 {
        wrench.force.dot(&self.linear) + wrench.torque.dot(&self.angular)
    }

    fn at(&self, pose: &RigidMotion, point: &Vector3<f64>) -> Vector3<f64> {
        self.linear + pose.rotation.rotate(&self.angular.cross(point))
    }
}

fn three(v: &[f64]) -> Vector3<f64> {
    Vector3::new(v[0], v[1], v[2])
}

/// A coordinate between two ends: its value, and what a unit of its force does to their bodies.
struct Coordinate {
    bodies: [Option<usize>; 2],
    value: f64,
    wrenches: [Wrench; 2],
}

impl Coordinate {
    fn rate<S: BodySpace>(&self, v: &[f64]) -> f64 {
        let power = |(body, wrench): (&Option<usize>, &Wrench)| {
            body.map_or(0.0, |body| Velocity::of::<S>(v, body).power(wrench))
        };
        self.bodies.iter().zip(&self.wrenches).map(power).sum()
    }

    fn line<S: BodySpace>(ends: &[Attachment; 2], q: &[f64], v: &[f64]) -> Self {
        let poses = ends.map(|end| match end {
            Attachment::World(_) => None,
            Attachment::Body(body, _) => Some((body, pose_or_none::<S>(q, body))),
        });
        let places = [0, 1].map(|k: usize| {
            let c = ends[k].vector();
            poses[k].map_or(c, |(_, pose)| pose.apply(&c))
        });
        let apart = places[1] - places[0];
        let (value, unit) = match apart.norm() {
            0.0 => {
                let moving = [0, 1].map(|k: usize| {
                    poses[k].map_or_else(Vector3::zeros, |(body, pose)| {
                        Velocity::of::<S>(v, body).at(&pose, &ends[k].vector())
                    })
                });
                let moved = moving[1] - moving[0];
                (0.0, moved.try_normalize(0.0).unwrap_or_else(Vector3::zeros))
            }
            length => (length, apart / length),
        };
        let wrench = |k: usize, force: Vector3<f64>| match poses[k] {
            Some((_, pose)) => force_at_point(&pose, &ends[k].vector(), force),
            None => Wrench { force, torque: Vector3::zeros() },
        };
        Coordinate {
            bodies: poses.map(|pose| pose.map(|(body, _)| body)),
            value,
            wrenches: [wrench(0, -unit), wrench(1, unit)],
        }
    }

    fn axis<S: BodySpace>(ends: &[JointEnd; 2], axes: &[Vector3<f64>; 4], q: &[f64]) -> Self {
        let [one, other]: [Placed; 2] = ends.each_ref().map(|end| end.placed_or_none::<S>(q));
        let [u, v, n, second] = axes;
        let seen = one.rotation.tr_mul(&(other.rotation * second));
        let turn = |torque| Wrench { force: Vector3::zeros(), torque };
        let axis = other.rotation.tr_mul(&(one.rotation * n));
        Coordinate {
            bodies: ends.map(|end| end.body),
            value: v.dot(&seen).atan2(u.dot(&seen)),
            wrenches: [turn(-n), turn(axis)],
        }
    }
}

impl<S: BodySpace> BodyForces<S> {
    /// Nothing yet, on this many bodies.
    pub fn new(_space: S, bodies: usize) -> Self {
        BodyForces { bodies, acting: Vec::new(), space: PhantomData }
    }

    fn add(&mut self, acting: Acting) -> usize {
        self.acting.push(acting);
        self.acting.len() - 1
    }

    fn check_body(&self, body: usize) -> Result<(), RigidError> {
        let bodies = self.bodies;
        if body < bodies { Ok(()) } else { Err(RigidError::NoSuchBody { body, bodies }) }
    }

    /// Adds a force between two points, N, which pushes them apart where it is positive: of time,
    /// distance and its rate. Returns the number of its work.
    ///
    /// # Errors
    /// A body that is not there, a point that is not finite.
    pub fn between_points(
        &mut self,
        ends: [Attachment; 2],
        law: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static,
    ) -> Result<usize, RigidError> {
        for end in &ends {
            check_finite("the force's point", end.vector().as_slice())?;
            end.check_body(self.bodies)?;
        }
        Ok(self.add(Acting::Line { ends, law: Arc::new(law) }))
    }

    /// Adds a torque about an axis of the ends, N m, on the second end and against the first: of time,
    /// turn and its rate. Returns the number of its work.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the motor and what is wrong with its ends or its axis.
    pub fn about_axis(
        &mut self,
        ends: [JointEnd; 2],
        axis: Vector3<f64>,
        law: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static,
    ) -> Result<usize, RigidError> {
        let joint = JointName { kind: "motor", bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        JointEnd::check_pair(&ends, self.bodies).map_err(fault)?;
        let axes = crate::joint::triad(&unit(axis).map_err(fault)?);
        let [u, v, n] = axes.map(|axis| ends[0].frame.rotation.rotate(&axis));
        let second = ends[1].frame.rotation.rotate(&axes[0]);
        Ok(self.add(Acting::Axis { ends, axes: [u, v, n, second], law: Arc::new(law) }))
    }

    /// Adds a force at a point of a body (m, body axes): of time, place and velocity of the point, all
    /// in world axes. Returns the number of its work.
    ///
    /// # Errors
    /// A body that is not there, a point that is not finite.
    pub fn at_point(
        &mut self,
        body: usize,
        point: Vector3<f64>,
        law: impl Fn(f64, Vector3<f64>, Vector3<f64>) -> Vector3<f64> + Send + Sync + 'static,
    ) -> Result<usize, RigidError> {
        check_finite("the force's point", point.as_slice())?;
        self.check_body(body)?;
        Ok(self.add(Acting::Point { body, point, law: Arc::new(law) }))
    }

    /// Adds a torque on a body (N m, world axes): of time, orientation and angular velocity (world
    /// axes). Returns the number of its work.
    ///
    /// # Errors
    /// A body that is not there.
    pub fn on_body(
        &mut self,
        body: usize,
        law: impl Fn(f64, Rotation, Vector3<f64>) -> Vector3<f64> + Send + Sync + 'static,
    ) -> Result<usize, RigidError> {
        self.check_body(body)?;
        Ok(self.add(Acting::Turn { body, law: Arc::new(law) }))
    }

    /// What one thing does to the bodies that it acts on.
    fn wrenches(
        &self,
        acting: &Acting,
        t: f64,
        q: &[f64],
        v: &[f64],
    ) -> ([Option<usize>; 2], [Wrench; 2]) {
        let scaled = |coordinate: Coordinate, law: &Law| {
            let force = law(t, coordinate.value, coordinate.rate::<S>(v));
            let wrenches = coordinate
                .wrenches
                .map(|w| Wrench { force: w.force * force, torque: w.torque * force });
            (coordinate.bodies, wrenches)
        };
        let nothing = Wrench { force: Vector3::zeros(), torque: Vector3::zeros() };
        match acting {
            Acting::Line { ends, law } => scaled(Coordinate::line::<S>(ends, q, v), law),
            Acting::Axis { ends, axes, law } => scaled(Coordinate::axis::<S>(ends, axes, q), law),
            Acting::Point { body, point, law } => {
                let (pose, moving) = (pose_or_none::<S>(q, *body), Velocity::of::<S>(v, *body));
                let force = law(t, pose.apply(point), moving.at(&pose, point));
                ([Some(*body), None], [force_at_point(&pose, point, force), nothing])
            }
            Acting::Turn { body, law } => {
                let rotation = pose_or_none::<S>(q, *body).rotation;
                let w = rotation.rotate(&Velocity::of::<S>(v, *body).angular);
                let torque = rotation.rotate_back(&law(t, rotation, w));
                let wrench = Wrench { force: Vector3::zeros(), torque };
                ([Some(*body), None], [wrench, nothing])
            }
        }
    }

    fn add_damping_of(
        &self,
        acting: &Acting,
        (t, q, v): (f64, &[f64], &[f64]),
        damping: &mut impl Sink,
    ) {
        let (bodies, block) = match acting {
            Acting::Line { law, .. } | Acting::Axis { law, .. } => {
                let coordinate = match acting {
                    Acting::Line { ends, .. } => Coordinate::line::<S>(ends, q, v),
                    Acting::Axis { ends, axes, .. } => Coordinate::axis::<S>(ends, axes, q),
                    Acting::Point { .. } | Acting::Turn { .. } => return,
                };
                let rate = coordinate.rate::<S>(v);
                let law = |e| Vector1::new(law(t, coordinate.value, rate + e));
                let along = along(&coordinate.wrenches);
                (coordinate.bodies, along * along.transpose() * against(law, rate.abs()).x)
            }
            Acting::Point { body, point, law } => {
                let (pose, moving) = (pose_or_none::<S>(q, *body), Velocity::of::<S>(v, *body));
                let (place, velocity) = (pose.apply(point), moving.at(&pose, point));
                let slope = slope(|v| law(t, place, v), velocity);
                let mut jacobian = SMatrix::<f64, 3, 12>::zeros();
                jacobian.fixed_view_mut::<3, 3>(0, 0).fill_with_identity();
                let turned = -(pose.rotation.matrix() * point.cross_matrix());
                jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&turned);
                ([Some(*body), None], jacobian.transpose() * slope * jacobian)
            }
            Acting::Turn { body, law } => {
                let rotation = pose_or_none::<S>(q, *body).rotation;
                let w = rotation.rotate(&Velocity::of::<S>(v, *body).angular);
                let slope = slope(|w| law(t, rotation, w), w);
                let mut jacobian = SMatrix::<f64, 3, 12>::zeros();
                jacobian.fixed_view_mut::<3, 3>(0, 3).copy_from(&rotation.matrix());
                ([Some(*body), None], jacobian.transpose() * slope * jacobian)
            }
        };
        let block: Local = block;
        damping.add_symmetric(&pair_freedoms::<S>(bodies), block.as_slice());
    }
}

/// Minus the derivative of a law with a velocity that is moved by `e` from one of this size. It is moved by as
/// little as can be seen, so that no unit matters: friction may change within a speed of any size.
fn against<const N: usize>(law: impl Fn(f64) -> SVector<f64, N>, speed: f64) -> SVector<f64, N> {
    let most = DIFFERENCE * (1.0 + speed);
    let least = DIFFERENCE * speed;
    let mut e = if least > 0.0 { least } else { most };
    loop {
        let [ahead, behind] = [law(e), law(-e)];
        let change = behind - ahead;
        let is_seen = change.amax() > SEEN * ahead.amax().max(behind.amax());
        let is_less = e < most;
        if is_seen || !is_less {
            return change / (2.0 * e);
        }
        e = (FARTHER * e).min(most);
    }
}

/// The symmetric part of minus the derivative of a law with velocity.
fn slope(law: impl Fn(Vector3<f64>) -> Vector3<f64>, velocity: Vector3<f64>) -> Matrix3<f64> {
    let column = |k| against(|e| law(velocity + Vector3::ith(k, e)), velocity.amax());
    let slope = Matrix3::from_columns(&[column(0), column(1), column(2)]);
    (slope + slope.transpose()) * 0.5
}

impl<S: BodySpace> Force for BodyForces<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn add_force(&self, t: f64, q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        for acting in &self.acting {
            let (bodies, wrenches) = self.wrenches(acting, t, q, v.0);
            for (&body, wrench) in bodies.iter().zip(&wrenches) {
                add_wrench::<S>(f.0, body, wrench, 1.0);
            }
        }
    }

    fn add_damping(&self, t: f64, q: &[f64], v: Vector<&[f64]>, damping: &mut impl Sink) {
        for acting in &self.acting {
            self.add_damping_of(acting, (t, q, v.0), damping);
        }
    }

    fn works(&self) -> usize {
        self.acting.len()
    }

    fn add_powers(
        &self,
        t: f64,
        q: &[f64],
        v: Vector<&[f64]>,
        u: Vector<&[f64]>,
        powers: &mut [f64],
    ) {
        for (power, acting) in powers.iter_mut().zip(&self.acting) {
            let (bodies, wrenches) = self.wrenches(acting, t, q, v.0);
            for (body, wrench) in bodies.iter().zip(&wrenches) {
                if let Some(body) = body {
                    *power += Velocity::of::<S>(u.0, *body).power(wrench);
                }
            }
        }
    }
}
