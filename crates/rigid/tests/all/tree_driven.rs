//! What drives a tree: order, work and momenta of the variational step, and where it must refuse.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_calculus::NewtonFailure;
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, State, StepError, Tolerance, integrate,
};
use stationary_measure::loglog_slope;
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeField, TreeForces, TreeMotion, TreeVariational,
};
use stationary_rigid::{Body, JointKind, LieGroup, RigidMotion, Rotation};

const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

fn at(z: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::z() * z, rotation: Rotation::identity() }
}

/// Two bars, one below the other, on a hinge and a ball joint.
fn bars(first: JointKind) -> Tree {
    let bar = Body::solid_box(1.0, [0.05, 0.1, 0.5]).unwrap();
    let mut builder = TreeBuilder::default();
    let upper = builder.hang(None, first, [at(0.0), at(0.5)], bar);
    builder.hang(Some(upper), JointKind::Ball, [at(-0.5), at(0.5)], bar);
    builder.build().unwrap()
}

/// A motor at the first joint, a damper at the ball, and a drag at the end.
fn drive(t: f64, motion: &TreeMotion, forces: &mut TreeForces) {
    let [upper, lower] = [0, 1].map(|body| motion.body(body).unwrap());
    let spin = upper.pose.rotation.rotate(&upper.angular_velocity);
    let other = lower.pose.rotation.rotate(&lower.angular_velocity);
    forces.joints_mut()[0] += 2.0 * (3.0 * t).sin() - 0.1 * spin.y;
    forces.add_torque(0, (other - spin) * 0.05).unwrap();
    forces.add_torque(1, (spin - other) * 0.05).unwrap();
    let tip = Vector3::z() * -0.5;
    let velocity = lower.velocity + other.cross(&lower.pose.rotation.rotate(&tip));
    forces.add_force(motion, 1, &tip, velocity * (-0.1 * velocity.norm())).unwrap();
}

const START: ([f64; 5], [f64; 4]) = ([0.4, 1.0, 0.0, 0.0, 0.0], [0.5, 0.3, -0.2, 1.0]);

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |far, (a, b)| f64::max(far, (a - b).abs()))
}

#[test]
fn a_driven_tree_has_order_two_and_its_work_balances_its_energy_to_order_two() {
    let tree = bars(JointKind::Hinge { axis: Vector3::y() });
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = TreeField::driven(tree.clone(), weight, drive).unwrap();
    let start = Moment::new(0.0, [&START.0[..], &START.1].concat());
    let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
    let mut method = DormandPrince853::new(field, tolerance.into(), start).unwrap();
    let mut truth = Vec::new();
    for eighth in 1..=8 {
        let t = 0.25 * f64::from(eighth);
        integrate(&mut method, t, |_| ControlFlow::Continue(())).unwrap();
        truth.push(method.moment().y[..5].to_vec());
    }
    let steps = [80_u32, 160, 320];
    let found = steps.map(|steps| {
        let mut method = TreeVariational::driven(tree.clone(), GRAVITY, drive).unwrap();
        let mut state = method.state(&START.0, &START.1).unwrap();
        let initial = method.energy(&state).unwrap();
        let (h, mut work, mut error, mut defect) = (2.0 / f64::from(steps), 0.0, 0.0_f64, 0.0_f64);
        for step in 1..=steps {
            method.step(&mut state, h).unwrap();
            work += method.work();
            defect = defect.max((method.energy(&state).unwrap() - initial - work).abs());
            if step % (steps / 8) == 0 {
                error = error.max(far(&state.q, &truth[(step * 8 / steps - 1) as usize]));
            }
        }
        assert!(work.abs() > 0.1, "{work}");
        [(h, error), (h, defect)]
    });
    for which in [0, 1] {
        let points = found.map(|both| both[which]);
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - 2.0).abs() < 0.15, "{slope} {points:?}");
    }
}

#[test]
fn what_acts_within_a_free_tree_leaves_both_momenta() {
    let tree = bars(JointKind::Free);
    let inner = |t: f64, motion: &TreeMotion, forces: &mut TreeForces| {
        let [spin, other] = [0, 1].map(|body| {
            let motion = motion.body(body).unwrap();
            motion.pose.rotation.rotate(&motion.angular_velocity)
        });
        let torque = (other - spin) * 0.05 + Vector3::x() * (0.1 * t.sin());
        forces.add_torque(0, torque).unwrap();
        forces.add_torque(1, -torque).unwrap();
    };
    let mut method = TreeVariational::driven(tree.clone(), Vector3::zeros(), inner).unwrap();
    let mut q = tree.rest();
    q[3..7].copy_from_slice(&[0.8, 0.6, 0.0, 0.0]);
    let v = [0.1, 0.2, -0.1, 1.0, 0.5, -0.3, 0.2, 0.4, -1.0];
    let mut state = method.state(&q, &v).unwrap();
    let momenta = |method: &mut TreeVariational<_>, state: &State<Vec<f64>>| {
        let motion = method.motion(state).unwrap();
        [motion.linear_momentum(), motion.angular_momentum()]
    };
    let before = momenta(&mut method, &state);
    for _ in 0..1000 {
        method.step(&mut state, 0.02).unwrap();
    }
    let after = momenta(&mut method, &state);
    assert!((0..2).all(|k| (after[k] - before[k]).norm() < 1e-12), "{before:?} {after:?}");
}

#[test]
fn a_step_too_long_for_its_damper_is_refused_and_leaves_the_state() {
    let mut builder = TreeBuilder::default();
    let wheel = Body::new(1.0, [1.0, 1.0, 1.0]).unwrap();
    builder.hang(None, JointKind::Hinge { axis: Vector3::z() }, [at(0.0), at(0.0)], wheel);
    let tree = builder.build().unwrap();
    let step = |damping: f64| {
        let drive = move |_: f64, motion: &TreeMotion, forces: &mut TreeForces| {
            let spin = motion.body(0).unwrap().angular_velocity.z;
            forces.joints_mut()[0] -= damping * spin;
        };
        let mut method = TreeVariational::driven(tree.clone(), Vector3::zeros(), drive).unwrap();
        let mut state = method.state(&[0.0], &[1.0]).unwrap();
        let before = state.clone();
        let result = method.step(&mut state, 1.0);
        assert!(result.is_ok() || state == before);
        result.map(|_| state.p.0[0])
    };
    // The iteration contracts by h c/2: below one the factor is that of the implicit kicks.
    let factor = (1.0 - 0.45) / (1.0 + 0.45);
    assert!((step(0.9).unwrap() - factor).abs() < 1e-14);
    let refused = step(3.0).unwrap_err();
    let StepError::Newton(error) = refused else { panic!("{refused}") };
    assert_eq!(error.failure, NewtonFailure::NotConverged);
}

#[test]
fn a_driven_step_of_a_tree_allocates_nothing() {
    let tree = bars(JointKind::Hinge { axis: Vector3::y() });
    let mut method = TreeVariational::driven(tree, GRAVITY, drive).unwrap();
    let mut state = method.state(&START.0, &START.1).unwrap();
    let count = allocation_counter::measure(|| {
        (0..10).for_each(|_| assert!(method.step(&mut state, 0.01).is_ok()));
    });
    assert_eq!(count.count_total, 0, "{count:?}");
}
