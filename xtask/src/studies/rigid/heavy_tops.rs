//! Heavy tops: between which tilts a top nods, and what becomes of Kovalevskaya's integral.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::{EnergyBehavior, State};
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::problems::{KOVALEVSKAYA as TOP_OF_HERS, TOP, kovalevskaya_top, nodding_top};
use stationary_rigid::{BodyMethod, BodySpace, Orientations, tilt};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The bounds of nutation, by every method.
pub const NUTATION: Entry<'static> = Entry {
    id: "nodding-top",
    krate: "rigid",
    chapter: "9.4",
    kind: Kind::Convergence,
    title: "Spinning top: its tilt against time, and the tilt's error against the step",
    tested: Tested::Claims,
    run: &nutation,
};

/// The fourth integral over time.
pub const KOVALEVSKAYA: Entry<'static> = Entry {
    id: "kovalevskaya-top",
    krate: "rigid",
    chapter: "9.4",
    kind: Kind::LongRun,
    title: "Kovalevskaya's top: error of its integral against time",
    tested: Tested::Claims,
    run: &fourth_integral,
};

/// The time over which the top is watched: some four nods.
const WATCHED: f64 = 2.0;

/// The largest tilt in `steps` steps, and the path of the tilt, where it survives.
fn most(method: BodyMethod, steps: u32) -> Result<(f64, Vec<(f64, f64)>), StudyError> {
    let problem = nodding_top().map_err(StudyError::at("the top"))?;
    let name = method.facts().name;
    let mut integrator = method.integrator(&problem.system).map_err(StudyError::at(name))?;
    let mut state = problem.initial.clone();
    let h = WATCHED / f64::from(steps);
    let (mut largest, mut path) = (0.0_f64, Vec::new());
    for _ in 0..steps {
        integrator.step(&mut state, h).map_err(StudyError::at(name))?;
        let angle = tilt(&Orientations::pose_at(&state.q, 0).rotation);
        largest = largest.max(angle);
        path.push((state.t, angle));
    }
    Ok((largest, path))
}

fn nutation(_: Size) -> Result<Study, StudyError> {
    let problem = nodding_top().map_err(StudyError::at("the top"))?;
    let m = Vector3::from_column_slice(problem.initial.p.components());
    let [low, high] = TOP.nutation(&problem.motion.pose.rotation, &m);
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("steps"),
        Column::rounded("largest tilt [rad]", 5, 0.0),
        Column::rounded("beyond the bound [rad]", 2, 1e-8),
    ]);
    let axis = Axis::log("step", "s");
    let mut errors =
        Lines::new("Error of the largest tilt", axis, Axis::log("off the largest tilt", "rad"));
    let mut claims = Vec::new();
    for &method in BodyMethod::ALL {
        let name = method.facts().name;
        let mut points = Vec::new();
        // At these steps several fall on each crest, and the crest is read to its own error.
        for steps in [1_000_u32, 2_000, 4_000, 8_000, 16_000] {
            let (largest, _) = most(method, steps)?;
            let off = (largest - high).abs();
            points.push((WATCHED / f64::from(steps), off.max(1e-12)));
            let cells: [Cell; 4] =
                [name.into(), u64::from(steps).into(), largest.into(), off.into()];
            table.push(cells);
        }
        if method.facts().energy == EnergyBehavior::Bounded {
            let text = format!("{name}: the power of the step with which the crest is missed");
            let order = loglog_slope(&points).unwrap_or(f64::NAN);
            claims.push(Claim::number(text, "2", order, (1.7, 2.3)));
        }
        errors = errors.with(Series::new(name, points));
    }
    let mut paths = Lines::new("Tilt", Axis::linear("time", "s"), Axis::linear("tilt", "rad"))
        .curve("least", [(0.0, low), (WATCHED, low)])
        .curve("largest", [(0.0, high), (WATCHED, high)]);
    let method = BodyMethod::VariationalRotation;
    let (largest, path) = most(method, 16_000)?;
    let path = path.into_iter().step_by(40);
    paths = paths.with(Series::new(method.facts().name, path));
    claims.push(Claim::number(
        "variational-rotation with the finest step: the largest tilt over that of the closed form",
        "1",
        largest / high,
        (1.0 - 1e-5, 1.0 + 1e-5),
    ));
    Ok(Study {
        conclusion: format!(
            "A top that spins at 60 rad/s is let go at a tilt of {low:.3} rad: it falls, and its spin \
             turns the fall round. Energy and two momenta bound the tilt by {high:.4} rad, and in {WATCHED} \
             s it comes there again and again. Methods that keep these invariants for ever miss the \
             crest by a bounded error that a half step quarters."
        ),
        table,
        charts: vec![paths.into(), errors.into()],
        claims,
        ..NUTATION.heading()
    })
}

/// The step of the fourth integral's run, seconds.
const STEP: f64 = 5e-3;

fn fourth_integral(size: Size) -> Result<Study, StudyError> {
    let steps: u32 = match size {
        Size::Default => 40_000,
        Size::Full => 1_000_000,
    };
    let problem = kovalevskaya_top().map_err(StudyError::at("the top"))?;
    let integral = |state: &State<Vec<f64>>| {
        let m = Vector3::from_column_slice(state.p.components());
        let w = problem.body().angular_velocity(&m);
        TOP_OF_HERS.integral(&Orientations::pose_at(&state.q, 0).rotation, &w)
    };
    let start = integral(&problem.initial);
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("steps"),
        Column::rounded("largest error of the integral", 2, 1e-9),
    ]);
    let axes = (Axis::log("steps", ""), Axis::log("largest relative error", ""));
    let mut chart = Lines::new("Kovalevskaya's integral", axes.0, axes.1);
    let mut claims = Vec::new();
    for &method in BodyMethod::ALL {
        let name = method.facts().name;
        let mut integrator = method.integrator(&problem.system).map_err(StudyError::at(name))?;
        let mut state = problem.initial.clone();
        let (mut worst, mut marks, mut next) = (0.0_f64, Vec::new(), 10);
        for step in 1..=steps {
            if integrator.step(&mut state, STEP).is_err() {
                break;
            }
            worst = worst.max((integral(&state) / start - 1.0).abs());
            if step == next || step == steps {
                marks.push((f64::from(step), worst));
                next = (step + step / 3 + 1).min(10_u32.pow(step.ilog10() + 1));
            }
        }
        for &(step, worst) in marks.iter().filter(|m| m.0.log10().fract() == 0.0) {
            table.push([Cell::from(name), Cell::from(step as u64), Cell::from(worst)]);
        }
        let at = |steps: f64| marks.iter().find(|m| m.0 >= steps).map_or(f64::NAN, |m| m.1);
        let growth = worst / at(f64::from(steps) / 10.0);
        let bounded = method.facts().energy == EnergyBehavior::Bounded;
        claims.push(if bounded {
            let text = format!("{name}: its growth in the last nine tenths of the time");
            Claim::number(text, "below 1.5: bounded", growth, (1.0, 1.5))
        } else {
            let text = format!("{name}: its growth in the last nine tenths of the time");
            Claim::number(text, "above 1.5: it drifts away", growth, (1.5, f64::INFINITY))
        });
        chart = chart.with(Series::new(name, marks));
    }
    Ok(Study {
        conclusion: format!(
            "A heavy top with moments 2 : 2 : 1 and its centre of mass across the third axis has a \
             fourth integral, which comes from no symmetry: no method keeps it to rounding. Over \
             {steps} steps of {} ms the symplectic ones keep it within a bound, as they do energy, since \
             they follow a motion that is integrable, too, but for little; the others lose it.",
            1e3 * STEP
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..KOVALEVSKAYA.heading()
    })
}
