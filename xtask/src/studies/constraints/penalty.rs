//! The penalty: where it is stable, and how well it holds.

use stationary_calculus::{DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Map, Series};
use stationary_constraints::Penalty;
use stationary_constraints::problems::{Pendulum, RodProblem, pendulum};
use stationary_integrators::{Integrator, StormerVerlet};
use stationary_measure::{Column, Table, loglog_slope};

use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Stiffness against step.
pub const PENALTY_STABILITY: Entry<'static> = Entry {
    id: "penalty-stability",
    krate: "constraints",
    chapter: "6.2",
    kind: Kind::StabilityMap,
    title: "Rod by penalty: which steps are stable, and its violation, against stiffness",
    tested: Tested::Claims,
    run: &study,
};

const HOLDS: &str = "holds the rod";
const SLACK: &str = "rod off by 1 % and more";
const BLOWS_UP: &str = "blows up";

/// The largest violation of the rod over half a swing; not finite if it blows up.
fn violation(exact: &Pendulum, k: f64, h: f64) -> Result<(f64, f64), StudyError> {
    let RodProblem { system, rods, initial } = &exact.problem;
    let spring = Penalty::new(rods, k, 0.0).map_err(StudyError::at("a penalty"))?;
    let metric = DiagonalMetric::new([1.0; 2]).map_err(StudyError::at("masses"))?;
    let stiff = System::new(metric, (system.potential().clone(), spring))
        .map_err(StudyError::at("a penalty"))?;
    let mut verlet = StormerVerlet::new(&stiff).map_err(StudyError::at("Stormer-Verlet"))?;
    let spring = &stiff.potential().1;
    let limit = spring
        .stable_step(verlet.facts(), stiff.metric(), &initial.q)
        .map_err(StudyError::at("the stable step"))?;
    let mut state = initial.clone();
    let mut worst = 0.0_f64;
    let steps = ((0.5 * exact.period / h).ceil() as u64).max(400);
    for _ in 0..steps {
        if verlet.step(&mut state, h).is_err() {
            return Ok((f64::INFINITY, limit));
        }
        worst = worst.max((state.q[0].hypot(state.q[1]) - 1.0).abs());
        if worst > 0.5 {
            return Ok((f64::INFINITY, limit));
        }
    }
    Ok((worst, limit))
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 21,
        Size::Full => 61,
    };
    let exact = pendulum(0.5).map_err(StudyError::at("the pendulum"))?;
    let mut table = Table::new([
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("stiffness [N/m]", 3, 0.0),
        Column::rounded("step over predicted limit", 3, 0.0),
        Column::exact("outcome"),
    ]);
    let axes = (Axis::log("step", "s"), Axis::log("stiffness", "N/m"));
    let mut map = Map::new("Which steps hold the rod", axes.0, axes.1, [HOLDS, SLACK, BLOWS_UP]);
    let (mut agree, mut cells) = (0_u32, 0_u32);
    for k in spaced(1e3, 1e6, count) {
        for h in spaced(1e-3, 0.3, count) {
            let (worst, limit) = violation(&exact, k, h)?;
            let outcome = match worst {
                worst if worst.is_infinite() => BLOWS_UP,
                worst if worst > 0.01 => SLACK,
                _ => HOLDS,
            };
            map.cell(h, k, outcome);
            table.push([h.into(), k.into(), (h / limit).into(), outcome.into()]);
            // A tenth on both sides of the border: there the swing shifts it.
            if (h / limit - 1.0).abs() > 0.1 {
                cells += 1;
                agree += u32::from((h < limit) == (outcome != BLOWS_UP));
            }
        }
    }
    let border = spaced(1e-3, 0.2, 40).map(|h| (h, (2.0 / h).powi(2)));
    map = map.border("h ω = 2", border.filter(|&(_, k)| (1e3..=1e6).contains(&k)));
    let mut held = Vec::new();
    for k in spaced(1e3, 1e6, 7) {
        held.push((k, violation(&exact, k, 0.2 / k.sqrt())?.0));
    }
    let claims = vec![
        Claim::number(
            "part of the map, off its border, that is stable as predicted from the stiffness",
            "1",
            f64::from(agree) / f64::from(cells),
            (1.0, 1.0),
        ),
        Claim::number(
            "slope of the violation against stiffness",
            "-1",
            loglog_slope(&held).unwrap_or(f64::NAN),
            (-1.05, -0.95),
        ),
    ];
    let axes = (Axis::log("stiffness", "N/m"), Axis::log("violation", "m"));
    let hold = Lines::new("Violation of the rod's length", axes.0, axes.1)
        .with(Series::new("largest violation at h ω = 0.2", held))
        .slope(-1.0, (1e4, 1e-3));
    Ok(Study {
        conclusion: "A pendulum whose rod is a spring of stiffness k, stepped by Stormer-Verlet. \
                     The largest stable step, predicted from the stiffness alone, is where the map \
                     ends. A hundred times the stiffness holds a hundred times better, and costs \
                     ten times the steps."
            .into(),
        table,
        charts: vec![map.into(), hold.into()],
        claims,
        ..PENALTY_STABILITY.heading()
    })
}
