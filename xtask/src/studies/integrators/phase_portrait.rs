//! Figure 4.1: one step of every method through the whirlpool of the oscillator.

use stationary_calculus::Covector;
use stationary_chart::{Axis, Portrait, Series};
use stationary_integrators::problems::oscillator;
use stationary_integrators::{EnergyBehavior, Method, State};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Study, StudyError, Tested};

/// One step of every method.
pub const ONE_STEP: Entry<'static> = Entry {
    id: "one-step",
    krate: "integrators",
    chapter: "4.3",
    kind: Kind::LongRun,
    title: "One step of 0.8 rad on an oscillator: where eight methods end",
    tested: Tested::Table,
    run: &|_| study(),
};

/// A step of most of a radian: large enough to tell the methods apart by eye.
const H: f64 = 0.8;

/// The state from which the steps start: on the unit circle, where no method is flattered.
const START: (f64, f64) = (0.8, 0.6);

fn study() -> Result<Study, StudyError> {
    let problem = oscillator(1.0).map_err(StudyError::at("the oscillator"))?;
    let arc = (-70..=70).map(|degrees| {
        let angle = f64::from(degrees).to_radians();
        (angle.cos(), angle.sin())
    });
    let grid = (1..=9).flat_map(|i| (-6..=6).map(move |j| (i, j)));
    let field = grid.map(|(i, j)| {
        let (q, p) = (0.16 * f64::from(i), 0.16 * f64::from(j));
        ((q, p), (p, -q))
    });
    let mut portrait = Portrait::new(
        "",
        Axis::linear("configuration q", "m"),
        Axis::linear("momentum p", "kg m/s"),
    )
    .field(field)
    .curve(Series::new("exact", arc));
    let mut table = Table::new([
        Column::exact("method"),
        Column::rounded("q", 6, 1e-12),
        Column::rounded("p", 6, 1e-12),
        Column::rounded("energy gained in one step", 4, 1e-12),
        Column::rounded("energy left after 100 steps", 4, 1e-12),
    ]);
    let mut claims = Vec::new();
    for method in Method::TABLE_4_1 {
        let facts = method.facts();
        let mut integrator =
            method.integrator(&problem.system).map_err(StudyError::at(facts.name))?;
        let mut state = State::new([START.0], Covector([START.1]));
        let start = problem.energy(&state);
        integrator.step(&mut state, H).map_err(StudyError::at(facts.name))?;
        let (q, p) = (state.q[0], state.p.0[0]);
        portrait = portrait.step(facts.name, START, (q, p));
        let gained = problem.energy(&state) / start - 1.0;
        for _ in 1..100 {
            integrator.step(&mut state, H).map_err(StudyError::at(facts.name))?;
        }
        let left = problem.energy(&state) / start;
        table.push([facts.name.into(), q.into(), p.into(), gained.into(), left.into()]);
        let (expected, band) = match facts.energy {
            EnergyBehavior::Bounded => ("between 1/2 and 2", (0.5, 2.0)),
            EnergyBehavior::Grows => ("more than 2", (2.0, f64::INFINITY)),
            EnergyBehavior::Decays => ("less than 1", (0.0, 1.0)),
        };
        let text = format!("energy of {} after 100 steps, of what it had", facts.name);
        claims.push(Claim::number(text, expected, left, band));
    }
    let square = H * H;
    for (method, factor, formula) in [
        (Method::ExplicitEuler, 1.0 + square, "1 + h² = 1.64"),
        (Method::ImplicitEuler, 1.0 / (1.0 + square), "1/(1 + h²) = 0.6098"),
        (Method::ImplicitMidpoint, 1.0, "1"),
    ] {
        let mut state = State::new([START.0], Covector([START.1]));
        let start = problem.energy(&state);
        let mut integrator =
            method.integrator(&problem.system).map_err(StudyError::at("one step"))?;
        integrator.step(&mut state, H).map_err(StudyError::at("one step"))?;
        let text = format!("energy after one step of {method}, of what it had");
        let ratio = problem.energy(&state) / start;
        claims.push(Claim::number(text, formula, ratio, (factor - 1e-12, factor + 1e-12)));
    }
    Ok(Study {
        conclusion:
            "The motion of a unit mass on a unit spring flows clockwise along circles. One \
                     step of 0.8 rad from the same state: explicit Euler follows the arrow at \
                     the start and leaves the circle outward, implicit Euler ends where the arrow \
                     at the end would have brought it, inside; the midpoint and trapezoid rules \
                     stay on the circle, though not at the right place."
                .into(),
        table,
        charts: vec![portrait.into()],
        claims,
        ..ONE_STEP.heading()
    })
}
