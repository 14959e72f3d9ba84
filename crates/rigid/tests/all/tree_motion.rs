//! Trees in motion: against closed forms, and against the same bodies held by RATTLE in full coordinates.

use std::ops::ControlFlow;

use nalgebra::{DMatrix, Vector3};
use stationary_constraints::{ConstrainedIntegrator, Rattle, SparseDiagonal};
use stationary_integrators::problems::pendulum;
use stationary_integrators::{
    AdaptiveMethod, DormandPrince853, Integrator, Moment, State, Tolerance, integrate,
};
use stationary_measure::{SplitMix64, loglog_slope};
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeField, TreeForces, TreeMotion, TreeVariational,
};
use stationary_rigid::{
    Body, BodyMetric, BodySpace, ConstantVelocity, FreeBodies, FreeTop, Joint, JointEnd, JointKind,
    LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

use crate::tree::{Shape, somewhere, tree};

pub(crate) const GRAVITY: Vector3<f64> = Vector3::new(0.0, 0.0, -9.81);

pub(crate) fn at(translation: Vector3<f64>) -> RigidMotion {
    RigidMotion { translation, rotation: Rotation::identity() }
}

/// The end of a motion under weight from coordinates and speeds, by the adaptive method.
pub(crate) fn end(
    tree: &Tree,
    gravity: Vector3<f64>,
    q: &[f64],
    v: &[f64],
    time: f64,
    relative: f64,
) -> Vec<f64> {
    let weight = TreeForces::weight(tree, gravity).unwrap();
    let field = TreeField::new(tree.clone(), weight).unwrap();
    let start = Moment::new(0.0, [q, v].concat());
    let tolerance = Tolerance::new(relative, relative).unwrap();
    let mut method = DormandPrince853::new(field, tolerance.into(), start).unwrap();
    integrate(&mut method, time, |_| ControlFlow::Continue(())).unwrap();
    method.moment().y.clone()
}

/// The state after equal steps.
pub(crate) fn stepped(
    method: &mut TreeVariational,
    start: &State<Vec<f64>>,
    time: f64,
    steps: u32,
) -> State<Vec<f64>> {
    let mut state = start.clone();
    for _ in 0..steps {
        method.step(&mut state, time / f64::from(steps)).unwrap();
    }
    state
}

pub(crate) fn order(errors: impl Fn(u32) -> f64, steps: &[u32]) -> f64 {
    let points: Vec<_> = steps.iter().map(|&n| (1.0 / f64::from(n), errors(n))).collect();
    loglog_slope(&points).unwrap()
}

/// A bar of 2 kg hung by its upper end.
pub(crate) fn bar() -> (Tree, f64) {
    let half = 0.4;
    let body = Body::solid_box(2.0, [0.03, 0.05, half]).unwrap();
    let mut builder = TreeBuilder::default();
    let joint = JointKind::Hinge { axis: -Vector3::y() };
    builder.hang(None, joint, [RigidMotion::identity(), at(Vector3::z() * half)], body);
    let inertia = body.moments().y + 2.0 * half * half;
    (builder.build().unwrap(), (2.0 * 9.81 * half / inertia).sqrt())
}

#[test]
fn a_bar_on_a_hinge_swings_as_the_pendulum_in_closed_form() {
    let (tree, rate) = bar();
    let problem = pendulum(2.5).unwrap();
    let exact = |time: f64| (problem.solution)(rate * time).unwrap()[0];
    let off = (end(&tree, GRAVITY, &[2.5], &[0.0], 5.0, 1e-12)[0] - exact(5.0)).abs();
    assert!(off < 1e-9, "{off:e}");
    let mut method = TreeVariational::new(tree, GRAVITY).unwrap();
    let start = method.state(&[2.5], &[0.0]).unwrap();
    // The largest error along the way.
    let error = |steps: u32| {
        let (mut method, mut state, mut worst) = (method.clone(), start.clone(), 0.0_f64);
        for step in 1..=steps {
            method.step(&mut state, 5.0 / f64::from(steps)).unwrap();
            worst = worst.max((state.q[0] - exact(5.0 * f64::from(step) / f64::from(steps))).abs());
        }
        worst
    };
    let order = order(error, &[1_000, 2_000, 4_000]);
    assert!((order - 2.0).abs() < 0.05, "{order}");
}

#[test]
fn a_free_body_turns_as_the_free_top_in_closed_form_and_flies_straight() {
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
    let (w, velocity) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.3, -1.0, 2.0));
    let mut builder = TreeBuilder::default();
    builder.hang(None, JointKind::Free, [RigidMotion::identity(); 2], body);
    let tree = builder.build().unwrap();
    let (q, v) = (tree.rest(), [velocity.as_slice(), w.as_slice()].concat());
    let top = FreeTop::new(body, Rotation::identity(), w).unwrap();
    let none = Vector3::zeros();
    let off = |q: &[f64]| {
        let motion = Poses::pose_at(q, 0);
        let turned = motion.rotation.normalized().direction_to(&top.orientation(4.0).unwrap());
        turned.norm().max((motion.translation - velocity * 4.0).norm())
    };
    let adaptive = off(&end(&tree, none, &q, &v, 4.0, 1e-12));
    assert!(adaptive < 1e-10, "{adaptive:e}");
    let mut method = TreeVariational::new(tree, none).unwrap();
    let start = method.state(&q, &v).unwrap();
    let order = order(
        |steps| off(&stepped(&mut method.clone(), &start, 4.0, steps).q),
        &[500, 1_000, 2_000],
    );
    assert!((order - 2.0).abs() < 0.05, "{order}");
}

/// Boxes in a row, each hung by its top from the foot of the one before it: as a tree, and as bodies
/// with joints.
pub(crate) struct Both<J> {
    pub(crate) tree: Tree,
    bodies: Vec<Body>,
    joints: J,
}

const HALF: f64 = 0.25;

pub(crate) fn row(n: usize, axis: Option<Vector3<f64>>) -> Both<Vec<Joint<Poses>>> {
    let bodies: Vec<Body> = (0..n)
        .map(|k| Body::solid_box(1.0 + 0.3 * k as f64, [0.05, 0.08, HALF]).unwrap())
        .collect();
    let joint = axis.map_or(JointKind::Ball, |axis| JointKind::Hinge { axis });
    let (top, foot) = (Vector3::z() * HALF, -Vector3::z() * HALF);
    let mut builder = TreeBuilder::default();
    let mut joints = Vec::new();
    for (k, body) in bodies.iter().enumerate() {
        let parent = k.checked_sub(1);
        let before = if k == 0 { Vector3::zeros() } else { foot };
        builder.hang(parent, joint, [at(before), at(top)], *body);
        let up = parent.map_or(JointEnd::world(before), |p| JointEnd::on(p, before));
        let ends = [up, JointEnd::on(k, top)];
        joints.push(match axis {
            None => Joint::new(Poses, n, JointKind::Ball, ends).unwrap(),
            Some(axis) => Joint::new(Poses, n, JointKind::Hinge { axis }, ends).unwrap(),
        });
    }
    Both { tree: builder.build().unwrap(), bodies, joints }
}

/// Runs the bodies by RATTLE from the tree's motion, and returns their poses.
fn by_rattle(
    both: &Both<Vec<Joint<Poses>>>,
    (q, v): (&[f64], &[f64]),
    time: f64,
    steps: u32,
) -> Vec<RigidMotion> {
    let mut motion = TreeMotion::new(both.tree.clone());
    motion.place(q, v).unwrap();
    let n = both.bodies.len();
    let motions: Vec<_> = (0..n).map(|body| motion.body(body).unwrap()).collect();
    let metric = BodyMetric::<Poses>::new(both.bodies.clone());
    let mut state = metric.state(&motions).unwrap();
    let load = |body: &Body| PointMass { mass: body.mass(), point: Vector3::zeros() };
    let masses = both.bodies.iter().map(load).collect();
    let system = metric.under(Weight { gravity: GRAVITY, masses, space: Poses }).unwrap();
    let free = FreeBodies(ConstantVelocity);
    let few = SparseDiagonal::default();
    let mut rattle = Rattle::along(free, &system, &both.joints, &state, few).unwrap();
    for _ in 0..steps {
        rattle.step(&mut state, time / f64::from(steps)).unwrap();
    }
    (0..n).map(|body| Poses::pose_at(&state.q, body)).collect()
}

fn apart(a: &[RigidMotion], b: &[RigidMotion]) -> f64 {
    let one = |(a, b): (&RigidMotion, &RigidMotion)| {
        (a.translation - b.translation).norm().max(a.rotation.direction_to(&b.rotation).norm())
    };
    a.iter().zip(b).map(one).fold(0.0, f64::max)
}

fn poses(tree: &Tree, q: &[f64]) -> Vec<RigidMotion> {
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(q, &vec![0.0; tree.speeds()]).unwrap();
    (0..tree.bodies()).map(|body| motion.pose(body).unwrap()).collect()
}

fn compare(both: &Both<Vec<Joint<Poses>>>, q: &[f64], v: &[f64]) {
    let time = 1.0;
    // The same discrete principle: the same motion to rounding, at any step.
    let mut method = TreeVariational::new(both.tree.clone(), GRAVITY).unwrap();
    let start = method.state(q, v).unwrap();
    let reduced = stepped(&mut method, &start, time, 100);
    let full = by_rattle(both, (q, v), time, 100);
    let off = apart(&full, &poses(&both.tree, &reduced.q));
    assert!(off < 1e-10, "{off:e}");
    // Both against the adaptive method, in the limit of small steps.
    let exact = end(&both.tree, GRAVITY, q, v, time, 1e-13);
    let exact = poses(&both.tree, &exact[..q.len()]);
    let order =
        order(|steps| apart(&by_rattle(both, (q, v), time, steps), &exact), &[400, 800, 1600]);
    assert!((order - 2.0).abs() < 0.05, "{order}");
}

#[test]
fn a_chain_of_hinges_moves_as_rattle_moves_its_bodies_to_rounding_and_both_converge_with_order_two()
{
    let both = row(4, Some(Vector3::new(0.0, 1.0, 0.2)));
    compare(&both, &[0.9, -0.4, 0.5, 0.2], &[1.0, -2.0, 0.5, 1.0]);
}

#[test]
fn a_ball_jointed_double_pendulum_moves_as_rattle_moves_it_to_rounding_and_both_converge_with_order_two()
 {
    let both = row(2, None);
    let mut q = both.tree.rest();
    both.tree.advance(&mut q, &[0.4, 0.9, -0.3, -0.5, 0.2, 0.6]).unwrap();
    compare(&both, &q, &[1.0, -0.5, 3.0, 2.0, 1.0, -4.0]);
}

/// The condition number of the mass matrix: what a momentum's rounding becomes in the speeds.
fn condition(tree: &Tree, q: &[f64]) -> f64 {
    let n = tree.speeds();
    let (mut motion, mut matrix) = (TreeMotion::new(tree.clone()), vec![0.0; n * n]);
    motion.place(q, &vec![0.0; n]).unwrap();
    motion.mass_matrix(&mut matrix).unwrap();
    let eigenvalues = DMatrix::from_vec(n, n, matrix).symmetric_eigenvalues();
    eigenvalues.max() / eigenvalues.min()
}

#[test]
fn the_variational_step_moves_every_kind_of_joint_with_order_two_down_to_the_rounding_of_its_momenta()
 {
    for seed in 0..12 {
        let mut random = SplitMix64::new(2_000 + seed);
        let shape = [Shape::Chain, Shape::Star, Shape::Any][seed as usize % 3];
        let root = if seed % 2 == 0 { JointKind::Free } else { JointKind::Ball };
        let tree = tree(&mut random, 6, shape, root);
        let (q, v) = somewhere(&mut random, &tree);
        let exact = end(&tree, GRAVITY, &q, &v, 0.1, 1e-13);
        let exact = poses(&tree, &exact[..q.len()]);
        let mut method = TreeVariational::new(tree.clone(), GRAVITY).unwrap();
        let start = method.state(&q, &v).unwrap();
        let error = |steps: u32| {
            let state = stepped(&mut method.clone(), &start, 0.1, steps);
            apart(&poses(&tree, &state.q), &exact)
        };
        let order = order(error, &[100, 200, 400]);
        let rounding = f64::EPSILON * condition(&tree, &q);
        assert!((order - 2.0).abs() < 0.1 || error(400) < rounding, "seed {seed}: {order}");
    }
}

#[test]
fn the_variational_step_of_a_small_swing_is_unstable_above_two_over_omega() {
    let (tree, rate) = bar();
    let grown = |product: f64| {
        let mut method = TreeVariational::new(tree.clone(), GRAVITY).unwrap();
        let mut state = method.state(&[1e-9], &[0.0]).unwrap();
        (0..80).for_each(|_| _ = method.step(&mut state, product / rate).unwrap());
        state.q[0].abs().max(state.p.0[0].abs()) / 1e-9
    };
    assert!(grown(1.98) < 100.0, "{}", grown(1.98));
    assert!(grown(2.01) > 1e4, "{}", grown(2.01));
}
