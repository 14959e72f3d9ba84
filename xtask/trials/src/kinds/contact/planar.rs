//! A scene of the plane.

use nalgebra::{Matrix3, Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    ContactError, Planar, PlanarCollider, PlanarContactPoint, PlanarDetector, PlanarShape,
    PlanarWorld, Touch, World, WorldReport,
};
use stationary_integrators::{State, StepError};
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

use super::case::{Case, Form, Thing};
use super::engine::{Body, Engine, Motion, Seen, law};
use super::hull::Pose;

pub(super) struct Scene {
    world: PlanarWorld<PlanarWeight>,
    state: State<Vec<f64>>,
    /// How bodies were turned when the last step began.
    frames: Vec<Matrix3<f64>>,
}

fn shape(thing: &Thing) -> Result<PlanarShape, ContactError> {
    let [a, b, _] = thing.half;
    match thing.form {
        Form::Round => PlanarShape::disc(a),
        Form::Box => PlanarShape::cuboid([a, b]),
        Form::Simplex => {
            let (s, c) = (0.75_f64.sqrt() * a, 0.5 * a);
            let corners = [[0.0, a], [-s, -c], [s, -c]];
            PlanarShape::polygon(&corners.map(Vector2::from))
        }
    }
}

impl Scene {
    pub(super) fn new(case: &Case) -> Result<Self, ContactError> {
        let bodies = Body::all(case);
        let moment = |body: &Body| body.moments[2].unwrap_or(f64::NAN);
        let (mut colliders, mut q, mut p) = (Vec::new(), Vec::new(), Vec::new());
        for (k, (thing, body)) in case.things.iter().zip(&bodies).enumerate() {
            let collider = PlanarCollider::on_body(k, shape(thing)?);
            let collider = collider.with_restitution(thing.restitution);
            colliders.push(collider.with_friction(thing.friction));
            q.extend([thing.place.x, thing.place.y, thing.turn.z]);
            let v = thing.velocity * thing.mass;
            p.extend([v.x, v.y, moment(body) * thing.spin.z]);
        }
        for normal in &case.grounds {
            let ground = PlanarShape::half_plane(normal.xy())?;
            colliders.push(PlanarCollider::fixed(PlanarMotion::identity(), ground));
        }
        let diagonal = bodies.iter().flat_map(|b| [b.mass, b.mass, moment(b)]).collect();
        let metric = DiagonalMetric::new(diagonal)?;
        let gravity = Vector2::new(0.0, -case.gravity);
        let weight = PlanarWeight { gravity, masses: bodies.iter().map(|b| b.mass).collect() };
        let mut detector = PlanarDetector::new(colliders, bodies.len())?;
        for pair in case.pairs() {
            detector = detector.with_rolling(pair, case.rolling[0], case.rolling[1])?;
        }
        let mut world = World::new(System::new(metric, weight)?, detector)?.with_law(law(case.law));
        if case.pushed {
            world = world.with_obstacles(vec![0])?;
        }
        if let Some(tolerance) = case.tolerance {
            world = world.with_tolerance(tolerance)?;
        }
        Ok(Scene { world, state: State::new(q, Covector(p)), frames: Vec::new() })
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
        let bodies = self.state.q.chunks_exact(3).zip(self.state.p.0.chunks_exact(3));
        let motion = |(q, p): (&[f64], &[f64])| {
            let (s, c) = q[2].sin_cos();
            let r = Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0);
            Motion {
                pose: Pose { x: Vector3::new(q[0], q[1], 0.0), r },
                p: Vector3::new(p[0], p[1], 0.0),
                l: Vector3::z() * p[2],
            }
        };
        bodies.map(motion).collect()
    }

    fn touches(&self) -> Vec<Seen> {
        let space = |v: Vector2<f64>| Vector3::new(v.x, v.y, 0.0);
        let arm = |contact: &PlanarContactPoint, side: usize| match contact.bodies[side] {
            Some(body) => self.frames[body] * space(contact.arms[side]),
            None => space(contact.arms[side]),
        };
        let seen = |touch: Touch<Planar>| Seen {
            bodies: touch.contact.bodies,
            normal: space(touch.contact.normal),
            points: touch.contact.points.map(space),
            arms: [0, 1].map(|side| arm(&touch.contact, side)),
            gap: touch.contact.gap,
            friction: touch.contact.friction,
            impact: touch.impact,
            rest: touch.normal,
            rubbed: space(touch.friction),
            moment: Vector3::z() * touch.moment,
        };
        self.world.touches().map(seen).collect()
    }
}
