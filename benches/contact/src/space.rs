//! Boxes of space: ours, rapier3d-f64 and box3d-rust.

use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, Rotation as Turn, Vector,
};
use stationary_contact::problems::{Boxes, FRICTION, GRAVITY, columns_of_boxes, falling_boxes};
use stationary_contact::{Detector, SpatialWorld};
use stationary_measure::SplitMix64;
use stationary_rigid::{LieGroup, Poses, RigidMotion, Weight};

use crate::box3d::Box3d;
use crate::quality::{Left, Seen, look};
use crate::{LOOKS, Row, STEP};

type Ours = SpatialWorld<Weight<Poses>>;

/// Cubes of a side of 1 m and of 1 kg on a floor, at rest.
pub fn rapier(starts: &[RigidMotion], can_sleep: bool) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let gravity = Vector::Z * -GRAVITY;
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
    world.integration_parameters.dt = STEP;
    let floor = ColliderBuilder::cuboid(1000.0, 1000.0, 1.0).translation(Vector::Z * -1.0);
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |start: &RigidMotion| {
        let [x, y, z] = start.translation.into();
        let turn = start.rotation.log();
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(x, y, z))
            .rotation(Vector::new(turn.x, turn.y, turn.z))
            .can_sleep(can_sleep);
        let cube = ColliderBuilder::cuboid(0.5, 0.5, 0.5).friction(FRICTION);
        world.insert(body, cube).0
    };
    let handles = starts.iter().map(insert).collect();
    (world, handles)
}

/// Poses and velocities of rapier's bodies as ours are.
pub fn states(world: &PhysicsWorld, handles: &[RigidBodyHandle]) -> (Vec<f64>, Vec<f64>) {
    let (mut q, mut v) = (Vec::new(), Vec::new());
    for handle in handles {
        let body = &world.bodies[*handle];
        let (at, turn): (Vector, Turn) = (body.translation(), *body.rotation());
        q.extend([at.x, at.y, at.z, turn.w, turn.x, turn.y, turn.z]);
        let (linear, angular) = (body.linvel(), turn.inverse() * body.angvel());
        v.extend([linear.x, linear.y, linear.z, angular.x, angular.y, angular.z]);
    }
    (q, v)
}

/// A cube of 1 kg and 1 m has moments of a sixth.
fn lightness(count: usize) -> Vec<f64> {
    [1.0, 1.0, 1.0, 6.0, 6.0, 6.0].repeat(count)
}

/// What a step left; cubes turn freely at their spin.
pub fn seen(detector: &mut Detector, q: &[f64], before: &[f64], after: &[f64]) -> Left {
    let count = q.len() / 7;
    let kick = [0.0, 0.0, -GRAVITY * STEP, 0.0, 0.0, 0.0].repeat(count);
    let lightness = lightness(count);
    look(detector, &Seen { q, before, after, kick: &kick, lightness: &lightness, h: STEP })
}

/// How far the farthest has moved, m.
pub fn drift(q: &[f64], from: &[f64]) -> f64 {
    let moved = |(q, from): (&[f64], &[f64])| {
        (Vector3::from_column_slice(&q[..3]) - Vector3::from_column_slice(&from[..3])).norm()
    };
    q.chunks_exact(7).zip(from.chunks_exact(7)).map(moved).fold(0.0, f64::max)
}

/// The engines for some steps in turn.
fn in_turn(boxes: &Boxes, can_sleep: bool, before: f64, time: f64) -> Vec<Row> {
    let start = boxes.state.q.clone();
    let mut watch = boxes.detector().expect("colliders");
    let detector = boxes.detector().expect("colliders");
    let mut ours: Ours = SpatialWorld::new(boxes.system.clone(), detector).expect("a world");
    let mut state = boxes.state.clone();
    let (mut world, handles) = rapier(&boxes.starts, can_sleep);
    let mut third = Box3d::new(&boxes.starts, can_sleep);
    let asleep = if can_sleep { ", may sleep" } else { "" };
    let peers = ["rapier3d-f64", "box3d-rust"].map(|name| Row::named(&format!("{name}{asleep}")));
    let [second, last] = peers;
    let mut rows = [Row::named("ours"), second, last];
    let velocities = |p: &[f64]| -> Vec<f64> {
        p.iter().zip(lightness(start.len() / 7)).map(|(p, light)| p * light).collect()
    };
    let skipped = (before / STEP).round() as usize;
    for _ in 0..skipped {
        ours.step(&mut state, STEP).expect("a step");
        world.step();
        third.step();
    }
    for step in 1..=(time / STEP).round() as usize {
        let looks = step % LOOKS == 0;
        let was = looks.then(|| (state.clone(), states(&world, &handles), third.states()));
        rows[0].timed(|| ours.step(&mut state, STEP)).expect("a step");
        rows[1].timed(|| world.step());
        rows[2].timed(|| third.step());
        if let Some((own, (q, v), (q3, v3))) = was {
            let left = seen(&mut watch, &own.q, &velocities(&own.p.0), &velocities(&state.p.0));
            rows[0].left = rows[0].left.or_worse(left);
            let after = states(&world, &handles).1;
            rows[1].left = rows[1].left.or_worse(seen(&mut watch, &q, &v, &after));
            rows[2].left = rows[2].left.or_worse(seen(&mut watch, &q3, &v3, &third.states().1));
        }
    }
    rows[0].drift = drift(&state.q, &start);
    rows[1].drift = drift(&states(&world, &handles).0, &start);
    rows[2].drift = drift(&third.states().0, &start);
    rows.to_vec()
}

pub fn falling(count: usize, time: f64) -> Vec<Row> {
    in_turn(&falling_boxes(count).expect("boxes"), false, 0.0, time)
}

pub fn columns(columns: usize, high: usize, before: f64, time: f64) -> Vec<Row> {
    let boxes = columns_of_boxes(columns, high).expect("boxes");
    let mut rows = in_turn(&boxes, false, before, time);
    rows.extend(in_turn(&boxes, true, before, time));
    rows
}

/// A column whose boxes are set off by up to a thousandth.
pub fn leaning(high: usize) -> Boxes {
    let mut boxes = columns_of_boxes(1, high).expect("boxes");
    let mut random = SplitMix64::new(5);
    for (pose, start) in boxes.state.q.chunks_exact_mut(7).zip(&mut boxes.starts) {
        for k in 0..2 {
            pose[k] += 1e-3 * random.symmetric();
            start.translation[k] = pose[k];
        }
    }
    boxes
}

pub fn tower(high: usize, time: f64) -> Vec<Row> {
    in_turn(&leaning(high), false, 0.0, time)
}
