//! A ball bounces: how high, for each choice of when the impulse is given.

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Series};
use stationary_contact::{Balls, ContactError, ImpactLaw, Impacting, Inequality, Wall, When};
use stationary_integrators::{State, UniformGravity};
use stationary_measure::{Column, Table, loglog_slope};

use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Error of the rebound height against the step.
pub const BOUNCING_BALL: Entry<'static> = Entry {
    id: "bouncing-ball",
    krate: "contact",
    chapter: "11.4",
    kind: Kind::Convergence,
    title: "Bouncing ball: error against the step, by when the impulse is given",
    tested: Tested::ByReport,
    run: &study,
};

const GRAVITY: f64 = 10.0;
const RADIUS: f64 = 0.25;
const RESTITUTION: f64 = 0.8;
/// Rounding of a height of a metre after a thousand steps.
const ROUNDING: f64 = 1e-12;

/// The error of the height between the first and the second bounce, from a fall of 1 m.
fn error(when: When, h: f64) -> Result<f64, ContactError> {
    let weight = UniformGravity { acceleration: [-GRAVITY], masses: vec![1.0] };
    let system = System::new(DiagonalMetric::new(vec![1.0])?, weight)?;
    let wall = Wall { normal: [1.0], offset: 0.0 };
    let gaps = Inequality(Balls::new(vec![RADIUS], vec![wall])?);
    let law = ImpactLaw::GeneralizedReflections;
    let mut impacting = Impacting::new(&system, &gaps, RESTITUTION, law, when)?;
    let mut state = State::new(vec![1.0 + RADIUS], Covector(vec![0.0]));
    let (mut impacts, mut top) = (0, 0.0_f64);
    while impacts < 2 && state.t < 3.0 {
        impacts += impacting.step(&mut state, h)?.impacts;
        let height = state.q[0] - RADIUS + state.p.0[0].powi(2) / (2.0 * GRAVITY);
        top = if impacts == 1 { top.max(height) } else { top };
    }
    Ok((top - RESTITUTION * RESTITUTION).abs())
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 9,
        Size::Full => 13,
    };
    let mut table = Table::new([
        Column::exact("when"),
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("largest error of the height [m]", 2, ROUNDING),
    ]);
    let axes = (Axis::log("step", "s"), Axis::log("error of the rebound height", "m"));
    let mut chart = Lines::new("", axes.0, axes.1).slope(1.0, (1e-3, 3e-3));
    let mut claims = Vec::new();
    for &when in When::ALL {
        let mut points = Vec::new();
        for h in spaced(3e-5, 2e-2, count) {
            let mut worst = 0.0_f64;
            // How a step happens to fall does not count: the largest error over steps of about a
            // size.
            for k in 0..8 {
                let h = h * (1.0 - 0.037_1 * f64::from(k));
                worst = worst.max(error(when, h).map_err(StudyError::at(when.name()))?);
            }
            table.push([when.name().into(), h.into(), worst.into()]);
            points.push((h, worst.max(1e-16)));
        }
        claims.push(match when {
            When::AtTheInstant => {
                let worst = points.iter().map(|p| p.1).fold(0.0, f64::max);
                let text = "at-the-instant: the largest error of the height, m";
                Claim::number(text, "below 1e-9", worst, (0.0, 1e-9))
            }
            When::AfterOverlap | When::VelocityFilter => {
                let slope = loglog_slope(&points).unwrap_or(f64::NAN);
                Claim::number(format!("order of {}", when.name()), "1", slope, (0.85, 1.15))
            }
        });
        chart = chart.with(Series::new(when.name(), points));
    }
    Ok(Study {
        conclusion: "A ball falls from a metre and rebounds to 0.64 of it. An impulse at the \
                     instant of the impact gives that height at any step; one after the overlap, \
                     or one before it, is off by as much as the ball falls in a step."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..BOUNCING_BALL.heading()
    })
}
