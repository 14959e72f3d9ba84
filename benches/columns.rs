//! A hundred columns of ten resting boxes, against rapier3d-f64 at the same step, in the same run.
//!
//! `cargo bench --bench columns --features peers` prints the ratio of times a step (ours over
//! rapier's, its boxes kept awake, then asleep), rapier's number of solver iterations, and what
//! each leaves after two seconds: how deep boxes have sunk, how fast the fastest moves, and the
//! residual of our conditions. Then detection alone, in microseconds. One thread each.

mod in_turn;

use std::time::Instant;

use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Vector,
};
use stationary_contact::problems::{Boxes, FRICTION, GRAVITY, columns_of_boxes};
use stationary_contact::{TouchingBodies, TouchingReport};
use stationary_integrators::State;

const COLUMNS: usize = 100;
const HIGH: usize = 10;
/// The step, seconds.
const STEP: f64 = 1e-3;
/// Steps after which quality is looked at.
const STEPS: usize = 2_000;

/// How deep boxes have sunk, m, and how fast the fastest is, m/s.
struct Quality {
    sunk: f64,
    speed: f64,
}

fn ours(boxes: &Boxes, state: &State<Vec<f64>>) -> Quality {
    let both = state.q.chunks_exact(7).zip(boxes.state.q.chunks_exact(7));
    let sunk = both.map(|(q, start)| (q[2] - start[2]).abs());
    let speed = |p: &[f64]| Vector3::from_column_slice(&p[..3]).norm();
    Quality {
        sunk: sunk.fold(0.0, f64::max),
        speed: state.p.0.chunks_exact(6).map(speed).fold(0.0, f64::max),
    }
}

fn rapier(boxes: &Boxes, can_sleep: bool) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let gravity = Vector::Z * -GRAVITY;
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
    world.integration_parameters.dt = STEP;
    let floor = ColliderBuilder::cuboid(100.0, 100.0, 1.0).translation(Vector::Z * -1.0);
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |q: &[f64]| {
        let body = RigidBodyBuilder::dynamic().translation(Vector::new(q[0], q[1], q[2]));
        let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5).friction(FRICTION);
        world.insert(body.can_sleep(can_sleep), cube).0
    };
    let handles = boxes.state.q.chunks_exact(7).map(insert).collect();
    (world, handles)
}

fn theirs(boxes: &Boxes, world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> Quality {
    let mut quality = Quality { sunk: 0.0, speed: 0.0 };
    for (handle, start) in handles.iter().zip(boxes.state.q.chunks_exact(7)) {
        let body = &world.bodies[*handle];
        quality.sunk = quality.sunk.max((body.translation().z - start[2]).abs());
        quality.speed = quality.speed.max(body.linvel().length());
    }
    quality
}

fn main() {
    let boxes = columns_of_boxes(COLUMNS, HIGH).expect("columns");
    let detector = || boxes.detector().expect("colliders of these bodies");
    let mut state = boxes.state.clone();
    let mut bodies = TouchingBodies::new(&boxes.system, detector()).expect("bodies");
    let mut worst = TouchingReport::default();
    let mut step = |state: &mut State<Vec<f64>>| {
        let report = bodies.step(state, STEP).expect("a step of resting boxes");
        worst.residual = worst.residual.max(report.residual);
        worst.coulomb = worst.coulomb.max(report.coulomb);
    };
    for can_sleep in [false, true] {
        let (mut world, handles) = rapier(&boxes, can_sleep);
        (0..STEPS).for_each(|_| world.step());
        let name = if can_sleep { "asleep" } else { "awake" };
        let iterations = world.integration_parameters.num_solver_iterations;
        in_turn::ratio(
            &format!("a step over rapier's, {name}, {iterations} iterations"),
            || step(&mut state),
            || world.step(),
        );
        let Quality { sunk, speed } = theirs(&boxes, &world, &handles);
        println!("  rapier, {name}: sunk {sunk:.1e} m, speed {speed:.1e} m/s");
    }
    (0..STEPS).for_each(|_| step(&mut state));
    let Quality { sunk, speed } = ours(&boxes, &state);
    let (residual, coulomb) = (worst.residual, worst.coulomb);
    println!("  ours: sunk {sunk:.1e} m, speed {speed:.1e} m/s");
    println!("  ours: residual {residual:.1e} m/s, Coulomb's law {coulomb:.1e} m/s");
    let (mut detector, start, runs) = (detector(), Instant::now(), 100_u32);
    for _ in 0..runs {
        detector.detect(&state.q, STEP * 0.1).expect("detection");
    }
    let each = start.elapsed().as_secs_f64() / f64::from(runs);
    println!("  detection alone: {:.0} microseconds", 1e6 * each);
}
