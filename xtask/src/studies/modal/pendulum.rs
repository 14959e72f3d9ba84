//! How large a motion linear modes can follow: a pendulum.

use stationary_calculus::Vector;
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::problems::{PendulumPotential, pendulum};
use stationary_measure::{Column, Table, loglog_slope};
use stationary_modal::{Linearized, Motion, RigidMotions};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of linear modes against the amplitude.
pub const STUDY: Entry<'static> = Entry {
    id: "modes-large-motion",
    krate: "modal",
    chapter: "14.2",
    kind: Kind::Ladder,
    title: "Pendulum by its linear mode: error against the amplitude",
    tested: Tested::Claims,
    run: &study,
};

fn study(_: Size) -> Result<Study, StudyError> {
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
    let within =
        small.first().map_or(f64::NAN, |(amplitude, error)| amplitude * (0.01 / error).sqrt());
    Ok(Study {
        conclusion: format!(
            "A pendulum over one period, by its one mode, against Jacobi's elliptic functions. The \
             true period is longer by a sixteenth of the amplitude's square, and the mode runs ahead \
             by so much: it is within one percent up to {within:.3} rad. There is no step to refine; \
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
                "0.182, where the largest of x sin(x) over a period, 4.81, times a^2/16 is a hundredth",
                within,
                (0.178, 0.186),
            ),
        ],
        ..STUDY.heading()
    })
}
