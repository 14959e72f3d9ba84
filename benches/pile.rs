//! A falling pile of boxes, against rapier3d-f64 at the same step, in the same run.
//!
//! `cargo bench --bench pile --features peers -- [boxes]` (1,000 by default) drops boxes from a
//! loose grid with friction: ours with at most 12 sweeps a step and with as many as it takes to
//! settle to 3e-3, 1e-3 and 1e-4 m/s, rapier with 4 (its default), 20 and 100 iterations, all from
//! the same state, a step of each in turn. A line for each: its time over that of rapier's default,
//! in flight (the first second), afterwards and in all; how far the contact conditions are from
//! being met at worst, in flight and in the last quarter of a second; how deep boxes overlap, how
//! fast the fastest is at the end, and the energy. For rapier the conditions are only how fast its
//! boxes still close once their gaps are used up (a lower bound of the residual of ours, which
//! counts impulses and friction as well). Below, what is left against the time as a chart. Nothing
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
/// Until when it is in flight, and from when it is looked at as a heap, seconds.
const FLIGHT: f64 = 1.0;
const HEAP: f64 = 2.75;
/// Steps between two looks at rapier's conditions.
const LOOKS: usize = 25;
/// Contact conditions of ours are settled so far, m/s, in at most so many sweeps: few, or all that
/// it takes.
const SETTLED: [Settling; 4] = [
    Settling { change: 1e-4, sweeps: 12 },
    Settling { change: 3e-3, sweeps: 400 },
    Settling { change: 1e-3, sweeps: 400 },
    Settling { change: 1e-4, sweeps: 400 },
];
/// Iterations of rapier's solver; its default first.
const ITERATIONS: [usize; 3] = [4, 20, 100];

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
fn poses(world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> (Vec<f64>, Vec<f64>) {
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

/// What a run took and left.
#[derive(Clone, Default)]
struct Run {
    name: String,
    /// Seconds in flight and afterwards.
    times: [f64; 2],
    /// The largest residual in flight and at rest, m/s.
    left: [f64; 2],
    overlap: f64,
    end: Quality,
}

impl Run {
    fn took(&mut self, t: f64, seconds: f64) {
        self.times[usize::from(t > FLIGHT)] += seconds;
    }

    fn saw(&mut self, t: f64, left: f64, overlap: f64) {
        let phase = if t <= FLIGHT { 0 } else { 1 };
        if t <= FLIGHT || t > HEAP {
            self.left[phase] = self.left[phase].max(left);
        }
        self.overlap = self.overlap.max(overlap);
    }
}

fn main() {
    let boxes = std::env::args().find_map(|a| a.parse().ok()).unwrap_or(1_000);
    let pile = falling_boxes(boxes).expect("a pile");
    let detector = || pile.detector().expect("colliders of these bodies");
    let cube = pile.system.metric().bodies()[0];
    let mut watch = detector();
    let mut ours = SETTLED.map(|settling| {
        let bodies = TouchingBodies::new(&pile.system, detector()).expect("bodies");
        let Settling { change, sweeps } = settling;
        let run = Run { name: format!("{change:e} m/s, {sweeps} sweeps"), ..Run::default() };
        (bodies.with_settling(settling), pile.state.clone(), run)
    });
    let mut theirs = ITERATIONS.map(|iterations| {
        let (mut world, handles) = rapier(&pile.starts);
        world.integration_parameters.num_solver_iterations = iterations;
        let run = Run { name: format!("rapier, {iterations} iterations"), ..Run::default() };
        (world, handles, run)
    });
    let steps = (TIME / STEP) as usize;
    for step in 1..=steps {
        let t = step as f64 * STEP;
        for (bodies, state, run) in &mut ours {
            let start = Instant::now();
            let report = bodies.step(state, STEP).expect("a step");
            run.took(t, start.elapsed().as_secs_f64());
            run.saw(t, report.residual.max(report.coulomb), report.overlap);
        }
        for (world, handles, run) in &mut theirs {
            let before = (step % LOOKS == 0).then(|| poses(world, handles).0);
            let start = Instant::now();
            world.step();
            run.took(t, start.elapsed().as_secs_f64());
            if let Some(before) = before {
                run.end = look(&mut watch, &before, &poses(world, handles).1, &cube);
                run.saw(t, run.end.closing, run.end.overlap);
            }
        }
    }
    let ours = ours.map(|(_, state, mut run)| {
        let v: Vec<f64> = state.p.0.chunks_exact(6).flat_map(|p| velocity(p, &cube)).collect();
        run.end = look(&mut watch, &state.q, &v, &cube);
        run
    });
    let runs: Vec<Run> = ours.into_iter().chain(theirs.map(|(_, _, run)| run)).collect();
    println!(
        "{boxes} boxes, {steps} steps of {STEP} s, ours settled so far in at most so many sweeps"
    );
    report(&runs, runs[SETTLED.len()].times);
}

/// A line for each run, and a chart of what is left in flight against the time.
fn report(runs: &[Run], base: [f64; 2]) {
    println!(
        "{:>23} | {:>7} {:>7} {:>7} | {:>8} {:>8} | {:>8} {:>8} {:>9}",
        "time over rapier's",
        "flight",
        "then",
        "in all",
        "flight",
        "at rest",
        "overlap",
        "speed",
        "energy"
    );
    for Run { name, times, left, overlap, end } in runs {
        println!(
            "{name:>23} | {:7.2} {:7.2} {:7.2} | {:8.1e} {:8.1e} | {overlap:8.1e} {:8.1e} {:9.1}",
            times[0] / base[0],
            times[1] / base[1],
            times.iter().sum::<f64>() / base.iter().sum::<f64>(),
            left[0],
            left[1],
            end.speed,
            end.energy
        );
    }
    for (phase, name) in ["in flight", "at rest"].into_iter().enumerate() {
        println!("what is left {name}, m/s, against the time over that of rapier's default");
        let mut points: Vec<_> =
            runs.iter().map(|r| (r.times[phase] / base[phase], r.left[phase], &r.name)).collect();
        points.sort_by(|a, b| b.1.total_cmp(&a.1));
        for (time, left, name) in points {
            let column = (10.0 * (time.log10() + 1.0)).clamp(0.0, 40.0) as usize;
            println!("{left:8.1e} |{:column$}* {time:.2} {name}", "");
        }
    }
}

fn velocity(p: &[f64], body: &Body) -> [f64; 6] {
    let w = body.angular_velocity(&Vector3::from_column_slice(&p[3..]));
    [p[0], p[1], p[2], w.x, w.y, w.z]
}
