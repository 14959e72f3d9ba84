//! Chains of boxes on ball joints that fall on a floor: ours, and rapier3d-f64 with joints between bodies and with
//! joints as coordinates.

use nalgebra::Vector3;
use rapier3d_f64::prelude::{
    ColliderBuilder, PhysicsWorld, RigidBodyBuilder, RigidBodyHandle, SphericalJointBuilder, Vector,
};
use stationary_calculus::Vector as Velocity;
use stationary_contact::problems::{FRICTION, GRAVITY};
use stationary_contact::{Collider, Detector, Kept, Shape, SpatialWorld, gap_rows};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Joint, JointEnd, JointKind, LieGroup, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

use crate::space::states;
use crate::{LOOKS, Row, STEP};

/// Half of a link between its joints, and half of its box, m.
const REACH: f64 = 0.2;
const HALF: [f64; 3] = [0.15, 0.05, 0.05];
/// How far the floor is below, m.
const BELOW: f64 = 0.5;

/// Where each link starts: chains side by side along a line, each hung by its first.
fn starts(chains: usize, links: usize) -> impl Iterator<Item = Vector3<f64>> {
    let at = move |i: usize| {
        let (chain, link) = (i / links, i % links);
        Vector3::new(REACH * (2 * link + 1) as f64, chain as f64, 0.0)
    };
    (0..chains * links).map(at)
}

fn at(place: Vector3<f64>) -> RigidMotion {
    RigidMotion { translation: place, rotation: Rotation::identity() }
}

type Ours = (SpatialWorld<Weight<Poses>>, State<Vec<f64>>, Vec<Joint<Poses>>);

fn detector(count: usize) -> Detector {
    let shape = Shape::cuboid(HALF).expect("a box");
    let mut colliders: Vec<_> =
        (0..count).map(|i| Collider::on_body(i, shape.clone()).with_friction(FRICTION)).collect();
    let floor = Shape::cuboid([1000.0, 1000.0, 1.0]).expect("a box");
    let floor = Collider::fixed(at(Vector3::z() * (-1.0 - BELOW)), floor);
    colliders.push(floor.with_friction(FRICTION));
    Detector::new(colliders, count).expect("colliders")
}

fn ours(chains: usize, links: usize) -> Ours {
    let count = chains * links;
    let bodies = vec![Body::solid_box(1.0, HALF).expect("a body"); count];
    let metric = BodyMetric::<Poses>::new(bodies);
    let motion = |place| BodyMotion {
        pose: at(place),
        velocity: Vector3::zeros(),
        angular_velocity: Vector3::zeros(),
    };
    let motions: Vec<_> = starts(chains, links).map(motion).collect();
    let state = metric.state(&motions).expect("a state");
    let joints = starts(chains, links).enumerate().map(|(i, place)| {
        let before = match i % links {
            0 => JointEnd::world(place - Vector3::x() * REACH),
            _ => JointEnd::on(i - 1, Vector3::x() * REACH),
        };
        let ends = [before, JointEnd::on(i, Vector3::x() * -REACH)];
        Joint::new(Poses, count, JointKind::Ball, ends).expect("a joint")
    });
    let joints = joints.collect();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }; count];
    let weight = Weight { gravity: Vector3::z() * -GRAVITY, masses, space: Poses };
    let system = metric.under(weight).expect("a system");
    (SpatialWorld::new(system, detector(count)).expect("a world"), state, joints)
}

fn rapier(chains: usize, links: usize, reduced: bool) -> (PhysicsWorld, Vec<RigidBodyHandle>) {
    let gravity = Vector::Z * -GRAVITY;
    let mut world = PhysicsWorld { gravity, ..PhysicsWorld::default() };
    world.integration_parameters.dt = STEP;
    let floor =
        ColliderBuilder::cuboid(1000.0, 1000.0, 1.0).translation(Vector::Z * (-1.0 - BELOW));
    world.insert(RigidBodyBuilder::fixed(), floor.friction(FRICTION));
    let insert = |place: Vector3<f64>| {
        let body = RigidBodyBuilder::dynamic()
            .translation(Vector::new(place.x, place.y, place.z))
            .can_sleep(false);
        let shape = ColliderBuilder::cuboid(HALF[0], HALF[1], HALF[2]).friction(FRICTION);
        world.insert(body, shape.mass(1.0)).0
    };
    let handles: Vec<RigidBodyHandle> = starts(chains, links).map(insert).collect();
    for (i, place) in starts(chains, links).enumerate() {
        let (before, anchor) = match i % links {
            // Of its own, as what hangs together is one system of coordinates.
            0 => {
                let from = Vector::new(place.x - REACH, place.y, place.z);
                let anchor = RigidBodyBuilder::fixed().translation(from);
                (world.insert_body(anchor), Vector::ZERO)
            }
            _ => (handles[i - 1], Vector::X * REACH),
        };
        let joint = SphericalJointBuilder::new().local_anchor1(anchor);
        let joint = joint.local_anchor2(Vector::X * -REACH);
        match reduced {
            true => drop(world.insert_multibody_joint(before, handles[i], joint)),
            false => drop(world.insert_impulse_joint(before, handles[i], joint)),
        }
    }
    (world, handles)
}

/// The widest joint of these poses, m.
fn open(q: &[f64], links: usize, chains: usize) -> f64 {
    let end = |i: usize, sign: f64| {
        let q = &q[7 * i..][..7];
        let turn = Rotation::from_quaternion([q[3], q[4], q[5], q[6]]).expect("a turn");
        Vector3::from_column_slice(&q[..3]) + turn.rotate(&(Vector3::x() * (sign * REACH)))
    };
    let apart = |(i, place): (usize, Vector3<f64>)| {
        let before = match i % links {
            0 => place - Vector3::x() * REACH,
            _ => end(i - 1, 1.0),
        };
        (end(i, -1.0) - before).norm()
    };
    starts(chains, links).enumerate().map(apart).fold(0.0, f64::max)
}

/// How fast what is within reach closes after a step once its gap is used up, m/s, and the deepest overlap, m.
fn closes(detector: &mut Detector, q: &[f64], after: &[f64]) -> [f64; 2] {
    let contacts = detector.detect(q, 0.02).expect("detection");
    let rows = gap_rows(contacts, q);
    let mut left = [0.0_f64; 2];
    for (i, contact) in contacts.iter().enumerate() {
        let closes = -rows.along(i, Velocity(after)) - contact.gap.max(0.0) / STEP;
        left = [left[0].max(closes), left[1].max(-contact.gap)];
    }
    left
}

/// Prints what each engine took and left.
pub fn print(chains: usize, links: usize, time: f64) {
    let (mut world, mut state, joints) = ours(chains, links);
    let mut peers = [false, true].map(|reduced| rapier(chains, links, reduced));
    let mut watch = detector(chains * links);
    let names = ["ours", "rapier3d-f64", "rapier3d-f64, joints as coordinates"];
    let mut rows = names.map(Row::named);
    let (mut opened, mut unsettled) = ([0.0_f64; 3], 0);
    let speeds = |p: &[f64]| -> Vec<f64> {
        let [a, b, c] = HALF.map(|half| half * half / 3.0);
        let light = [1.0, 1.0, 1.0, (b + c).recip(), (a + c).recip(), (a + b).recip()];
        p.iter().zip(light.iter().cycle()).map(|(p, light)| p * light).collect()
    };
    for step in 1..=(time / STEP).round() as usize {
        let was = [
            state.q.clone(),
            states(&peers[0].0, &peers[0].1).0,
            states(&peers[1].0, &peers[1].1).0,
        ];
        let report = rows[0].timed(|| world.step_with(&mut state, STEP, &Kept(&joints)));
        unsettled += usize::from(!report.expect("a step").settled);
        for (row, (peer, _)) in rows[1..].iter_mut().zip(&mut peers) {
            row.timed(|| peer.step());
        }
        if step % LOOKS != 0 {
            continue;
        }
        let [first, second] = [0, 1].map(|k| states(&peers[k].0, &peers[k].1));
        let now = [(state.q.clone(), speeds(&state.p.0)), first, second];
        for (k, ((q, v), was)) in now.iter().zip(&was).enumerate() {
            let [closes, overlap] = closes(&mut watch, was, v);
            rows[k].left.closes = rows[k].left.closes.max(closes);
            rows[k].left.overlap = rows[k].left.overlap.max(overlap);
            opened[k] = opened[k].max(open(q, links, chains));
        }
    }
    println!(
        "\n{chains} chains of {links} boxes on ball joints fall on a floor, {time} s; {unsettled} steps of ours not settled"
    );
    println!("| engine | time, s | over ours | closes, m/s | overlap, m | joints open, m |");
    println!("| --- | --- | --- | --- | --- | --- |");
    for (Row { name, time, left, .. }, open) in rows.iter().zip(opened) {
        println!(
            "| {name} | {time:.2} | {:.3} | {:.1e} | {:.1e} | {open:.1e} |",
            time / rows[0].time,
            left.closes,
            left.overlap
        );
    }
}
