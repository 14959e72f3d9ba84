//! Variational steps of a tree whose loops are held closed: RATTLE's motion, forces and order, with drives as well;
//! rows that others hold are set aside.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::Number;
use stationary_constraints::{ConstrainedIntegrator, Rattle, Redundancy, SparseDiagonal};
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, StepError, Tolerance,
};
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeDrive, TreeError, TreeField, TreeForces, TreeLoops, TreeMotion,
    TreeVariational,
};
use stationary_rigid::{
    Along, Body, BodyMetric, ConstantVelocity, Drive, FourBar, FreeBodies, Joint, JointEnd,
    JointKind, LieGroup, PointMass, Poses, RigidMotion, Rotation, Schedule, Weight,
};

const LINKAGE: FourBar =
    FourBar { lengths: [0.2, 0.5, 0.4, 0.5], density: 2.0, gravity: Vector2::new(0.0, -9.81) };
const GRAVITY: Vector3<f64> = Vector3::new(0.0, -9.81, 0.0);
const HINGE: JointKind = JointKind::Hinge { axis: Vector3::new(0.0, 0.0, 1.0) };
const RATE: f64 = 6.0;

#[derive(Clone, Copy)]
struct Turned;

impl Schedule for Turned {
    fn at<R: Number>(&self, t: R) -> R {
        t * RATE + (t * 2.0).sin() * (t * 2.0).sin() * 0.5
    }
}

fn at(x: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::x() * x, rotation: Rotation::identity() }
}

fn bar(k: usize) -> Body {
    let (masses, moments) = (LINKAGE.masses(), LINKAGE.moments());
    Body::new(masses[k], [0.01 * moments[k], moments[k], moments[k]]).unwrap()
}

/// Crank, coupler and follower, and the hinge that closes them, of whose five rows three are held already.
fn linkage() -> (Tree, TreeLoops) {
    let [a, b, c, d] = LINKAGE.lengths;
    let mut builder = TreeBuilder::default();
    let crank = builder.hang(None, HINGE, [at(0.0), at(-a / 2.0)], bar(0));
    builder.hang(Some(crank), HINGE, [at(a / 2.0), at(-b / 2.0)], bar(1));
    builder.hang(None, HINGE, [at(d), at(-c / 2.0)], bar(2));
    let tree = builder.build().unwrap();
    let mut loops = TreeLoops::new(&tree);
    loops.join(&tree, HINGE, ends()[3]).unwrap();
    assert_eq!(loops.rows(), 5);
    let mut motion = TreeMotion::new(tree.clone());
    let (q, v) = start();
    motion.place(&q, &v).unwrap();
    loops.keep_independent(&mut motion).unwrap();
    assert_eq!(loops.rows(), 2);
    (tree, loops)
}

/// The four hinges.
fn ends() -> [[JointEnd; 2]; 4] {
    let [a, b, c, d] = LINKAGE.lengths;
    let on = |body, x: f64| JointEnd::on(body, Vector3::x() * x);
    [
        [JointEnd::world(Vector3::zeros()), on(0, -a / 2.0)],
        [on(0, a / 2.0), on(1, -b / 2.0)],
        [JointEnd::world(Vector3::x() * d), on(2, -c / 2.0)],
        [on(1, b / 2.0), on(2, c / 2.0)],
    ]
}

/// Its coordinates and speeds at the crank's angle zero.
fn start() -> ([f64; 3], [f64; 3]) {
    let [u, v, w] = LINKAGE.angles(0.0);
    let slope = LINKAGE.slope(0.0);
    let (v_rate, w_rate) = (slope[5] * RATE, slope[8] * RATE);
    ([u, v - u, w], [RATE, v_rate - RATE, w_rate])
}

fn crank(tree: &Tree) -> TreeDrive {
    TreeDrive::new(tree, 0, 0, Turned).unwrap()
}

/// The step in the coordinates of hinges, with the crank driven or not.
fn steps(driven: bool) -> TreeVariational {
    let (tree, loops) = linkage();
    let steps = TreeVariational::new(tree.clone(), GRAVITY).unwrap().closed(loops).unwrap();
    if driven { steps.prescribed(vec![crank(&tree)]).unwrap() } else { steps }
}

#[test]
fn loops_are_held_with_the_motion_the_torque_and_the_work_of_rattle() {
    let masses = (0..3).map(|k| PointMass { mass: bar(k).mass(), point: Vector3::zeros() });
    let weight = Weight { gravity: GRAVITY, masses: masses.collect(), space: Poses };
    let system = BodyMetric::new((0..3).map(bar).collect()).under(weight).unwrap();
    let joints = ends().map(|ends| Joint::new(Poses, 3, HINGE, ends).unwrap()).to_vec();
    let drive = Drive::new(Poses, 3, Along::Turn, Vector3::z(), ends()[0], Turned).unwrap();
    let equations = SparseDiagonal(Redundancy::LeastNorm);
    let (q, v) = start();
    let (tree, _) = linkage();
    let mut motion = TreeMotion::new(tree);
    motion.place(&q, &v).unwrap();
    let bodies = [0, 1, 2].map(|body| motion.body(body).unwrap());
    let (free, h) = (FreeBodies(ConstantVelocity), 2e-3);
    for driven in [false, true] {
        let mut full = system.metric().state(&bodies).unwrap();
        let mut method = steps(driven);
        let mut state = method.state(&q, &v).unwrap();
        let held = (joints.clone(), vec![drive; usize::from(driven)]);
        let mut rattle = Rattle::along(free, &system, &held, &full, equations).unwrap();
        let mut works = [0.0; 2];
        for _ in 0..1000 {
            method.step(&mut state, h).unwrap();
            works[0] += method.drive_work();
            works[1] += rattle.step(&mut full, h).unwrap().work;
            // A force in the plane of the loop alone holds it; RATTLE has what the second end exerts.
            let of_rattle = &rattle.multipliers()[15..17];
            for (ours, theirs) in method.loop_forces().iter().zip(of_rattle) {
                assert!((ours + theirs).abs() < 1e-6 * theirs.abs().max(1.0), "{ours} {theirs}");
            }
        }
        let placed = method.motion(&state).unwrap();
        for body in 0..3 {
            let place = placed.pose(body).unwrap().translation;
            let theirs = Vector3::from_column_slice(&full.q[7 * body..][..3]);
            assert!((place - theirs).norm() < 1e-9, "{driven}: {place} {theirs}");
        }
        assert!((works[0] - works[1]).abs() < 1e-9, "{works:?}");
        assert_eq!(works[0].abs() > 0.1, driven, "{works:?}");
    }
}

#[test]
fn closed_loops_under_a_damper_have_order_two_and_close_the_balance_of_energy() {
    let damp = |_: f64, motion: &TreeMotion, forces: &mut TreeForces| {
        let spin = motion.body(1).unwrap().angular_velocity;
        forces.add_torque(1, spin * -0.02).unwrap();
        let slow = motion.body(2).unwrap().velocity * -0.3;
        forces.add_force(motion, 2, &Vector3::zeros(), slow).unwrap();
    };
    let ((tree, mut loops), (q, v)) = (linkage(), start());
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = TreeField::driven(tree.clone(), weight, damp).unwrap().closed(loops.clone());
    let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
    let begin = Moment::new(0.0, [q, v].concat());
    let mut truth = DormandPrince853::new(field, tolerance.into(), begin).unwrap();
    while truth.moment().t < 1.0 {
        truth.step(1.0).unwrap();
    }
    let mut errors = [[0.0; 2]; 3];
    for (n, error) in [100, 200, 400].into_iter().zip(&mut errors) {
        let method = TreeVariational::driven(tree.clone(), GRAVITY, damp).unwrap();
        let mut method = method.closed(loops.clone()).unwrap();
        let mut state = method.state(&q, &v).unwrap();
        let (mut work, before) = (0.0, method.energy(&state).unwrap());
        for _ in 0..n {
            method.step(&mut state, 1.0 / f64::from(n)).unwrap();
            work += method.work();
        }
        let [gap, speed] = loops.violation(method.motion(&state).unwrap()).unwrap();
        assert!(gap < 1e-14 && speed < 1e-12, "{gap:e} {speed:e}");
        let far = state.q.iter().zip(&truth.moment().y).map(|(a, b)| (a - b).abs());
        let balance = method.energy(&state).unwrap() - before - work;
        *error = [far.fold(0.0, f64::max), balance.abs()];
    }
    for k in 0..2 {
        let slope = (errors[0][k] / errors[2][k]).log2() / 2.0;
        assert!((slope - 2.0).abs() < 0.15, "{k}: {errors:?}");
    }
    // What a motion holds stays where it is when loops are closed.
    let mut motion = TreeMotion::new(tree.clone());
    motion.hold(&[crank(&tree)]).unwrap();
    let (mut q, mut v) = (q, v);
    q[2] += 1e-3;
    v[1] += 1e-2;
    let crank = [q[0], v[0]];
    loops.close(&mut motion, &mut q, &mut v).unwrap();
    assert_eq!([q[0], v[0]], crank);
    let [gap, speed] = loops.violation(&motion).unwrap();
    assert!(gap < 1e-14 && speed < 1e-13, "{gap:e} {speed:e}");
}

#[test]
fn a_step_goes_on_from_what_was_saved_and_loops_that_depend_on_a_drive_are_refused() {
    let (q, v) = start();
    let mut method = steps(false);
    let mut state = method.state(&q, &v).unwrap();
    for _ in 0..20 {
        method.step(&mut state, 2e-3).unwrap();
    }
    let (saved, mut again) = (method.save(), state.clone());
    method.step(&mut state, 2e-3).unwrap();
    let mut other = steps(false);
    other.load(&saved).unwrap();
    other.step(&mut again, 2e-3).unwrap();
    assert_eq!(state, again);
    let count = allocation_counter::measure(|| {
        method.step(&mut state, 2e-3).unwrap();
    });
    assert_eq!(count.count_total, 0);

    // One freedom follows one schedule: two cranks are one too many.
    let (tree, loops) = linkage();
    let follower = TreeDrive::new(&tree, 2, 0, Turned).unwrap();
    let method = TreeVariational::new(tree.clone(), GRAVITY).unwrap().closed(loops).unwrap();
    let mut method = method.prescribed(vec![crank(&tree), follower]).unwrap();
    let mut state = method.state(&q, &v).unwrap();
    let before = state.clone();
    assert!(matches!(
        method.step(&mut state, 1e-3),
        Err(StepError::SingularLegendreTransform) | Err(StepError::Newton(_))
    ));
    assert_eq!(state, before);
    let other = TreeLoops::new(&TreeBuilder::default().build().unwrap());
    let error = TreeVariational::new(tree, GRAVITY).unwrap().closed(other).unwrap_err();
    assert!(matches!(error, TreeError::Size(_)), "{error}");
}

/// A gap at the origin is all that its points are away from there: it is rounded against the tree.
#[test]
fn a_loop_that_holds_a_point_at_the_origin_is_held_as_anywhere_else() {
    let ends = [1e-6, 1.0].map(|size| {
        [0.0, 3.0].map(|place| {
            let mut builder = TreeBuilder::default();
            let planar = JointKind::Planar { axes: [Vector3::x(), Vector3::y()] };
            let body = Body::new(1.0, [0.1 * size * size; 3]).unwrap();
            let first = builder.hang(None, planar, [at(0.0); 2], body);
            builder.hang(Some(first), HINGE, [at(size); 2], body);
            let tree = builder.build().unwrap();
            let mut loops = TreeLoops::new(&tree);
            let held = JointEnd::world(Vector3::x() * (place * size));
            let centre = JointEnd::on(first, Vector3::zeros());
            loops.join(&tree, JointKind::Ball, [held, centre]).unwrap();
            let mut motion = TreeMotion::new(tree.clone());
            let mut q = [(place + 0.3) * size, 0.2 * size, 0.3, 0.2];
            let mut v = [0.1 * size, 0.2 * size, 1.0, -0.5];
            motion.place(&q, &v).unwrap();
            // Out of the plane the joint holds already.
            loops.keep_independent(&mut motion).unwrap();
            loops.close(&mut motion, &mut q, &mut v).unwrap();
            let gravity = GRAVITY * size;
            let mut method = TreeVariational::new(tree, gravity).unwrap().closed(loops).unwrap();
            let mut state = method.state(&q, &v).unwrap();
            for _ in 0..20 {
                method.step(&mut state, 1e-2).unwrap();
            }
            assert!((state.q[0] - place * size).hypot(state.q[1]) < 1e-14 * size);
            [state.q[2], state.q[3]]
        })
    });
    for [x, y] in ends.as_flattened() {
        let [one, other] = ends[0][0];
        assert!((x - one).abs() < 1e-12 && (y - other).abs() < 1e-12, "{ends:?}");
    }
}
