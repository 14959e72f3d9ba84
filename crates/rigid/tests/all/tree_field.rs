//! A tree as a first-order system under the adaptive methods.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_integrators::{
    AdaptiveMethod, BackwardDifferences, DormandPrince853, Moment, RadauIia5, Tolerance,
    VectorField, integrate,
};
use stationary_measure::SplitMix64;
use stationary_rigid::JointKind;
use stationary_rigid::tree::{TreeField, TreeForces, TreeMotion};

use crate::tree::{Shape, somewhere, tree};
use crate::tree_motion::{GRAVITY, bar, end, row};

#[test]
fn energy_is_kept_by_the_adaptive_method_on_random_trees() {
    for seed in 0..40 {
        let mut random = SplitMix64::new(1_000 + seed);
        let shape = [Shape::Chain, Shape::Star, Shape::Any][seed as usize % 3];
        let root = if seed % 2 == 0 { JointKind::Free } else { JointKind::Ball };
        let tree = tree(&mut random, 1 + seed as usize % 8, shape, root);
        let (q, v) = somewhere(&mut random, &tree);
        let end = end(&tree, GRAVITY, &q, &v, 0.2, 1e-11);
        let mut motion = TreeMotion::new(tree.clone());
        let mut parts = |q: &[f64], v: &[f64]| {
            motion.place(q, v).unwrap();
            [motion.kinetic_energy(), motion.potential_energy(&GRAVITY)]
        };
        let (before, after) = (parts(&q, &v), parts(&end[..q.len()], &end[q.len()..]));
        let off = (after[0] + after[1] - before[0] - before[1]).abs();
        let scale = before[0] + after[0] + (after[1] - before[1]).abs();
        assert!(off < 1e-8 * scale, "seed {seed}: {:e}", off / scale);
    }
}

#[test]
fn a_driven_field_loses_what_its_dampers_take() {
    let (tree, rate) = bar();
    // Small swings with a torque -c v die out as exp(-c t/2 I).
    let damping = 0.05;
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let mut momentum = [0.0];
    let mut motion = TreeMotion::new(tree.clone());
    motion.place(&[0.0], &[1.0]).unwrap();
    motion.momenta(&mut momentum).unwrap();
    let decay = 0.5 * damping / momentum[0];
    let field =
        TreeField::driven(tree, weight, |_t, motion: &TreeMotion, forces: &mut TreeForces| {
            let turning = motion.body(0).map_or(f64::NAN, |body| -body.angular_velocity.y);
            forces.joints_mut()[0] -= damping * turning;
        })
        .unwrap();
    let tolerance = Tolerance::new(1e-11, 1e-15).unwrap();
    let start = Moment::new(0.0, vec![1e-4, 0.0]);
    let mut method = DormandPrince853::new(field, tolerance.into(), start).unwrap();
    integrate(&mut method, 3.0, |_| ControlFlow::Continue(())).unwrap();
    let fast = (rate * rate - decay * decay).sqrt();
    let (sine, cosine) = (fast * 3.0).sin_cos();
    let expected = 1e-4 * (-decay * 3.0).exp() * (cosine + decay / fast * sine);
    assert!((method.moment().y[0] - expected).abs() < 1e-11, "{}", method.moment().y[0] - expected);
}

#[test]
fn every_adaptive_method_runs_a_tree_to_the_same_end() {
    let both = row(2, Some(Vector3::y()));
    let (q, v) = ([0.9, -0.4], [1.0, -2.0]);
    let exact = end(&both.tree, GRAVITY, &q, &v, 1.0, 1e-12);
    let weight = TreeForces::weight(&both.tree, GRAVITY).unwrap();
    let field = TreeField::new(both.tree.clone(), weight).unwrap();
    let start = || Moment::new(0.0, [q, v].concat());
    let control = || Tolerance::new(1e-9, 1e-9).unwrap().into();
    let mut radau = RadauIia5::new(&field, control(), start()).unwrap();
    let mut backward = BackwardDifferences::new(&field, control(), start()).unwrap();
    integrate(&mut radau, 1.0, |_| ControlFlow::Continue(())).unwrap();
    integrate(&mut backward, 1.0, |_| ControlFlow::Continue(())).unwrap();
    for y in [&radau.moment().y, &backward.moment().y] {
        let off = y.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-5, "{off:e}");
    }
}

#[test]
fn accelerations_do_not_depend_on_the_length_of_quaternions() {
    let mut random = SplitMix64::new(5);
    let tree = tree(&mut random, 6, Shape::Chain, JointKind::Free);
    let (q, v) = somewhere(&mut random, &tree);
    let weight = TreeForces::weight(&tree, GRAVITY).unwrap();
    let field = TreeField::new(tree.clone(), weight).unwrap();
    let n = q.len();
    let mut stretched = q.clone();
    for body in 0..tree.bodies() {
        let range = tree.coordinates_of(body).unwrap();
        if matches!(tree.joint(body).unwrap().0, JointKind::Ball | JointKind::Free) {
            stretched[range.end - 4..range.end].iter_mut().for_each(|c| *c *= 3.0);
        }
    }
    let rates = |q: &[f64]| {
        let mut f = vec![0.0; field.dim()];
        field.evaluate(0.0, &[q, &v].concat(), &mut f);
        f
    };
    let (unit, long) = (rates(&q), rates(&stretched));
    let scale = unit[n..].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
    assert!(unit[n..].iter().zip(&long[n..]).all(|(a, b)| (a - b).abs() < 1e-12 * scale));
}
