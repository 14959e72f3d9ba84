//! Free bodies: what their integrators keep over a long time, and what accuracy costs.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_integrators::EnergyBehavior;
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::problems::tumbling_box;
use stationary_rigid::{BodyMethod, BodySpace, FreeTop, LieGroup, Poses, spatial_angular_momentum};

use crate::studies::cheapest::Asked;
use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// Energy and angular momentum of a tumbling box over many steps.
pub const LONG_RUN: Entry<'static> = Entry {
    id: "tumbling-box-long-run",
    krate: "rigid",
    chapter: "9.5",
    kind: Kind::LongRun,
    title: "Tumbling box: energy and momentum over a hundred thousand steps",
    tested: Tested::Claims,
    run: &long_run,
};

/// Attitude against the closed form, and what it costs.
pub const WORK_PRECISION: Entry<'static> = Entry {
    id: "tumbling-box-work-precision",
    krate: "rigid",
    chapter: "9.5",
    kind: Kind::WorkPrecision,
    title: "Free rigid body: error of its attitude against cost",
    tested: Tested::Claims,
    run: &work_precision,
};

/// The step of the long run, seconds.
const STEP: f64 = 0.01;
/// Rounding of energy and momentum over so many steps.
const ROUNDING: f64 = 1e-11;

/// The worst errors after some steps, and the energy then.
#[derive(Clone, Copy)]
struct Mark {
    steps: u32,
    energy: f64,
    momentum: f64,
}

fn follow(method: BodyMethod, h: f64, steps: u32) -> Result<(Vec<Mark>, bool), StudyError> {
    let problem = tumbling_box().map_err(StudyError::at("the box"))?;
    let mut integrator =
        method.integrator(&problem.system).map_err(StudyError::at(method.facts().name))?;
    let mut state = problem.initial.clone();
    let (energy, momentum) = (
        problem.energy(&state),
        spatial_angular_momentum::<Poses>(&state).map_err(StudyError::at("the momentum"))?,
    );
    let (mut worst, mut marks, mut next) = ((0.0_f64, 0.0_f64), Vec::new(), 10);
    for step in 1..=steps {
        if integrator.step(&mut state, h).is_err() {
            return Ok((marks, false));
        }
        worst.0 = worst.0.max((problem.energy(&state) / energy - 1.0).abs());
        let off = spatial_angular_momentum::<Poses>(&state)
            .map_err(StudyError::at("the momentum"))?
            - momentum;
        worst.1 = worst.1.max(off.norm() / momentum.norm());
        if step == next || step == steps {
            marks.push(Mark { steps: step, energy: worst.0, momentum: worst.1 });
            let power = 10_u32.pow(step.ilog10() + 1);
            next = (step + (step / 4).max(1)).min(power);
        }
    }
    Ok((marks, true))
}

fn long_run(size: Size) -> Result<Study, StudyError> {
    let steps = match size {
        Size::Default => 100_000,
        Size::Full => 1_000_000,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("steps"),
        Column::rounded("energy error", 2, ROUNDING),
        Column::rounded("angular momentum error", 2, ROUNDING),
    ]);
    let axis = |title, y| Lines::new(title, Axis::log("steps", ""), Axis::log(y, ""));
    let mut energies = axis("Energy", "largest energy error");
    let mut momenta = axis("Angular momentum", "largest angular momentum error");
    let mut claims = Vec::new();
    for &method in BodyMethod::ALL {
        let (marks, survived) = follow(method, STEP, steps)?;
        let name = method.facts().name;
        for mark in marks.iter().filter(|mark| f64::from(mark.steps).log10().fract() == 0.0) {
            let mut cells: Vec<Cell> = vec![name.into(), u64::from(mark.steps).into()];
            cells.extend([mark.energy, mark.momentum].map(Cell::from));
            table.push(cells);
        }
        let line = |of: fn(&Mark) -> f64| {
            let points = marks.iter().map(|m| (f64::from(m.steps), of(m).max(1e-17)));
            Series::new(name, points)
        };
        energies = energies.with(line(|mark| mark.energy));
        momenta = momenta.with(line(|mark| mark.momentum));
        claims.extend(kept(method, &marks, survived)?);
    }
    Ok(Study {
        conclusion: format!(
            "A free box of half sizes 0.1, 0.2 and 0.3 m that starts at (1, 2, 3) rad/s, in \
             steps of 10 ms, {steps} times. The maps that turn orientation and momentum by one \
             and the same rotation keep spatial angular momentum to rounding, and energy within \
             a bound that a quarter of the step divides by sixteen. Munthe-Kaas starts more \
             accurate and drifts; the step of game engines gains energy until the box flies to \
             pieces."
        ),
        table,
        charts: vec![energies.into(), momenta.into()],
        claims,
        ..LONG_RUN.heading()
    })
}

/// What the numbers must show of a method.
fn kept(method: BodyMethod, marks: &[Mark], survived: bool) -> Result<Vec<Claim>, StudyError> {
    let name = method.facts().name;
    let Some(last) = marks.last() else {
        return Ok(Vec::new());
    };
    if method.facts().energy != EnergyBehavior::Bounded {
        let points: Vec<_> = marks
            .iter()
            .filter(|m| m.steps >= 1_000)
            .map(|m| (f64::from(m.steps), m.energy))
            .collect();
        if !survived {
            let claim = format!("{name} loses more than a tenth of the angular momentum");
            return Ok(vec![Claim::number(
                claim,
                "more than 0.1",
                last.momentum,
                (0.1, f64::INFINITY),
            )]);
        }
        let power = loglog_slope(&points).unwrap_or(f64::NAN);
        let claim = format!("{name}: the power of time with which energy drifts");
        return Ok(vec![Claim::number(claim, "1: linear", power, (0.9, 1.1))]);
    }
    let fine = follow(method, STEP / 4.0, 4_000)?.0;
    let coarse = marks.iter().find(|mark| mark.steps == 1_000);
    let mut claims = vec![Claim::number(
        format!("{name} keeps angular momentum to rounding"),
        "below 1e-12",
        last.momentum,
        (0.0, 1e-12),
    )];
    if method == BodyMethod::ExactRotation {
        let text = format!("{name} keeps the energy of a free body to rounding");
        claims.push(Claim::number(text, "below 1e-11", last.energy, (0.0, 1e-11)));
        return Ok(claims);
    }
    if let (Some(coarse), Some(fine)) = (coarse, fine.last()) {
        claims.push(Claim::number(
            format!("{name}: the energy error at 10 ms"),
            "below 2e-5",
            last.energy,
            (0.0, 2e-5),
        ));
        claims.push(Claim::number(
            format!("{name}: energy error at four times the step"),
            "16 times larger",
            coarse.energy / fine.energy,
            (15.6, 16.4),
        ));
        claims.push(Claim::number(
            format!("{name}: energy error at the end over that after 1000 steps"),
            "1: no trend",
            last.energy / coarse.energy,
            (1.0, 1.001),
        ));
    }
    Ok(claims)
}

/// The largest error of the attitude, radians.
fn attitude_error(method: BodyMethod, steps: u32) -> Result<f64, StudyError> {
    let problem = tumbling_box().map_err(StudyError::at("the box"))?;
    let start = &problem.motion;
    let truth = FreeTop::new(*problem.body(), start.pose.rotation, start.angular_velocity)
        .map_err(StudyError::at("the closed form"))?;
    let mut integrator =
        method.integrator(&problem.system).map_err(StudyError::at(method.facts().name))?;
    let mut state = problem.initial.clone();
    let h = problem.horizon / f64::from(steps);
    let mut worst = 0.0_f64;
    for step in 1..=steps {
        integrator.step(&mut state, h).map_err(StudyError::at(method.facts().name))?;
        if step % (steps / 50) == 0 {
            let exact = truth.orientation(h * f64::from(step));
            let exact = exact.map_err(StudyError::at("the closed form"))?;
            let off: Vector3<f64> = Poses::pose_at(&state.q, 0).rotation.direction_to(&exact);
            worst = worst.max(off.norm());
        }
    }
    Ok(worst)
}

fn work_precision(size: Size) -> Result<Study, StudyError> {
    let halvings = match size {
        Size::Default => 8,
        Size::Full => 12,
    };
    let mut table = Table::new([
        Column::exact("method"),
        Column::exact("steps"),
        Column::exact("torques"),
        Column::rounded("attitude error [rad]", 2, ROUNDING),
    ]);
    let mut chart = Lines::new(
        "Attitude",
        Axis::log("torques evaluated", ""),
        Axis::log("largest error", "rad"),
    );
    let mut for_any_torque = chart.clone();
    let mut claims = Vec::new();
    for &method in BodyMethod::ALL {
        let name = method.facts().name;
        let mut points = Vec::new();
        let coarsest: u32 = if method.facts().order == 1 { 1_600 } else { 50 };
        for halving in 0..halvings {
            let steps = coarsest << halving;
            let error = attitude_error(method, steps)?;
            let torques = u64::from(steps) * u64::from(method.facts().stages);
            let cells: [Cell; 4] =
                [name.into(), u64::from(steps).into(), torques.into(), error.into()];
            table.push(cells);
            points.push((torques as f64, error.max(1e-16)));
        }
        if method == BodyMethod::ExactRotation {
            let (_, worst) =
                points.iter().copied().fold((0.0, 0.0_f64), |(_, w), p| (p.0, w.max(p.1)));
            let text = format!("{name} has no error but rounding at any step");
            claims.push(Claim::number(text, "below 1e-11", worst, (0.0, 1e-11)));
        } else {
            let settled: Vec<_> =
                points.iter().copied().filter(|&(_, e)| e < 0.01 && e > ROUNDING).collect();
            let order =
                -loglog_slope(&settled[settled.len().saturating_sub(4)..]).unwrap_or(f64::NAN);
            let claimed = f64::from(method.facts().order);
            let band = (claimed - 0.15, claimed + 0.15);
            claims.push(Claim::number(
                format!("order of {name}"),
                claimed.to_string(),
                order,
                band,
            ));
        }
        let series = Series::new(name, points);
        if method != BodyMethod::ExactRotation {
            for_any_torque = for_any_torque.with(series.clone());
        }
        chart = chart.with(series);
    }
    let asked = Asked {
        question: "Attitude of a rigid body over seconds, to 1e-4\u{a0}rad",
        error: 1e-4,
        cost: "torques",
        rival: "variational-rotation",
    };
    Ok(Study {
        answers: asked.of(&for_any_torque).into_iter().collect(),
        conclusion: "A free box of half sizes 0.1, 0.2 and 0.3 m over 5 s, its attitude against \
             Jacobi's elliptic functions. Per torque the methods of order 2 are ahead only at the coarsest accuracies; what they \
             buy is the long run. The exact drift has no error here, where no torque acts: it is \
             for weak ones."
            .into(),
        table,
        charts: vec![chart.into()],
        claims,
        ..WORK_PRECISION.heading()
    })
}
