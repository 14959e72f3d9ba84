//! What drives a tree: order, work and momenta of the variational step, and where it must refuse.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_calculus::{NewtonFailure, Number};
use stationary_constraints::{ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, State, StepError, Tolerance, VectorField,
    integrate,
};
use stationary_measure::loglog_slope;
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeDrive, TreeError, TreeField, TreeForces, TreeLoops, TreeMotion,
    TreeVariational,
};
use stationary_rigid::{
    Along, Body, BodyMetric, ConstantVelocity, Drive, FreeBodies, Joint, JointEnd, JointKind,
    LieGroup, PointMass, Poses, RigidMotion, Rotation, Schedule, Weight,
};

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
fn after_a_step_that_fails_the_work_is_still_that_of_the_last_one() {
    let tree = bars(JointKind::Hinge { axis: Vector3::y() });
    let mut method = TreeVariational::driven(tree, GRAVITY, drive).unwrap();
    let mut state = method.state(&START.0, &START.1).unwrap();
    method.step(&mut state, 0.01).unwrap();
    let work = method.work();
    // More than half a turn.
    method.step(&mut state, 10.0).unwrap_err();
    assert!(method.work() == work && work != 0.0, "{} {work}", method.work());
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

/// An angle that swings.
#[derive(Clone, Copy)]
struct Swing;

impl Schedule for Swing {
    fn at<R: Number>(&self, t: R) -> R {
        (t * 1.7).sin() * 0.8
    }
}

const HINGE: JointKind = JointKind::Hinge { axis: Vector3::new(0.0, 1.0, 0.0) };

#[test]
fn the_torque_that_drives_a_pendulum_is_that_of_the_closed_form() {
    let bar = Body::solid_box(2.0, [0.05, 0.1, 0.5]).unwrap();
    let mut builder = TreeBuilder::default();
    builder.hang(None, HINGE, [at(0.0), at(0.5)], bar);
    let tree = builder.build().unwrap();
    let inertia = bar.moments().y + 2.0 * 0.25;
    let field = TreeField::new(tree.clone(), TreeForces::weight(&tree, GRAVITY).unwrap()).unwrap();
    let drive = TreeDrive::new(&tree, 0, 0, Swing).unwrap();
    let field = field.prescribed(vec![drive.clone()]).unwrap();
    for t in [0.0, 0.4, 1.3] {
        let [angle, speed, acceleration] = drive.motion(t);
        let (mut rate, mut torque) = ([0.0; 2], [0.0]);
        field.evaluate(t, &[9.0, 9.0], &mut rate);
        assert_eq!(rate, [speed, acceleration]);
        field.drive_forces(t, &[angle, speed], &mut torque).unwrap();
        let expected = inertia * acceleration + 2.0 * 9.81 * 0.5 * angle.sin();
        assert!((torque[0] - expected).abs() < 1e-12, "{} {expected}", torque[0]);
    }
}

#[test]
fn a_tree_with_a_prescribed_joint_is_the_limit_of_rattle_with_a_drive_in_place_and_torque() {
    let tree = bars(HINGE);
    let bar = Body::solid_box(1.0, [0.05, 0.1, 0.5]).unwrap();
    let drive = TreeDrive::new(&tree, 0, 0, Swing).unwrap();
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = || {
        let weight = weight.clone();
        TreeField::new(tree.clone(), weight).unwrap().prescribed(vec![drive.clone()]).unwrap()
    };
    let [angle, speed, _] = drive.motion(0.0);
    let q = [angle, 1.0, 0.0, 0.0, 0.0];
    let v = [speed, 0.3, -0.2, 1.0];
    let start = Moment::new(0.0, [&q[..], &v].concat());
    let tolerance = Tolerance::new(1e-11, 1e-11).unwrap();
    let mut method = DormandPrince853::new(field(), tolerance.into(), start).unwrap();
    let mut motion = TreeMotion::new(tree.clone());
    let mut truth = Vec::new();
    for k in 1..=16 {
        let t = f64::from(k) / 16.0;
        integrate(&mut method, t, |_| ControlFlow::Continue(())).unwrap();
        let (y, mut torque) = (method.moment().y.clone(), [0.0]);
        field().drive_forces(t, &y, &mut torque).unwrap();
        let (q, v) = y.split_at(5);
        motion.place(q, v).unwrap();
        let tip = motion.pose(1).unwrap().translation;
        truth.push([tip.x, tip.y, tip.z, torque[0]]);
    }
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; 2];
    let weight = Weight { gravity: GRAVITY, masses, space: Poses };
    let system = BodyMetric::new(vec![bar; 2]).under(weight).unwrap();
    let hung = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * 0.5)];
    let ball = [JointEnd::on(0, Vector3::z() * -0.5), JointEnd::on(1, Vector3::z() * 0.5)];
    let joints = vec![
        Joint::new(Poses, 2, HINGE, hung).unwrap(),
        Joint::new(Poses, 2, JointKind::Ball, ball).unwrap(),
    ];
    let held = (joints, Drive::new(Poses, 2, Along::Turn, Vector3::y(), hung, Swing).unwrap());
    motion.place(&q, &v).unwrap();
    let bodies = [motion.body(0).unwrap(), motion.body(1).unwrap()];
    let found = [128_u32, 256, 512].map(|steps| {
        let h = 1.0 / f64::from(steps);
        let mut state = system.metric().state(&bodies).unwrap();
        let equations = SparseDiagonal(Redundancy::Refuse);
        let free = FreeBodies(ConstantVelocity);
        let mut rattle = Rattle::along(free, &system, &held, &state, equations).unwrap();
        let (mut last, mut off) = (0.0, [0.0_f64; 2]);
        for step in 1..=steps {
            rattle.step(&mut state, h).unwrap();
            if (step - 1) % (steps / 16) == 0 && step > 1 {
                // The torque at the end of a step is the mean of those of the steps about it.
                let torque = -0.5 * (last + rattle.multipliers()[8]);
                let truth = truth[((step - 1) * 16 / steps - 1) as usize][3];
                off[1] = off[1].max((torque - truth).abs());
            }
            last = rattle.multipliers()[8];
            if step % (steps / 16) == 0 {
                let truth = &truth[(step * 16 / steps - 1) as usize];
                off[0] = off[0].max(far(&state.q[7..10], &truth[..3]));
            }
        }
        [(h, off[0]), (h, off[1])]
    });
    for which in [0, 1] {
        let points = found.map(|both| both[which]);
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - 2.0).abs() < 0.2, "{which}: {slope} {points:?}");
    }
}

#[test]
fn a_loop_with_a_driven_crank_takes_the_force_that_inverse_dynamics_gives() {
    // Two bars on the world, joined by a rod: the second follows, or is pulled.
    let bar = Body::solid_box(1.0, [0.05, 0.1, 0.5]).unwrap();
    let mut builder = TreeBuilder::default();
    let apart = RigidMotion { translation: Vector3::x() * 1.5, rotation: Rotation::identity() };
    builder.hang(None, HINGE, [at(0.0), at(0.5)], bar);
    builder.hang(None, HINGE, [apart, at(0.5)], bar);
    let tree = builder.build().unwrap();
    let tip = Vector3::z() * -0.5;
    let mut loops = TreeLoops::new(&tree);
    let ends = [JointEnd::on(0, tip), JointEnd::on(1, tip)];
    loops.join(&tree, JointKind::Rod { length: 1.5 }, ends).unwrap();
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = TreeField::new(tree.clone(), weight.clone()).unwrap().closed(loops);
    let drive = TreeDrive::new(&tree, 0, 0, Swing).unwrap();
    let field = field.prescribed(vec![drive.clone()]).unwrap();
    let t = 0.3;
    let [angle, speed, acceleration] = drive.motion(t);
    // A parallelogram: both bars move alike.
    let y = [angle, angle, speed, speed];
    let (mut rate, mut torque) = ([0.0; 4], [0.0]);
    field.evaluate(t, &y, &mut rate);
    assert!(far(&rate, &[speed, speed, acceleration, acceleration]) < 1e-12, "{rate:?}");
    field.drive_forces(t, &y, &mut torque).unwrap();
    let inertia = bar.moments().y + 0.25;
    let expected = 2.0 * (inertia * acceleration + 9.81 * 0.5 * angle.sin());
    assert!((torque[0] - expected).abs() < 1e-12, "{} {expected}", torque[0]);
}

#[test]
fn freedoms_that_no_schedule_can_lead_are_refused() {
    let tree = bars(HINGE);
    let error = TreeDrive::new(&tree, 1, 0, Swing).unwrap_err();
    assert!(error.to_string().contains("ball"), "{error}");
    assert!(TreeDrive::new(&tree, 0, 1, Swing).is_err());
    assert!(matches!(TreeDrive::new(&tree, 2, 0, Swing), Err(TreeError::NoSuchBody { .. })));
    let drive = TreeDrive::new(&tree, 0, 0, Swing).unwrap();
    let field = TreeField::new(tree.clone(), TreeForces::none(&tree)).unwrap();
    let error = field.prescribed(vec![drive.clone(), drive]).unwrap_err();
    assert!(matches!(error, TreeError::DrivenTwice { speed: 0 }));
}
