//! A hundred columns of ten resting boxes, against rapier3d-f64 at the same step, in the same run.
//!
//! `cargo bench --bench columns --features peers` prints the ratio of times a step (ours over
//! rapier's, its boxes kept awake, then asleep), then a table of times and of what each leaves after
//! two seconds: how deep boxes overlap, how fast the fastest moves, how far the contact conditions
//! are from being met, and how far boxes have drifted. For rapier the conditions are only how fast
//! its boxes still close (a lower bound of the residual of ours, which counts impulses and friction
//! as well). Rapier's number of solver iterations is its default; one thread each.

mod box_quality;
mod in_turn;
mod rapier_boxes;

use nalgebra::Vector3;
use stationary_contact::problems::columns_of_boxes;
use stationary_contact::{SpatialWorld, WorldReport};
use stationary_integrators::State;

use self::box_quality::{Quality, look, poses, velocities};
use self::rapier_boxes::{STEP, rapier};

const COLUMNS: usize = 100;
const HIGH: usize = 10;
/// Steps after which quality is looked at.
const STEPS: usize = 2_000;

/// How far the farthest has moved, m.
fn drift(q: &[f64], from: &[f64]) -> f64 {
    let moved = |(q, from): (&[f64], &[f64])| {
        (Vector3::from_column_slice(&q[..3]) - Vector3::from_column_slice(&from[..3])).norm()
    };
    q.chunks_exact(7).zip(from.chunks_exact(7)).map(moved).fold(0.0, f64::max)
}

fn main() {
    let boxes = columns_of_boxes(COLUMNS, HIGH).expect("columns");
    let cube = boxes.system.metric().bodies()[0];
    let detector = || boxes.detector().expect("colliders of these bodies");
    let (start, mut watch) = (&boxes.state.q, detector());
    let mut state = boxes.state.clone();
    let mut bodies = SpatialWorld::new(boxes.system.clone(), detector()).expect("bodies");
    let mut worst = WorldReport::default();
    let mut step = |state: &mut State<Vec<f64>>| {
        let report = bodies.step(state, STEP).expect("a step of resting boxes");
        worst.residual = worst.residual.max(report.residual);
        worst.coulomb = worst.coulomb.max(report.coulomb);
    };
    let mut rows = Vec::new();
    for can_sleep in [false, true] {
        let (mut world, handles) = rapier(&boxes.starts, can_sleep);
        (0..STEPS).for_each(|_| world.step());
        let asleep = if can_sleep { "asleep" } else { "awake" };
        let iterations = world.integration_parameters.num_solver_iterations;
        let name = format!("rapier, {asleep}, {iterations} iterations");
        let ratio = in_turn::ratio(
            &format!("a step of ours over one of {name}"),
            || step(&mut state),
            || world.step(),
        );
        let (q, v) = poses(&world, &handles);
        rows.push((name, ratio.recip(), look(&mut watch, &q, &v, &cube, STEP), drift(&q, start)));
    }
    (0..STEPS).for_each(|_| step(&mut state));
    let quality = look(&mut watch, &state.q, &velocities(&state.p.0, &cube), &cube, STEP);
    let closing = worst.residual.max(worst.coulomb);
    let quality = Quality { closing, ..quality };
    rows.insert(0, ("ours".to_owned(), 1.0, quality, drift(&state.q, start)));
    println!(
        "{:>30} | {:>8} {:>9} {:>9} {:>9} {:>9}",
        "", "time", "overlap", "speed", "off", "drift"
    );
    for (name, time, Quality { overlap, speed, closing, .. }, drift) in rows {
        println!("{name:>30} | {time:8.3} {overlap:9.1e} {speed:9.1e} {closing:9.1e} {drift:9.1e}");
    }
}
