//! Loops of a tree: a four-bar linkage of three hinged bars, closed by two rows.

use std::f64::consts::TAU;

use nalgebra::{Vector2, Vector3};
use stationary_integrators::{AdaptiveMethod, DormandPrince853, Moment, Tolerance};
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeError, TreeField, TreeForces, TreeLoops, TreeMotion,
};
use stationary_rigid::{
    Body, FourBar, JointEnd, JointFault, JointKind, LieGroup, RigidMotion, Rotation,
};

const LINKAGE: FourBar =
    FourBar { lengths: [0.2, 0.5, 0.4, 0.5], density: 2.0, gravity: Vector2::new(0.0, -9.81) };
const RATE: f64 = 12.0;

fn at(x: f64) -> RigidMotion {
    RigidMotion { translation: Vector3::x() * x, rotation: Rotation::identity() }
}

/// Crank, coupler and follower, opened where the last two meet.
fn linkage() -> (Tree, TreeLoops) {
    let [a, b, c, d] = LINKAGE.lengths;
    let (masses, moments) = (LINKAGE.masses(), LINKAGE.moments());
    let bar = |k: usize| Body::new(masses[k], [0.01 * moments[k], moments[k], moments[k]]).unwrap();
    let hinge = JointKind::Hinge { axis: Vector3::z() };
    let mut builder = TreeBuilder::default();
    let crank = builder.hang(None, hinge, [at(0.0), at(-a / 2.0)], bar(0));
    let coupler = builder.hang(Some(crank), hinge, [at(a / 2.0), at(-b / 2.0)], bar(1));
    let follower = builder.hang(None, hinge, [at(d), at(-c / 2.0)], bar(2));
    let tree = builder.build().unwrap();
    let mut loops = TreeLoops::new(&tree);
    let end = |body, length: f64| JointEnd::on(body, Vector3::x() * (length / 2.0));
    // The hinges hold everything out of their plane already.
    let pin = JointKind::OnLine { axis: Vector3::z() };
    loops.join(&tree, pin, [end(coupler, b), end(follower, c)]).unwrap();
    (tree, loops)
}

/// Its coordinates and speeds at the crank's angle zero.
fn start() -> ([f64; 3], [f64; 3]) {
    let [u, v, w] = LINKAGE.angles(0.0);
    let slope = LINKAGE.slope(0.0);
    let (v_rate, w_rate) = (slope[5] * RATE, slope[8] * RATE);
    ([u, v - u, w], [RATE, v_rate - RATE, w_rate])
}

fn run(tolerance: f64, time: f64, mut see: impl FnMut(&mut Moment<Vec<f64>>) -> bool) -> Vec<f64> {
    let (tree, loops) = linkage();
    let weight = TreeForces::weight(&tree, Vector3::y() * -9.81).unwrap();
    let field = TreeField::new(tree, weight).unwrap().closed(loops);
    let (q, v) = start();
    let tolerance = Tolerance::new(tolerance, tolerance).unwrap();
    let begin = Moment::new(0.0, [q, v].concat());
    let mut method = DormandPrince853::new(field, tolerance.into(), begin).unwrap();
    while method.moment().t < time {
        method.step(time).unwrap();
        let mut moment = method.moment().clone();
        if see(&mut moment) {
            method.restart(&moment).unwrap();
        }
    }
    method.moment().y.clone()
}

#[test]
fn a_four_bar_as_a_tree_closed_by_two_rows_takes_the_time_of_a_revolution_that_energy_gives() {
    let time = LINKAGE.revolution(0.0, RATE);
    let end = run(1e-12, time, |_| false);
    let ((q, v), turned) = (start(), [TAU, -TAU, 0.0]);
    for k in 0..3 {
        assert!((end[k] - q[k] - turned[k]).abs() < 1e-8, "{k}: {end:?}");
        assert!((end[3 + k] - v[k]).abs() < 1e-6, "{k}: {end:?}");
    }
}

#[test]
fn loops_drift_by_the_tolerance_unless_they_are_closed_again_and_are_then_closed_to_rounding() {
    let (tree, mut loops) = linkage();
    let mut motion = TreeMotion::new(tree);
    let look = loops.clone();
    let mut worst = 0.0_f64;
    let mut watched = motion.clone();
    let time = 20.0 * LINKAGE.revolution(0.0, RATE);
    run(1e-6, time, |moment| {
        watched.place(&moment.y[..3], &moment.y[3..]).unwrap();
        worst = worst.max(look.violation(&watched).unwrap()[0]);
        false
    });
    let mut closed = 0.0_f64;
    let end = run(1e-6, time, |moment| {
        let (q, v) = moment.y.split_at_mut(3);
        loops.close(&mut motion, q, v).unwrap();
        let [gap, speed] = loops.violation(&motion).unwrap();
        closed = closed.max(gap).max(speed);
        true
    });
    assert!(worst > 1e-6 && closed < 2e-13, "{worst:e} {closed:e}");
    // With the loops closed the energy is that of the start, to the tolerance.
    let gravity = Vector3::y() * -9.81;
    let mut energy = |q: &[f64], v: &[f64]| {
        motion.place(q, v).unwrap();
        motion.kinetic_energy() + motion.potential_energy(&gravity)
    };
    let ((q, v), after) = (start(), energy(&end[..3], &end[3..]));
    let before = energy(&q, &v);
    assert!((after / before - 1.0).abs() < 1e-3, "{before} {after}");
}

#[test]
fn the_multipliers_are_the_forces_that_hold_the_loop() {
    let (tree, mut loops) = linkage();
    let (q, v) = start();
    let weight = TreeForces::weight(&tree, Vector3::y() * -9.81).unwrap();
    let mut motion = TreeMotion::new(tree);
    motion.place(&q, &v).unwrap();
    let mut held = [0.0; 3];
    loops.forward_dynamics(&mut motion, &weight, &mut held).unwrap();
    // The same forces, given to the open tree: along two directions of the coupler, across the axis.
    let turned = motion.pose(1).unwrap().rotation;
    let across = [Vector3::y(), -Vector3::x()].map(|across| turned.rotate(&across));
    let force = across[0] * loops.multipliers()[0] + across[1] * loops.multipliers()[1];
    let mut forces = weight.clone();
    let tip = |length: f64| Vector3::x() * (length / 2.0);
    forces.add_force(&motion, 1, &tip(LINKAGE.lengths[1]), force).unwrap();
    forces.add_force(&motion, 2, &tip(LINKAGE.lengths[2]), -force).unwrap();
    let mut open = [0.0; 3];
    motion.forward_dynamics(&forces, &mut open).unwrap();
    let largest = held.iter().fold(0.0_f64, |largest, a| largest.max(a.abs()));
    assert!((0..3).all(|k| (held[k] - open[k]).abs() < 1e-12 * largest), "{held:?} {open:?}");
}

#[test]
fn rows_that_hold_the_same_and_loops_that_cannot_close_are_refused() {
    let (tree, mut loops) = linkage();
    let (mut q, mut v) = start();
    let mut motion = TreeMotion::new(tree.clone());
    // Out of the plane the hinges hold already.
    let [_, b, c, _] = LINKAGE.lengths;
    let ends = [(1, b), (2, c)].map(|(k, length)| JointEnd::on(k, Vector3::x() * (length / 2.0)));
    let mut redundant = TreeLoops::new(&tree);
    redundant.join(&tree, JointKind::Ball, ends).unwrap();
    let error = redundant.close(&mut motion, &mut q, &mut v).unwrap_err();
    assert!(matches!(error, TreeError::DependentLoops { rows: 3 }), "{error}");
    let weight = TreeForces::weight(&tree, Vector3::y()).unwrap();
    motion.place(&q, &v).unwrap();
    let error = redundant.forward_dynamics(&mut motion, &weight, &mut [0.0; 3]).unwrap_err();
    assert!(matches!(error, TreeError::DependentLoops { rows: 3 }), "{error}");
    // A point out of reach.
    let far = JointEnd::world(Vector3::x() * 10.0);
    let tip = JointEnd::on(0, Vector3::zeros());
    loops.join(&tree, JointKind::Rod { length: 1.0 }, [tip, far]).unwrap();
    assert!(loops.close(&mut motion, &mut q, &mut v).is_err());
    let absent = JointEnd::on(9, Vector3::zeros());
    let error = loops.join(&tree, JointKind::Ball, [tip, absent]).unwrap_err();
    let fault = JointFault::NoSuchBody { body: 9, bodies: 3 };
    assert!(matches!(error, TreeError::Loop { fault: it, .. } if it == fault), "{error}");
}

#[test]
fn a_loop_s_dynamics_allocate_nothing() {
    let (tree, mut loops) = linkage();
    let (mut q, mut v) = start();
    let weight = TreeForces::weight(&tree, Vector3::y() * -9.81).unwrap();
    let mut motion = TreeMotion::new(tree);
    motion.place(&q, &v).unwrap();
    let mut held = [0.0; 3];
    let count = allocation_counter::measure(|| {
        loops.forward_dynamics(&mut motion, &weight, &mut held).unwrap();
        loops.close(&mut motion, &mut q, &mut v).unwrap();
    });
    assert_eq!(count.count_total, 0);
}

#[test]
fn a_rod_between_bodies_that_are_welded_or_share_its_end_is_refused_where_it_is_met() {
    let at = |x: f64| RigidMotion {
        translation: Vector3::new(x, 0.13 * x, 0.0),
        rotation: Rotation::exp(Vector3::new(0.2, -0.4 * x, 0.7)),
    };
    for (ratio, welded) in [(1.0, true), (1e6, true), (1e-6, true), (1.0, false)] {
        let mut builder = TreeBuilder::default();
        let heavy = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
        let light = Body::solid_box(ratio, [0.3, 0.1, 0.2]).unwrap();
        let first = builder.hang(None, JointKind::Free, [at(0.0), at(0.2)], heavy);
        let between =
            if welded { JointKind::Weld } else { JointKind::Hinge { axis: Vector3::z() } };
        let second = builder.hang(Some(first), between, [at(0.4), at(-0.3)], light);
        let tree = builder.build().unwrap();
        let mut motion = TreeMotion::new(tree.clone());
        let (mut q, mut v) = (tree.rest(), vec![0.3; tree.speeds()]);
        motion.place(&q, &v).unwrap();
        let ends = [JointEnd::on(first, Vector3::x()), JointEnd::on(second, Vector3::y())];
        let place = |body: usize, c: Vector3<f64>| motion.pose(body).unwrap().apply(&c);
        let length = (place(first, Vector3::x()) - place(second, Vector3::y())).norm();
        let mut loops = TreeLoops::new(&tree);
        loops.join(&tree, JointKind::Rod { length }, ends).unwrap();
        let closed = loops.close(&mut motion, &mut q, &mut v);
        let dependent = matches!(closed, Err(TreeError::DependentLoops { rows: 1 }));
        assert_eq!(dependent, welded, "{ratio}: {closed:?}");
    }
}

/// How far an end of a loop is from its place, with its velocity and its acceleration.
fn path(t: f64) -> [Vector3<f64>; 3] {
    let of = |size: f64, w: f64, phase: f64| {
        let (sin, cos) = (w * t + phase).sin_cos();
        [size * (sin - phase.sin()), size * w * cos, -size * w * w * sin]
    };
    let [x, y, z] = [of(0.2, 3.0, 0.4), of(0.15, 2.0, 1.1), of(-0.1, 4.0, -0.3)];
    std::array::from_fn(|k| Vector3::new(x[k], y[k], z[k]))
}

/// If the row's speed, its acceleration or its power were wrong, it would open, or the energy would not be that
/// power's.
#[test]
fn an_end_that_moves_along_a_path_leads_a_joint_of_every_kind() {
    let axis = Vector3::new(0.2, 0.3, 0.9).normalize();
    let other = Vector3::new(0.9, 0.0, -0.2).normalize();
    let kinds = [
        JointKind::Ball,
        JointKind::Weld,
        JointKind::Hinge { axis },
        JointKind::Slider { axis },
        JointKind::Cylinder { axis },
        JointKind::Universal { axes: [axis, other] },
        JointKind::Planar { axes: [axis, other] },
        JointKind::OnLine { axis },
        JointKind::Rod { length: 0.6 },
    ];
    for (number, kind) in kinds.into_iter().enumerate() {
        let mut builder = TreeBuilder::default();
        let body = Body::new(2.0, [0.3, 0.2, 0.25]).unwrap();
        let first = builder.hang(None, JointKind::Free, [at(0.0), at(0.0)], body);
        let tree = builder.build().unwrap();
        let mut loops = TreeLoops::new(&tree);
        let point = Vector3::new(0.1, -0.2, 0.15);
        let apart = if matches!(kind, JointKind::Rod { .. }) {
            Vector3::x() * 0.6
        } else {
            Vector3::zeros()
        };
        // Its world end first in some of them.
        let mut ends = [JointEnd::world(point + apart), JointEnd::on(first, point)];
        if number % 2 == 1 {
            ends.reverse();
        }
        let within = ends.map(|end| JointEnd { body: Some(first), ..end });
        assert!(matches!(
            loops.join_moving(&tree, kind, within, path),
            Err(TreeError::Loop { fault: JointFault::NoEndInWorld, .. })
        ));
        loops.join_moving(&tree, kind, ends, path).unwrap();
        let mut motion = TreeMotion::new(tree.clone());
        let (mut q, mut v) = (tree.rest(), vec![0.3, -0.2, 0.4, 0.5, -0.6, 0.7]);
        loops.close(&mut motion, &mut q, &mut v).unwrap();
        let energy = motion.kinetic_energy();
        let none = TreeForces::none(&tree);
        let field = || TreeField::new(tree.clone(), none.clone()).unwrap().closed(loops.clone());
        let (look, tolerance) = (field(), Tolerance::new(1e-12, 1e-12).unwrap());
        let begin = Moment::new(0.0, [q, v].concat());
        let mut method = DormandPrince853::new(field(), tolerance.into(), begin).unwrap();
        // Simpson's rule of its power.
        let (steps, h, mut work) = (400, 0.8 / 400.0, 0.0);
        for step in 0..=steps {
            let t = h * f64::from(step);
            while method.moment().t < t {
                method.step(t).unwrap();
            }
            let weight =
                if step == 0 || step == steps { 1.0 } else { f64::from(2 + 2 * (step % 2)) };
            work += weight * h / 3.0 * look.power_of_ends(t, &method.moment().y).unwrap();
        }
        let y = &method.moment().y;
        motion.place(&y[..7], &y[7..]).unwrap();
        let mut there = loops.clone();
        there.set_time(0.8);
        let [gap, rate] = there.violation(&motion).unwrap();
        assert!(gap < 1e-9 && rate < 1e-9, "{kind:?}: {gap} {rate}");
        let gained = motion.kinetic_energy() - energy;
        assert!((gained - work).abs() < 1e-8 && work.abs() > 1e-3, "{kind:?}: {gained} {work}");
    }
}
