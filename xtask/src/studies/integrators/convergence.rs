//! Convergence of every integrator on two problems with known answers.

use stationary_calculus::{Metric, Potential};
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{Problem, kepler, pendulum};
use stationary_integrators::{Convergence, Method};
use stationary_measure::{Cell, Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Kepler's problem at e = 0.6.
pub const KEPLER: Entry<'static> = Entry {
    id: "kepler-convergence",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::Convergence,
    title: "Eccentric orbit: error of eight methods against the step",
    tested: Tested::ByReport,
    run: &|size| {
        let mut problem = kepler(0.6).map_err(StudyError::at("the orbit"))?;
        problem.horizon = problem.period;
        study(KEPLER, &problem, size, "one orbit of eccentricity 0.6")
    },
};

/// The pendulum released from 115 degrees.
pub const PENDULUM: Entry<'static> = Entry {
    id: "pendulum-convergence",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::Convergence,
    title: "Swinging pendulum: error of eight methods against the step",
    tested: Tested::ByReport,
    run: &|size| {
        let mut problem = pendulum(2.0).map_err(StudyError::at("the pendulum"))?;
        problem.horizon = problem.period;
        study(PENDULUM, &problem, size, "one swing of a pendulum released from 2 rad")
    },
};

/// How far a measured order may be from the claimed one.
const BAND: f64 = 0.1;

fn study<M: Metric, P: Potential, const N: usize>(
    entry: Entry<'_>,
    problem: &Problem<M, P, [f64; N]>,
    size: Size,
    motion: &str,
) -> Result<Study, StudyError> {
    let mut chart = Lines::new("", Axis::log("step", "s"), Axis::log("largest error", ""));
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("steps"),
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("error", 2, 1e-11),
    ]);
    let mut claims = Vec::new();
    for method in Method::TABLE_4_1 {
        let facts = method.facts();
        // Low orders need more steps until their error follows its law.
        let finest = match (size, facts.order) {
            (Size::Default, 1) => 18,
            (Size::Default, _) => 16,
            (Size::Full, 1) => 22,
            (Size::Full, _) => 20,
        };
        let steps = (6..=finest).map(|k| 1_u64 << k);
        let measured =
            Convergence::measure(problem, method, steps).map_err(StudyError::at(facts.name))?;
        let mut series = Series::new(facts.name, measured.errors());
        for row in &measured.rows {
            let step = row.horizon.step();
            let mut cells: Vec<Cell> =
                vec![facts.name.into(), row.horizon.steps().into(), step.into()];
            match &row.outcome {
                Ok(run) => cells.push(run.error.map_or("not known".into(), Cell::from)),
                Err(error) => {
                    series = series.failed(step, error.to_string());
                    cells.push(format!("failed at t = {:.3}", error.time).into());
                }
            }
            table.push(cells);
        }
        chart = chart.with(series);
        let claimed = f64::from(facts.order);
        claims.push(Claim::number(
            format!("{} has order {}", facts.name, facts.order),
            format!("{claimed}"),
            measured.order().unwrap_or(f64::NAN),
            (claimed - BAND, claimed + BAND),
        ));
    }
    let chart = chart.slope(1.0, (1e-3, 1e-1)).slope(2.0, (1e-2, 3e-6)).slope(4.0, (1e-2, 3e-10));
    Ok(Study {
        conclusion: format!(
            "The largest error along {motion}, against the step. Halving the step halves the error \
             of a method of order 1, quarters that of order 2, and divides that of RK4 by 16, until \
             rounding takes over. The notes' \"velocity Verlet\" is symplectic Euler: order 1; \
             splitting its kick in two makes Störmer-Verlet: order 2, at the same cost."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..entry.heading()
    })
}
