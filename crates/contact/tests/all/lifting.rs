//! Lifting out of overlap, in a pile.

use nalgebra::Vector3;
use stationary_contact::{Collider, Detector, Shape, SpatialWorld};
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

const STEP: f64 = 5e-3;
const RADIUS: f64 = 0.5;

/// Sixty-four balls of 1 kg in a grid that is too narrow for them by a fifth, each off its place a little, on a floor:
/// more than a hundred contacts. A step gives back a fifth of an overlap where nothing is in its way.
#[test]
fn a_pile_of_balls_that_overlap_comes_apart() {
    let mut random = SplitMix64::new(5);
    let still = Vector3::zeros();
    let one = |k: usize| {
        let cell = [k % 4, k / 4 % 4, k / 16].map(|c| 0.8 * c as f64);
        let off = Vector3::from_fn(|_, _| 0.02 * random.symmetric());
        let translation = Vector3::from(cell) + Vector3::z() * 0.45 + off;
        let pose = RigidMotion { translation, rotation: Rotation::identity() };
        BodyMotion { pose, velocity: still, angular_velocity: still }
    };
    let starts: Vec<_> = (0..64).map(one).collect();
    let count = starts.len();
    let ball = Body::solid_ball(1.0, RADIUS).unwrap();
    let metric = BodyMetric::new(vec![ball; count]);
    let mut state = metric.state(&starts).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: still }; count];
    let weight = Weight { gravity: -Vector3::z() * 9.81, masses, space: Poses };
    let shape = Shape::ball(RADIUS).unwrap();
    let on_body = |body| Collider::on_body(body, shape.clone()).with_friction(0.5);
    let floor = Shape::half_space(Vector3::z()).unwrap();
    let floor = Collider::fixed(RigidMotion::identity(), floor).with_friction(0.5);
    let colliders = (0..count).map(on_body).chain([floor]).collect();
    let detector = Detector::new(colliders, count).unwrap();
    let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
    let overlaps: Vec<f64> =
        (0..60).map(|_| world.step(&mut state, STEP).unwrap().overlap).collect();
    println!("{:e} m of {:e} m are left", overlaps[59], overlaps[0]);
    assert!(overlaps[0] > 0.2 && overlaps[59] < 1e-3, "{} {}", overlaps[0], overlaps[59]);
}
