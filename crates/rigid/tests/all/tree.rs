//! Trees in joint coordinates: their algorithms against each other, over random trees.

use nalgebra::{DMatrix, DVector, Vector3};
use stationary_measure::SplitMix64;
use stationary_rigid::tree::{Tree, TreeBuilder, TreeForces, TreeMotion};
use stationary_rigid::{Body, JointKind, LieGroup, RigidMotion, Rotation};

/// What hangs from what.
#[derive(Clone, Copy, Debug)]
pub enum Shape {
    Chain,
    Star,
    Any,
}

pub fn vector(random: &mut SplitMix64) -> Vector3<f64> {
    Vector3::new(random.symmetric(), random.symmetric(), random.symmetric())
}

fn motion(random: &mut SplitMix64) -> RigidMotion {
    RigidMotion { translation: vector(random) * 0.5, rotation: Rotation::exp(vector(random) * 2.0) }
}

fn below(random: &mut SplitMix64, n: usize) -> usize {
    (random.bits() % n as u64) as usize
}

fn joint(random: &mut SplitMix64) -> JointKind {
    let axis = vector(random);
    let axes = [axis, vector(random)];
    match below(random, 9) {
        0 => JointKind::Weld,
        1 => JointKind::Hinge { axis },
        2 => JointKind::Slider { axis },
        3 => JointKind::Screw { axis, pitch: random.symmetric() },
        4 => JointKind::Cylinder { axis },
        5 => JointKind::Universal { axes },
        6 => JointKind::Planar { axes },
        7 => JointKind::Ball,
        _ => JointKind::Free,
    }
}

/// Boxes whose masses differ by up to a factor of a million.
pub fn tree(random: &mut SplitMix64, bodies: usize, shape: Shape, root: JointKind) -> Tree {
    let mut builder = TreeBuilder::default();
    for body in 0..bodies {
        let parent = match shape {
            _ if body == 0 => None,
            Shape::Chain => Some(body - 1),
            Shape::Star => Some(0),
            Shape::Any => Some(below(random, body)),
        };
        let joint = if body == 0 { root } else { joint(random) };
        let half = [0.0; 3].map(|_| 0.3 + 0.25 * random.symmetric());
        let mass = 10.0_f64.powf(3.0 * random.symmetric());
        let frames = [motion(random), motion(random)];
        builder.hang(parent, joint, frames, Body::solid_box(mass, half).unwrap());
    }
    builder.build().unwrap()
}

/// Somewhere, moving somehow.
pub fn somewhere(random: &mut SplitMix64, tree: &Tree) -> (Vec<f64>, Vec<f64>) {
    let mut q = tree.rest();
    let by: Vec<f64> = (0..tree.speeds()).map(|_| 2.0 * random.symmetric()).collect();
    tree.advance(&mut q, &by).unwrap();
    (q, (0..tree.speeds()).map(|_| 2.0 * random.symmetric()).collect())
}

fn each(trees: u64, largest: usize, mut see: impl FnMut(&mut SplitMix64, Tree)) {
    for seed in 0..trees {
        let mut random = SplitMix64::new(seed);
        let shape = [Shape::Chain, Shape::Star, Shape::Any][seed as usize % 3];
        let bodies = if seed < 3 { largest } else { 1 + below(&mut random, largest) };
        let root = if seed % 2 == 0 { JointKind::Free } else { JointKind::Ball };
        let tree = tree(&mut random, bodies, shape, root);
        see(&mut random, tree);
    }
}

fn forces(random: &mut SplitMix64, motion: &TreeMotion) -> TreeForces {
    let tree = motion.tree();
    let mut forces = TreeForces::weight(tree, vector(random) * 9.81).unwrap();
    for body in 0..tree.bodies() {
        forces.add_force(motion, body, &vector(random), vector(random) * 5.0).unwrap();
        forces.add_torque(body, vector(random)).unwrap();
    }
    forces.joints_mut().iter_mut().for_each(|force| *force = random.symmetric());
    forces
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| largest.max(x.abs()))
}

#[test]
fn the_acceleration_under_forces_takes_no_other_joint_forces_on_trees_of_1_to_200_bodies() {
    let mut worst = 0.0_f64;
    each(150, 200, |random, tree| {
        let (q, v) = somewhere(random, &tree);
        let n = tree.speeds();
        let mut motion = TreeMotion::new(tree);
        motion.place(&q, &v).unwrap();
        let forces = forces(random, &motion);
        let (mut acceleration, mut left, mut needed) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        motion.forward_dynamics(&forces, &mut acceleration).unwrap();
        motion.inverse_dynamics(&forces, &acceleration, &mut left).unwrap();
        // Against the forces that would hold it from accelerating.
        motion.inverse_dynamics(&forces, &vec![0.0; n], &mut needed).unwrap();
        worst = worst.max(largest(&left) / largest(&needed));
    });
    assert!(worst < 1e-9, "{worst:e}");
}

#[test]
fn forward_dynamics_solves_the_mass_matrix_and_inverse_dynamics_multiplies_by_it() {
    each(60, 30, |random, tree| {
        let (q, v) = somewhere(random, &tree);
        let n = tree.speeds();
        let mut motion = TreeMotion::new(tree);
        motion.place(&q, &v).unwrap();
        let mut matrix = vec![0.0; n * n];
        motion.mass_matrix(&mut matrix).unwrap();
        let matrix = DMatrix::from_vec(n, n, matrix);
        assert_eq!(matrix, matrix.transpose());
        // Scaled to a diagonal of ones it is as positive as rounding lets it be.
        let scale = matrix.diagonal().map(|m| 1.0 / m.sqrt());
        let scaled = DMatrix::from_diagonal(&scale) * &matrix * DMatrix::from_diagonal(&scale);
        assert!(scaled.clone().cholesky().is_some(), "{n} freedoms");
        let speeds = DVector::from_column_slice(&v);
        let momentum = &matrix * &speeds;
        let energy = 0.5 * speeds.dot(&momentum);
        assert!((motion.kinetic_energy() / energy - 1.0).abs() < 1e-12);
        let mut momenta = vec![0.0; n];
        motion.momenta(&mut momenta).unwrap();
        let off = (0..n).map(|k| (momenta[k] - momentum[k]).abs() * scale[k]).fold(0.0, f64::max);
        assert!(off < 1e-12 * energy.sqrt(), "{off:e}");
        // Columns by inverse dynamics, at rest and without forces.
        motion.place(&q, &vec![0.0; n]).unwrap();
        let none = TreeForces::none(motion.tree());
        let (mut unit, mut column) = (vec![0.0; n], vec![0.0; n]);
        for k in 0..n {
            unit[k] = 1.0;
            motion.inverse_dynamics(&none, &unit, &mut column).unwrap();
            unit[k] = 0.0;
            for j in 0..n {
                let off = (column[j] - matrix[(j, k)]).abs() * scale[j] * scale[k];
                assert!(off < 1e-12, "{j} {k}: {off:e}");
            }
        }
        let mut back = vec![0.0; n];
        motion.speeds_of(momentum.as_slice(), &mut back).unwrap();
        let again = &matrix * DVector::from_column_slice(&back) - &momentum;
        let off = again.component_mul(&scale).amax();
        assert!(off < 1e-10 * energy.sqrt(), "{off:e}");
    });
}

#[test]
fn momenta_of_a_free_tree_change_as_the_outer_forces_say_and_its_energy_as_their_power_does() {
    each(60, 12, |random, tree| {
        let tree = if tree.joint(0).unwrap().0 == &JointKind::Free { tree } else { return };
        let (q, v) = somewhere(random, &tree);
        let n = tree.speeds();
        let mut motion = TreeMotion::new(tree);
        motion.place(&q, &v).unwrap();
        let mut forces = TreeForces::none(motion.tree());
        let (mut total, mut moment) = (Vector3::zeros(), Vector3::zeros());
        let mut power = 0.0;
        for body in 0..motion.tree().bodies() {
            let (point, force) = (vector(random), vector(random) * 5.0);
            forces.add_force(&motion, body, &point, force).unwrap();
            let place = motion.pose(body).unwrap().apply(&point);
            total += force;
            moment += place.cross(&force);
            let mut jacobian = vec![0.0; 3 * n];
            motion.point_jacobian(body, &point, &mut jacobian).unwrap();
            for k in 0..n {
                power += v[k] * (0..3).map(|i| jacobian[3 * k + i] * force[i]).sum::<f64>();
            }
        }
        // What joints push between bodies moves no momentum. The root is pushed by nothing.
        forces.joints_mut()[6..].iter_mut().zip(&v[6..]).for_each(|(force, v)| {
            *force = random.symmetric();
            power += *force * v;
        });
        let mut acceleration = vec![0.0; n];
        motion.forward_dynamics(&forces, &mut acceleration).unwrap();
        let e = 1e-5 / (1.0 + largest(&acceleration).sqrt());
        let mut at = |sign: f64| {
            let mut there = q.clone();
            let by: Vec<f64> = v
                .iter()
                .zip(&acceleration)
                .map(|(v, a)| sign * e * (v + 0.5 * sign * e * a))
                .collect();
            motion.tree().advance(&mut there, &by).unwrap();
            let fast: Vec<f64> =
                v.iter().zip(&acceleration).map(|(v, a)| v + sign * e * a).collect();
            motion.place(&there, &fast).unwrap();
            (motion.linear_momentum(), motion.angular_momentum(), motion.kinetic_energy())
        };
        let (ahead, behind) = (at(1.0), at(-1.0));
        let scale = (ahead.0.norm() + ahead.1.norm() + ahead.2) / e * 1e-11
            + 1e-6 * (total.norm() + moment.norm() + power.abs());
        assert!(((ahead.0 - behind.0) / (2.0 * e) - total).norm() < 100.0 * scale);
        assert!(((ahead.1 - behind.1) / (2.0 * e) - moment).norm() < 100.0 * scale);
        assert!(((ahead.2 - behind.2) / (2.0 * e) - power).abs() < 100.0 * scale);
    });
}

/// The same mechanism with compound joints, and with simple ones in a row.
fn compound(random: &mut SplitMix64, whole: JointKind, parts: &[JointKind]) -> [Tree; 2] {
    let frames = [motion(random), motion(random)];
    let (first, second) = (motion(random), motion(random));
    let body = Body::solid_box(1.3, [0.1, 0.2, 0.3]).unwrap();
    let here = RigidMotion::identity();
    [&[whole][..], parts].map(|joints| {
        let mut builder = TreeBuilder::default();
        let hinge = JointKind::Hinge { axis: Vector3::new(0.0, 1.0, 1.0) };
        let mut parent = builder.hang(None, hinge, [first, second], body);
        for (k, joint) in joints.iter().enumerate() {
            let before = if k == 0 { frames[0] } else { here };
            parent = match k + 1 < joints.len() {
                true => builder.hang_frame(Some(parent), *joint, [before, here]),
                false => builder.hang(Some(parent), *joint, [before, frames[1]], body),
            };
        }
        builder.build().unwrap()
    })
}

#[test]
fn compound_joints_move_as_simple_ones_in_a_row_with_frames_without_mass_between_them() {
    let mut random = SplitMix64::new(7);
    let (a, b) = (Vector3::new(0.6, 0.0, 0.8), Vector3::new(0.0, 1.0, 0.3).normalize());
    let (hinge, slider) = (|axis| JointKind::Hinge { axis }, |axis| JointKind::Slider { axis });
    let cases = [
        (JointKind::Cylinder { axis: a }, vec![slider(a), hinge(a)]),
        (JointKind::Universal { axes: [a, b] }, vec![hinge(a), hinge(b)]),
        (JointKind::Planar { axes: [a, b] }, vec![slider(a), slider(b), hinge(a.cross(&b))]),
    ];
    for (whole, parts) in cases {
        let trees = compound(&mut random, whole, &parts);
        let (q, v) = somewhere(&mut random, &trees[0]);
        let accelerations = trees.map(|tree| {
            let weight = TreeForces::weight(&tree, Vector3::z() * -9.81).unwrap();
            let mut motion = TreeMotion::new(tree);
            motion.place(&q, &v).unwrap();
            let mut acceleration = vec![0.0; q.len()];
            motion.forward_dynamics(&weight, &mut acceleration).unwrap();
            acceleration
        });
        let pairs = accelerations[0].iter().zip(&accelerations[1]);
        let off = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(off < 1e-12 * largest(&accelerations[0]), "{}: {off:e}", whole.name());
    }
}

#[test]
fn a_body_on_a_screw_falls_with_the_inertia_that_its_pitch_adds() {
    let (mass, pitch) = (2.0, 0.1);
    let body = Body::new(mass, [0.3, 0.4, 0.5]).unwrap();
    let mut builder = TreeBuilder::default();
    let joint = JointKind::Screw { axis: Vector3::z() * 5.0, pitch };
    builder.hang(None, joint, [RigidMotion::identity(); 2], body);
    let tree = builder.build().unwrap();
    let weight = TreeForces::weight(&tree, Vector3::z() * -9.81).unwrap();
    let mut motion = TreeMotion::new(tree);
    motion.place(&[1.0], &[3.0]).unwrap();
    let mut acceleration = [0.0];
    motion.forward_dynamics(&weight, &mut acceleration).unwrap();
    let expected = -mass * 9.81 * pitch / (0.5 + mass * pitch * pitch);
    assert!((acceleration[0] / expected - 1.0).abs() < 1e-15, "{acceleration:?}");
    assert!((motion.potential_energy(&(Vector3::z() * -9.81)) - mass * 9.81 * pitch).abs() < 1e-14);
}

#[test]
fn the_algorithms_allocate_nothing() {
    let mut random = SplitMix64::new(3);
    let tree = tree(&mut random, 20, Shape::Any, JointKind::Free);
    let (q, v) = somewhere(&mut random, &tree);
    let n = tree.speeds();
    let weight = TreeForces::weight(&tree, Vector3::z() * -9.81).unwrap();
    let mut motion = TreeMotion::new(tree);
    let (mut acceleration, mut torque) = (vec![0.0; n], vec![0.0; n]);
    let mut matrix = vec![0.0; n * n];
    let count = allocation_counter::measure(|| {
        motion.place(&q, &v).unwrap();
        motion.forward_dynamics(&weight, &mut acceleration).unwrap();
        motion.inverse_dynamics(&weight, &acceleration, &mut torque).unwrap();
        motion.mass_matrix(&mut matrix).unwrap();
        motion.momenta(&mut torque).unwrap();
        motion.speeds_of(&torque, &mut acceleration).unwrap();
    });
    assert_eq!(count.count_total, 0);
}

#[test]
fn a_tree_a_million_metres_away_loses_no_digits() {
    let accelerations = |far: f64| {
        let mut builder = TreeBuilder::default();
        let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
        let at = |translation| RigidMotion { translation, rotation: Rotation::identity() };
        let arm = Vector3::new(0.2, -0.1, 0.3);
        builder.hang(None, JointKind::Ball, [at(Vector3::x() * far), at(arm)], body);
        builder.hang(Some(0), JointKind::Ball, [at(-arm), at(arm)], body);
        let tree = builder.build().unwrap();
        let weight = TreeForces::weight(&tree, Vector3::z() * -9.81).unwrap();
        let mut q = tree.rest();
        tree.advance(&mut q, &[0.3, 0.5, -0.2, 0.9, 0.1, 0.4]).unwrap();
        let mut motion = TreeMotion::new(tree);
        motion.place(&q, &[1.0, -2.0, 0.5, 3.0, 0.0, 1.0]).unwrap();
        let mut acceleration = [0.0; 6];
        motion.forward_dynamics(&weight, &mut acceleration).unwrap();
        acceleration
    };
    let (near, far) = (accelerations(0.0), accelerations(1e6));
    assert!((0..6).all(|k| (near[k] - far[k]).abs() < 1e-13 * largest(&near)), "{near:?} {far:?}");
}
