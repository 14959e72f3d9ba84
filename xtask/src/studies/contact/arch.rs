//! A masonry arch: how rough its joints must be for it to stand.

use stationary_chart::{Axis, Lines, Portrait, Series};
use stationary_contact::{Arch, ContactError, Dimension, Planar};
use stationary_integrators::State;
use stationary_measure::{Column, Table};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// How far an arch sinks against its friction.
pub const MASONRY_ARCH: Entry<'static> = Entry {
    id: "masonry-arch",
    krate: "contact",
    chapter: "friction",
    kind: Kind::Limit,
    title: "Masonry arch: whether it stands, against friction",
    tested: Tested::Claims,
    run: &study,
};

/// The step, seconds.
const STEP: f64 = 2e-3;
/// A keystone that sinks by more than this in the time of a run falls, m.
const FALLS: f64 = 2e-4;

fn arch(friction: f64) -> Arch {
    Arch { wedges: 11, radius: 1.0, thickness: 0.3, friction, gravity: 9.81 }
}

/// The least friction with which some thrust leans from no joint's normal by more than friction
/// holds: a horizontal thrust `eta` and the weight `phi` of what is above the joint at the angle
/// `phi` from the crown, both over that of a radian of the arch.
fn least_friction(wedges: usize) -> f64 {
    let joint = |k: usize| (k as f64 + 0.5) * std::f64::consts::PI / wedges as f64;
    let leans = |eta: f64| {
        let joints = (0..=wedges / 2).map(joint);
        joints.map(|phi| ((phi / eta).atan() - phi).abs().tan()).fold(0.0, f64::max)
    };
    (1..2_000).map(|k| leans(5e-4 * f64::from(k))).fold(f64::INFINITY, f64::min)
}

/// What an arch did.
struct Run {
    sunk: f64,
    coulomb: f64,
    residual: f64,
    states: Vec<State<Vec<f64>>>,
}

/// Runs an arch for some steps, or until it falls if a border is given, keeping every so many-th
/// state.
fn run(arch: Arch, steps: usize, keep: usize, border: f64) -> Result<Run, ContactError> {
    let (mut world, mut state) = arch.built()?;
    let start = state.clone();
    let mut run = Run { sunk: 0.0, coulomb: 0.0, residual: 0.0, states: vec![start.clone()] };
    for step in 1..=steps {
        let report = world.step(&mut state, STEP)?;
        run.coulomb = report.coulomb;
        run.residual = run.residual.max(report.residual);
        run.sunk = arch.sunk(&start, &state);
        if step % keep == 0 {
            run.states.push(state.clone());
        }
        if run.sunk > border {
            break;
        }
    }
    Ok(run)
}

/// The outlines of the wedges, one after the other.
fn outlines(arch: Arch, state: &State<Vec<f64>>) -> Result<Vec<(f64, f64)>, ContactError> {
    let (mut world, _) = arch.built()?;
    let mut points = Vec::new();
    for (wedge, collider) in world.detector().colliders().iter().take(arch.wedges).enumerate() {
        let pose = Planar::pose(&state.q, wedge);
        for piece in collider.shape.pieces() {
            let corners = piece.iter().cycle().take(piece.len() + 1);
            points.extend(corners.map(|corner| {
                let place = pose.apply(corner);
                (place.x, place.y)
            }));
            points.push((f64::NAN, f64::NAN));
        }
    }
    Ok(points)
}

fn picture(title: &str, arch: Arch, run: &Run, every: f64) -> Result<Portrait, ContactError> {
    let mut portrait = Portrait::new(title, Axis::linear("x", "m"), Axis::linear("height", "m"));
    for (k, state) in run.states.iter().enumerate() {
        let name = match k {
            0 => "as built".into(),
            k => format!("after {} s", every * k as f64),
        };
        portrait = portrait.curve(Series::new(&name, outlines(arch, state)?));
    }
    Ok(portrait)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (steps, long, frictions) = match size {
        Size::Default => (100, 500, 9),
        Size::Full => (400, 5_000, 33),
    };
    let mut table = Table::new([
        Column::rounded("friction", 4, 0.0),
        Column::exact("what it does"),
        Column::rounded("keystone sunk [m]", 2, 1e-6),
        Column::rounded("residual of Coulomb's law [m/s]", 1, 1e-4),
    ]);
    let failed = |error: ContactError| StudyError::at("an arch")(error);
    let (mut falls, mut points, mut residual) = (Vec::new(), Vec::new(), 0.0_f64);
    for k in 0..frictions {
        let friction = 0.2 + 0.2 * f64::from(k) / f64::from(frictions - 1);
        let run = run(arch(friction), steps, steps, FALLS).map_err(failed)?;
        let fell = run.sunk > FALLS;
        falls.push((friction, fell));
        points.push((friction, run.sunk));
        residual = residual.max(run.residual);
        let outcome = if fell { "falls" } else { "stands" };
        table.push([friction.into(), outcome.into(), run.sunk.into(), run.coulomb.into()]);
    }
    let stays = run(arch(0.6), long, long, f64::INFINITY).map_err(failed)?;
    let fallen = run(arch(0.0), 200, 100, f64::INFINITY).map_err(failed)?;
    let predicted = least_friction(11);
    let lowest = falls.iter().filter(|(_, fell)| !fell).map(|f| f.0).fold(f64::INFINITY, f64::min);
    let highest = falls.iter().filter(|(_, fell)| *fell).map(|f| f.0).fold(0.0, f64::max);
    let border = 0.5 * (lowest + highest);
    let spacing = 0.2 / f64::from(frictions - 1);
    let claims = vec![
        Claim::number(
            "least friction that stands, between the last that falls and the first that stands",
            format!("{predicted:.3}, by statics, within a spacing of {spacing:.3}"),
            border,
            (predicted - spacing, predicted + spacing),
        ),
        Claim::number(
            "spacings between those two",
            "1",
            (lowest - highest) / spacing,
            (0.99, 1.01),
        ),
        Claim::number("sunk with friction 0.6, m", "below 1e-6", stays.sunk.abs(), (0.0, 1e-6)),
        Claim::number(
            "residual of Coulomb's law in the end, m/s",
            "below 1e-9",
            stays.coulomb,
            (0.0, 1e-9),
        ),
        Claim::number(
            "residual of the normal conditions with friction 0.6, m/s",
            "below 1e-9",
            stays.residual,
            (0.0, 1e-9),
        ),
        Claim::number(
            "of all, over what the weight changes of a velocity in a step",
            "within the tolerance, 1e-2",
            residual / (9.81 * STEP),
            (0.0, 1e-2),
        ),
        Claim::number(
            "sunk without friction after 0.4 s, m",
            "more than 0.2",
            fallen.sunk,
            (0.2, 2.0),
        ),
    ];
    let axes = (Axis::linear("friction", ""), Axis::log("keystone sunk", "m"));
    let chart = Lines::new("Eleven stones, let go", axes.0, axes.1)
        .with(Series::new("keystone", points.iter().map(|&(x, y)| (x, y.max(1e-9)))))
        .curve("statics", [(predicted, 1e-8), (predicted, 1e-3)]);
    let seconds = STEP * long as f64;
    let charts = vec![
        picture("Friction 0.6", arch(0.6), &stays, seconds).map_err(failed)?.into(),
        picture("No friction", arch(0.0), &fallen, 0.2).map_err(failed)?.into(),
        chart.into(),
    ];
    Ok(Study {
        conclusion:
            "Eleven wedges lean on each other in a half circle and are let go. With enough \
                     friction nothing moves; without it the springings slide apart and the crown \
                     comes down. The border is where statics puts it: some thrust must lean from \
                     every joint's normal by less than friction holds. A run of the chart ends \
                     once the keystone has sunk by 0.2 mm."
                .into(),
        table,
        charts,
        claims,
        ..MASONRY_ARCH.heading()
    })
}
