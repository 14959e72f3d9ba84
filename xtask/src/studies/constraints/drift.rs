//! Constraints on accelerations, with and without gains: what other engines do, for contrast.
//!
//! ```text
//! J a + J. v + 2 alpha J v + alpha^2 g = 0,    a = M^-1 (F - J^T lambda)      (Baumgarte 1972)
//! ```
//! For one rod in the plane lambda has a closed form; the motion is stepped by RK4.

use stationary_chart::{Axis, Lines, Map, Series};
use stationary_constraints::problems::{Pendulum, pendulum};
use stationary_measure::{Column, Table, loglog_slope};

use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Gain against step, and the drift without gains.
pub const ACCELERATION_DRIFT: Entry<'static> = Entry {
    id: "acceleration-drift",
    krate: "constraints",
    chapter: "6",
    kind: Kind::StabilityMap,
    title: "Rod held by its acceleration: which gains are stable, and its drift",
    tested: Tested::ByReport,
    run: &study,
};

const HOLDS: &str = "violation below 1e-6";
const LOOSE: &str = "violation above 1e-6";
const BLOWS_UP: &str = "blows up";

/// Place and velocity of the unit pendulum.
type Motion = [f64; 4];

/// The rate of a motion under a gain.
fn rate([x, y, u, v]: Motion, alpha: f64) -> Motion {
    let (g, square) = (x * x + y * y - 1.0, x * x + y * y);
    let along = 2.0 * (x * u + y * v);
    // J = (2x, 2y), and J J^T = 4 |q|^2.
    let lambda = (2.0 * (u * u + v * v) - 2.0 * y + 2.0 * alpha * along + alpha * alpha * g)
        / (4.0 * square);
    [u, v, -2.0 * x * lambda, -1.0 - 2.0 * y * lambda]
}

fn moved(motion: Motion, h: f64, rate: Motion) -> Motion {
    std::array::from_fn(|i| motion[i] + h * rate[i])
}

fn runge_kutta(motion: Motion, h: f64, alpha: f64) -> Motion {
    let a = rate(motion, alpha);
    let b = rate(moved(motion, 0.5 * h, a), alpha);
    let c = rate(moved(motion, 0.5 * h, b), alpha);
    let d = rate(moved(motion, h, c), alpha);
    std::array::from_fn(|i| motion[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

fn violation(motion: Motion) -> f64 {
    (motion[0].hypot(motion[1]) - 1.0).abs()
}

fn energy(motion: Motion) -> f64 {
    0.5 * (motion[2] * motion[2] + motion[3] * motion[3]) + motion[1]
}

/// The largest violation and energy error after each of some periods.
fn follow(exact: &Pendulum, h: f64, alpha: f64, periods: u32) -> Vec<[f64; 2]> {
    let state = exact.state(0.7);
    // Off by a little, as every start is: what the gains are there to mend.
    let mut motion = [state.q[0], state.q[1], state.p.0[0], state.p.0[1]];
    let (start, steps) = (energy(motion), (exact.period / h).ceil() as u64);
    let (mut worst, mut marks) = ([0.0_f64; 2], Vec::new());
    for _ in 0..periods {
        for _ in 0..steps {
            motion = runge_kutta(motion, h, alpha);
            let now = [violation(motion), (energy(motion) - start).abs()];
            for (worst, now) in worst.iter_mut().zip(now) {
                *worst = if now < f64::INFINITY { worst.max(now) } else { f64::INFINITY };
            }
        }
        marks.push(worst);
    }
    marks
}

/// The stability limit of RK4 on a double root -alpha: `1 - z + z^2/2 - z^3/6 + z^4/24 = 1`.
const LIMIT: f64 = 2.785_293_563_405_282;

fn study(size: Size) -> Result<Study, StudyError> {
    let (count, periods) = match size {
        Size::Default => (21, 50),
        Size::Full => (41, 300),
    };
    let exact = pendulum(1.9).map_err(StudyError::at("the pendulum"))?;
    let mut table = Table::new([
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("gain [1/s]", 3, 0.0),
        Column::rounded("violation", 2, 1e-13),
        Column::rounded("energy error [J]", 2, 1e-12),
        Column::exact("outcome"),
    ]);
    let axes = (Axis::log("step", "s"), Axis::log("gain", "1/s"));
    let mut map = Map::new("Twenty periods", axes.0, axes.1, [HOLDS, LOOSE, BLOWS_UP]);
    let (mut agree, mut cells) = (0_u32, 0_u32);
    for alpha in spaced(1.0, 1e3, count) {
        for h in spaced(2e-3, 0.3, count) {
            let worst = follow(&exact, h, alpha, 20).pop().unwrap_or([f64::NAN; 2]);
            let outcome = match worst[0] {
                worst if worst < 1e-6 => HOLDS,
                worst if worst < 0.5 => LOOSE,
                _ => BLOWS_UP,
            };
            map.cell(h, alpha, outcome);
            table.push([h.into(), alpha.into(), worst[0].into(), worst[1].into(), outcome.into()]);
            let z = h * alpha;
            if (z / LIMIT - 1.0).abs() > 0.25 {
                cells += 1;
                agree += u32::from((z < LIMIT) == (outcome != BLOWS_UP));
            }
        }
    }
    let border = spaced(2e-3, 0.3, 40).map(|h| (h, LIMIT / h));
    map = map.border("h α = 2.785", border.filter(|&(_, a)| (1.0..=1e3).contains(&a)));
    let (h, mut lines) = (0.02, Vec::new());
    for (name, alpha) in [("no gain", 0.0), ("gain 10 1/s", 10.0)] {
        let marks = follow(&exact, h, alpha, periods);
        let points = marks.iter().enumerate().map(|(i, worst)| ((i + 1) as f64, worst[0]));
        lines.push((name, points.collect::<Vec<_>>()));
    }
    let last_decade = |points: &[(f64, f64)]| {
        let later: Vec<_> =
            points.iter().copied().filter(|point| 10.0 * point.0 >= points.len() as f64).collect();
        loglog_slope(&later).unwrap_or(f64::NAN)
    };
    let claims = vec![
        Claim::number(
            "part of the map, off its border, that is stable as RK4 predicts for a double root",
            "1",
            f64::from(agree) / f64::from(cells),
            (0.99, 1.0),
        ),
        Claim::number(
            "power of time by which the rod's violation grows without gains",
            "at least 1",
            last_decade(&lines[0].1),
            (0.8, 2.5),
        ),
        Claim::number("the same with a gain of 10 1/s", "0", last_decade(&lines[1].1), (0.0, 0.05)),
    ];
    let axes = (Axis::log("periods", ""), Axis::log("violation", "m"));
    let chart = lines
        .into_iter()
        .fold(Lines::new("Steps of 0.02 s", axes.0, axes.1), |chart, (name, points)| {
            chart.with(Series::new(name, points))
        });
    Ok(Study {
        conclusion: "Here the constraint is differentiated twice and solved for the acceleration, \
                     as many engines do. Nothing then remembers the rod's length, and it drifts. \
                     Gains pull it back, critically damped; too small they are loose, and above \
                     h α = 2.785 they blow up themselves. A multiplier step has neither a \
                     gain nor a drift."
            .into(),
        table,
        charts: vec![chart.into(), map.into()],
        claims,
        ..ACCELERATION_DRIFT.heading()
    })
}
