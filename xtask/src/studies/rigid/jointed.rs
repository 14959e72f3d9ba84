//! Jointed bodies: RATTLE along the free motion of bodies, and along straight lines.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Metric, Space, Vector};
use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::{
    ConstrainedIntegrator, ConstraintError, Dense, FreeMotion, Rattle, Redundancy,
};
use stationary_integrators::StepError;
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::problems::{JointedProblem, held_at_a_point};
use stationary_rigid::{
    AxisRotations, Body, BodyMetric, BodySpace, ConstantVelocity, ExactRotation, FreeBodies,
    LieGroup, Poses, Rotation, Weight,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The attitude of a box on its corner against the step.
pub const JOINTED: Entry<'static> = Entry {
    id: "box-on-its-corner",
    krate: "rigid",
    chapter: "9.5",
    kind: Kind::Convergence,
    title: "Box hung from its corner: error of its attitude against the step",
    tested: Tested::ByReport,
    run: &study,
};

/// The half sizes of the box, metres, and its time, seconds.
const HALF: [f64; 3] = [0.1, 0.2, 0.3];
const TIME: f64 = 1.0;

fn hung() -> Result<JointedProblem<Weight<Poses>>, StudyError> {
    let at = || StudyError::at("the box");
    let body = Body::solid_box(1.0, HALF).map_err(at())?;
    let start = Rotation::exp(Vector3::new(0.5, -0.2, 1.1));
    let w = Vector3::new(4.0, -3.0, 8.0);
    held_at_a_point(body, Vector3::from(HALF), start, w, Vector3::z() * -9.81).map_err(at())
}

/// What a run ends with: its attitude, the largest energy error, the iterations of a step.
struct Outcome {
    attitude: Rotation,
    energy: f64,
    iterations: f64,
}

fn run(
    motion: impl FreeMotion<BodyMetric<Poses>, Poses> + Clone,
    steps: u32,
) -> Result<Outcome, StudyError> {
    let problem = hung()?;
    let choice = Dense::<3>(Redundancy::Refuse);
    let stage = StudyError::at::<ConstraintError>;
    let mut rattle =
        Rattle::along(motion, &problem.system, &problem.joints, &problem.initial, choice)
            .map_err(stage("the joint"))?;
    let (mut state, start) = (problem.initial.clone(), problem.energy(&problem.initial));
    let (mut energy, mut iterations) = (0.0_f64, 0);
    for _ in 0..steps {
        let report = rattle.step(&mut state, TIME / f64::from(steps)).map_err(stage("a step"))?;
        iterations += report.iterations;
        energy = energy.max((problem.energy(&state) / start - 1.0).abs());
    }
    let attitude = Poses::pose_at(&state.q, 0).rotation;
    let iterations = f64::from(iterations) / f64::from(steps);
    Ok(Outcome { attitude, energy, iterations })
}

/// Straight motions, which are not those of bodies whose moments differ.
#[derive(Clone)]
struct Careless;

impl FreeMotion<BodyMetric<Poses>, Poses> for Careless {
    fn advance(
        &mut self,
        metric: &BodyMetric<Poses>,
        space: &Poses,
        (_, h): (f64, f64),
        q: &mut [f64],
        p: Covector<&mut [f64]>,
        mut room: Vector<&mut [f64]>,
    ) -> Result<(), StepError> {
        metric.drift(h, p.view(), room.view_mut());
        space.advance(q, 1.0, room.view());
        Ok(())
    }
}

const MOTIONS: [&str; 4] = ["straight", "constant velocity", "axis rotations", "exact rotation"];

fn along(motion: &str, steps: u32) -> Result<Outcome, StudyError> {
    match motion {
        "straight" => run(Careless, steps),
        "constant velocity" => run(FreeBodies(ConstantVelocity), steps),
        "axis rotations" => run(FreeBodies(AxisRotations), steps),
        _ => run(FreeBodies(ExactRotation), steps),
    }
}

fn study(size: Size) -> Result<Study, StudyError> {
    let (finest, halvings) = match size {
        Size::Default => (40_000, 6),
        Size::Full => (320_000, 9),
    };
    let reference = along("exact rotation", finest)?.attitude;
    let other = along("axis rotations", finest)?.attitude;
    let doubt = reference.direction_to(&other).norm();
    let mut table = Table::new([
        Column::exact("free motion"),
        Column::exact("steps"),
        Column::rounded("attitude error [rad]", 2, 1e-8),
        Column::rounded("energy error", 2, 1e-9),
        Column::rounded("iterations", 2, 0.0),
    ]);
    let mut chart = Lines::new("Attitude", Axis::log("step", "s"), Axis::log("error", "rad"));
    let mut claims = Vec::new();
    for motion in MOTIONS {
        let mut points = Vec::new();
        for halving in 0..halvings {
            let steps = 125_u32 << halving;
            let outcome = along(motion, steps)?;
            let error = outcome.attitude.direction_to(&reference).norm();
            let cells: [Cell; 5] = [
                motion.into(),
                u64::from(steps).into(),
                error.into(),
                outcome.energy.into(),
                outcome.iterations.into(),
            ];
            table.push(cells);
            points.push((TIME / f64::from(steps), error));
        }
        claims.push(if motion == "straight" {
            let last = points[points.len() - 1].1;
            let text = "straight: the error that no step takes away, rad";
            Claim::number(text, "more than 0.1", last, (0.1, f64::INFINITY))
        } else {
            let order = loglog_slope(&points[2..]).unwrap_or(f64::NAN);
            Claim::number(format!("{motion}: order"), "2", order, (1.9, 2.1))
        });
        chart = chart.with(Series::new(motion, points));
    }
    Ok(Study {
        conclusion: format!(
            "A box with half sizes 0.1, 0.2 and 0.3 m hangs from a corner by a ball joint and turns \
             fast, for {TIME} s, by RATTLE. Between the joint's impulses it must move as a free body \
             does: where its angular velocity is merely held, the gyroscopic torque is lost, and the \
             method converges to a motion of something else. Any symplectic free rotation mends it. \
             The reference is the finest run; two of them differ by {doubt:.0e} rad."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..JOINTED.heading()
    })
}
