//! A falling pile of boxes, against rapier3d-f64 at the same step, in the same run.
//!
//! `cargo bench --bench pile --features peers -- [boxes]` (1,000 by default) drops boxes from a
//! loose grid with friction, both engines from the same state, a step of each in turn, and prints a
//! line for every quarter of a second: the median time of a step of each and their ratio, how deep
//! boxes overlap, how fast the fastest is, the energy, and how far the contact conditions are from
//! being met. For rapier that is only how fast its boxes still close once their gaps are used up (a
//! lower bound of the residual of ours, which counts impulses and friction as well). Nothing
//! sleeps; one thread each.

use std::time::Instant;

use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Rotation as Turn, Vector,
};
use stationary_calculus::Vector as Velocity;
use stationary_contact::problems::{FRICTION, GRAVITY, falling_boxes};
use stationary_contact::{Detector, Settling, TouchingBodies, gap_rows};
use stationary_rigid::{Body, LieGroup, RigidMotion};

/// The step, seconds.
const STEP: f64 = 1e-3;
/// How long the pile falls, seconds.
const TIME: f64 = 3.0;
/// Steps a line.
const LINE: usize = 250;
/// Contact conditions settled so far, m/s, in at most so many sweeps.
const SETTLING: Settling = Settling { change: 1e-5, sweeps: 12 };

fn rapier(starts: &[RigidMotion]) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let gravity = Vector::Z * -GRAVITY;
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
    world.integration_parameters.dt = STEP;
    let floor = ColliderBuilder::cuboid(1000.0, 1000.0, 1.0).translation(Vector::Z * -1.0);
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |start: &RigidMotion| {
        let [x, y, z] = start.translation.into();
        let turn = start.rotation.log();
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(x, y, z))
            .rotation(Vector::new(turn.x, turn.y, turn.z))
            .can_sleep(false);
        let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5).friction(FRICTION);
        world.insert(body, cube).0
    };
    let handles = starts.iter().map(insert).collect();
    (world, handles)
}

/// Poses and velocities as ours are.
fn theirs(world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for handle in handles {
        let body = &world.bodies[*handle];
        let (at, turn): (Vector, Turn) = (body.translation(), *body.rotation());
        q.extend([at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z]);
        let (linear, angular) = (body.linvel(), turn.inverse() * body.angvel());
        v.extend([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]);
    }
    (q, v)
}

/// What a pile is like.
#[derive(Clone, Copy, Default)]
struct Quality {
    overlap: f64,
    closing: f64,
    speed: f64,
    energy: f64,
}

/// Looks at velocities over a step that starts at some poses.
fn look(detector: &mut Detector, q: &[f64], v: &[f64], body: &Body) -> Quality {
    let mut quality = Quality::default();
    let contacts = detector.detect(q, 0.02).expect("detection");
    let rows = gap_rows(contacts, q);
    for (i, contact) in contacts.iter().enumerate() {
        quality.overlap = quality.overlap.max(-contact.gap);
        let closing = -rows.along(i, Velocity(v)) - contact.gap.max(0.0) / STEP;
        quality.closing = quality.closing.max(closing);
    }
    for (q, v) in q.chunks_exact(7).zip(v.chunks_exact(6)) {
        let linear = Vector3::from_column_slice(&v[..3]);
        let angular = Vector3::from_column_slice(&v[3..]);
        quality.speed = quality.speed.max(linear.norm());
        let kinetic = linear.norm_squared() + angular.dot(&body.angular_momentum(&angular));
        quality.energy += 0.5 * kinetic + GRAVITY * q[2];
    }
    quality
}

fn median(times: &mut [f64]) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

fn main() {
    let boxes = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1_000);
    let pile = falling_boxes(boxes).expect("a pile");
    let detector = || pile.detector().expect("colliders of these bodies");
    let cube = pile.system.metric().bodies()[0];
    let mut state = pile.state.clone();
    let bodies = TouchingBodies::new(&pile.system, detector()).expect("bodies");
    let mut bodies = bodies.with_settling(SETTLING);
    let (mut world, handles) = rapier(&pile.starts);
    let mut watch = detector();
    let iterations = world.integration_parameters.num_solver_iterations;
    println!("{boxes} boxes, steps of {STEP} s; {SETTLING:?}; rapier's iterations {iterations}");
    println!(
        "{:>5} {:>8} | {:>7} {:>7} {:>5} | {:>8} {:>8} {:>8} \
         | {:>8} {:>8} {:>8} | {:>6} {:>9} {:>9}",
        "t",
        "contacts",
        "ours",
        "rapier",
        "ratio",
        "residual",
        "Coulomb",
        "rapier",
        "overlap",
        "rapier",
        "visits",
        "speed",
        "energy",
        "rapier"
    );
    let (mut slow, mut slower) = (Vec::new(), Vec::new());
    for line in 1..=(TIME / STEP) as usize / LINE {
        let (mut own, mut other) = (Vec::new(), Vec::new());
        let (mut residual, mut coulomb, mut overlap) = (0.0_f64, 0.0_f64, 0.0_f64);
        let (mut closing, mut sunk, mut visits, mut contacts) = (0.0_f64, 0.0_f64, 0, 0);
        let mut last = Quality::default();
        for k in 0..LINE {
            let before = theirs(&world, &handles).0;
            let start = Instant::now();
            let report = bodies.step(&mut state, STEP).expect("a step");
            let middle = Instant::now();
            world.step();
            other.push(middle.elapsed().as_secs_f64());
            own.push((middle - start).as_secs_f64());
            residual = residual.max(report.residual);
            coulomb = coulomb.max(report.coulomb);
            overlap = overlap.max(report.overlap);
            visits += report.relaxed;
            contacts = report.contacts;
            if k % 25 == 0 {
                last = look(&mut watch, &before, &theirs(&world, &handles).1, &cube);
                (closing, sunk) = (closing.max(last.closing), sunk.max(last.overlap));
            }
        }
        let v: Vec<f64> = state.p.0.chunks_exact(6).flat_map(|p| velocity(p, &cube)).collect();
        let ours = look(&mut watch, &state.q, &v, &cube);
        let (a, b) = (median(&mut own), median(&mut other));
        slow.append(&mut own);
        slower.append(&mut other);
        println!(
            "{:5.2} {contacts:8} | {:7.3} {:7.3} {:5.2} \
             | {residual:8.1e} {coulomb:8.1e} {closing:8.1e} \
             | {overlap:8.1e} {sunk:8.1e} {:8} | {:6.3} {:9.1} {:9.1}",
            line as f64 * LINE as f64 * STEP,
            1e3 * a,
            1e3 * b,
            a / b,
            visits / LINE,
            ours.speed,
            ours.energy,
            last.energy
        );
    }
    let sums = [&slow, &slower].map(|times| times.iter().sum::<f64>());
    println!("all steps: {:.3} s and {:.3} s, ratio {:.2}", sums[0], sums[1], sums[0] / sums[1]);
}

fn velocity(p: &[f64], body: &Body) -> [f64; 6] {
    let w = body.angular_velocity(&Vector3::from_column_slice(&p[3..]));
    [p[0], p[1], p[2], w.x, w.y, w.z]
}
