//! A ball against a penalty wall: where the step is too large, and how far it is from rigid.

use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_chart::{Axis, Lines, Map, Series};
use stationary_contact::{Balls, ContactError, Inequality, OneSidedPenalty, Wall};
use stationary_integrators::{Integrator, State, StormerVerlet};
use stationary_measure::{Column, Table, loglog_slope};

use crate::studies::spaced::spaced;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Stiffness against step.
pub const CONTACT_PENALTY: Entry<'static> = Entry {
    id: "contact-penalty",
    krate: "contact",
    chapter: "11.3",
    kind: Kind::StabilityMap,
    title: "Ball on a wall of springs: what becomes of it, against step and stiffness",
    tested: Tested::Claims,
    run: &study,
};

const BOUNCES: &str = "speed kept within 5 %";
const OFF: &str = "off by more";
const THROWS: &str = "thrown out at more than twice the speed";
/// A ball of 1 kg at 1 m/s.
const RADIUS: f64 = 1.0;

/// The speed after the impact and the deepest overlap, for a ball that is `part` of a step's way
/// from the wall at the start.
fn impact(k: f64, h: f64, part: f64) -> Result<(f64, f64), ContactError> {
    let wall = Wall { normal: [1.0], offset: 0.0 };
    let gaps = Inequality(Balls::new(vec![RADIUS], vec![wall])?);
    let spring = OneSidedPenalty::new(gaps, k)?;
    let system = System::new(DiagonalMetric::new(vec![1.0])?, spring)?;
    let mut verlet = StormerVerlet::new(&system)?;
    let mut state = State::new(vec![RADIUS + part * h], Covector(vec![-1.0]));
    let (mut deepest, steps) = (0.0_f64, 20 + (10.0 / (h * k.sqrt())) as usize);
    for _ in 0..steps {
        verlet.step(&mut state, h)?;
        deepest = deepest.max(RADIUS - state.q[0]);
        if state.q[0] > RADIUS && state.p.0[0] > 0.0 {
            break;
        }
    }
    Ok((state.p.0[0], deepest))
}

fn worst(k: f64, h: f64) -> Result<f64, StudyError> {
    let mut off = 0.0_f64;
    for part in [0.05, 0.2, 0.35, 0.5, 0.65, 0.8, 0.95] {
        off = off.max((impact(k, h, part).map_err(StudyError::at("a penalty"))?.0 - 1.0).abs());
    }
    Ok(off)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let count = match size {
        Size::Default => 25,
        Size::Full => 61,
    };
    let mut table = Table::new([
        Column::rounded("step [s]", 3, 0.0),
        Column::rounded("stiffness [N/m]", 3, 0.0),
        Column::rounded("h omega", 3, 0.0),
        Column::exact("outcome"),
    ]);
    let axes = (Axis::log("step", "s"), Axis::log("stiffness", "N/m"));
    let mut map = Map::new("What becomes of the ball", axes.0, axes.1, [BOUNCES, OFF, THROWS]);
    let (mut resolved, mut beyond) = (0.0_f64, f64::INFINITY);
    for k in spaced(1e2, 1e6, count) {
        for h in spaced(1e-4, 0.3, count) {
            let (off, number) = (worst(k, h)?, h * k.sqrt());
            let outcome = match off {
                off if off <= 0.05 => BOUNCES,
                off if off <= 1.0 => OFF,
                _ => THROWS,
            };
            if number < 0.1 {
                resolved = resolved.max(off);
            }
            if number > 2.2 {
                beyond = beyond.min(off);
            }
            map.cell(h, k, outcome);
            table.push([h.into(), k.into(), number.into(), outcome.into()]);
        }
    }
    let border = spaced(1e-4, 0.2, 40).map(|h| (h, (2.0 / h).powi(2)));
    map = map.border("h ω = 2", border.filter(|&(_, k)| (1e2..=1e6).contains(&k)));
    let mut depths = Vec::new();
    for k in spaced(1e2, 1e6, 9) {
        let (_, depth) =
            impact(k, 0.01 / k.sqrt(), 0.3).map_err(StudyError::at("a resolved penalty"))?;
        depths.push((k, depth));
    }
    let slope = loglog_slope(&depths).unwrap_or(f64::NAN);
    let claims = vec![
        Claim::number(
            "the largest error of the speed where h ω is below 0.1",
            "small",
            resolved,
            (0.0, 0.06),
        ),
        Claim::number(
            "the smallest of the worst errors of the speed where h ω exceeds 2.2",
            "more than 1: thrown out",
            beyond,
            (1.0, f64::INFINITY),
        ),
        Claim::number("slope of the depth against stiffness", "-1/2", slope, (-0.505, -0.495)),
    ];
    let axes = (Axis::log("stiffness", "N/m"), Axis::log("deepest overlap", "m"));
    let depth = Lines::new("Deepest overlap", axes.0, axes.1)
        .with(Series::new("deepest overlap at h ω = 0.01", depths))
        .slope(-0.5, (1e4, 1.3e-2));
    Ok(Study {
        conclusion: "A ball of 1 kg flies at 1 m/s into a wall of springs, stepped by \
                     Stormer-Verlet, from seven distances. Beyond h ω = 2 with ω the root of k/m, \
                     one kick throws it out faster than it came. A hundred times the stiffness \
                     lets it sink in a tenth as far, and asks for a tenth of the step."
            .into(),
        table,
        charts: vec![map.into(), depth.into()],
        claims,
        ..CONTACT_PENALTY.heading()
    })
}
