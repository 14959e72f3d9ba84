//! Error against cost: what each method's digits cost, on one planet and on five.

use std::hint::black_box;

use stationary_calculus::{Cell, Column, Metric, Potential, Storage, Table};
use stationary_integrators::problems::{Problem, kepler};
use stationary_integrators::{Delivered, Evaluation, Horizon, Method, deliver, simulate};

use super::outer_solar_system;
use crate::chart::{Axis, Lines, Series};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError};
use crate::timing::median_wall;

/// Kepler's problem at e = 0.6, ten orbits.
pub const KEPLER: Entry = Entry {
    id: "kepler-work-precision",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "What a digit costs on an eccentric orbit",
    run: |size| {
        let problem = kepler(0.6).map_err(StudyError::at("the orbit"))?;
        let steps = |method: Method| {
            let finest = match (size, method.facts().evaluation) {
                (Size::Default, Evaluation::Explicit) => 18,
                (Size::Default, Evaluation::Implicit) => 15,
                (Size::Full, _) => 20,
            };
            (8..=finest).map(|k| 1_u64 << k).collect()
        };
        let expected = ["runge-kutta-4", "runge-kutta-4", "runge-kutta-4"];
        study(KEPLER, &problem, steps, expected, "ten orbits of eccentricity 0.6")
    },
};

/// The outer solar system over 200,000 days.
pub const OUTER_SOLAR_SYSTEM: Entry = Entry {
    id: "outer-solar-system-work-precision",
    krate: "scene",
    chapter: "4.5",
    kind: Kind::WorkPrecision,
    title: "What a digit costs in the outer solar system",
    run: |size| {
        let problem = outer_solar_system::with_reference()?;
        let steps = |method: Method| {
            let finest = match (size, method.facts().evaluation) {
                (Size::Default, Evaluation::Explicit) => 9,
                (Size::Default, Evaluation::Implicit) => 6,
                (Size::Full, Evaluation::Explicit) => 11,
                (Size::Full, Evaluation::Implicit) => 9,
            };
            (0..=finest).map(|k| outer_solar_system::SAMPLES << k).collect()
        };
        let expected = ["runge-kutta-4", "runge-kutta-4", "runge-kutta-4"];
        let motion = "200,000 days of the Sun, Jupiter, Saturn, Uranus, Neptune and Pluto";
        study(OUTER_SOLAR_SYSTEM, &problem, steps, expected, motion)
    },
};

/// Errors for which the cheapest method is named.
const TOLERANCES: [f64; 3] = [1e-2, 1e-4, 1e-6];

/// The least counted work at which a method meets a tolerance: read off between two runs.
pub(super) fn cost_at(tolerance: f64, runs: &Series) -> Option<f64> {
    let mut least: Option<f64> = None;
    for pair in runs.points.windows(2) {
        let [(work, error), (more_work, less_error)] = [pair[0], pair[1]];
        if error > tolerance && less_error <= tolerance {
            let part = (error / tolerance).ln() / (error / less_error).ln();
            let cost = work * (more_work / work).powf(part);
            least = Some(least.map_or(cost, |least| least.min(cost)));
        }
    }
    least
}

fn study<M: Metric, P: Potential, C: Storage>(
    entry: Entry,
    problem: &Problem<M, P, C>,
    steps: impl Fn(Method) -> Vec<u64>,
    expected: [&str; 3],
    motion: &str,
) -> Result<Study, StudyError> {
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
    let mut smallest = f64::INFINITY;
    for method in Method::TABLE_4_1 {
        let name = method.facts().name;
        let (mut by_count, mut by_time) = (Series::new(name, []), Series::new(name, []));
        for steps in steps(method) {
            let horizon = Horizon::divided(problem.horizon, steps).map_err(StudyError::at(name))?;
            let mut integrator =
                method.integrator(&problem.system).map_err(StudyError::at(name))?;
            let mut cells: Vec<Cell> = vec![name.into(), steps.into()];
            match deliver(problem, &mut *integrator, horizon) {
                Ok(Delivered { error, cost, .. }) => {
                    let wall = median_wall(5, || {
                        let mut state = problem.initial.clone();
                        let run = simulate(&mut *integrator, &mut state, horizon, |_| {
                            std::ops::ControlFlow::Continue(())
                        });
                        black_box((run.is_ok(), state));
                    });
                    let evaluations = cost.differentials + cost.hessians;
                    by_count.points.push((evaluations as f64, error));
                    by_time.points.push((wall.median, error));
                    cells.extend([evaluations.into(), error.into()]);
                    cells.extend([wall.median, wall.min, wall.max].map(Cell::from));
                    smallest = smallest.min(error);
                }
                Err(failure) => {
                    // The cost that it would have had, at one evaluation a step, places the cross.
                    by_count = by_count.failed(steps as f64, failure.to_string());
                    cells.extend([
                        Cell::from("-"),
                        format!("failed at t = {:.1}", failure.time).into(),
                    ]);
                }
            }
            table.push(cells);
        }
        counted = counted.with(by_count);
        timed = timed.with(by_time);
    }
    let mut claims = Vec::new();
    let mut verdicts: Vec<(String, String)> = Vec::new();
    for (tolerance, expected) in TOLERANCES.into_iter().zip(expected) {
        let costs = counted
            .series
            .iter()
            .filter_map(|runs| cost_at(tolerance, runs).map(|cost| (cost, runs.name.as_str())));
        let cheapest = costs.min_by(|a, b| a.0.total_cmp(&b.0)).map_or("no method", |best| best.1);
        let text = format!("cheapest by counted work at an error of {tolerance:e}");
        claims.push(Claim::words(text, expected, cheapest));
        match verdicts.last_mut() {
            Some((name, tolerances)) if *name == cheapest => {
                *tolerances = format!("{tolerances} and {tolerance:e}");
            }
            _ => verdicts.push((cheapest.to_owned(), format!("{tolerance:e}"))),
        }
    }
    claims.push(Claim::number(
        "the answer that errors are taken against is better than the smallest error charted",
        "below 1",
        problem.solution_error / smallest,
        (0.0, 1.0),
    ));
    let verdicts: Vec<String> = verdicts
        .into_iter()
        .map(|(name, tolerances)| format!("{name} is cheapest for an error of {tolerances}"))
        .collect();
    Ok(Study {
        id: entry.id,
        krate: entry.krate,
        chapter: entry.chapter,
        kind: entry.kind,
        title: entry.title.into(),
        conclusion: format!(
            "The largest error over {motion}, against what it costs: lower and further left is \
             better, and the marked line joins the runs that no other run beats. By counted work \
             {}. A cross at the top is a run that failed; pointing at it tells why.",
            verdicts.join(", ")
        ),
        table,
        charts: vec![counted.into(), timed.into()],
        claims,
    })
}
