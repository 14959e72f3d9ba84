//! An arm on a hinge under RATTLE: driven, by a motor, and damped.

use nalgebra::Vector3;
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, ConstraintError, Forced, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::State;
use stationary_measure::loglog_slope;
use stationary_rigid::{
    Along, Body, BodyForces, BodyMetric, BodyMotion, ConstantVelocity, Drive, ExactRotation,
    FreeBodies, Joint, JointEnd, JointKind, LieGroup, PointMass, Poses, RigidMotion, Rotation,
    Steady, Weight,
};

use crate::body_forces::{POINT, Swing, far};

/// A bar of 1 kg, half a metre from its hinge, that a drive turns about y under its weight.
fn arm() -> (stationary_calculus::System<BodyMetric<Poses>, Weight<Poses>, Poses>, [JointEnd; 2]) {
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.1, 0.01]).unwrap()]);
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }];
    let weight = Weight { gravity: Vector3::z() * -9.81, masses, space: Poses };
    let ends = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * 0.5)];
    (metric.under(weight).unwrap(), ends)
}

fn hanging(angle: f64, speed: f64) -> BodyMotion {
    let rotation = Rotation::exp(Vector3::y() * angle);
    let arm = rotation.rotate(&(Vector3::z() * 0.5));
    BodyMotion {
        pose: RigidMotion { translation: -arm, rotation },
        velocity: (Vector3::y() * speed).cross(&-arm),
        angular_velocity: Vector3::y() * speed,
    }
}

#[test]
fn a_drive_turns_as_told_and_its_torque_and_work_are_those_of_the_closed_form() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let inertia = 0.1 + 0.25;
    let points = [100, 200, 400].map(|steps| {
        let h = 2.0 / f64::from(steps);
        let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), ends, Swing).unwrap();
        let mut state = system.metric().state(&[hanging(0.0, 0.8 * 1.7)]).unwrap();
        let held = (hinge.clone(), drive);
        let equations = SparseDiagonal(Redundancy::Refuse);
        let motion = FreeBodies(ConstantVelocity);
        let mut rattle = Rattle::along(motion, &system, &held, &state, equations).unwrap();
        let (mut error, mut work, start) = (0.0_f64, 0.0, system.energy(&state.q, state.p.view()));
        for _ in 0..steps {
            let middle = state.t + 0.5 * h;
            work += rattle.step(&mut state, h).unwrap().work;
            let angle = 0.8 * (1.7 * middle).sin();
            let torque = -inertia * 1.7 * 1.7 * angle + 9.81 * 0.5 * angle.sin();
            error = error.max((-rattle.multipliers()[5] - torque).abs());
            let mut g = [0.0; 6];
            held.value(state.t, &state.q, &mut g).unwrap();
            assert!(g.iter().all(|g| g.abs() < 1e-12));
            let energy = system.energy(&state.q, state.p.view());
            assert!((energy - start - work).abs() < 3.0 * h * h, "{} {h}", energy - start - work);
        }
        (h, error)
    });
    let slope = loglog_slope(&points).unwrap();
    assert!((slope - 2.0).abs() < 0.1, "{slope} {points:?}");
}

#[test]
fn a_drive_that_starts_at_another_speed_or_place_is_refused() {
    let (system, ends) = arm();
    let start = |angle: f64, speed: f64| {
        let steady = Steady { start: 0.3, speed: 2.0 };
        let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), ends, steady).unwrap();
        let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
        let state = system.metric().state(&[hanging(angle, speed)]).unwrap();
        let equations = SparseDiagonal(Redundancy::Refuse);
        Rattle::along(FreeBodies(ExactRotation), &system, (hinge, drive), &state, equations).err()
    };
    assert!(start(0.3, 2.0).is_none());
    assert!(matches!(start(0.3, 0.0), Some(ConstraintError::InfeasibleVelocity { .. })));
    assert!(matches!(start(0.0, 2.0), Some(ConstraintError::Infeasible { .. })));
}

#[test]
fn rattle_keeps_its_order_and_its_balance_of_energy_under_a_motor_and_a_damper() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let initial = system.metric().state(&[hanging(0.4, 0.0)]).unwrap();
    let run = |steps: u32, every: u32| {
        let mut forces = BodyForces::new(Poses, 1);
        forces
            .about_axis(ends, Vector3::y(), |t, a, rate| (2.0 * t).sin() - 0.3 * a - 0.2 * rate)
            .unwrap();
        let drag = |_: f64, _: Vector3<f64>, v: Vector3<f64>| v * (-0.3 * v.norm());
        forces.at_point(0, Vector3::z() * -0.4, drag).unwrap();
        let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
        let equations = SparseDiagonal(Redundancy::Refuse);
        let mut rattle = Rattle::along(motion, &system, &hinge, &initial, equations).unwrap();
        let (mut state, h) = (initial.clone(), 3.0 / f64::from(steps));
        let (mut seen, mut works, mut defect) = (Vec::new(), [0.0; 2], 0.0_f64);
        for step in 1..=steps {
            rattle.step(&mut state, h).unwrap();
            works.iter_mut().zip(rattle.motion().works()).for_each(|(sum, w)| *sum += w);
            let energy = |s: &State<Vec<f64>>| system.energy(&s.q, s.p.view());
            let change = energy(&state) - energy(&initial);
            defect = defect.max((change - works[0] - works[1]).abs());
            if step % every == 0 {
                seen.extend(state.q.iter().chain(&state.p.0));
            }
        }
        assert!(works[1] < -0.01, "drag only takes: {works:?}");
        (seen, defect)
    };
    let truth = run(6400, 800).0;
    let steps = [48, 96, 192, 384];
    let found = steps.map(|steps| (steps, run(steps, steps / 8)));
    for values in [
        found.each_ref().map(|(n, (seen, _))| (1.0 / f64::from(*n), far(seen, &truth))),
        found.each_ref().map(|(n, (_, defect))| (1.0 / f64::from(*n), *defect)),
    ] {
        let slope = loglog_slope(&values).unwrap();
        assert!((slope - 2.0).abs() < 0.12, "{slope} {values:?}");
    }
}

#[test]
fn rattle_under_a_damper_of_any_stiffness_runs_and_only_loses_energy() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    for damping in [1.0, 3.0, 100.0, 1e6] {
        // In units of the inertia 0.35 about the hinge, over a step of 0.1 s.
        let c = damping * 0.35 / 0.1;
        let mut forces = BodyForces::new(Poses, 1);
        forces.about_axis(ends, Vector3::y(), move |_, _, rate| -c * rate).unwrap();
        let initial = system.metric().state(&[hanging(0.4, 1.0)]).unwrap();
        let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
        let equations = SparseDiagonal(Redundancy::Refuse);
        let mut rattle = Rattle::along(motion, &system, &hinge, &initial, equations).unwrap();
        let (mut state, start) = (initial.clone(), system.energy(&initial.q, initial.p.view()));
        for _ in 0..50 {
            rattle.step(&mut state, 0.1).unwrap();
            assert!(system.energy(&state.q, state.p.view()) < start + 1e-9, "{damping}");
        }
    }
}

#[test]
fn a_step_of_a_driven_arm_under_a_force_allocates_nothing() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let drive = Drive::new(Poses, 1, Along::Turn, Vector3::y(), ends, Swing).unwrap();
    let mut forces = BodyForces::new(Poses, 1);
    forces.at_point(0, POINT, |t, x, v| x * t.sin() - v).unwrap();
    let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
    let mut state = system.metric().state(&[hanging(0.0, 0.8 * 1.7)]).unwrap();
    let equations = SparseDiagonal(Redundancy::Refuse);
    let mut rattle = Rattle::along(motion, &system, (hinge, drive), &state, equations).unwrap();
    rattle.step(&mut state, 0.01).unwrap();
    let count = allocation_counter::measure(|| {
        (0..10).for_each(|_| assert!(rattle.step(&mut state, 0.01).is_ok()));
    });
    assert_eq!(count.count_total, 0, "{count:?}");
}

#[test]
fn rattle_tells_the_works_of_the_last_step_that_was_made() {
    let (system, ends) = arm();
    let hinge = Joint::new(Poses, 1, JointKind::Hinge { axis: Vector3::y() }, ends).unwrap();
    let initial = system.metric().state(&[hanging(0.4, 1.0)]).unwrap();
    let mut forces = BodyForces::new(Poses, 1);
    forces.about_axis(ends, Vector3::y(), |_, _, rate| -0.2 * rate).unwrap();
    let motion = Forced::new(FreeBodies(ConstantVelocity), forces);
    let equations = SparseDiagonal(Redundancy::Refuse);
    let mut rattle = Rattle::along(motion, &system, &hinge, &initial, equations).unwrap();
    let mut state = initial.clone();
    rattle.step(&mut state, 0.1).unwrap();
    let works = rattle.motion().works().to_vec();
    for h in [3.0, 1e3, 1e200] {
        rattle.step(&mut state, h).unwrap_err();
        assert_eq!(rattle.motion().works(), works, "{h:e}");
    }
}
