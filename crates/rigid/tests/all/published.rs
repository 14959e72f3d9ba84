//! Published mechanisms: both ways in which they are told, and Andrews' squeezer against its published end.

use std::ops::ControlFlow;

use nalgebra::Vector3;
use stationary_constraints::{
    ConstrainedIntegrator, Constraint, Forced, Rattle, Redundancy, SparseDiagonal,
};
use stationary_integrators::{AdaptiveMethod, DormandPrince853, Moment, Tolerance, integrate};
use stationary_measure::loglog_slope;
use stationary_rigid::problems::{Mechanism, SQUEEZED, bricard, four_bars, governor, squeezer};
use stationary_rigid::tree::{TreeField, TreeForces, TreeMotion};
use stationary_rigid::{BodySpace, ConstantVelocity, FreeBodies, LieGroup, Poses};

/// The largest distance between the bodies of a state and those of a tree, and between their axes.
fn apart(q: &[f64], motion: &TreeMotion) -> f64 {
    let one = |body: usize| {
        let (full, pose) = (Poses::pose_at(q, body), motion.pose(body).unwrap());
        (full.translation - pose.translation).norm()
            + full.rotation.direction_to(&pose.rotation).norm()
    };
    (0..motion.tree().bodies()).map(one).fold(0.0, f64::max)
}

fn placed(mechanism: &Mechanism, [q, v]: [&[f64]; 2]) -> TreeMotion {
    let mut motion = TreeMotion::new(mechanism.tree().unwrap());
    motion.place(q, v).unwrap();
    motion
}

#[test]
fn published_mechanisms_start_closed_and_are_the_same_in_full_coordinates_and_as_trees() {
    for mechanism in
        [four_bars(1), four_bars(2), bricard(), governor(4e4), squeezer()].map(Result::unwrap)
    {
        let [q, v] = &mechanism.start;
        let motion = placed(&mechanism, [q, v]);
        let name = mechanism.name;
        let off = apart(&mechanism.initial.q, &motion);
        assert!(off < 1e-14, "{name}: {off:e}");
        let mut g = vec![0.0; mechanism.joints.count()];
        mechanism.joints.value(0.0, &mechanism.initial.q, &mut g).unwrap();
        assert!(g.iter().all(|g| g.abs() < 1e-14), "{name}: {g:?}");
        let [gap, rate] = mechanism.loops(motion.tree()).unwrap().violation(&motion).unwrap();
        assert!(gap < 1e-14 && rate < 1e-14, "{name}: {gap:e} {rate:e}");
        let energy = mechanism.system.energy(&mechanism.initial.q, mechanism.initial.p.view());
        let gravity = mechanism.system.potential().gravity;
        let other = motion.kinetic_energy() + motion.potential_energy(&gravity);
        assert!((energy - other).abs() < 1e-13 * energy.abs().max(1.0), "{name}");
    }
}

#[test]
fn andrews_squeezer_ends_where_it_was_published_by_rattle_with_order_two_and_as_a_tree() {
    let squeezer = squeezer().unwrap();
    let end = placed(&squeezer, [&SQUEEZED, &[0.0; 7]]);
    let errors = [1_500_u32, 3_000, 6_000].map(|steps| {
        let motion = Forced::new(FreeBodies(ConstantVelocity), squeezer.forces().unwrap());
        let (system, equations) = (&squeezer.system, SparseDiagonal(Redundancy::LeastNorm));
        let mut state = squeezer.initial.clone();
        let mut rattle =
            Rattle::along(motion, system, &squeezer.joints, &state, equations).unwrap();
        let h = squeezer.horizon / f64::from(steps);
        (0..steps).for_each(|_| _ = rattle.step(&mut state, h).unwrap());
        (h, apart(&state.q, &end))
    });
    let order = loglog_slope(&errors).unwrap();
    assert!((order - 2.0).abs() < 0.1, "{order} {errors:?}");

    let tree = squeezer.tree().unwrap();
    let drive = |_: f64, motion: &TreeMotion, forces: &mut TreeForces| {
        squeezer.act(motion, forces).unwrap();
    };
    let field = TreeField::driven(tree.clone(), TreeForces::none(&tree), drive).unwrap();
    let field = field.closed(squeezer.loops(&tree).unwrap());
    let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
    let start = Moment::new(0.0, squeezer.start.concat());
    let mut method = DormandPrince853::new(field, tolerance.into(), start).unwrap();
    integrate(&mut method, squeezer.horizon, |_| ControlFlow::Continue(())).unwrap();
    let angles = &method.moment().y[..7];
    let off = angles.iter().zip(&SQUEEZED).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(off < 1e-8, "{off:e}: {angles:?}");
}

#[test]
fn a_strut_pushes_a_tree_as_it_pushes_bodies() {
    let governor = governor(4e4).unwrap();
    let motion = placed(&governor, [&[0.2, 0.1, 0.4, 0.7], &[1.0, -0.3, 0.5, 0.2]]);
    let mut forces = TreeForces::none(motion.tree());
    governor.act(&motion, &mut forces).unwrap();
    let bodies = (0..4).map(|body| motion.body(body).unwrap()).collect::<Vec<_>>();
    let state = governor.system.metric().state(&bodies).unwrap();
    let mut v = stationary_calculus::Vector(vec![0.0; 24]);
    stationary_calculus::Metric::sharp(governor.system.metric(), state.p.view(), v.view_mut());
    let mut full = stationary_calculus::Covector(vec![0.0; 24]);
    let acting = governor.forces().unwrap();
    stationary_calculus::Force::add_force(&acting, 0.0, &state.q, v.view(), full.view_mut());
    // The power along the motion, and the joint forces that hold still what struts push.
    let mut rest = TreeMotion::new(motion.tree().clone());
    rest.place(&[0.2, 0.1, 0.4, 0.7], &[0.0; 4]).unwrap();
    let mut held = [0.0; 4];
    rest.inverse_dynamics(&forces, &[0.0; 4], &mut held).unwrap();
    let power: f64 = held.iter().zip([1.0, -0.3, 0.5, 0.2]).map(|(f, v)| -f * v).sum();
    let expected: f64 = full.0.iter().zip(&v.0).map(|(f, v)| f * v).sum();
    assert!((power / expected - 1.0).abs() < 1e-12, "{power} {expected}");
    assert!(expected.abs() > 1.0 && motion.pose(0).unwrap().apply(&Vector3::z()).z > 0.0);
}
