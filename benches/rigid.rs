//! Rotations against nalgebra's, and a step of many free bodies.
//!
//! `cargo bench --bench rigid` prints the median ratio of times, ours over nalgebra's, for exp,
//! log, composition and the rotation of a vector over random turns, with its quartiles; then
//! nanoseconds a body and step for a thousand tumbling boxes, with the energy error that they were
//! bought with.

mod in_turn;

use std::f64::consts::PI;
use std::hint::black_box;
use std::time::Instant;

use nalgebra::{UnitQuaternion, Vector3};
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMethod, BodyMetric, BodyMotion, Free, LieGroup, Poses, RigidMotion, Rotation,
    right_jacobian,
};

/// Turns of one measurement.
const TURNS: usize = 10_000;

/// Random axes with angles up to `largest`.
fn turns(largest: f64) -> Vec<Vector3<f64>> {
    let mut random = SplitMix64::new(1);
    let mut number = || random.symmetric();
    let one = |_| Vector3::new(number(), number(), number()) * (largest / 3.0_f64.sqrt());
    (0..TURNS).map(one).collect()
}

fn each<T>(of: &[T], see: impl FnMut(&T)) {
    of.iter().for_each(see);
}

fn against_nalgebra(name: &str, theta: &[Vector3<f64>]) {
    let ours: Vec<Rotation> = theta.iter().map(|&v| Rotation::exp(v)).collect();
    let theirs: Vec<_> = theta.iter().map(|&v| UnitQuaternion::from_scaled_axis(v)).collect();
    in_turn::ratio(
        &format!("exp, {name}"),
        || each(theta, |&v| _ = black_box(Rotation::exp(v))),
        || each(theta, |&v| _ = black_box(UnitQuaternion::from_scaled_axis(v))),
    );
    in_turn::ratio(
        &format!("log, {name}"),
        || each(&ours, |r| _ = black_box(r.log())),
        || each(&theirs, |r| _ = black_box(r.scaled_axis())),
    );
    in_turn::ratio(
        &format!("composition, {name}"),
        || ours.windows(2).for_each(|w| _ = black_box(w[0].compose(&w[1]))),
        || theirs.windows(2).for_each(|w| _ = black_box(w[0] * w[1])),
    );
    in_turn::ratio(
        &format!("rotation of a vector, {name}"),
        || ours.iter().zip(theta).for_each(|(r, v)| _ = black_box(r.rotate(v))),
        || theirs.iter().zip(theta).for_each(|(r, v)| _ = black_box(r * v)),
    );
    in_turn::ratio(
        &format!("T over nalgebra's exp, {name}"),
        || each(theta, |v| _ = black_box(right_jacobian(v))),
        || each(theta, |&v| _ = black_box(UnitQuaternion::from_scaled_axis(v))),
    );
}

/// Nanoseconds a body and step, the median of seven runs, and the largest relative energy error.
fn many_boxes(method: BodyMethod) -> (f64, f64) {
    const BODIES: usize = 1_000;
    const STEPS: usize = 1_000;
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).expect("a box");
    let metric = BodyMetric::<Poses>::new(vec![body; BODIES]);
    let mut random = SplitMix64::new(2);
    let mut number = || random.symmetric();
    let motions: Vec<BodyMotion> = (0..BODIES)
        .map(|_| BodyMotion {
            pose: RigidMotion::identity(),
            velocity: Vector3::new(number(), number(), number()),
            angular_velocity: Vector3::new(1.0, 2.0, 3.0)
                + Vector3::new(number(), number(), number()) * 0.1,
        })
        .collect();
    let initial = metric.state(&motions).expect("finite motions");
    let system = metric.under(Free { freedoms: 6 * BODIES }).expect("as many freedoms");
    let mut integrator = method.integrator(&system).expect("a method of bodies");
    let mut times = Vec::new();
    let mut state = initial.clone();
    for _ in 0..7 {
        state = initial.clone();
        let start = Instant::now();
        for _ in 0..STEPS {
            integrator.step(&mut state, 1e-3).expect("a step of a millisecond");
        }
        times.push(start.elapsed().as_secs_f64() * 1e9 / (BODIES * STEPS) as f64);
    }
    times.sort_by(f64::total_cmp);
    let energy = |k: usize, p: &[f64]| -> f64 {
        let m = Vector3::from_column_slice(&p[6 * k + 3..][..3]);
        m.dot(&body.angular_velocity(&m))
    };
    let error = |k: usize| (energy(k, &state.p.0) / energy(k, &initial.p.0) - 1.0).abs();
    (times[3], (0..BODIES).map(error).fold(0.0, f64::max))
}

fn main() {
    against_nalgebra("turns up to pi", &turns(PI));
    against_nalgebra("turns up to 0.01", &turns(0.01));
    println!("\na thousand free boxes, a thousand steps of 1 ms");
    for &method in BodyMethod::ALL {
        let (nanoseconds, error) = many_boxes(method);
        println!(
            "{:22} {nanoseconds:8.1} ns a body and step, energy {error:.1e}",
            method.to_string()
        );
    }
}
