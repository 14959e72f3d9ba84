//! How many modes an answer needs, and how large a motion they can follow.

use stationary_calculus::{Column, Covector, Table, Vector, loglog_slope};
use stationary_integrators::problems::{PendulumPotential, pendulum};
use stationary_modal::problems::fixed_chain;
use stationary_modal::{Answer, Linearized, Motion, RigidMotions};

use crate::chart::{Axis, Lines, Series};
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError};

/// Error of a chain's answer against the number of modes.
pub const MODES_NEEDED: Entry<'static> = Entry {
    id: "modes-needed",
    krate: "modal",
    chapter: "14.3",
    kind: Kind::Ladder,
    title: "How many modes an answer needs",
    run: &modes_needed,
};

/// Error of linear modes against the amplitude.
pub const LARGE_MOTION: Entry<'static> = Entry {
    id: "modes-large-motion",
    krate: "modal",
    chapter: "14.2",
    kind: Kind::Ladder,
    title: "How large a motion linear modes can follow",
    run: &large_motion,
};

const TOLERANCES: [f64; 3] = [1e-1, 1e-2, 1e-3];

fn modes_needed(size: Size) -> Result<Study, StudyError> {
    let (masses, count) = match size {
        Size::Default => (399, 300),
        Size::Full => (1999, 600),
    };
    let middle = masses / 2;
    let problem = fixed_chain(masses).map_err(StudyError::at("the chain"))?;
    let mut chain = Linearized::at(&problem.metric, &problem.potential, &problem.q, 1e-12)
        .map_err(StudyError::at("the chain"))?;
    let modes = chain.lowest(count, &RigidMotions::none()).map_err(StudyError::at("the modes"))?;
    let point: Vec<f64> = (0..masses).map(|i| if i == middle { 1.0 } else { 0.0 }).collect();
    let loads = [("load everywhere", vec![1.0; masses]), ("load at a point", point.clone())];
    let mut table = Table::new([
        Column::exact("load"),
        Column::exact("modes"),
        Column::rounded("error", 3, 1e-11),
    ]);
    let mut chart =
        Lines::new("", Axis::log("modes", ""), Axis::log("error of the middle's displacement", ""));
    let mut claims = Vec::new();
    for ((name, load), power) in loads.iter().zip([-3.0, -1.0]) {
        let answer: Answer = chain
            .answer(&modes, Covector(load), Covector(&point))
            .map_err(StudyError::at(*name))?;
        // The middle takes part in every other mode only.
        let points: Vec<(f64, f64)> =
            (1..=count).step_by(2).map(|n| (n as f64, answer.errors[n])).collect();
        for n in [1, 3, 9, 31, 99, 299] {
            table.push([(*name).into(), (n as u64).into(), answer.errors[n].into()]);
        }
        let fitted: Vec<_> = points
            .iter()
            .copied()
            .filter(|&(n, _)| (9.0..0.15 * masses as f64).contains(&n))
            .collect();
        claims.push(Claim::number(
            format!("{name}: the error falls like a power of the number of modes"),
            format!("{power}"),
            loglog_slope(&fitted).unwrap_or(f64::NAN),
            (power - 0.2, power + 0.2),
        ));
        for tolerance in TOLERANCES {
            let least = answer.least_modes(tolerance);
            table.push([
                format!("{name}, least for {tolerance:e}").into(),
                least.map_or_else(|| "more".into(), |least| (least as u64).into()),
            ]);
        }
        chart = chart.with(Series::new(name, points));
    }
    Ok(Study {
        id: MODES_NEEDED.id,
        krate: MODES_NEEDED.krate,
        chapter: MODES_NEEDED.chapter,
        kind: MODES_NEEDED.kind,
        title: MODES_NEEDED.title.into(),
        conclusion: format!(
            "A chain of {masses} masses between two walls, pushed everywhere or in the middle, and \
             the error of the middle's displacement with the lowest modes only. A load that reaches \
             far is met by a few modes; a load at a point needs ten times as many for each digit."
        ),
        table,
        charts: vec![chart.slope(-3.0, (10.0, 3e-5)).slope(-1.0, (10.0, 0.15)).into()],
        claims,
    })
}

fn large_motion(_: Size) -> Result<Study, StudyError> {
    let stage = || StudyError::at("the pendulum");
    let metric = stationary_calculus::DiagonalMetric::new([1.0]).map_err(StudyError::at("mass"))?;
    let mut hanging = Linearized::at(&metric, &PendulumPotential, &[0.0], 1e-15)
        .map_err(StudyError::at("the pendulum"))?;
    let modes = hanging.lowest(1, &RigidMotions::none()).map_err(stage())?;
    let mut table = Table::new([
        Column::rounded("amplitude [rad]", 3, 0.0),
        Column::rounded("error over a period", 3, 1e-9),
    ]);
    let mut points = Vec::new();
    for k in 0..=16 {
        let amplitude = 3.0 * 2.0_f64.powf(-0.5 * f64::from(k));
        let exact = pendulum(amplitude).map_err(StudyError::at("the pendulum"))?;
        let motion = Motion::new(&modes, hanging.mass(), Vector(&[amplitude]), Vector(&[0.0]))
            .map_err(stage())?;
        let mut worst = 0.0_f64;
        for i in 1..=100 {
            let t = exact.period * f64::from(i) / 100.0;
            let (mut d, mut v) = (Vector([0.0]), Vector([0.0]));
            motion.at(t, d.view_mut(), v.view_mut()).map_err(stage())?;
            worst = worst.max(exact.error(t, &d.0).unwrap_or(f64::NAN));
        }
        table.push([amplitude.into(), worst.into()]);
        points.push((amplitude, worst));
    }
    let small: Vec<_> = points.iter().copied().filter(|(amplitude, _)| *amplitude < 0.3).collect();
    let within = points.iter().filter(|(_, error)| *error <= 0.01).map(|p| p.0).fold(0.0, f64::max);
    Ok(Study {
        id: LARGE_MOTION.id,
        krate: LARGE_MOTION.krate,
        chapter: LARGE_MOTION.chapter,
        kind: LARGE_MOTION.kind,
        title: LARGE_MOTION.title.into(),
        conclusion: format!(
            "A pendulum over one period, by its one mode, against Jacobi's elliptic functions. The \
             true period is longer by a sixteenth of the amplitude's square, and the mode runs ahead \
             by so much: it is within one percent up to {within:.2} rad. There is no step to refine; \
             what is wrong is the model."
        ),
        table,
        charts: vec![
            Lines::new("", Axis::log("amplitude", "rad"), Axis::log("largest error", ""))
                .with(Series::new("one mode", points))
                .slope(2.0, (0.1, 1e-3))
                .into(),
        ],
        claims: vec![
            Claim::number(
                "the error grows with the square of the amplitude",
                "2",
                loglog_slope(&small).unwrap_or(f64::NAN),
                (1.95, 2.05),
            ),
            Claim::number(
                "one mode is within one percent over a period up to some amplitude [rad]",
                "0.16, where 2 pi a^2/16 is a hundredth",
                within,
                (0.1, 0.2),
            ),
        ],
    })
}
