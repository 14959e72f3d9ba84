//! Steps of varying length on eccentric orbits: chosen at each step's start, and reversibly.

use std::f64::consts::TAU;

use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{SmallProblem, kepler};
use stationary_integrators::{
    CentralGravity, Integrator, PotentialPower, ReversibleSteps, State, StepDensity, StepError,
    StormerVerlet,
};
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Kepler's problem at e = 0.9 and 0.99.
pub const STUDY: Entry<'static> = Entry {
    id: "step-control",
    krate: "integrators",
    chapter: "4.5",
    kind: Kind::LongRun,
    title: "Eccentric orbits in adaptive steps: energy error against time, and error against cost",
    tested: Tested::Claims,
    run: &study,
};

type Planet = SmallProblem<CentralGravity<2>, 2>;

/// How the steps of Stormer-Verlet are chosen.
#[derive(Clone, Copy, PartialEq)]
enum Steps {
    Equal,
    Naive,
    Reversible,
}

impl Steps {
    const ALL: [Steps; 3] = [Steps::Equal, Steps::Naive, Steps::Reversible];

    fn name(self) -> &'static str {
        match self {
            Steps::Equal => "equal steps",
            Steps::Naive => "steps chosen at their start",
            Steps::Reversible => "reversible steps",
        }
    }
}

/// The worst so far at a mark.
#[derive(Clone, Copy, Default)]
struct Mark {
    orbits: f64,
    energy: f64,
    error: f64,
    differentials: u64,
}

/// Follows a planet with `scale |q|^(-3/2)` steps a second, or with `equal` steps an orbit.
fn course(
    planet: &Planet,
    steps: Steps,
    scale: f64,
    equal: f64,
    orbits: f64,
) -> Result<Vec<Mark>, StudyError> {
    let at = StudyError::at::<StepError>;
    let made = || StormerVerlet::new(&planet.system).map_err(StudyError::at("Stormer-Verlet"));
    let wished = PotentialPower { potential: *planet.system.potential(), power: 1.5, scale };
    let mut verlet = made()?;
    let mut reversible = ReversibleSteps::new(&planet.system, made()?, wished)
        .map_err(StudyError::at("the reversible steps"))?;
    let mut state: State<[f64; 2]> = planet.initial.clone();
    let start = planet.energy(&state);
    let (mut worst, mut marks) = (Mark::default(), Vec::new());
    let mut next = 0.1;
    while state.t < orbits * TAU {
        let report = match steps {
            Steps::Equal => verlet.step(&mut state, TAU / equal),
            Steps::Naive => {
                let h = wished.density(&state.q).recip();
                verlet.step(&mut state, h)
            }
            Steps::Reversible => reversible.advance(&mut state),
        };
        let report = report.map_err(at(steps.name()))?;
        worst.differentials += u64::from(report.differentials);
        worst.energy = worst.energy.max((planet.energy(&state) - start).abs());
        worst.error = worst.error.max(planet.error(state.t, &state.q).unwrap_or(f64::NAN));
        worst.orbits = state.t / TAU;
        if worst.orbits >= next {
            marks.push(worst);
            next *= 1.25;
        }
    }
    marks.push(worst);
    Ok(marks)
}

/// Steps of an orbit with this density: `scale` times the integral of |q|^(-3/2) over a period.
fn steps_an_orbit(e: f64, scale: f64) -> f64 {
    // dt = |q| dE with the eccentric anomaly E, at the midpoints of many arcs.
    let arcs = 20_000;
    let sum: f64 = (0..arcs)
        .map(|i| (1.0 - e * (TAU * (f64::from(i) + 0.5) / f64::from(arcs)).cos()).powf(-0.5))
        .sum();
    scale * sum * TAU / f64::from(arcs)
}

/// Steps in the time that a body at unit distance takes for one radian.
const SCALE: f64 = 30.0;

fn study(size: Size) -> Result<Study, StudyError> {
    let orbits = match size {
        Size::Default => 300.0,
        Size::Full => 30_000.0,
    };
    let mut table = Table::new([
        Column::rounded("e", 2, 0.0),
        Column::exact("steps"),
        Column::rounded("orbits", 2, 0.0),
        Column::rounded("energy error [J]", 2, 1e-12),
        Column::rounded("error", 2, 1e-12),
        Column::exact("differentials"),
    ]);
    let (mut charts, mut claims) = (Vec::new(), Vec::new());
    for e in [0.9, 0.99] {
        let planet = kepler(e).map_err(StudyError::at("the orbit"))?;
        let title = format!("Energy, eccentricity {e}");
        let axes = (Axis::log("orbits", ""), Axis::log("largest energy error so far", "J"));
        let mut chart = Lines::new(&title, axes.0, axes.1);
        for steps in Steps::ALL {
            // As many evaluations for each: a reversible step takes one more.
            let scale = if steps == Steps::Reversible { SCALE } else { 2.0 * SCALE };
            let marks = course(&planet, steps, scale, steps_an_orbit(e, scale), orbits)?;
            for mark in &marks {
                table.push([
                    e.into(),
                    steps.name().into(),
                    mark.orbits.into(),
                    mark.energy.into(),
                    mark.error.into(),
                    mark.differentials.into(),
                ]);
            }
            let points = marks.iter().map(|mark| (mark.orbits, mark.energy));
            chart = chart.with(Series::new(steps.name(), points));
            claims.extend(growth_claim(e, steps, &marks));
        }
        charts.push(chart.into());
        charts.push(work(e, &planet, size, &mut claims)?.into());
    }
    Ok(Study {
        conclusion: "Störmer-Verlet at equal cost, with steps that are equal, proportional to \
                     |q|^(3/2) at each step's start, and proportional to it reversibly. Short \
                     steps near the sun are worth a great deal on an eccentric orbit; but \
                     chosen at the step's start they are longer on the way in than on the way \
                     out, and the energy climbs with every orbit. Reversible steps keep it as \
                     equal steps do."
            .into(),
        table,
        charts,
        claims,
        ..STUDY.heading()
    })
}

/// The energy error over all orbits, relative to that over the first tenth of them.
fn growth_claim(e: f64, steps: Steps, marks: &[Mark]) -> Option<Claim> {
    let last = marks.last()?;
    let tenth = marks.iter().find(|mark| mark.orbits >= 0.1 * last.orbits)?;
    let text =
        format!("e = {e}, {}: energy error of all orbits over a tenth of them", steps.name());
    let (expected, band) = match steps {
        Steps::Naive => ("it drifts: 10, less where it saturates", (2.0, 11.0)),
        Steps::Equal | Steps::Reversible => ("1", (1.0, 1.1)),
    };
    Some(Claim::number(text, expected, last.energy / tenth.energy, band))
}

/// The error of one orbit against its cost.
fn work(e: f64, planet: &Planet, size: Size, claims: &mut Vec<Claim>) -> Result<Lines, StudyError> {
    let finest = match size {
        Size::Default => 6,
        Size::Full => 10,
    };
    let title = format!("Error against cost, eccentricity {e}");
    let mut chart = Lines::new(&title, Axis::log("differentials", ""), Axis::log("error", ""));
    let mut finest_errors = Vec::new();
    for steps in [Steps::Equal, Steps::Reversible] {
        let mut points = Vec::new();
        for k in 0..=finest {
            let scale = f64::from(20 << k) * if steps == Steps::Equal { 2.0 } else { 1.0 };
            let marks = course(planet, steps, scale, steps_an_orbit(e, scale), 1.0)?;
            points.extend(marks.last().map(|mark| (mark.differentials as f64, mark.error)));
        }
        finest_errors.extend(points.last().map(|point| point.1));
        chart = chart.with(Series::new(steps.name(), points));
    }
    if let [equal, reversible] = finest_errors[..] {
        claims.push(Claim::number(
            format!("e = {e}: error of equal steps over that of reversible ones, at equal cost"),
            "10 and more",
            equal / reversible,
            (10.0, f64::INFINITY),
        ));
    }
    Ok(chart.mark_front())
}
