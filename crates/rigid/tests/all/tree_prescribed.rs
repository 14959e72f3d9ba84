//! Joints of a tree that follow a schedule in the variational step: the motion, force and work of RATTLE with a
//! drive, order 2, and what is refused.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_calculus::Number;
use stationary_constraints::{ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, StepError, Tolerance, VectorField,
    integrate,
};
use stationary_measure::loglog_slope;
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeDrive, TreeError, TreeField, TreeForces, TreeMotion, TreeVariational,
};
use stationary_rigid::{
    Along, Body, BodyMetric, ConstantVelocity, Drive, FreeBodies, Joint, JointEnd, JointKind,
    LieGroup, PointMass, Poses, RigidMotion, Rotation, Schedule, Weight,
};

const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);
const HINGE: JointKind = JointKind::Hinge { axis: Vector3::new(0.0, 1.0, 0.0) };
/// Coordinates and speeds of the ball joint at the start.
const BALL: ([f64; 4], [f64; 3]) = ([1.0, 0.0, 0.0, 0.0], [0.3, -0.2, 1.0]);

#[derive(Clone, Copy)]
struct Swing;

impl Schedule for Swing {
    fn at<R: Number>(&self, t: R) -> R {
        (t * 2.5).sin() * 0.9 + 0.4
    }
}

fn at(z: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::z() * z, rotation: Rotation::identity() }
}

fn bar() -> Body {
    Body::solid_box(1.0, [0.05, 0.1, 0.5]).unwrap()
}

/// A bar on a hinge, and another on a ball joint below it.
fn bars() -> Tree {
    let mut builder = TreeBuilder::default();
    let upper = builder.hang(None, HINGE, [at(0.0), at(0.5)], bar());
    builder.hang(Some(upper), JointKind::Ball, [at(-0.5), at(0.5)], bar());
    builder.build().unwrap()
}

fn swung(tree: &Tree) -> TreeDrive {
    TreeDrive::new(tree, 0, 0, Swing).unwrap()
}

fn far(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).fold(0.0, |far, (a, b)| f64::max(far, (a - b).abs()))
}

/// All coordinates and speeds; the hinge's are where its schedule is.
fn start(tree: &Tree) -> ([f64; 5], [f64; 4]) {
    let ([angle, speed, _], (q, v)) = (swung(tree).motion(0.0), BALL);
    ([angle, q[0], q[1], q[2], q[3]], [speed, v[0], v[1], v[2]])
}

#[test]
fn a_prescribed_joint_moves_as_under_rattle_with_a_drive_with_its_torque_and_its_work() {
    let tree = bars();
    let mut method = TreeVariational::new(tree.clone(), GRAVITY)
        .unwrap()
        .prescribed(vec![swung(&tree)])
        .unwrap();
    let (q, v) = start(&tree);
    // What the hinge is said to do does not count.
    let mut state = method.state(&[0.0, q[1], q[2], q[3], q[4]], &[7.0, v[1], v[2], v[3]]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; 2];
    let weight = Weight { gravity: GRAVITY, masses, space: Poses };
    let system = BodyMetric::new(vec![bar(); 2]).under(weight).unwrap();
    let hung = [JointEnd::world(Vector3::zeros()), JointEnd::on(0, Vector3::z() * 0.5)];
    let ball = [JointEnd::on(0, Vector3::z() * -0.5), JointEnd::on(1, Vector3::z() * 0.5)];
    let joints = vec![
        Joint::new(Poses, 2, HINGE, hung).unwrap(),
        Joint::new(Poses, 2, JointKind::Ball, ball).unwrap(),
    ];
    let held = (joints, Drive::new(Poses, 2, Along::Turn, Vector3::y(), hung, Swing).unwrap());
    let mut motion = TreeMotion::new(tree);
    motion.place(&q, &v).unwrap();
    let bodies = [motion.body(0).unwrap(), motion.body(1).unwrap()];
    let mut full = system.metric().state(&bodies).unwrap();
    let equations = SparseDiagonal(Redundancy::Refuse);
    let free = FreeBodies(ConstantVelocity);
    let mut rattle = Rattle::along(free, &system, &held, &full, equations).unwrap();
    let (h, mut works) = (2e-3, [0.0; 2]);
    for _ in 0..1000 {
        method.step(&mut state, h).unwrap();
        works[0] += method.drive_work();
        works[1] += rattle.step(&mut full, h).unwrap().work;
        let torque = -rattle.multipliers()[8];
        assert!((method.drive_forces()[0] - torque).abs() < 1e-7 * torque.abs().max(1.0));
    }
    let placed = method.motion(&state).unwrap();
    for body in 0..2 {
        let place = placed.pose(body).unwrap().translation;
        assert!(far(place.as_slice(), &full.q[7 * body..][..3]) < 1e-9);
    }
    assert!((works[0] - works[1]).abs() < 1e-9 && works[0].abs() > 0.1, "{works:?}");
}

#[test]
fn a_prescribed_joint_has_order_two_in_place_and_in_the_balance_of_energy() {
    let tree = bars();
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field =
        TreeField::new(tree.clone(), weight).unwrap().prescribed(vec![swung(&tree)]).unwrap();
    let (q, v) = start(&tree);
    let tolerance = Tolerance::new(1e-11, 1e-11).unwrap();
    let moment = Moment::new(0.0, [&q[..], &v].concat());
    let mut exact = DormandPrince853::new(field, tolerance.into(), moment).unwrap();
    integrate(&mut exact, 1.0, |_| ControlFlow::Continue(())).unwrap();
    let mut truth = TreeMotion::new(tree.clone());
    let (q_end, v_end) = exact.moment().y.split_at(5);
    truth.place(q_end, v_end).unwrap();
    let tip = truth.pose(1).unwrap().translation;
    let points = [64_u32, 128, 256, 512].map(|steps| {
        let h = 1.0 / f64::from(steps);
        let method = TreeVariational::new(tree.clone(), GRAVITY).unwrap();
        let mut method = method.prescribed(vec![swung(&tree)]).unwrap();
        let mut state = method.state(&q, &v).unwrap();
        let (before, mut work) = (method.energy(&state).unwrap(), 0.0);
        for _ in 0..steps {
            method.step(&mut state, h).unwrap();
            work += method.drive_work();
        }
        let balance = method.energy(&state).unwrap() - before - work;
        let moved = method.motion(&state).unwrap();
        let off = (moved.pose(1).unwrap().translation - tip).norm();
        [(h, off), (h, balance.abs())]
    });
    for which in [0, 1] {
        let points = points.map(|both| both[which]);
        let slope = loglog_slope(&points).unwrap();
        assert!((slope - 2.0).abs() < 0.2, "{which}: {slope} {points:?}");
    }
}

#[test]
fn two_drives_of_a_joint_another_tree_s_and_a_state_off_its_schedule_are_refused() {
    let tree = bars();
    let method = || TreeVariational::new(tree.clone(), GRAVITY).unwrap();
    let twice = method().prescribed(vec![swung(&tree), swung(&tree)]).err();
    assert_eq!(twice, Some(TreeError::DrivenTwice { speed: 0 }));
    let mut builder = TreeBuilder::default();
    let mut parent = None;
    for _ in 0..9 {
        parent = Some(builder.hang(parent, HINGE, [at(0.0), at(0.5)], bar()));
    }
    let long = builder.build().unwrap();
    let last = TreeDrive::new(&long, 8, 0, Swing).unwrap();
    assert!(matches!(method().prescribed(vec![last]), Err(TreeError::Size(_))));
    let mut method = method().prescribed(vec![swung(&tree)]).unwrap();
    let (q, v) = start(&tree);
    let mut state = method.state(&q, &v).unwrap();
    state.q[0] += 1e-3;
    let before = state.clone();
    let error = method.step(&mut state, 1e-3).unwrap_err();
    assert!(matches!(error, StepError::Configuration { number: 0 }), "{error}");
    assert_eq!(state, before);
}

/// What depends on velocities sees the driven joint at both ends of a step as the schedule moves it.
#[test]
fn a_prescribed_joint_with_a_damper_below_it_has_order_two_in_place_force_and_work() {
    let tree = bars();
    let damp = |_: f64, motion: &TreeMotion, forces: &mut TreeForces| {
        let [upper, lower] = [0, 1].map(|body| {
            let motion = motion.body(body).unwrap();
            motion.pose.rotation.rotate(&motion.angular_velocity)
        });
        let torque = (upper - lower) * 0.4;
        forces.add_torque(1, torque).unwrap();
        forces.add_torque(0, -torque).unwrap();
    };
    let (q, v) = start(&tree);
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = || {
        let field = TreeField::driven(tree.clone(), weight.clone(), damp).unwrap();
        field.prescribed(vec![swung(&tree)]).unwrap()
    };
    let y = integrate_to(field(), [&q[..], &v].concat(), 1.0);
    let mut torque = [0.0];
    field().drive_forces(1.0, &y, &mut torque).unwrap();
    let mut errors = [[0.0; 2]; 3];
    for (n, error) in [100, 200, 400].into_iter().zip(&mut errors) {
        let method = TreeVariational::driven(tree.clone(), GRAVITY, damp).unwrap();
        let mut method = method.prescribed(vec![swung(&tree)]).unwrap();
        let mut state = method.state(&q, &v).unwrap();
        let (mut work, before) = (0.0, method.energy(&state).unwrap());
        for _ in 0..n {
            method.step(&mut state, 1.0 / f64::from(n)).unwrap();
            work += method.work() + method.drive_work();
        }
        let balance = method.energy(&state).unwrap() - before - work;
        *error = [far(&state.q, &y[..5]), balance.abs()];
        assert!((method.drive_forces()[0] - torque[0]).abs() < 0.1 * torque[0].abs().max(1.0));
    }
    for k in 0..2 {
        let slope = (errors[0][k] / errors[2][k]).log2() / 2.0;
        assert!((slope - 2.0).abs() < 0.15, "{k}: {errors:?}");
    }
}

fn integrate_to<F: VectorField>(field: F, y: Vec<f64>, time: f64) -> Vec<f64> {
    let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
    let mut method = DormandPrince853::new(field, tolerance.into(), Moment::new(0.0, y)).unwrap();
    while method.moment().t < time {
        method.step(time).unwrap();
    }
    method.moment().y.clone()
}

/// A sinusoidal shift, metres.
#[derive(Clone, Copy)]
struct Shaken(f64);

impl Schedule for Shaken {
    fn at<R: Number>(&self, t: R) -> R {
        (t * 4.0).sin() * self.0
    }
}

#[test]
fn a_shift_follows_its_schedule_to_rounding_whatever_the_unit_of_length() {
    for unit in [1.0, 2.0_f64.powi(-20), 2.0_f64.powi(-40)] {
        let at = |z: f64| at(z * unit);
        let body = Body::solid_box(1.0, [0.05, 0.1, 0.5].map(|half| half * unit)).unwrap();
        let (slider, [x, y]) = (JointKind::Slider { axis: Vector3::x() }, [1.0, 0.2]);
        let mut builder = TreeBuilder::default();
        let cart = builder.hang(None, slider, [at(0.0), at(0.0)], body);
        builder.hang(Some(cart), HINGE, [at(0.0), at(0.5)], body);
        let tree = builder.build().unwrap();
        let drive = TreeDrive::new(&tree, 0, 0, Shaken(0.3 * unit)).unwrap();
        let steps = TreeVariational::new(tree, GRAVITY * unit).unwrap();
        let mut steps = steps.prescribed(vec![drive]).unwrap();
        let mut state = steps.state(&[0.0, x], &[0.0, y]).unwrap();
        for _ in 0..100 {
            steps.step(&mut state, 5e-3).unwrap();
            let off = state.q[0] / unit - 0.3 * (4.0 * state.t).sin();
            assert!(off.abs() < 1e-14, "{unit:e}: {off:e}");
        }
        state.q[0] += 1e-3 * unit;
        let refused = steps.step(&mut state, 5e-3);
        assert_eq!(refused, Err(StepError::Configuration { number: 0 }), "{unit:e}");
    }
}
