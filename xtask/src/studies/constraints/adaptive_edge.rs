//! Adaptive RATTLE from loose tolerances to those that no step meets, and beside other obstacles.

mod obstacles;

use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::problems::{Pendulum, pendulum};
use stationary_constraints::{
    Adaptive, Composed, ConstrainedIntegrator, ConstraintError, Dense, Rattle, Redundancy,
    StepTolerance,
};
use stationary_integrators::Scheme;
use stationary_measure::{Cell, Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Where steps of their own length end.
pub const ADAPTIVE_EDGE: Entry<'static> = Entry {
    id: "adaptive-edge",
    krate: "constraints",
    chapter: "6.5",
    kind: Kind::Limit,
    title: "Pendulum, steps of their own length: error against tolerance, down to where no step meets it",
    tested: Tested::Claims,
    run: &study,
};

const TIME: f64 = 1.0;
/// More steps than any tolerance takes that can be met.
const MOST: u32 = 100_000;

/// How a run ended.
enum End {
    Done {
        error: f64,
        steps: u32,
    },
    /// The error of the shortest step that was tried, in metres.
    TooShort {
        error: f64,
    },
    Crawls,
}

/// From a first step that is tried to a time.
fn run<I>(
    problem: &Pendulum,
    integrator: I,
    absolute: f64,
    (first, time): (f64, f64),
) -> Result<End, StudyError>
where
    I: ConstrainedIntegrator<[f64; 2]> + Clone,
{
    let mut state = problem.problem.initial.clone();
    let tolerance = StepTolerance { absolute, relative: 0.0 };
    let mut method = Adaptive::new(integrator, tolerance, first, &state)
        .map_err(StudyError::at("a tolerance"))?;
    for steps in 1..=MOST {
        match method.advance(&mut state, time) {
            Ok(step) if step.to < time => {}
            Ok(_) => return Ok(End::Done { error: problem.error(time, &state.q), steps }),
            Err(ConstraintError::StepTooShort { error, .. }) => {
                return Ok(End::TooShort { error: error * absolute });
            }
            Err(error) => return Err(StudyError::at("a step")(error)),
        }
    }
    Ok(End::Crawls)
}

fn study(_: Size) -> Result<Study, StudyError> {
    let problem = pendulum(1.0).map_err(StudyError::at("the pendulum"))?;
    let (system, rods, initial) =
        (&problem.problem.system, &problem.problem.rods, &problem.problem.initial);
    let rattle = || {
        Rattle::new(system, rods, initial, Dense::<1>(Redundancy::Refuse))
            .map_err(StudyError::at("the method"))
    };
    let fourth =
        || Composed::new(rattle()?, Scheme::Suzuki4, initial).map_err(StudyError::at("the method"));
    let columns = [
        Column::exact("method"),
        Column::exact("tolerance [m]"),
        Column::exact("outcome"),
        Column::rounded("steps", 1, 0.0),
        Column::rounded("error [m]", 1, 1e-12),
    ];
    let (mut table, mut claims) = (Table::new(columns), Vec::new());
    let axes =
        (Axis::log("tolerance", "m"), Axis::log("error at the end, or of the shortest step", "m"));
    let mut chart = Lines::new("error against tolerance", axes.0, axes.1);
    for (name, order, bound) in
        [("RATTLE, order 2", 2, (0.6, 0.75)), ("RATTLE, order 4", 4, (0.7, 0.95))]
    {
        let (mut done, mut edge) = (Vec::new(), Vec::new());
        let mut outcomes = Vec::new();
        for digits in [4, 6, 8, 10, 12, 13, 17, 18, 20] {
            let tolerance = 10.0_f64.powi(-digits);
            let end = match order {
                2 => run(&problem, rattle()?, tolerance, (0.1, TIME))?,
                _ => run(&problem, fourth()?, tolerance, (0.1, TIME))?,
            };
            let (outcome, steps, error): (&str, Cell, Cell) = match end {
                End::Done { error, steps } => {
                    done.push((tolerance, error));
                    ("done", f64::from(steps).into(), error.into())
                }
                End::TooShort { error } => {
                    edge.push((tolerance, error));
                    ("no step meets it", "-".into(), "-".into())
                }
                End::Crawls => ("crawls", "-".into(), "-".into()),
            };
            outcomes.push((digits, outcome));
            table.push([name.into(), format!("1e-{digits}").into(), outcome.into(), steps, error]);
        }
        let slope = loglog_slope(&done).unwrap_or(f64::NAN);
        let expected = format!("{order}/{}", order + 1);
        let text = format!("{name}: power of the tolerance by which the error falls");
        claims.push(Claim::number(text, expected, slope, bound));
        let below =
            |&&(digits, outcome): &&(i32, &str)| digits >= 18 && outcome != "no step meets it";
        let crawl = outcomes.iter().find(below).map_or("an error", |_| "something else");
        let text = format!("{name}: what a tolerance of 1e-18 and less, below rounding, ends in");
        claims.push(Claim::words(text, "an error", crawl));
        chart = chart.with(Series::new(name, done));
        chart = chart.with(Series::new(&format!("{name}: no step meets it"), edge));
    }
    let obstacles::Found { charts, claims: others } = obstacles::obstacles(&problem)?;
    claims.extend(others);
    let mut all = vec![chart.into()];
    all.extend(charts.into_iter().map(Into::into));
    Ok(Study {
        conclusion: "A step's error goes as the power p + 1 of its length and so the error at the end as the power \
                     p/(p + 1) of the tolerance. Below the rounding of the configuration no step meets a tolerance: \
                     shorter steps are no better, and the method says so instead of crawling. A first step that is too \
                     long is shortened and changes little; a stiff spring is followed, in steps as short as its \
                     period asks for; singular positions are passed on the branch."
            .into(),
        table,
        charts: all,
        claims,
        ..ADAPTIVE_EDGE.heading()
    })
}
