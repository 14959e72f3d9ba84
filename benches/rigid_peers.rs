//! Rigid motion in turn with other people's: the crates `rapier3d-f64` and `sophus_lie`.
//!
//! `cargo bench --bench rigid_peers --features peers` prints, first, by how much `sophus_lie`'s
//! left Jacobian of SO(3) is off from a sum of its series at several angles, and where it is right
//! the ratio of times; then for a thousand free boxes over a thousand steps of a millisecond the
//! ratio of times a body and step, with the errors of energy and angular momentum that each time
//! has bought. No collider is there, no body may fall asleep, and `rapier` runs on one thread, as
//! we do.

mod in_turn;

use std::hint::black_box;
use std::time::Instant;

use nalgebra::{Matrix3, Vector3};
use rapier3d_f64::prelude as rapier;
use sophus_lie::Rotation3F64;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, BodyStore, Free, LieGroup, Poses,
    RigidMotion, left_jacobian,
};

/// `sum_k [theta]^k / (k + 1)!`
fn series(theta: &Vector3<f64>) -> Matrix3<f64> {
    let hat = theta.cross_matrix();
    let mut term = Matrix3::identity();
    let mut sum = term;
    for k in 1..60 {
        term = term * hat / f64::from(k + 1);
        sum += term;
    }
    sum
}

/// The largest error of a left Jacobian beyond the identity, relative to what is there.
fn off(theta: &Vector3<f64>, matrix: Matrix3<f64>) -> f64 {
    // Across the diagonal: there no 1 hides it.
    let twist = |m: Matrix3<f64>| m - m.transpose();
    let right = twist(series(theta));
    (twist(matrix) - right).amax() / right.amax()
}

fn left_jacobians() {
    println!("left Jacobian of SO(3): errors of what differs from the identity");
    for angle in [1e-8, 1e-6, 1e-4, 9e-4, 1.1e-3, 1e-2, 1.0, 3.0] {
        let theta = Vector3::new(0.36, -0.48, 0.8) * angle;
        let theirs = Rotation3F64::left_jacobian([theta.x, theta.y, theta.z].into());
        let theirs = Matrix3::from_fn(|i, j| theirs[(i, j)]);
        println!(
            "  angle {angle:7.1e}   ours {:.1e}   sophus_lie {:.1e}",
            off(&theta, left_jacobian(&theta)),
            off(&theta, theirs)
        );
    }
    let mut random = SplitMix64::new(1);
    let mut number = || 1.8 * random.symmetric();
    let ours: Vec<Vector3<f64>> =
        (0..10_000).map(|_| Vector3::new(number(), number(), number())).collect();
    let theirs: Vec<_> = ours.iter().map(|v| [v.x, v.y, v.z].into()).collect();
    in_turn::ratio(
        "left Jacobian over sophus_lie's, turns up to pi",
        || ours.iter().for_each(|v| _ = black_box(left_jacobian(v))),
        || theirs.iter().for_each(|v| _ = black_box(Rotation3F64::left_jacobian(*v))),
    );
}

const BODIES: usize = 1_000;
const STEPS: usize = 1_000;
const STEP: f64 = 1e-3;

fn body() -> Body {
    Body::solid_box(1.0, [0.1, 0.2, 0.3]).expect("a box")
}

/// How each box starts: about as MuJoCo's own tumbling box.
fn motions() -> Vec<BodyMotion> {
    let mut random = SplitMix64::new(2);
    let mut vector = || Vector3::from_fn(|_, _| random.symmetric());
    let one = |_| BodyMotion {
        pose: RigidMotion::identity(),
        velocity: vector(),
        angular_velocity: Vector3::new(1.0, 2.0, 3.0) + vector() * 0.1,
    };
    (0..BODIES).map(one).collect()
}

/// The largest relative errors of energy and spatial angular momentum, over all boxes.
#[derive(Clone, Copy, Default)]
struct Errors {
    energy: f64,
    momentum: f64,
}

impl Errors {
    /// Takes account of a box that now has this angular momentum (world) and angular velocity.
    fn see(&mut self, start: &BodyMotion, spin: Vector3<f64>, twice_energy: f64) {
        let body = body();
        let w = start.angular_velocity;
        let before = start.pose.rotation.rotate(&body.angular_momentum(&w));
        let energy = w.dot(&body.angular_momentum(&w));
        self.energy = self.energy.max((twice_energy / energy - 1.0).abs());
        self.momentum = self.momentum.max((spin - before).norm() / before.norm());
    }
}

fn their_world(motions: &[BodyMotion]) -> (rapier::PhysicsWorld, Vec<rapier::RigidBodyHandle>) {
    let vector = |v: Vector3<f64>| rapier::Vector::new(v.x, v.y, v.z);
    let mut world = rapier::PhysicsWorld::new();
    world.gravity = rapier::Vector::ZERO;
    world.integration_parameters.dt = STEP;
    let (mass, moments) = (body().mass(), vector(body().moments()));
    let properties = rapier::MassProperties::new(rapier::Vector::ZERO, mass, moments);
    let insert = |motion: &BodyMotion| {
        let body = rapier::RigidBodyBuilder::dynamic()
            .additional_mass_properties(properties)
            .linvel(vector(motion.velocity))
            .angvel(vector(motion.angular_velocity))
            .can_sleep(false);
        world.bodies.insert(body)
    };
    let handles = motions.iter().map(insert).collect();
    (world, handles)
}

fn their_errors(
    motions: &[BodyMotion],
    (world, handles): &(rapier::PhysicsWorld, Vec<rapier::RigidBodyHandle>),
) -> Errors {
    let mut errors = Errors::default();
    for (motion, handle) in motions.iter().zip(handles) {
        let one = &world.bodies[*handle];
        let w = one.rotation().inverse() * one.angvel();
        let w = Vector3::new(w.x, w.y, w.z);
        let m = body().angular_momentum(&w);
        let spin = *one.rotation() * rapier::Vector::new(m.x, m.y, m.z);
        errors.see(motion, Vector3::new(spin.x, spin.y, spin.z), w.dot(&m));
    }
    errors
}

fn free_boxes() {
    println!("\na thousand free boxes, a thousand steps of 1 ms");
    let motions = motions();
    let mut world = their_world(&motions);
    let start = Instant::now();
    (0..STEPS).for_each(|_| world.0.step());
    let per_step = |start: Instant| start.elapsed().as_secs_f64() * 1e9 / (BODIES * STEPS) as f64;
    let (time, errors) = (per_step(start), their_errors(&motions, &world));
    let show = |name: &str, time: f64, errors: Errors| {
        println!(
            "  {name:22} {time:8.1} ns a body and step, energy {:.1e}, angular momentum {:.1e}",
            errors.energy, errors.momentum
        );
    };
    show("rapier3d-f64", time, errors);
    let mut store =
        BodyStore::new(vec![body(); BODIES], &motions, Vector3::zeros()).expect("finite motions");
    let start = Instant::now();
    (0..STEPS).for_each(|_| store.step(STEP).expect("a step of a millisecond"));
    let (time, mut errors) = (per_step(start), Errors::default());
    for (k, motion) in motions.iter().enumerate() {
        let now = store.motion(k).expect("as many bodies");
        let m = body().angular_momentum(&now.angular_velocity);
        errors.see(motion, now.pose.rotation.rotate(&m), now.angular_velocity.dot(&m));
    }
    show("store", time, errors);
    in_turn::ratio(
        "  store over rapier3d-f64",
        || (0..STEPS / 10).for_each(|_| store.step(STEP).expect("a step of a millisecond")),
        || (0..STEPS / 10).for_each(|_| world.0.step()),
    );
    let metric = BodyMetric::<Poses>::new(vec![body(); BODIES]);
    let initial = metric.state(&motions).expect("finite motions");
    let system = metric.under(Free { freedoms: 6 * BODIES }).expect("as many freedoms");
    for &method in BodyMethod::ALL {
        let mut integrator = method.integrator(&system).expect("a method of bodies");
        let mut state = initial.clone();
        let start = Instant::now();
        for _ in 0..STEPS {
            integrator.step(&mut state, STEP).expect("a step of a millisecond");
        }
        let time = per_step(start);
        let mut errors = Errors::default();
        for (k, motion) in motions.iter().enumerate() {
            let m = Vector3::from_column_slice(&state.p.0[6 * k + 3..][..3]);
            let spin = Poses::pose_at(&state.q, k).rotation.rotate(&m);
            errors.see(motion, spin, m.dot(&body().angular_velocity(&m)));
        }
        show(method.facts().name, time, errors);
        // A tenth of the steps in turn, so that a machine that slows down slows both.
        in_turn::ratio(
            &format!("  {method} over rapier3d-f64"),
            || {
                for _ in 0..STEPS / 10 {
                    integrator.step(&mut state, STEP).expect("a step of a millisecond");
                }
            },
            || (0..STEPS / 10).for_each(|_| world.0.step()),
        );
    }
}

fn main() {
    left_jacobians();
    free_boxes();
}
