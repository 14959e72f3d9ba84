//! Forces on bodies: the budget of their energy, and where damping becomes unstable.

use nalgebra::Vector3;
use stationary_chart::{Axis, Lines, Series};
use stationary_constraints::{
    ConstrainedIntegrator, ConstraintError, Forced, Rattle, Redundancy, SparseDiagonal,
};
use stationary_measure::{Cell, Column, Table, loglog_slope};
use stationary_rigid::{
    Body, BodyForces, BodyMethod, BodyMetric, BodyMotion, ConstantVelocity, Free, FreeBodies,
    Joint, JointEnd, JointKind, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::study::{Claim, Entry, Kind, Size, Study, StudyError, Tested};

/// The energy of a driven arm against its step, and the borders of damping.
pub const FORCED: Entry<'static> = Entry {
    id: "driven-arm-energy-budget",
    krate: "rigid",
    chapter: "10.1",
    kind: Kind::Convergence,
    title: "Driven arm: what is left of its energy's balance against the step, and borders of damping",
    tested: Tested::ByReport,
    run: &study,
};

/// Seconds.
const TIME: f64 = 4.0;

fn ends() -> [JointEnd; 2] {
    [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * 0.5)]
}

/// A motor of given torque, a viscous bearing, and the drag of air at the tip.
fn acting() -> Result<BodyForces<Poses>, StudyError> {
    let at = || StudyError::at("the forces");
    let mut forces = BodyForces::new(Poses, 1);
    let axis = Vector3::y();
    forces.about_axis(ends(), axis, |t, _, _| 3.0 * (2.0 * t).sin()).map_err(at())?;
    forces.about_axis(ends(), axis, |_, _, rate| -0.2 * rate).map_err(at())?;
    let drag = |_: f64, _: Vector3<f64>, v: Vector3<f64>| v * (-0.3 * v.norm());
    forces.at_point(0, Vector3::z() * -0.5, drag).map_err(at())?;
    Ok(forces)
}

/// The works of motor, bearing and air, J, and the largest defect of the balance on the way.
fn budget(steps: u32) -> Result<([f64; 3], f64, f64), StudyError> {
    let at = || StudyError::at("the arm");
    let body = Body::new(1.0, [0.1, 0.1, 0.01]).map_err(at())?;
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let pose = RigidMotion { translation: -Vector3::z() * 0.5, rotation: Rotation::identity() };
    let still = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::zeros() };
    let mut state = metric.state(&[still]).map_err(at())?;
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }];
    let weight = Weight { gravity: Vector3::z() * -9.81, masses, space: Poses };
    let system = metric.under(weight).map_err(StudyError::at("the weight"))?;
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends());
    let hinge = hinge.map_err(at())?;
    let motion = Forced::new(FreeBodies(ConstantVelocity), acting()?);
    let stage = StudyError::at::<ConstraintError>;
    let mut rattle =
        Rattle::along(motion, &system, &hinge, &state, SparseDiagonal(Redundancy::Refuse))
            .map_err(stage("the hinge"))?;
    let start = system.energy(&state.q, state.p.view());
    let (mut works, mut defect, mut change) = ([0.0; 3], 0.0_f64, 0.0);
    for _ in 0..steps {
        rattle.step(&mut state, TIME / f64::from(steps)).map_err(stage("a step"))?;
        works.iter_mut().zip(rattle.motion().works()).for_each(|(sum, work)| *sum += work);
        change = system.energy(&state.q, state.p.view()) - start;
        defect = defect.max((change - works.iter().sum::<f64>()).abs());
    }
    Ok((works, change, defect))
}

/// The spin, of 1 at the start, that 40 steps of 1 s leave of a wheel of inertia 1 with a damper.
fn left(method: BodyMethod, damping: f64) -> Result<f64, StudyError> {
    let at = || StudyError::at("the wheel");
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [1.0; 3]).map_err(at())?]);
    let pose = RigidMotion { translation: Vector3::zeros(), rotation: Rotation::identity() };
    let motion = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::z() };
    let mut state = metric.state(&[motion]).map_err(at())?;
    let system = metric.under(Free { freedoms: 6 }).map_err(StudyError::at("the wheel"))?;
    let mut forces = BodyForces::new(Poses, 1);
    forces.on_body(0, move |_, _, w| w * -damping).map_err(at())?;
    let mut integrator = method.forced(&system, forces).map_err(StudyError::at("the damper"))?;
    for _ in 0..40 {
        // What has grown out of all bounds ends in an error.
        if integrator.step(&mut state, 1.0).is_err() {
            return Ok(f64::INFINITY);
        }
    }
    Ok(state.p.0[5].abs())
}

/// The damping beyond which the spin grows, by bisection up to a million.
fn border(method: BodyMethod) -> Result<f64, StudyError> {
    let (mut stable, mut unstable) = (0.1, 1e6);
    if left(method, unstable)? <= 1.0 {
        return Ok(f64::INFINITY);
    }
    for _ in 0..40 {
        let middle = f64::sqrt(stable * unstable);
        if left(method, middle)? <= 1.0 { stable = middle } else { unstable = middle }
    }
    Ok(stable)
}

fn study(size: Size) -> Result<Study, StudyError> {
    let halvings = match size {
        Size::Default => 5,
        Size::Full => 9,
    };
    let mut table = Table::new([
        Column::exact("steps"),
        Column::rounded("motor [J]", 4, 1e-9),
        Column::rounded("bearing [J]", 4, 1e-9),
        Column::rounded("air [J]", 4, 1e-9),
        Column::rounded("change of energy [J]", 4, 1e-9),
        Column::rounded("largest defect [J]", 2, 1e-10),
    ]);
    let mut points = Vec::new();
    for halving in 0..halvings {
        let steps = 100_u32 << halving;
        let ([motor, bearing, air], change, defect) = budget(steps)?;
        let cells: [Cell; 6] = [
            u64::from(steps).into(),
            motor.into(),
            bearing.into(),
            air.into(),
            change.into(),
            defect.into(),
        ];
        table.push(cells);
        points.push((TIME / f64::from(steps), defect));
    }
    let order = loglog_slope(&points).unwrap_or(f64::NAN);
    let mut claims = vec![Claim::number(
        "energy less the works of motor, bearing and air: order of what is left",
        "2",
        order,
        (1.9, 2.1),
    )];
    for (method, predicted) in
        [(BodyMethod::RenormalizedEuler, 2.0), (BodyMethod::MuntheKaas4, 2.785_293_563_405_282)]
    {
        let measured = border(method)?;
        claims.push(Claim::number(
            format!("{method}: the largest stable h c/I"),
            format!("{predicted:.4}"),
            measured,
            (0.999 * predicted, 1.001 * predicted),
        ));
    }
    for method in
        [BodyMethod::VariationalRotation, BodyMethod::AxisRotations, BodyMethod::ExactRotation]
    {
        let text = format!("{method}: the spin that h c/I = 10^6 leaves of 1 after 40 steps");
        claims.push(Claim::number(text, "below 1", left(method, 1e6)?, (0.0, 1.0)));
    }
    let chart = Lines::new("Balance", Axis::log("step", "s"), Axis::log("defect", "J"))
        .with(Series::new("RATTLE with forces", points));
    Ok(Study {
        conclusion: format!(
            "A bar on a hinge is driven by a motor for {TIME} s, against a viscous bearing and the drag \
             of the air at its tip. The works of the three, summed from the kicks that they give, \
             account for its energy but for a defect of order {order:.2}, which is the integrator's own. A \
             damper is stable at every step where its kick is implicit, as those of the discrete \
             Lagrange-d'Alembert principle are; explicit methods lose it at the border of their \
             stability regions."
        ),
        table,
        charts: vec![chart.into()],
        claims,
        ..FORCED.heading()
    })
}
