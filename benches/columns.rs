//! A hundred columns of ten resting boxes, against rapier3d-f64 at the same step, in the same run.
//!
//! `cargo bench --bench columns --features peers` prints the ratio of times a step (ours over
//! rapier's, its boxes kept awake, then asleep), rapier's number of solver iterations, and what each
//! leaves after two seconds: how deep boxes have sunk, how fast the fastest moves, and the residual of
//! our conditions. Then detection alone, in microseconds. One thread each.

mod in_turn;

use std::time::Instant;

use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};
use stationary_contact::{Collider, Detector, Shape, TouchingBodies, TouchingReport};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

const COLUMNS: usize = 100;
const HIGH: usize = 10;
const GRAVITY: f64 = 9.81;
const FRICTION: f64 = 0.5;
/// The step, seconds.
const STEP: f64 = 1e-3;
/// Steps after which quality is looked at.
const STEPS: usize = 2_000;

/// Where a box of 1 m starts.
fn place(k: usize) -> [f64; 3] {
    let column = k / HIGH;
    [2.0 * (column % 10) as f64, 2.0 * (column / 10) as f64, 0.5 + (k % HIGH) as f64]
}

/// How deep boxes have sunk, m, and how fast the fastest is, m/s.
struct Quality {
    sunk: f64,
    speed: f64,
}

fn detector() -> Detector {
    let cube = Shape::cuboid([0.5; 3]).expect("a box");
    let on_body = |body| Collider::on_body(body, cube.clone()).with_friction(FRICTION);
    let mut colliders: Vec<_> = (0..COLUMNS * HIGH).map(on_body).collect();
    let floor = Shape::half_space(Vector3::z()).expect("a floor");
    colliders.push(Collider::fixed(RigidMotion::identity(), floor).with_friction(FRICTION));
    Detector::new(colliders, COLUMNS * HIGH).expect("colliders of these bodies")
}

fn boxes() -> (BodyMetric<Poses>, State<Vec<f64>>) {
    let still = |k| BodyMotion {
        pose: RigidMotion { translation: place(k).into(), rotation: Rotation::identity() },
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let motions: Vec<_> = (0..COLUMNS * HIGH).map(still).collect();
    let cube = Body::solid_box(1.0, [0.5; 3]).expect("a box");
    let metric = BodyMetric::new(vec![cube; COLUMNS * HIGH]);
    let state = metric.state(&motions).expect("poses");
    (metric, state)
}

fn ours(state: &State<Vec<f64>>) -> Quality {
    let sunk = |(k, q): (usize, &[f64])| (q[2] - place(k)[2]).abs();
    let speed = |p: &[f64]| Vector3::from_column_slice(&p[..3]).norm();
    Quality {
        sunk: state.q.chunks_exact(7).enumerate().map(sunk).fold(0.0, f64::max),
        speed: state.p.0.chunks_exact(6).map(speed).fold(0.0, f64::max),
    }
}

fn rapier(can_sleep: bool) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let mut world = PhysicsWorld::default();
    world.gravity = Vector::Z * -GRAVITY;
    world.integration_parameters.dt = STEP;
    let floor = ColliderBuilder::cuboid(100.0, 100.0, 1.0).translation(Vector::Z * -1.0);
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |k: usize| {
        let [x, y, z] = place(k);
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(x, y, z));
        let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5).friction(FRICTION);
        world.insert(body.can_sleep(can_sleep), cube).0
    };
    let handles = (0..COLUMNS * HIGH).map(insert).collect();
    (world, handles)
}

fn theirs(world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> Quality {
    let mut quality = Quality { sunk: 0.0, speed: 0.0 };
    for (k, handle) in handles.iter().enumerate() {
        let body = &world.bodies[*handle];
        quality.sunk = quality.sunk.max((body.translation().z - place(k)[2]).abs());
        quality.speed = quality.speed.max(body.linvel().length());
    }
    quality
}

fn main() {
    let (metric, mut state) = boxes();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; COLUMNS * HIGH];
    let weight = Weight { gravity: -Vector3::z() * GRAVITY, masses, space: Poses };
    let system = metric.under(weight).expect("one system");
    let mut bodies = TouchingBodies::new(&system, detector()).expect("bodies");
    let mut worst = TouchingReport::default();
    let mut step = |state: &mut State<Vec<f64>>| {
        let report = bodies.step(state, STEP).expect("a step of resting boxes");
        worst.residual = worst.residual.max(report.residual);
        worst.coulomb = worst.coulomb.max(report.coulomb);
    };
    for can_sleep in [false, true] {
        let (mut world, handles) = rapier(can_sleep);
        (0..STEPS).for_each(|_| world.step());
        let name = if can_sleep { "asleep" } else { "awake" };
        let iterations = world.integration_parameters.num_solver_iterations;
        in_turn::ratio(
            &format!("a step over rapier's, {name}, {iterations} iterations"),
            || step(&mut state),
            || world.step(),
        );
        let Quality { sunk, speed } = theirs(&world, &handles);
        println!("  rapier, {name}: sunk {sunk:.1e} m, speed {speed:.1e} m/s");
    }
    (0..STEPS).for_each(|_| step(&mut state));
    let Quality { sunk, speed } = ours(&state);
    let (residual, coulomb) = (worst.residual, worst.coulomb);
    println!("  ours: sunk {sunk:.1e} m, speed {speed:.1e} m/s");
    println!("  ours: residual {residual:.1e} m/s, Coulomb's law {coulomb:.1e} m/s");
    let (mut detector, start, runs) = (detector(), Instant::now(), 100);
    for _ in 0..runs {
        detector.detect(&state.q, STEP * 0.1).expect("detection");
    }
    let each = start.elapsed().as_secs_f64() / f64::from(runs);
    println!("  detection alone: {:.0} microseconds", 1e6 * each);
}
