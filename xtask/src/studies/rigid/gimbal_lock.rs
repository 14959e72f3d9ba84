//! Gimbal lock: one steady turn, followed in Euler angles and on the group.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::problems::BodyProblem;
use stationary_rigid::{
    Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, EulerAngles, Free, LieGroup, Orientations,
    RigidMotion, Rotation,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The error of the attitude against how close the turn passes by gimbal lock.
pub const GIMBAL_LOCK: Entry<'static> = Entry {
    id: "gimbal-lock",
    krate: "rigid",
    chapter: "9.1",
    kind: Kind::Ladder,
    title: "Euler angles and the group: error against the distance from gimbal lock",
    tested: Tested::Claims,
    run: &study,
};

/// The steps of half a turn, four evaluations of the rates each.
const STEPS: u32 = 300;

/// Rates of roll, pitch and yaw at an angular velocity about the body's second axis.
fn rates([roll, pitch, _]: [f64; 3]) -> [f64; 3] {
    [roll.sin() * pitch.tan(), roll.cos(), roll.sin() / pitch.cos()]
}

/// One step of the classical Runge-Kutta method in the three angles.
fn step(y: [f64; 3], h: f64) -> [f64; 3] {
    let along = |k: [f64; 3], h: f64| [0, 1, 2].map(|i| y[i] + h * k[i]);
    let a = rates(y);
    let b = rates(along(a, 0.5 * h));
    let c = rates(along(b, 0.5 * h));
    let d = rates(along(c, h));
    [0, 1, 2].map(|i| y[i] + h / 6.0 * (a[i] + 2.0 * b[i] + 2.0 * c[i] + d[i]))
}

/// Attitude errors after half a turn at 1 rad/s that misses the lock by `miss` radians: in Euler
/// angles, and with Munthe-Kaas's method of the same order.
fn errors(miss: f64) -> Result<[f64; 2], StudyError> {
    let (start, w) = (Rotation::exp(Vector3::x() * miss), Vector3::y());
    let h = std::f64::consts::PI / f64::from(STEPS);
    let truth = start.walk(w * (h * f64::from(STEPS)));
    let angles = (0..STEPS).fold([miss, 0.0, 0.0], |y, _| step(y, h));
    let [roll, pitch, yaw] = angles;
    let euler = EulerAngles { roll, pitch, yaw };
    let euler = match euler.rotation() {
        Ok(rotation) => rotation.direction_to(&truth).norm(),
        // Rates that overflowed: the attitude is lost.
        Err(_) => std::f64::consts::PI,
    };
    let stage = || StudyError::at("the turning body");
    let body = Body::new(1.0, [1.0; 3]).map_err(stage())?;
    let metric = BodyMetric::<Orientations>::new(vec![body]);
    let pose = RigidMotion { translation: Vector3::zeros(), rotation: start };
    let motion = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: w };
    let initial = metric.state(&[motion]).map_err(stage())?;
    let system = metric.under(Free { freedoms: 3 }).map_err(StudyError::at("three freedoms"))?;
    let horizon = h * f64::from(STEPS);
    let problem = BodyProblem { name: "turn", system, initial, motion, horizon };
    let mut integrator = BodyMethod::MuntheKaas4
        .integrator(&problem.system)
        .map_err(StudyError::at("the method"))?;
    let mut state = problem.initial.clone();
    for _ in 0..STEPS {
        integrator.step(&mut state, h).map_err(StudyError::at("a step on the group"))?;
    }
    let group = Orientations::pose_at(&state.q, 0).rotation.direction_to(&truth).norm();
    Ok([euler, group])
}

fn study(_: Size) -> Result<Study, StudyError> {
    let misses = [1.0, 0.5, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005, 0.002, 0.001];
    let mut table = Table::new([
        Column::rounded("miss [rad]", 2, 0.0),
        Column::rounded("Euler angles [rad]", 2, 1e-12),
        Column::rounded("group [rad]", 2, 1e-12),
    ]);
    let (mut euler, mut group) = (Vec::new(), Vec::new());
    for miss in misses {
        let [in_angles, on_group] = errors(miss)?;
        table.push([miss, in_angles, on_group].map(Cell::from));
        euler.push((miss, in_angles));
        group.push((miss, on_group.max(1e-17)));
    }
    let worst = |points: &[(f64, f64)]| points.iter().fold(0.0_f64, |w, p| w.max(p.1));
    let resolved: Vec<_> = euler.iter().copied().filter(|p| p.0 > 0.003 && p.0 < 0.3).collect();
    let claims = vec![
        Claim::number("the group does not feel the lock", "rounding", worst(&group), (0.0, 1e-12)),
        Claim::number(
            "in Euler angles: the worst error over that of a turn that misses by a radian",
            "a million times or more",
            worst(&euler) / euler[0].1,
            (1e6, f64::INFINITY),
        ),
        Claim::number(
            "in Euler angles: the power of the miss that the error goes with",
            "about -3",
            loglog_slope(&resolved).unwrap_or(f64::NAN),
            (-4.0, -2.5),
        ),
    ];
    let chart = Lines::new("Attitude", Axis::log("miss", "rad"), Axis::log("error", "rad"))
        .with(Series::new("Euler angles", euler))
        .with(Series::new("group", group));
    Ok(Study {
        conclusion: format!(
            "A body turns steadily by half a turn, in {STEPS} steps of a Runge-Kutta method of \
             order 4, and on its way its first axis passes the vertical at some distance. The rates \
             of roll and yaw grow like one over that distance, and the error in Euler angles with \
             its third power: eight digits are lost on the way to a thousandth of a radian. On the \
             group there is nothing to be passed."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..GIMBAL_LOCK.heading()
    })
}
