//! What bodies in contact are judged by: eight scenes, with what is known of each.
//!
//! | scene | what happens | known |
//! | --- | --- | --- |
//! | block | slides up an incline, stops, stays | closed form |
//! | rocking block | rocks over its corners, inelastic | its own limit |
//! | Euler's disc | a thin disc rolls on its rim | its own limit |
//! | rattleback | an ellipsoid whose principal axes are turned against its shape | its own limit |
//! | box | tumbles, lands with restitution and friction | its own limit |
//! | corner | an elastic ball between three planes | closed form |
//! | cradle | an elastic ball hits a row of four that touch | closed form |
//! | pile | 20 boxes fall on each other | its own limit |

use nalgebra::Vector3;
use stationary_contact::problems::falling_boxes;
use stationary_contact::{
    BodiesIn, Collider, ContactError, Detector, EventDriven, FlightOrder, Shape, Spatial,
    SpatialWorld,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

/// Acceleration of gravity, m/s^2.
const GRAVITY: f64 = 9.81;
/// Speed and inclination of the block, and its friction.
const BLOCK: [f64; 3] = [3.0, 0.2, 0.4];

/// Where centres are at a time.
pub type Known = fn(usize, f64) -> Vector3<f64>;

/// Bodies before the first step.
pub struct Scene {
    /// Its name.
    pub name: &'static str,
    /// How long it is watched, s.
    pub duration: f64,
    /// What errors are parts of, m.
    pub size: f64,
    /// Where centres are, where there is a closed form.
    pub known: Option<Known>,
    /// Masses and principal moments.
    pub bodies: Vec<Body>,
    /// How each body starts.
    pub motions: Vec<BodyMotion>,
    /// What touches.
    pub colliders: Vec<Collider>,
    /// Acceleration, m/s^2.
    pub gravity: Vector3<f64>,
}

type Bodies = BodiesIn<Spatial, Weight<Poses>>;

impl Scene {
    fn system(&self) -> Result<Bodies, ContactError> {
        let still = Vector3::zeros();
        let masses = self.bodies.iter().map(|body| PointMass { mass: body.mass(), point: still });
        let weight = Weight { gravity: self.gravity, masses: masses.collect(), space: Poses };
        Ok(BodyMetric::new(self.bodies.clone()).under(weight)?)
    }

    fn detector(&self) -> Result<Detector, ContactError> {
        Detector::new(self.colliders.clone(), self.bodies.len())
    }

    /// A world of it.
    pub fn world(&self) -> Result<SpatialWorld<Weight<Poses>>, ContactError> {
        SpatialWorld::new(self.system()?, self.detector()?)
    }

    /// The same with impacts at their instant.
    pub fn event_driven(
        &self,
        contact_step: f64,
    ) -> Result<EventDriven<Spatial, Weight<Poses>>, ContactError> {
        EventDriven::new(self.system()?, self.detector()?, FlightOrder::Fourth, contact_step)
    }

    /// Its state at the start.
    pub fn start(&self) -> Result<State<Vec<f64>>, ContactError> {
        Ok(BodyMetric::<Poses>::new(self.bodies.clone()).state(&self.motions)?)
    }
}

fn at(translation: Vector3<f64>, turn: Vector3<f64>) -> RigidMotion {
    RigidMotion { translation, rotation: Rotation::exp(turn) }
}

fn moving(pose: RigidMotion, velocity: Vector3<f64>, angular_velocity: Vector3<f64>) -> BodyMotion {
    BodyMotion { pose, velocity, angular_velocity }
}

fn floor(normal: Vector3<f64>, through: Vector3<f64>) -> Result<Collider, ContactError> {
    let place = RigidMotion { translation: through, rotation: Rotation::identity() };
    Ok(Collider::fixed(place, Shape::half_space(normal)?))
}

/// One body over the ground `z = 0`.
fn one(
    name: &'static str,
    duration: f64,
    size: f64,
    body: Body,
    motion: BodyMotion,
    collider: Collider,
) -> Result<Scene, ContactError> {
    let friction = collider.friction;
    let ground = floor(Vector3::z(), Vector3::zeros())?.with_friction(friction);
    Ok(Scene {
        name,
        duration,
        size,
        known: None,
        bodies: vec![body],
        motions: vec![motion],
        colliders: vec![collider, ground],
        gravity: -Vector3::z() * GRAVITY,
    })
}

fn block() -> Result<Scene, ContactError> {
    let [speed, angle, friction] = BLOCK;
    let motion =
        moving(at(Vector3::z() * 0.5, Vector3::zeros()), Vector3::x() * speed, Vector3::zeros());
    let cube = Collider::on_body(0, Shape::cuboid([0.5; 3])?).with_friction(friction);
    let scene = one("block", 1.0, 1.0, Body::solid_box(1.0, [0.5; 3])?, motion, cube)?;
    let gravity = Vector3::new(-angle.sin(), 0.0, -angle.cos()) * GRAVITY;
    let known: Known = |_, t| {
        let [speed, angle, friction] = BLOCK;
        let slows = GRAVITY * (angle.sin() + friction * angle.cos());
        let t = t.min(speed / slows);
        Vector3::new(speed * t - 0.5 * slows * t * t, 0.0, 0.5)
    };
    Ok(Scene { gravity, known: Some(known), ..scene })
}

fn rocking_block() -> Result<Scene, ContactError> {
    let (half, tilt) = ([0.1, 0.05, 0.4], -0.1_f64);
    let (sine, cosine) = tilt.sin_cos();
    // It stands on the edge at the origin.
    let centre = Vector3::new(0.1 * cosine + 0.4 * sine, 0.0, -0.1 * sine + 0.4 * cosine);
    let motion = moving(at(centre, Vector3::y() * tilt), Vector3::zeros(), Vector3::zeros());
    let shape = Collider::on_body(0, Shape::cuboid(half)?).with_friction(1.0);
    one("rocking block", 0.6, 0.4, Body::solid_box(1.0, half)?, motion, shape)
}

/// Its axis is the body's z; it leans, and rolls around.
fn eulers_disc() -> Result<Scene, ContactError> {
    let (radius, half, mass, lean) = (0.1_f64, 0.005_f64, 0.4, 0.4_f64);
    let across = mass * (0.25 * radius * radius + half * half / 3.0);
    let body = Body::new(mass, [across, across, 0.5 * mass * radius * radius])?;
    let height = radius * lean.sin() + half * lean.cos();
    let pose = at(Vector3::z() * height, Vector3::x() * lean);
    let motion = moving(pose, Vector3::zeros(), spin(lean));
    let shape = Collider::on_body(0, Shape::cylinder(half, radius)?);
    one("Euler's disc", 0.3, 0.1, body, motion, shape.with_friction(0.5))
}

/// The precession of a thin disc that rolls with its centre at rest: `Omega^2 = 4 g / (r sin lean)`.
fn spin(lean: f64) -> Vector3<f64> {
    let precession = (4.0 * GRAVITY / (0.1 * lean.sin())).sqrt();
    Vector3::y() * (precession * lean.sin())
}

fn rattleback() -> Result<Scene, ContactError> {
    let axes = [0.1, 0.02, 0.015];
    let body = Body::new(0.2, [4e-5, 4.2e-4, 4.4e-4])?;
    let place = at(Vector3::zeros(), Vector3::z() * 0.1);
    let shape = Collider { place, ..Collider::on_body(0, Shape::ellipsoid(axes)?) };
    let pose = at(Vector3::z() * axes[2], Vector3::zeros());
    let motion = moving(pose, Vector3::zeros(), Vector3::new(0.2, 0.0, -5.0));
    one("rattleback", 0.5, 0.1, body, motion, shape.with_friction(0.8))
}

fn tumbling_box() -> Result<Scene, ContactError> {
    let half = [0.3, 0.2, 0.1];
    let pose = at(Vector3::z() * 0.8, Vector3::new(0.3, -0.2, 0.5));
    let motion = moving(pose, Vector3::new(0.5, 0.2, 0.0), Vector3::new(2.0, 3.0, -1.0));
    let shape = Collider::on_body(0, Shape::cuboid(half)?).with_friction(0.3);
    let shape = shape.with_restitution(0.5);
    one("box", 0.7, 0.3, Body::solid_box(1.0, half)?, motion, shape)
}

fn corner() -> Result<Scene, ContactError> {
    let ball = Collider::on_body(0, Shape::ball(0.1)?).with_restitution(1.0);
    let mut colliders = vec![ball];
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let mut inwards = Vector3::zeros();
            inwards[axis] = -sign;
            colliders.push(floor(inwards, inwards * -0.6)?);
        }
    }
    let velocity = Vector3::new(1.0, 0.7, -0.4);
    let known: Known = |_, t| {
        // A triangle wave between -0.5 and 0.5 along each axis.
        Vector3::new(1.0, 0.7, -0.4).map(|v: f64| {
            let phase = (v * t + 0.5).rem_euclid(2.0);
            phase.min(2.0 - phase) - 0.5
        })
    };
    Ok(Scene {
        name: "corner",
        duration: 4.0,
        size: 1.0,
        known: Some(known),
        bodies: vec![Body::new(1.0, [0.004; 3])?],
        motions: vec![moving(RigidMotion::identity(), velocity, Vector3::zeros())],
        colliders,
        gravity: Vector3::zeros(),
    })
}

/// A ball half a metre in front of four that touch.
fn cradle() -> Result<Scene, ContactError> {
    const HIT: f64 = 0.5;
    let centre = |k: usize| Vector3::x() * if k == 0 { -HIT } else { k as f64 };
    let speed = |k: usize| if k == 0 { Vector3::x() } else { Vector3::zeros() };
    let on = |body| Ok(Collider::on_body(body, Shape::ball(0.5)?).with_restitution(1.0));
    let known: Known = |k, t| {
        Vector3::x()
            * match k {
                0 => t.min(HIT) - HIT,
                4 => 4.0 + (t - HIT).max(0.0),
                _ => k as f64,
            }
    };
    Ok(Scene {
        name: "cradle",
        // No step of the table ends at the instant of the impact.
        duration: 1.013,
        size: 1.0,
        known: Some(known),
        bodies: vec![Body::new(1.0, [0.1; 3])?; 5],
        motions: (0..5)
            .map(|k| moving(at(centre(k), Vector3::zeros()), speed(k), Vector3::zeros()))
            .collect(),
        colliders: (0..5).map(on).collect::<Result<_, ContactError>>()?,
        gravity: Vector3::zeros(),
    })
}

fn pile() -> Result<Scene, ContactError> {
    let boxes = falling_boxes(20)?;
    let still = Vector3::zeros();
    let cube = Shape::cuboid([0.5; 3])?;
    let on = |body| Collider::on_body(body, cube.clone()).with_friction(0.5);
    let mut colliders: Vec<_> = (0..20).map(on).collect();
    colliders.push(floor(Vector3::z(), still)?.with_friction(0.5));
    Ok(Scene {
        name: "pile",
        duration: 0.3,
        size: 1.0,
        known: None,
        bodies: vec![Body::solid_box(1.0, [0.5; 3])?; 20],
        motions: boxes.starts.iter().map(|&pose| moving(pose, still, still)).collect(),
        colliders,
        gravity: -Vector3::z() * GRAVITY,
    })
}

/// All of them, in the order of the table.
pub fn scenes() -> Result<Vec<Scene>, ContactError> {
    Ok(vec![
        block()?,
        rocking_block()?,
        eulers_disc()?,
        rattleback()?,
        tumbling_box()?,
        corner()?,
        cradle()?,
        pile()?,
    ])
}
