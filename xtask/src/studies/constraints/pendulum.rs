//! A pendulum kept four ways, against its elliptic functions: order, violation and energy.

use std::error::Error;

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::problems::{Pendulum, RodProblem, pendulum};
use stationary_constraints::{
    ArcsinePendulum, ConstrainedHamilton, ConstrainedIntegrator, Dense, Links, Penalty, Rattle,
    Reduced, Redundancy, Sampling, StepAndProject, Weight,
};
use stationary_integrators::{Integrator, State, StormerVerlet, Variational};
use stationary_measure::{Cell, Column, Table, loglog_slope};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of every way against step and cost.
pub const PENDULUM_WAYS: Entry<'static> = Entry {
    id: "pendulum-four-ways",
    krate: "constraints",
    chapter: "6",
    kind: Kind::Convergence,
    title: "Pendulum on a rod, kept four ways: error against step and cost",
    tested: Tested::ByReport,
    run: &ways,
};

/// Energy of every way over many steps.
pub const PENDULUM_ENERGY: Entry<'static> = Entry {
    id: "pendulum-constrained-energy",
    krate: "constraints",
    chapter: "6",
    kind: Kind::LongRun,
    title: "Pendulum on a rod: energy error against time",
    tested: Tested::ByReport,
    run: &energy,
};

const FEW: Dense<1> = Dense(Redundancy::Refuse);

/// A way to keep the rod.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Arcsine,
    ReducedBoth,
    Penalty,
    StepAndProject,
    Hamilton,
    Rattle,
}

const WAYS: [Way; 6] =
    [Way::Arcsine, Way::ReducedBoth, Way::Penalty, Way::StepAndProject, Way::Hamilton, Way::Rattle];

impl Way {
    fn name(self) -> &'static str {
        match self {
            Way::Arcsine => "angle, arcsine form",
            Way::ReducedBoth => "angle, mean of both ends",
            Way::Penalty => "penalty, k = (0.3/h)^2",
            Way::StepAndProject => "step and project",
            Way::Hamilton => "constrained Hamilton",
            Way::Rattle => "RATTLE",
        }
    }

    /// The order that is expected, and how far the measured slope may be from it.
    fn order(self) -> (f64, f64) {
        match self {
            Way::Arcsine | Way::StepAndProject | Way::Hamilton => (1.0, 0.15),
            Way::ReducedBoth | Way::Rattle => (2.0, 0.1),
            // The rod starts unstretched, and then swings about its stretch of F/k, a multiple of
            // h^2.
            Way::Penalty => (2.0, 0.3),
        }
    }
}

/// The place, its violation is told from it; the energy; the cost of the step.
struct Seen {
    t: f64,
    place: [f64; 2],
    energy: f64,
    evaluations: u32,
}

/// Steps one way from the time `start`, until the observer has seen all steps.
fn follow(
    exact: &Pendulum,
    way: Way,
    (start, h, steps): (f64, f64, u64),
    mut observe: impl FnMut(Seen),
) -> Result<(), Box<dyn Error + Send + Sync>> {
    let RodProblem { system, rods, .. } = &exact.problem;
    let first = exact.state(start);
    let energy = |q: &State<[f64; 2]>| system.energy(&q.q, q.p.view());
    let mut state = first.clone();
    let mut constrained = |method: &mut dyn ConstrainedIntegrator<[f64; 2]>| {
        for _ in 0..steps {
            let report = method.step(&mut state, h)?;
            let evaluations = report.differentials + report.iterations;
            let seen = Seen { t: state.t, place: state.q, energy: energy(&state), evaluations };
            observe(seen);
        }
        Ok(())
    };
    match way {
        Way::Rattle => constrained(&mut Rattle::new(system, rods, &first, FEW)?),
        Way::Hamilton => constrained(&mut ConstrainedHamilton::new(system, rods, &first, FEW)?),
        Way::StepAndProject => {
            let verlet = StormerVerlet::new(system)?;
            constrained(&mut StepAndProject::new(verlet, system, rods, &first, FEW)?)
        }
        Way::Penalty => {
            let spring = Penalty::new(rods, (0.3 / h).powi(2), 0.0)?;
            let metric = DiagonalMetric::new([1.0; 2])?;
            let stiff = System::new(metric, (system.potential().clone(), spring))?;
            let mut verlet = StormerVerlet::new(&stiff)?;
            for _ in 0..steps {
                let report = verlet.step(&mut state, h)?;
                let (t, place) = (state.t, state.q);
                let energy = stiff.energy(&state.q, state.p.view());
                observe(Seen { t, place, energy, evaluations: report.differentials });
            }
            Ok(())
        }
        Way::Arcsine | Way::ReducedBoth => in_angle(exact, way, (start, h, steps), observe),
    }
}

/// The ways in the pendulum's angle. The energy is that of the momentum that belongs to the angle.
fn in_angle(
    exact: &Pendulum,
    way: Way,
    (start, h, steps): (f64, f64, u64),
    mut observe: impl FnMut(Seen),
) -> Result<(), Box<dyn Error + Send + Sync>> {
    let mut state = State::new([exact.angle(start)], Covector([exact.rate(start)]));
    state.t = start;
    let arcsine = ArcsinePendulum::new(1.0, 1.0, 1.0)?;
    let weight = Weight { masses: [1.0], gravity: 1.0 };
    let both = Sampling::Both;
    let reduced = Reduced::<_, _, 1, 2>::new(Links::new([1.0]), [1.0; 2], weight, both)?;
    let mut variational = Variational::new(reduced)?;
    for _ in 0..steps {
        let evaluations = if way == Way::Arcsine {
            arcsine.step(&mut state, h)?;
            1
        } else {
            let report = variational.step(&mut state, h)?;
            report.differentials + report.hessians
        };
        let (s, c) = state.q[0].sin_cos();
        let energy = 0.5 * state.p.0[0] * state.p.0[0] - c;
        observe(Seen { t: state.t, place: [s, -c], energy, evaluations });
    }
    Ok(())
}

/// A small swing, a large one, and one over the top.
const SPEEDS: [(f64, &str); 3] = [(0.2, "small"), (1.9, "large"), (2.5, "over the top")];

/// The swings start here, where no symmetry hides a term.
const START: f64 = 0.7;

fn ways(size: Size) -> Result<Study, StudyError> {
    let halvings = match size {
        Size::Default => 5,
        Size::Full => 8,
    };
    let mut table = Table::new([
        Column::exact("way"),
        Column::exact("swing"),
        Column::exact("steps a period"),
        Column::rounded("error", 2, 1e-11),
        Column::rounded("violation", 1, 1e-14),
        Column::exact("evaluations"),
    ]);
    let (mut against_step, mut against_cost) = (
        Lines::new("Large swing, by step", Axis::log("step", "s"), Axis::log("largest error", "")),
        Lines::new(
            "Large swing, by cost",
            Axis::log("evaluations", ""),
            Axis::log("largest error", ""),
        ),
    );
    let mut claims = Vec::new();
    for way in WAYS {
        for (speed, swing) in SPEEDS {
            let exact = pendulum(speed).map_err(StudyError::at("the pendulum"))?;
            let (mut errors, mut costs, mut violated) = (Vec::new(), Vec::new(), 0.0_f64);
            for halving in 0..halvings {
                let steps = 1600_u64 << halving;
                let h = exact.period / steps as f64;
                let (mut error, mut violation, mut cost) = (0.0_f64, 0.0_f64, 0_u64);
                follow(&exact, way, (START, h, steps), |seen| {
                    error = error.max(exact.error(seen.t, &seen.place));
                    violation = violation.max((seen.place[0].hypot(seen.place[1]) - 1.0).abs());
                    cost += u64::from(seen.evaluations);
                })
                .map_err(at(way))?;
                errors.push((h, error));
                costs.push((cost as f64, error));
                violated = violated.max(violation);
                let cells: [Cell; 6] = [
                    way.name().into(),
                    swing.into(),
                    steps.into(),
                    error.into(),
                    violation.into(),
                    cost.into(),
                ];
                table.push(cells);
            }
            let (order, band) = way.order();
            let text = format!("order of {}, {swing} swing", way.name());
            let slope = loglog_slope(&errors).unwrap_or(f64::NAN);
            let expected = format!("{order}");
            claims.push(Claim::number(text, expected, slope, (order - band, order + band)));
            if way != Way::Penalty {
                let text = format!("violation by {}, {swing} swing", way.name());
                claims.push(Claim::number(text, "rounding", violated, (0.0, 1e-12)));
            }
            if swing == "large" {
                against_step = against_step.with(Series::new(way.name(), errors));
                against_cost = against_cost.with(Series::new(way.name(), costs));
            }
        }
    }
    Ok(Study {
        conclusion: "Each way steps the same pendulum over one period, against its elliptic \
                     functions. RATTLE and the angle with the mean of both ends lie on one line: \
                     they make the same discrete action stationary, one from outside and one from \
                     inside. Step and project is of order 1, although its step is of order 2. The \
                     penalty's stiffness is tied to the step by stability, so its rod is stretched \
                     by a multiple of the squared step. An evaluation is a differential, a \
                     value of the constraint, or a Hessian."
            .into(),
        table,
        charts: vec![
            against_step.slope(1.0, (3e-3, 2e-2)).slope(2.0, (3e-3, 2e-5)).into(),
            against_cost.into(),
        ],
        claims,
        ..PENDULUM_WAYS.heading()
    })
}

fn at(way: Way) -> impl FnOnce(Box<dyn Error + Send + Sync>) -> StudyError {
    move |source| StudyError::Library { stage: way.name().into(), source }
}

/// Steps in a second of the long run.
const STEP: f64 = 0.01;

fn energy(size: Size) -> Result<Study, StudyError> {
    let decades = match size {
        Size::Default => 5,
        Size::Full => 6,
    };
    let exact = pendulum(1.9).map_err(StudyError::at("the pendulum"))?;
    let mut table = Table::new([
        Column::exact("way"),
        Column::exact("steps"),
        Column::rounded("largest energy error", 2, 1e-11),
    ]);
    let (x, y) = (Axis::log("steps", ""), Axis::log("largest energy error", "J"));
    let mut chart = Lines::new("", x, y);
    let mut claims = Vec::new();
    for way in WAYS.into_iter().filter(|way| *way != Way::Penalty) {
        let mut marks = Vec::new();
        let (mut first, mut worst, mut step) = (f64::NAN, 0.0_f64, 0_u64);
        let mut next = 1000.0_f64;
        follow(&exact, way, (START, STEP, 10_u64.pow(decades)), |seen| {
            step += 1;
            if step == 1 {
                first = seen.energy;
            }
            worst = worst.max((seen.energy - first).abs());
            if step as f64 >= next.round() {
                marks.push((step as f64, worst));
                next *= 10.0_f64.powf(0.25);
            }
        })
        .map_err(at(way))?;
        for &(steps, worst) in marks.iter().step_by(4) {
            let cells: [Cell; 3] = [way.name().into(), (steps as u64).into(), worst.into()];
            table.push(cells);
        }
        let grown = marks[marks.len() - 1].1 / marks[0].1;
        claims.push(if way == Way::StepAndProject {
            let text = "energy error of step and project, last over first thousand steps";
            Claim::number(text, "it goes on falling", grown, (3.0, f64::INFINITY))
        } else {
            let text = format!("energy error of {}, last over first thousand steps", way.name());
            Claim::number(text, "1: it oscillates", grown, (1.0, 1.05))
        });
        chart = chart.with(Series::new(way.name(), marks));
    }
    Ok(Study {
        conclusion: format!(
            "A large swing with steps of {STEP} s. Whatever comes from a discrete action keeps its \
             energy near, at order 1 or 2, for as long as one looks. The projection takes a little \
             in every step, until the pendulum hangs."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..PENDULUM_ENERGY.heading()
    })
}
