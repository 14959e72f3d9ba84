//! The studies of a user's own scene: which method to write into its file, and at which step.
//!
//! The scene is run with every method from an eighth of its own number of steps to eight times as
//! many. The reference is made here; what it cannot tell apart is not judged.

use std::ops::ControlFlow;

use stationary_calculus::{Cell, Column, Metric, Table};
use stationary_integrators::{
    Horizon, Method, State, angular_momentum, angular_momentum_scale, linear_momentum,
    linear_momentum_scale, simulate,
};
use stationary_scene::{Scene, SceneProblem};

use super::reference::{Samples, with_reference};
use super::work_precision::{Run, cheapest, run, show, verdicts};
use crate::chart::{Axis, Lines, Series};
use crate::study::{Claim, Entry, Kind, Measure, Size, Study, StudyError};

/// Errors for which a method is named, relative to the scene's size.
const TOLERANCES: [f64; 4] = [1e-2, 1e-4, 1e-6, 1e-8];

/// A tolerance is judged where the reference is this many times better.
const MARGIN: f64 = 10.0;

/// Most times at which the reference is kept.
const SAMPLES: u64 = 500;

/// The entries of both studies, given how each is made: [`work_precision`] and [`long_run`].
pub fn entries<'a>(work_precision: &'a Measure<'a>, long_run: &'a Measure<'a>) -> Vec<Entry<'a>> {
    vec![labels(&WORK_PRECISION, work_precision), labels(&LONG_RUN, long_run)]
}

type Labels = (&'static str, Kind, &'static str);

const WORK_PRECISION: Labels =
    ("scene-work-precision", Kind::WorkPrecision, "What a digit costs in your scene");
const LONG_RUN: Labels =
    ("scene-long-run", Kind::LongRun, "Energy and momentum in your scene, at its own step");

fn labels<'a>(&(id, kind, title): &Labels, run: &'a Measure<'a>) -> Entry<'a> {
    Entry { id, krate: "scene", chapter: "your scene", kind, title, run }
}

/// Error against cost for every method, and which of them to choose.
///
/// # Errors
/// Where the scene makes no system, or the reference cannot be made.
pub fn work_precision(scene: &Scene, size: Size) -> Result<Study, StudyError> {
    match scene.dimension() {
        1 => work_precision_in::<1>(scene, size),
        2 => work_precision_in::<2>(scene, size),
        _ => work_precision_in::<3>(scene, size),
    }
}

/// Energy, momenta and error of every method at the scene's own step.
///
/// # Errors
/// Where the scene makes no system.
pub fn long_run(scene: &Scene, _: Size) -> Result<Study, StudyError> {
    match scene.dimension() {
        1 => long_run_in::<1>(scene),
        2 => long_run_in::<2>(scene),
        _ => long_run_in::<3>(scene),
    }
}

fn problem<const D: usize>(scene: &Scene) -> Result<SceneProblem<D>, StudyError> {
    let by_impulses = scene.contact().is_some_and(|contact| contact.stiffness.is_none());
    let beyond = match (scene.drag(), scene.rods()) {
        (Some(_), _) => Some("drag"),
        (None, [_, ..]) => Some("rods"),
        (None, []) if by_impulses => Some("contact by impulses"),
        (None, []) => None,
    };
    match beyond {
        Some(what) => Err(StudyError::NotCompared { scene: scene.title().to_owned(), what }),
        None => scene.problem::<D>().map_err(StudyError::at(scene.title())),
    }
}

fn work_precision_in<const D: usize>(scene: &Scene, size: Size) -> Result<Study, StudyError> {
    // Seconds after which no finer run is made.
    let longest = match size {
        Size::Default => 0.3,
        Size::Full => 30.0,
    };
    let own = scene.timing().steps();
    let count = (own / 8).clamp(1, SAMPLES);
    let per_sample = own.div_ceil(count);
    let at = Samples { count, coarsest: 4 * per_sample };
    let problem = with_reference(problem::<D>(scene)?, at)?;
    let coarsest = (per_sample / 8).max(1);
    let steps =
        || (0..).map(|k| count * (coarsest << k)).take_while(|&n| n <= count * per_sample * 8);
    let mut runs = Vec::new();
    for &method in Method::ALL {
        let name = method.facts().name;
        let integrator = scene.integrator(&problem, method).map_err(StudyError::at(name))?;
        runs.extend(run(&problem, method, integrator, steps(), longest)?);
    }
    let (table, counted, timed) = show(&runs, Method::ALL);
    Ok(Study {
        id: WORK_PRECISION.0,
        krate: "scene",
        chapter: "your scene",
        kind: WORK_PRECISION.1,
        title: format!("{}: what a digit costs", scene.title()),
        conclusion: advice(scene, &runs, problem.solution_error),
        table,
        charts: vec![counted.into(), timed.into(), by_step(&runs).into()],
        claims: vec![Claim::number(
            "two methods agree on the answer that errors are taken against, relative to the \
             scene's size",
            format!("{:e} or better", TOLERANCES[0] / MARGIN),
            problem.solution_error,
            (0.0, TOLERANCES[0] / MARGIN),
        )],
    })
}

/// What to write into the scene's file.
fn advice(scene: &Scene, runs: &[Run], uncertainty: f64) -> String {
    let judged = TOLERANCES.into_iter().filter(|tolerance| uncertainty * MARGIN < *tolerance);
    let best: Vec<(f64, &Run)> =
        judged.filter_map(|tolerance| Some((tolerance, cheapest(runs, tolerance)?))).collect();
    let names: Vec<(f64, &str)> =
        best.iter().map(|(tolerance, run)| (*tolerance, run.method.facts().name)).collect();
    let lines = best.iter().map(|(tolerance, run)| {
        let (name, step) = (run.method.facts().name, run.horizon.step());
        format!("for {tolerance:e}: integrator = \"{name}\" and step = {step}")
    });
    let said = if best.is_empty() {
        "No charted run meets a tolerance that the reference can judge.".to_owned()
    } else {
        let lines = lines.collect::<Vec<_>>().join("; ");
        format!("By counted work {}. To say so in the scene's file: {lines}.", verdicts(&names))
    };
    format!(
        "The largest error of a configuration over the scene's {} {}, relative to the scene's size, \
         against its cost. The answer that errors are taken against is a Störmer-Verlet run \
         extrapolated to a step of zero; a run of another method, of order 8, differs from it by \
         {uncertainty:.1e}, and charted errors below that mean nothing. {said}",
        scene.timing().horizon(),
        scene.units().time,
    )
}

fn by_step(runs: &[Run]) -> Lines {
    let axis = Axis::log("step", "");
    let mut chart = Lines::new("By step", axis, Axis::log("largest error", ""));
    for runs in runs.chunk_by(|a, b| a.method == b.method) {
        let points = runs.iter().filter_map(|run| Some((run.horizon.step(), run.error()?)));
        let mut series = Series::new(runs[0].method.facts().name, points);
        for run in runs {
            if let Err(failure) = &run.outcome {
                series = series.failed(run.horizon.step(), failure.to_string());
            }
        }
        chart = chart.with(series);
    }
    chart
}

/// The largest deviations up to some time.
#[derive(Clone, Copy, Default)]
struct Drift {
    energy: f64,
    linear: f64,
    angular: f64,
}

fn long_run_in<const D: usize>(scene: &Scene) -> Result<Study, StudyError> {
    let problem = problem::<D>(scene)?;
    let mut chart = Lines::new(
        "Energy",
        Axis::log("time", &scene.units().time),
        Axis::log("largest energy error", ""),
    );
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("energy error", 2, 1e-12),
        Column::rounded("linear momentum drift", 2, 1e-12),
        Column::rounded("angular momentum drift", 2, 1e-12),
        Column::exact("evaluations"),
    ]);
    for &method in Method::ALL {
        let name = method.facts().name;
        let (course, drift, end) = follow(scene, &problem, method)?;
        let mut series = Series::new(name, course);
        let mut cells: Vec<Cell> = vec![name.into()];
        cells.extend([drift.energy, drift.linear, drift.angular].map(Cell::from));
        match end {
            Ok(evaluations) => cells.push(evaluations.into()),
            Err((time, reason)) => {
                cells.push(format!("failed at t = {time:.3}").into());
                series = series.failed(time, reason);
            }
        }
        table.push(cells);
        chart = chart.with(series);
    }
    Ok(Study {
        id: LONG_RUN.0,
        krate: "scene",
        chapter: "your scene",
        kind: LONG_RUN.1,
        title: format!("{}: energy and momentum at its own step", scene.title()),
        conclusion: format!(
            "The scene at its own step of {}, with every method. Energy is relative to the kinetic \
             energy at its largest, momenta to the sums of the particles' magnitudes. Gravity \
             towards a floor and pinned particles change momenta rightly; then they say nothing of \
             a method.",
            scene.timing().step()
        ),
        table,
        charts: vec![chart.into()],
        claims: Vec::new(),
    })
}

type End = Result<u64, (f64, String)>;
type Course = Vec<(f64, f64)>;

fn follow<const D: usize>(
    scene: &Scene,
    problem: &SceneProblem<D>,
    method: Method,
) -> Result<(Course, Drift, End), StudyError> {
    let name = method.facts().name;
    let mut integrator = scene.integrator(problem, method).map_err(StudyError::at(name))?;
    let steps = scene.timing().steps();
    let horizon = Horizon::divided(problem.horizon, steps).map_err(StudyError::at(name))?;
    let mut state = problem.initial.clone();
    let momenta =
        |state: &State<Vec<f64>>| (linear_momentum::<D>(state), angular_momentum::<D>(state));
    let (energy, (linear, angular)) = (problem.energy(&state), momenta(&state));
    let (mut drift, mut kinetic, mut course, mut next) =
        (Drift::default(), f64::MIN_POSITIVE, Vec::new(), 1_u64);
    let mut energy_off = 0.0_f64;
    let result = simulate(&mut *integrator, &mut state, horizon, |now| {
        let state = now.state;
        kinetic = kinetic.max(problem.system.metric().kinetic_energy(state.p.view()));
        energy_off = energy_off.max((problem.energy(state) - energy).abs());
        let (p, l) = momenta(state);
        drift.energy = energy_off / kinetic;
        drift.linear = drift.linear.max(off(&p, &linear) / linear_momentum_scale::<D>(state));
        drift.angular = drift.angular.max(off(&l, &angular) / angular_momentum_scale::<D>(state));
        if now.step == next || now.step == steps {
            course.push((state.t, drift.energy));
            next = (next * 5 / 4).max(next + 1);
        }
        ControlFlow::Continue(())
    });
    let end = match result {
        Ok(cost) => Ok(cost.differentials + cost.hessians),
        Err(failure) => Err((failure.time, failure.to_string())),
    };
    Ok((course, drift, end))
}

fn off(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}
