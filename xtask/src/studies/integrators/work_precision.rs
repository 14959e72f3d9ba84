//! Error against cost: what each method's digits cost, on one planet and on five.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use stationary_calculus::{Metric, Potential, Storage};
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{Problem, kepler};
use stationary_integrators::{
    Delivered, Evaluation, Horizon, Integrator, Method, SimulationError, deliver, simulate,
};
use stationary_measure::{Cell, Column, Table};

use super::reference::{Samples, with_reference};
use crate::studies::cheapest::{Asked, cost_at};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};
use crate::timing::{Wall, median_wall};

/// Kepler's problem at e = 0.6, ten orbits.
pub const KEPLER: Entry<'static> = Entry {
    id: "kepler-work-precision",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Eccentric orbit: error of eight methods against cost",
    tested: Tested::ByReport,
    run: &|size| {
        let problem = kepler(0.6).map_err(StudyError::at("the orbit"))?;
        let steps = |method: Method| {
            let finest = match (size, method.facts().evaluation) {
                (Size::Default, Evaluation::Explicit) => 17,
                (Size::Default, Evaluation::Implicit) => 15,
                (Size::Full, _) => 20,
            };
            (8..=finest).map(|k| 1_u64 << k).collect()
        };
        let motion = "ten orbits of eccentricity 0.6";
        study(KEPLER, &problem, steps, &Contest { motion, ..TABLE_4_1 })
    },
};

/// Times at which the outer solar system is known.
pub(super) const OUTER: Samples = Samples { count: 500, coarsest: 128 };

/// The outer solar system over 200,000 days.
pub const OUTER_SOLAR_SYSTEM: Entry<'static> = Entry {
    id: "outer-solar-system-work-precision",
    krate: "scene",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "Outer solar system: error of eight methods against cost",
    tested: Tested::ByReport,
    run: &|size| {
        let problem = stationary_scene::problems::outer_solar_system()
            .map_err(StudyError::at("the outer solar system"))?;
        let problem = with_reference(problem, OUTER)?;
        let steps = |method: Method| {
            let finest = match (size, method.facts().evaluation) {
                (Size::Default, Evaluation::Explicit) => 8,
                (Size::Default, Evaluation::Implicit) => 6,
                (Size::Full, Evaluation::Explicit) => 11,
                (Size::Full, Evaluation::Implicit) => 9,
            };
            (0..=finest).map(|k| OUTER.count << k).collect()
        };
        study(OUTER_SOLAR_SYSTEM, &problem, steps, &Contest { motion: PLANETS, ..TABLE_4_1 })
    },
};

/// The motion of the outer solar system in words.
pub(super) const PLANETS: &str =
    "200,000 days of the Sun, Jupiter, Saturn, Uranus, Neptune and Pluto";

/// The methods of the notes' table.
const TABLE_4_1: Contest<'_> = Contest {
    methods: &Method::TABLE_4_1,
    cheapest: [(1e-2, "runge-kutta-4"), (1e-4, "runge-kutta-4"), (1e-6, "runge-kutta-4")],
    motion: "",
    asked: None,
};

/// A method at one step.
pub(super) struct Run {
    pub(super) method: Method,
    pub(super) horizon: Horizon,
    pub(super) outcome: Result<(Delivered, Wall), SimulationError>,
}

impl Run {
    /// The deterministic cost: evaluations of the force and of its derivative.
    pub(super) fn evaluations(&self) -> Option<u64> {
        let (Delivered { cost, .. }, _) = self.outcome.as_ref().ok()?;
        Some(cost.differentials + cost.hessians)
    }

    /// The largest error along the trajectory.
    pub(super) fn error(&self) -> Option<f64> {
        self.outcome.as_ref().ok().and_then(|(delivered, _)| delivered.error)
    }
}

/// Runs one method at growing numbers of steps, until a run takes longer than `longest` seconds; of
/// that one the wall time is taken once, of the others five times.
pub(super) fn run<M: Metric, P: Potential, C: Storage>(
    problem: &Problem<M, P, C>,
    method: Method,
    mut integrator: Box<dyn Integrator<C> + '_>,
    steps: impl IntoIterator<Item = u64>,
    longest: f64,
) -> Result<Vec<Run>, StudyError> {
    let mut runs = Vec::new();
    for steps in steps {
        let horizon = Horizon::divided(problem.horizon, steps)
            .map_err(StudyError::at(method.facts().name))?;
        let start = Instant::now();
        let delivered = deliver(problem, &mut *integrator, horizon);
        let once = start.elapsed().as_secs_f64();
        let outcome = delivered.map(|delivered| {
            if once > longest {
                return (delivered, Wall { median: once, min: once, max: once });
            }
            let wall = median_wall(|| {
                let mut state = problem.initial.clone();
                let run =
                    simulate(&mut *integrator, &mut state, horizon, |_| ControlFlow::Continue(()));
                black_box((run.is_ok(), state));
            });
            (delivered, wall)
        });
        runs.push(Run { method, horizon, outcome });
        if once > longest {
            break;
        }
    }
    Ok(runs)
}

/// The runs as a table and two charts, by counted work and by wall time.
pub(super) fn show(runs: &[Run], methods: &[Method]) -> (Table, Lines, Lines) {
    let error_axis = || Axis::log("largest error", "");
    let evaluations_axis = Axis::log("evaluations of the force and its derivative", "");
    let mut counted = Lines::new("By counted work", evaluations_axis, error_axis()).mark_front();
    let mut timed = Lines::new("By wall time", Axis::log("wall time", "s"), error_axis());
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("steps"),
        Column::exact("evaluations"),
        Column::rounded("error", 2, 1e-10),
        Column::volatile("wall [s]"),
        Column::volatile("fastest [s]"),
        Column::volatile("slowest [s]"),
    ]);
    for &method in methods {
        let name = method.facts().name;
        let (mut by_count, mut by_time) = (Series::new(name, []), Series::new(name, []));
        for run in runs.iter().filter(|run| run.method == method) {
            let mut cells: Vec<Cell> = vec![name.into(), run.horizon.steps().into()];
            match (&run.outcome, run.evaluations()) {
                (Ok((Delivered { error, .. }, wall)), Some(evaluations)) => {
                    if let Some(error) = *error {
                        by_count.points.push((evaluations as f64, error));
                        by_time.points.push((wall.median, error));
                    }
                    let error = error.map_or("not known".into(), Cell::from);
                    cells.extend([evaluations.into(), error]);
                    cells.extend([wall.median, wall.min, wall.max].map(Cell::from));
                }
                (Err(failure), _) => {
                    // The cost that it would have had, at one evaluation a step, places the cross.
                    by_count = by_count.failed(run.horizon.steps() as f64, failure.to_string());
                    cells.push(Cell::from("-"));
                    cells.push(format!("failed at t = {:.1}", failure.time).into());
                }
                (Ok(_), None) => {}
            }
            table.push(cells);
        }
        counted = counted.with(by_count);
        timed = timed.with(by_time);
    }
    (table, counted, timed)
}

/// The method with the least counted work at which it meets a tolerance, read off between two runs,
/// and that of its charted runs which meets it in the fewest steps.
pub(super) fn cheapest(runs: &[Run], tolerance: f64) -> Option<&Run> {
    let mut best: Option<(f64, &Run)> = None;
    for runs in runs.chunk_by(|a, b| a.method == b.method) {
        let measured: Vec<(f64, f64, &Run)> = runs
            .iter()
            .filter_map(|run| Some((run.evaluations()? as f64, run.error()?, run)))
            .collect();
        let points: Vec<_> = measured.iter().map(|&(work, error, _)| (work, error)).collect();
        let Some(cost) = cost_at(tolerance, &points) else { continue };
        let Some(&(.., run)) = measured.iter().find(|run| run.1 <= tolerance) else { continue };
        if best.is_none_or(|(least, _)| cost < least) {
            best = Some((cost, run));
        }
    }
    best.map(|(_, run)| run)
}

/// Who is cheapest at which tolerances, neighbours with the same answer in one phrase.
pub(super) fn verdicts(cheapest: &[(f64, &str)]) -> String {
    let phrases = cheapest.chunk_by(|a, b| a.1 == b.1).map(|same| {
        let at: Vec<String> = same.iter().map(|(tolerance, _)| format!("{tolerance:e}")).collect();
        format!("{} is cheapest for an error of {}", same[0].1, at.join(" or "))
    });
    phrases.collect::<Vec<_>>().join(", ")
}

/// What a study compares, and who is expected to be cheapest at which error.
pub(super) struct Contest<'a> {
    pub(super) methods: &'a [Method],
    pub(super) cheapest: [(f64, &'a str); 3],
    /// The motion in words.
    pub(super) motion: &'a str,
    /// What it answers on the page's first screen.
    pub(super) asked: Option<Asked<'a>>,
}

/// The study of a problem with methods that need nothing but its system.
pub(super) fn study<M: Metric, P: Potential, C: Storage>(
    entry: Entry<'_>,
    problem: &Problem<M, P, C>,
    steps: impl Fn(Method) -> Vec<u64>,
    contest: &Contest<'_>,
) -> Result<Study, StudyError> {
    let mut runs = Vec::new();
    for &method in contest.methods {
        let name = method.facts().name;
        let integrator = method.integrator(&problem.system).map_err(StudyError::at(name))?;
        runs.extend(run(problem, method, integrator, steps(method), f64::INFINITY)?);
    }
    let (table, counted, timed) = show(&runs, contest.methods);
    let best = contest.cheapest.map(|(tolerance, _)| {
        (tolerance, cheapest(&runs, tolerance).map_or("no method", |run| run.method.facts().name))
    });
    let mut claims: Vec<Claim> = best
        .iter()
        .zip(contest.cheapest)
        .map(|(&(tolerance, cheapest), (_, expected))| {
            let text = format!("cheapest by counted work at an error of {tolerance:e}");
            Claim::words(text, expected, cheapest)
        })
        .collect();
    let finest = contest.cheapest.iter().map(|best| best.0).fold(f64::INFINITY, f64::min);
    claims.push(Claim::number(
        "the answer that errors are taken against, relative to the finest of these errors",
        "below 0.1",
        problem.solution_error / finest,
        (0.0, 0.1),
    ));
    let answers = contest.asked.iter().filter_map(|asked| asked.of(&counted)).collect();
    Ok(Study {
        answers,
        conclusion: format!(
            "The largest error over {}, against what it costs: lower and further left is better, \
             and the marked line joins the runs that no other run beats. By counted work {}. A \
             cross at the top is a run that failed; pointing at it tells why.",
            contest.motion,
            verdicts(&best)
        ),
        table,
        charts: vec![counted.into(), timed.into()],
        claims,
        ..entry.heading()
    })
}
