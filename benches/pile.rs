//! A falling pile of boxes, against rapier3d-f64 at the same step, in the same run.
//!
//! `cargo bench --bench pile --features peers -- [boxes]` (1,000 by default) drops boxes from a
//! loose grid with friction: ours to its default tolerance and to 0.1, 0.03 and 0.003 m/s, rapier
//! with 4 (its default), 20 and 100 iterations, all from the same state, a step of each in turn. A line for each: its time over that of rapier's default,
//! in flight (the first second), afterwards and in all; how far the contact conditions are from
//! being met at worst, in flight and in the last quarter of a second; how deep boxes overlap, how
//! fast the fastest is at the end, and the energy. For rapier the conditions are only how fast its
//! boxes still close once their gaps are used up (a lower bound of the residual of ours, which
//! counts impulses and friction as well). Below, what is left against the time as a chart. Nothing
//! sleeps; one thread each.

mod box_quality;
mod rapier_boxes;

use std::time::Instant;

use stationary_contact::SpatialWorld;
use stationary_contact::problems::falling_boxes;

use self::box_quality::{Quality, look, poses, velocities};
use self::rapier_boxes::{STEP, rapier};

/// How long the pile falls, seconds.
const TIME: f64 = 3.0;
/// Until when it is in flight, and from when it is looked at as a heap, seconds.
const FLIGHT: f64 = 1.0;
const HEAP: f64 = 2.75;
/// Steps between two looks at rapier's conditions.
const LOOKS: usize = 25;
/// Contact conditions of ours are met to these tolerances, m/s; the default first.
const TOLERANCES: [Option<f64>; 4] = [None, Some(0.1), Some(0.03), Some(0.003)];
/// Iterations of rapier's solver; its default first.
const ITERATIONS: [usize; 3] = [4, 20, 100];

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
    let mut ours = TOLERANCES.map(|tolerance| {
        let mut bodies = SpatialWorld::new(pile.system.clone(), detector()).expect("bodies");
        let mut name = "default".to_owned();
        if let Some(tolerance) = tolerance {
            bodies = bodies.with_tolerance(tolerance).expect("a tolerance");
            name = format!("{tolerance:e} m/s");
        }
        (bodies, pile.state.clone(), Run { name, ..Run::default() })
    });
    let mut theirs = ITERATIONS.map(|iterations| {
        let (mut world, handles) = rapier(&pile.starts, false);
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
                run.end = look(&mut watch, &before, &poses(world, handles).1, &cube, STEP);
                run.saw(t, run.end.closing, run.end.overlap);
            }
        }
    }
    let ours = ours.map(|(_, state, mut run)| {
        run.end = look(&mut watch, &state.q, &velocities(&state.p.0, &cube), &cube, STEP);
        run
    });
    let runs: Vec<Run> = ours.into_iter().chain(theirs.map(|(_, _, run)| run)).collect();
    println!("{boxes} boxes, {steps} steps of {STEP} s, ours to the tolerance named");
    report(&runs, runs[TOLERANCES.len()].times);
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
