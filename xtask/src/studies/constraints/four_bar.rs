//! A closed loop: a four-bar linkage, all ways on one scene.

use std::error::Error;

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::problems::{Crank, FourBar, RodProblem, four_bar};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, Dense, Penalty, Rattle, Reduced,
    Redundancy, Sampling, StepAndProject, Weight,
};
use stationary_integrators::{Integrator, State, StormerVerlet, Variational};
use stationary_measure::{Cell, Column, Table, loglog_slope};

use crate::studies::cheapest::Asked;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Place, violation, energy and cost of every way.
pub const FOUR_BAR: Entry<'static> = Entry {
    id: "four-bar-linkage",
    krate: "constraints",
    chapter: "6",
    kind: Kind::WorkPrecision,
    title: "Four-bar linkage: error after three revolutions against cost",
    tested: Tested::ByReport,
    run: &study,
};

/// The crank's first angle and rate, and how often it goes round.
const ANGLE: f64 = 1.0;
const RATE: f64 = 4.0;
const REVOLUTIONS: f64 = 3.0;

const WAYS: [&str; 5] =
    ["crank angle", "penalty", "step and project", "constrained Hamilton", "RATTLE"];

/// What became of the linkage.
#[derive(Clone, Copy, Default)]
struct Outcome {
    /// The distance from where it began, after whole revolutions.
    error: f64,
    violation: f64,
    energy: f64,
    evaluations: u64,
}

type Linkage = System<DiagonalMetric<[f64; 4]>, stationary_integrators::UniformGravity<2>>;

impl Outcome {
    /// Takes a state into account.
    fn see(&mut self, problem: &RodProblem<[f64; 4]>, state: &State<[f64; 4]>, energy: f64) {
        let mut g = [0.0; 3];
        let known = problem.rods.value(0.0, &state.q, &mut g);
        if known.is_err() {
            self.violation = f64::INFINITY;
        }
        for (g, rod) in g.iter().zip(problem.rods.rods()) {
            self.violation = self.violation.max(g.abs() / (2.0 * rod.length() * rod.length()));
        }
        let initial = &problem.initial;
        let start = problem.system.energy(&initial.q, initial.p.view());
        self.energy = self.energy.max((energy - start).abs());
        let pairs = state.q.iter().zip(&initial.q);
        self.error = pairs.map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    }
}

fn constrained(
    problem: &RodProblem<[f64; 4]>,
    method: &mut dyn ConstrainedIntegrator<[f64; 4]>,
    (h, steps): (f64, u64),
) -> Result<Outcome, Box<dyn Error + Send + Sync>> {
    let (mut state, mut outcome) = (problem.initial.clone(), Outcome::default());
    for _ in 0..steps {
        let report = method.step(&mut state, h)?;
        outcome.evaluations += u64::from(report.differentials + report.iterations);
        outcome.see(problem, &state, problem.system.energy(&state.q, state.p.view()));
    }
    Ok(outcome)
}

fn run(
    linkage: &FourBar,
    way: &str,
    (h, steps): (f64, u64),
) -> Result<Outcome, Box<dyn Error + Send + Sync>> {
    let problem = &linkage.problem;
    let RodProblem { system, rods, initial } = problem;
    let few = Dense::<3>(Redundancy::Refuse);
    let steps = (h, steps);
    match way {
        "RATTLE" => constrained(problem, &mut Rattle::new(system, rods, initial, few)?, steps),
        "constrained Hamilton" => {
            constrained(problem, &mut ConstrainedHamilton::new(system, rods, initial, few)?, steps)
        }
        "step and project" => {
            let verlet = StormerVerlet::new(system)?;
            let mut method = StepAndProject::new(verlet, system, rods, initial, few)?;
            constrained(problem, &mut method, steps)
        }
        "penalty" => penalty(problem, system, steps),
        _ => crank(problem, steps),
    }
}

/// Stormer-Verlet on stiff springs, with the stiffness that the step allows.
fn penalty(
    problem: &RodProblem<[f64; 4]>,
    system: &Linkage,
    (h, steps): (f64, u64),
) -> Result<Outcome, Box<dyn Error + Send + Sync>> {
    let spring = Penalty::new(&problem.rods, (0.3 / h).powi(2), 0.0)?;
    let metric = DiagonalMetric::new([1.0; 4])?;
    let stiff = System::new(metric, (system.potential().clone(), spring))?;
    let mut verlet = StormerVerlet::new(&stiff)?;
    let (mut state, mut outcome) = (problem.initial.clone(), Outcome::default());
    for _ in 0..steps {
        outcome.evaluations += u64::from(verlet.step(&mut state, h)?.differentials);
        outcome.see(problem, &state, stiff.energy(&state.q, state.p.view()));
    }
    Ok(outcome)
}

/// The chord's discrete Lagrangian in the crank's angle.
fn crank(
    problem: &RodProblem<[f64; 4]>,
    (h, steps): (f64, u64),
) -> Result<Outcome, Box<dyn Error + Send + Sync>> {
    let weight = Weight { masses: [1.0; 2], gravity: 1.0 };
    let reduced = Reduced::<_, _, 1, 4>::new(Crank, [1.0; 4], weight, Sampling::Both)?;
    let momentum = reduced.momentum([ANGLE], stationary_calculus::Vector([RATE]));
    let mut method = Variational::new(reduced.clone())?;
    let mut state = State { t: 0.0, q: [ANGLE], p: momentum };
    let mut outcome = Outcome::default();
    for _ in 0..steps {
        let report = method.step(&mut state, h)?;
        outcome.evaluations += u64::from(report.differentials + report.hessians);
        let rate =
            state.p.0[0] / reduced.momentum(state.q, stationary_calculus::Vector([1.0])).0[0];
        let places = State { t: state.t, q: reduced.places(state.q), p: Covector([0.0; 4]) };
        let energy = reduced.total_energy(state.q, stationary_calculus::Vector([rate]));
        outcome.see(problem, &places, energy);
    }
    Ok(outcome)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let halvings = match size {
        Size::Default => 4,
        Size::Full => 7,
    };
    let linkage = four_bar(ANGLE, RATE).map_err(StudyError::at("the linkage"))?;
    let time = REVOLUTIONS * linkage.revolution.unwrap_or(f64::NAN);
    let mut table = Table::new([
        Column::exact("way"),
        Column::exact("steps"),
        Column::rounded("error", 2, 1e-10),
        Column::rounded("violation", 1, 1e-14),
        Column::rounded("energy error [J]", 2, 1e-11),
        Column::exact("evaluations"),
    ]);
    let axes = (Axis::log("evaluations", ""), Axis::log("error after three revolutions", "m"));
    let mut chart = Lines::new("", axes.0, axes.1);
    let mut claims = Vec::new();
    for way in WAYS {
        let (mut errors, mut costs, mut violation) = (Vec::new(), Vec::new(), 0.0_f64);
        for halving in 0..halvings {
            let steps = 4000_u64 << halving;
            let h = time / steps as f64;
            let outcome = run(&linkage, way, (h, steps))
                .map_err(|source| StudyError::Library { stage: way.into(), source })?;
            errors.push((h, outcome.error));
            costs.push((outcome.evaluations as f64, outcome.error));
            violation = violation.max(outcome.violation);
            let cells: [Cell; 6] = [
                way.into(),
                steps.into(),
                outcome.error.into(),
                outcome.violation.into(),
                outcome.energy.into(),
                outcome.evaluations.into(),
            ];
            table.push(cells);
        }
        let order =
            if ["step and project", "constrained Hamilton"].contains(&way) { 1.0 } else { 2.0 };
        let slope = loglog_slope(&errors).unwrap_or(f64::NAN);
        let (text, expected) = (format!("order of {way}"), format!("{order}"));
        claims.push(Claim::number(text, expected, slope, (order - 0.2, order + 0.2)));
        if way != "penalty" {
            let text = format!("violation by {way}");
            claims.push(Claim::number(text, "rounding", violation, (0.0, 1e-12)));
        }
        chart = chart.with(Series::new(way, costs));
    }
    let asked = Asked {
        question: "Joints that close a loop, to 1e-3\u{a0}m",
        error: 1e-3,
        cost: "evaluations",
        rival: "constrained Hamilton",
    };
    Ok(Study {
        answers: asked.of(&chart).into_iter().collect(),
        conclusion: "A crank goes round and drags a rocker to and fro. After three revolutions, \
                     whose time follows from energy alone, it must be where it began. One angle \
                     describes the closed loop here, because its geometry can be solved; three \
                     multipliers need no such luck, and land on the same points."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..FOUR_BAR.heading()
    })
}
