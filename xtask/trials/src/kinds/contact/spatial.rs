//! A scene of space.

use nalgebra::{Matrix3, Quaternion, UnitQuaternion, Vector3};
use stationary_contact::{
    Collider, ContactError, ContactPoint, Detector, Shape, Spatial, SpatialWorld, Touch, World,
    WorldReport,
};
use stationary_integrators::{State, StepError};
use stationary_rigid::{
    Body as RigidBody, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation,
    Weight,
};

use super::case::{Case, Form, Thing};
use super::engine::{Body, Engine, Motion, Seen, law};
use super::hull::Pose;

pub(super) struct Scene {
    world: SpatialWorld<Weight<Poses>>,
    state: State<Vec<f64>>,
    /// How bodies were turned when the last step began.
    frames: Vec<Matrix3<f64>>,
}

fn shape(thing: &Thing) -> Result<Shape, ContactError> {
    let a = thing.half[0];
    match thing.form {
        Form::Round => Shape::ball(a),
        Form::Box => Shape::cuboid(thing.half),
        Form::Simplex => {
            let b = a / 3.0_f64.sqrt();
            let corners = [[b, b, b], [b, -b, -b], [-b, b, -b], [-b, -b, b]];
            Shape::convex(&corners.map(Vector3::from))
        }
    }
}

impl Scene {
    pub(super) fn new(case: &Case) -> Result<Self, ContactError> {
        let (mut colliders, mut bodies, mut motions) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (thing, body)) in case.things.iter().zip(Body::all(case)).enumerate() {
            let collider = Collider::on_body(k, shape(thing)?);
            let collider = collider.with_restitution(thing.restitution);
            colliders.push(collider.with_friction(thing.friction));
            bodies.push(RigidBody::new(body.mass, body.moments.map(|i| i.unwrap_or(f64::NAN)))?);
            let turn = UnitQuaternion::from_scaled_axis(thing.turn);
            let rotation = Rotation::from_quaternion([turn.w, turn.i, turn.j, turn.k])?;
            motions.push(BodyMotion {
                pose: RigidMotion { translation: thing.place, rotation },
                velocity: thing.velocity,
                angular_velocity: turn.inverse() * thing.spin,
            });
        }
        for normal in &case.grounds {
            colliders.push(Collider::fixed(RigidMotion::identity(), Shape::half_space(*normal)?));
        }
        let point = |body: &RigidBody| PointMass { mass: body.mass(), point: Vector3::zeros() };
        let masses = bodies.iter().map(point).collect();
        let weight = Weight { gravity: Vector3::z() * -case.gravity, masses, space: Poses };
        let metric = BodyMetric::<Poses>::new(bodies);
        let state = metric.state(&motions)?;
        let mut detector = Detector::new(colliders, case.things.len())?;
        for pair in case.pairs() {
            detector = detector.with_rolling(pair, case.rolling[0], case.rolling[1])?;
        }
        let mut world = World::new(metric.under(weight)?, detector)?.with_law(law(case.law));
        if case.pushed {
            world = world.with_obstacles(vec![0])?;
        }
        if let Some(tolerance) = case.tolerance {
            world = world.with_tolerance(tolerance)?;
        }
        Ok(Scene { world, state, frames: Vec::new() })
    }
}

impl Engine for Scene {
    fn step(&mut self, h: f64) -> Result<WorldReport, ContactError> {
        self.frames = self.motions().iter().map(|motion| motion.pose.r).collect();
        self.world.step(&mut self.state, h)
    }

    fn reload(&mut self) -> Result<(), StepError> {
        self.world.load(&self.world.save())
    }

    fn motions(&self) -> Vec<Motion> {
        let bodies = self.state.q.chunks_exact(7).zip(self.state.p.0.chunks_exact(6));
        let motion = |(q, p): (&[f64], &[f64])| {
            let turn = UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[4], q[5], q[6]));
            let r = turn.to_rotation_matrix().into_inner();
            Motion {
                pose: Pose { x: Vector3::new(q[0], q[1], q[2]), r },
                p: Vector3::new(p[0], p[1], p[2]),
                l: r * Vector3::new(p[3], p[4], p[5]),
            }
        };
        bodies.map(motion).collect()
    }

    fn touches(&self) -> Vec<Seen> {
        let arm = |contact: &ContactPoint, side: usize| match contact.bodies[side] {
            Some(body) => self.frames[body] * contact.arms[side],
            None => contact.arms[side],
        };
        let seen = |touch: Touch<Spatial>| Seen {
            bodies: touch.contact.bodies,
            normal: touch.contact.normal,
            points: touch.contact.points,
            arms: [0, 1].map(|side| arm(&touch.contact, side)),
            gap: touch.contact.gap,
            friction: touch.contact.friction,
            impact: touch.impact,
            rest: touch.normal,
            rubbed: touch.friction,
            moment: touch.moment,
        };
        self.world.touches().map(seen).collect()
    }
}
