//! Friction problems as such: the solver of coupled rows beside nonsmooth Gauss-Seidel.

pub mod problem;

use std::time::Instant;

use stationary_chart::{Axis, Lines, Mark, Series};
use stationary_measure::{Column, Table};

use self::problem::{FrictionProblem, friction_problems};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Time of each over the better one's, over all problems.
pub const FRICTION_PROBLEMS: Entry<'static> = Entry {
    id: "friction-problems",
    krate: "contact",
    chapter: "11.5.1",
    kind: Kind::WorkPrecision,
    title: "Friction problems: coupled rows to 1e-10 beside nonsmooth Gauss-Seidel to 1e-4",
    tested: Tested::Claims,
    run: &study,
};

/// Residuals that are asked for, m/s, of problems whose free velocities are about 0.1 m/s.
const EXACT: f64 = 1e-10;
const ROUGH: f64 = 1e-4;
/// Sweeps after which Gauss-Seidel is stopped.
const SWEEPS: usize = 5_000;
/// A residual below it is rounding, m/s.
const LEAST: f64 = 1e-18;

/// What led to impulses, in the order of [`RowsMethod`](stationary_contact::RowsMethod).
const METHODS: [&str; 4] = ["Newton", "pivots", "interior point", "sweeps"];

fn study(size: Size) -> Result<Study, StudyError> {
    let count = if size == Size::Full { 400 } else { 80 };
    let problems = friction_problems(count, 27).map_err(StudyError::at("the problems"))?;
    let mut table = Table::new([
        Column::exact("problem"),
        Column::exact("contacts, joints"),
        Column::exact("coupled rows: led to by"),
        Column::rounded("residual [m/s]", 1, 1e-10),
        Column::exact("systems solved"),
        Column::rounded("Gauss-Seidel: residual [m/s]", 1, 1e-10),
        Column::exact("sweeps"),
        Column::volatile("coupled rows [s]"),
        Column::volatile("Gauss-Seidel [s]"),
    ]);
    let (mut solved, mut faster) = (0, 0);
    let mut ratios: [Vec<f64>; 2] = Default::default();
    let mut points: [Vec<(f64, f64)>; 5] = Default::default();
    for problem in &problems {
        // What is solved is what a file would hold.
        let problem = FrictionProblem::read(&problem.write())
            .map_err(StudyError::at(problem.name.as_str()))?;
        let clock = Instant::now();
        let exact = problem.solve(1e-3 * EXACT).map_err(StudyError::at(problem.name.as_str()))?;
        let exact_time = clock.elapsed().as_secs_f64();
        let clock = Instant::now();
        let (rough, sweeps) = problem.gauss_seidel(ROUGH, SWEEPS);
        let rough_time = clock.elapsed().as_secs_f64();
        let left = [problem.residual(&exact.0), problem.residual(&rough)];
        solved += usize::from(left[0] <= EXACT);
        let met = [left[0] <= EXACT, left[1] <= ROUGH];
        faster += usize::from(met[0] && (exact_time <= rough_time || !met[1]));
        let times = [exact_time, rough_time];
        let method = exact.1.method as usize;
        points[method].push((exact_time, left[0].max(LEAST)));
        points[METHODS.len()].push((rough_time, left[1].max(LEAST)));
        let best = (0..2).filter(|&k| met[k]).map(|k| times[k]).fold(f64::INFINITY, f64::min);
        for k in (0..2).filter(|&k| met[k]) {
            ratios[k].push(times[k] / best);
        }
        table.push([
            problem.name.as_str().into(),
            (problem.blocks() as u64).into(),
            METHODS[method].into(),
            left[0].into(),
            (exact.1.solved as u64).into(),
            left[1].into(),
            (sweeps as u64).into(),
            exact_time.into(),
            rough_time.into(),
        ]);
    }
    let axes =
        (Axis::log("time over the better one's", ""), Axis::linear("part of the problems", ""));
    let mut chart = Lines::new("Performance profile", axes.0, axes.1);
    for (name, ratios) in ["coupled rows, 1e-10", "Gauss-Seidel, 1e-4"].iter().zip(&mut ratios) {
        ratios.sort_by(f64::total_cmp);
        let part = |(k, ratio): (usize, &f64)| (*ratio, (k + 1) as f64 / count as f64);
        chart = chart.with(Series::new(name, ratios.iter().enumerate().map(part)));
    }
    let axes = (Axis::log("time", "s"), Axis::log("residual", "m/s"));
    let mut cost = Lines::new("Residual against time", axes.0, axes.1);
    let names = METHODS.into_iter().chain(["Gauss-Seidel"]);
    for (name, points) in names.zip(points).filter(|(_, points)| !points.is_empty()) {
        cost = cost.with(Series::new(name, points).marked(Mark::Markers));
    }
    let part = solved as f64 / count as f64;
    Ok(Study {
        conclusion: format!(
            "Blocks, chains of balls, columns, packings, and boxes on joints with dry friction, the kinds of the \
             FCLIB collection; where corners touch, rows depend on each other. Coupled rows try Newton's method, \
             then pivots, an interior point and sweeps, each where those before leave too much. They meet \
             1e-10 m/s on {:.0} of 100 problems; on {:.0} of 100 they do so before Gauss-Seidel meets 1e-4 \
             (shown, not asserted).",
            100.0 * part,
            100.0 * faster as f64 / count as f64
        ),
        table,
        charts: vec![chart.into(), cost.into()],
        claims: vec![Claim::number(
            "coupled rows: part of the problems with a residual below 1e-10 m/s",
            "at least 0.95",
            part,
            (0.95, 1.0),
        )],
        ..FRICTION_PROBLEMS.heading()
    })
}
