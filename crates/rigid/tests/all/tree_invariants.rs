//! What the variational step of a tree keeps: momenta, energy without a trend, its way back, the symplectic form.

use nalgebra::{DMatrix, DVector, Vector3};
use stationary_integrators::{Integrator, State, VectorField};
use stationary_rigid::problems::thrown_boxes;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeField, TreeForces, TreeVariational};
use stationary_rigid::{Body, JointKind, LieGroup, RigidMotion};

use crate::tree_motion::{GRAVITY, at, order, row};

/// The three boxes of [`thrown_boxes`] as a free tree, with their coordinates and speeds.
fn boxes() -> (Tree, Vec<f64>, Vec<f64>) {
    let problem = thrown_boxes().unwrap();
    let bodies = problem.system.metric().bodies();
    let widths = [0.1, 0.2, 0.15];
    let mut builder = TreeBuilder::default();
    builder.hang(None, JointKind::Free, [RigidMotion::identity(); 2], bodies[0]);
    let joints = [JointKind::Ball, JointKind::Hinge { axis: Vector3::y() }];
    for (k, joint) in joints.into_iter().enumerate() {
        let frames = [at(Vector3::x() * widths[k]), at(-Vector3::x() * widths[k + 1])];
        builder.hang(Some(k), joint, frames, bodies[k + 1]);
    }
    let tree = builder.build().unwrap();
    let velocity = |k: usize| problem.initial.p.0[k] / bodies[0].mass();
    let v = vec![velocity(0), velocity(1), velocity(2), 1.0, 2.0, 3.0, -3.0, -1.0, -2.5, 3.0];
    let mut q = tree.rest();
    q[..3].copy_from_slice(&problem.initial.q[..3]);
    (tree, q, v)
}

#[test]
fn a_free_tree_keeps_its_momenta_over_100_000_steps_and_its_energy_has_no_trend() {
    let (tree, q, v) = boxes();
    let mut method = TreeVariational::new(tree, Vector3::zeros()).unwrap();
    let mut state = method.state(&q, &v).unwrap();
    let energy = method.energy(&state).unwrap();
    let problem = thrown_boxes().unwrap();
    assert!((energy / problem.energy(&problem.initial) - 1.0).abs() < 1e-14);
    let mut see = method.clone();
    let mut momenta = |state: &State<Vec<f64>>| {
        let motion = see.motion(state).unwrap();
        (motion.linear_momentum(), motion.angular_momentum())
    };
    let start = momenta(&state);
    let (mut worst, mut mean) = (0.0_f64, [0.0; 2]);
    for step in 0..100_000 {
        method.step(&mut state, 2e-3).unwrap();
        if step % 50 == 0 {
            let (linear, angular) = momenta(&state);
            assert!((linear - start.0).norm() < 1e-12 && (angular - start.1).norm() < 1e-12);
            let off = method.energy(&state).unwrap() / energy - 1.0;
            worst = worst.max(off.abs());
            mean[usize::from(step >= 50_000)] += off / 1_000.0;
        }
    }
    // The motion is chaotic: how far energy swings depends on where it leads, its mean does not.
    assert!(worst < 1e-5 && (mean[1] - mean[0]).abs() < 5e-7, "{worst:e} {mean:?}");
}

#[test]
fn under_weight_the_momentum_about_the_vertical_is_kept_and_the_largest_energy_error_falls_with_h_squared()
 {
    let both = row(3, None);
    let mut q = both.tree.rest();
    both.tree.advance(&mut q, &[0.4, 0.9, -0.3, -0.5, 0.2, 0.6, 0.1, 0.3, 0.2]).unwrap();
    let v = [1.0, -0.5, 3.0, 2.0, 1.0, -4.0, 0.0, 1.0, 0.5];
    let method = TreeVariational::new(both.tree.clone(), GRAVITY).unwrap();
    let error = |steps: u32| {
        let mut method = method.clone();
        let mut state = method.state(&q, &v).unwrap();
        let energy = method.energy(&state).unwrap();
        let about = method.motion(&state).unwrap().angular_momentum().z;
        let mut worst = 0.0_f64;
        for _ in 0..steps {
            method.step(&mut state, 2.0 / f64::from(steps)).unwrap();
            worst = worst.max((method.energy(&state).unwrap() - energy).abs());
            let now = method.motion(&state).unwrap().angular_momentum().z;
            assert!((now - about).abs() < 1e-12, "{:e}", now - about);
        }
        worst
    };
    let order = order(error, &[1_000, 2_000, 4_000]);
    assert!((order - 2.0).abs() < 0.05, "{order}");
}

#[test]
fn the_variational_step_returns_when_momenta_are_reversed() {
    let (tree, q, v) = boxes();
    let mut method = TreeVariational::new(tree, GRAVITY).unwrap();
    let start = method.state(&q, &v).unwrap();
    let mut state = start.clone();
    for _ in 0..2 {
        for _ in 0..50 {
            method.step(&mut state, 0.01).unwrap();
        }
        state.p.0.iter_mut().for_each(|p| *p = -*p);
    }
    let off = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-11, "{off:e}");
}

#[test]
fn a_step_and_an_evaluation_of_a_tree_allocate_nothing() {
    let (tree, q, v) = boxes();
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = TreeField::new(tree.clone(), weight).unwrap();
    let (y, mut f) = ([&q[..], &v].concat(), vec![0.0; field.dim()]);
    let mut method = TreeVariational::new(tree, GRAVITY).unwrap();
    let mut state = method.state(&q, &v).unwrap();
    let count = allocation_counter::measure(|| {
        field.evaluate(0.0, &y, &mut f);
        (0..10).for_each(|_| _ = method.step(&mut state, 1e-3).unwrap());
    });
    assert_eq!(count.count_total, 0);
}

#[test]
fn the_variational_step_preserves_the_symplectic_form() {
    let mut builder = TreeBuilder::default();
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
    let axes = [Vector3::x(), Vector3::new(0.0, 1.0, 0.4)];
    let frames = [at(Vector3::new(0.1, 0.3, -0.4)), at(Vector3::new(0.2, -0.1, 0.3))];
    builder.hang(None, JointKind::Universal { axes }, frames, body);
    builder.hang(Some(0), JointKind::Cylinder { axis: axes[1] }, frames, body);
    let mut method = TreeVariational::new(builder.build().unwrap(), GRAVITY).unwrap();
    let state = method.state(&[0.3, -0.8, 0.1, 0.5], &[2.0, -1.0, 0.5, 3.0]).unwrap();
    let mut moved = |k: usize, by: f64| {
        let mut state = state.clone();
        let (q, p) = (&mut state.q, &mut state.p.0);
        *q.iter_mut().chain(p).nth(k).unwrap() += by;
        method.step(&mut state, 0.05).unwrap();
        DVector::from_iterator(8, state.q.into_iter().chain(state.p.0))
    };
    let e = 1e-3;
    let mut d = DMatrix::<f64>::zeros(8, 8);
    for k in 0..8 {
        let (near, far) = (moved(k, e) - moved(k, -e), moved(k, 2.0 * e) - moved(k, -2.0 * e));
        d.set_column(k, &((near * 8.0 - far) / (12.0 * e)));
    }
    let form = DMatrix::from_fn(8, 8, |i, j| match (i + 4 == j, j + 4 == i) {
        (true, _) => 1.0,
        (_, true) => -1.0,
        _ => 0.0,
    });
    let off = (d.transpose() * &form * d - form).amax();
    assert!(off < 1e-8, "{off:e}");
}
