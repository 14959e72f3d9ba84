//! Seams of gently curved ground: what slides over them loses what the bends take and no more.
//!
//! ```text
//! v+ >= v- cos b                     at each bend by an angle b, without friction
//! ```

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    Collider, Detector, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld, Shape,
    SpatialWorld,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PlanarMotion, PlanarWeight, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

const G: f64 = 10.0;
const SPEED: f64 = 5.0;
const STEP: f64 = 2.5e-3;
const STEPS: usize = 100;

/// The most that gravity, bends and steps may change of half a square of the speed, m^2/s^2: heights
/// between first and last place, and for each of eight lines of seams its bend.
fn allowed(curvature: f64) -> f64 {
    let bend = curvature * 0.7;
    8.0 * 0.5 * (SPEED * bend).powi(2) + 0.1 * SPEED * SPEED * curvature
}

/// Places in order, random between.
fn lines(random: &mut SplitMix64) -> Vec<f64> {
    let mut lines: Vec<f64> = (0..9).map(|k| -2.0 + 0.625 * f64::from(k)).collect();
    lines[1..8].iter_mut().for_each(|x| *x += 0.2 * random.symmetric());
    lines
}

#[test]
fn what_slides_over_a_gently_curved_mesh_keeps_its_energy_but_for_the_bends() {
    let mut random = SplitMix64::new(91);
    let mut worst = 0.0_f64;
    for k in 0..100 {
        let curvature = [0.0, 1e-3, 1e-2, 3e-2][k % 4] * if k / 4 % 2 == 0 { 1.0 } else { -1.0 };
        let height = |x: f64| -0.5 * curvature * x * x;
        let (xs, ys) = (lines(&mut random), [-2.0, -0.3 * random.symmetric().abs(), 0.4, 2.0]);
        let vertices: Vec<V> =
            xs.iter().flat_map(|&x| ys.map(|y| V::new(x, y, height(x)))).collect();
        let mut triangles = Vec::new();
        for i in 0..xs.len() as u32 - 1 {
            for j in 0..3 {
                let [a, b, c, d] = [4 * i + j, 4 * i + 4 + j, 4 * i + 5 + j, 4 * i + 1 + j];
                triangles.extend(match random.bits() % 2 {
                    0 => [[a, b, c], [a, c, d]],
                    _ => [[a, b, d], [b, c, d]],
                });
            }
        }
        let ground = Shape::mesh(&vertices, &triangles).unwrap();
        let radius = 0.2 + 0.1 * random.symmetric();
        let (shape, up) = match k / 8 % 3 {
            0 => (Shape::ball(radius).unwrap(), radius),
            1 => (Shape::cuboid([radius, radius, 0.2]).unwrap(), 0.2),
            _ => (Shape::capsule(radius, 0.15).unwrap(), 0.15 + radius),
        };
        let name = shape.name();
        let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.1, 0.12]).unwrap()]);
        let pose = RigidMotion {
            translation: V::new(0.0, 0.0, up + 0.02 * curvature.abs()),
            rotation: Rotation::identity(),
        };
        let motion = BodyMotion { pose, velocity: V::x() * SPEED, angular_velocity: V::zeros() };
        let mut state = metric.state(&[motion]).unwrap();
        let masses = vec![PointMass { mass: 1.0, point: V::zeros() }];
        let weight = Weight { gravity: -V::z() * G, masses, space: Poses };
        let ground = Collider::fixed(RigidMotion::identity(), ground);
        let colliders = vec![ground, Collider::on_body(0, shape).with_friction(0.0)];
        let detector = Detector::new(colliders, 1).unwrap();
        let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
        let energy = |state: &State<Vec<f64>>| {
            let moving: f64 = state.p.0[..3].iter().map(|p| p * p).sum();
            let turning =
                (state.p.0[3].powi(2) + state.p.0[4].powi(2)) / 0.1 + state.p.0[5].powi(2) / 0.12;
            0.5 * (moving + turning) + G * state.q[2]
        };
        let start = energy(&state);
        for _ in 0..STEPS {
            world.step(&mut state, STEP).unwrap();
        }
        let lost = (energy(&state) - start).abs();
        worst = worst.max(lost);
        let bound = if curvature == 0.0 { 1e-9 * SPEED * SPEED } else { allowed(curvature.abs()) };
        assert!(lost <= bound, "{k}: a {name}, curvature {curvature}: {lost:e} of {bound:e}");
    }
    println!("at most {worst:e} J of {} J", 0.5 * SPEED * SPEED);
}

#[test]
fn what_slides_over_a_polyline_of_the_plane_keeps_its_energy_but_for_the_bends() {
    let mut random = SplitMix64::new(92);
    for k in 0..300 {
        let curvature = [0.0, 1e-3, 1e-2, 3e-2][k % 4] * if k / 4 % 2 == 0 { 1.0 } else { -1.0 };
        let height = |x: f64| -0.5 * curvature * x * x;
        let xs = lines(&mut random);
        let mut colliders: Vec<_> = xs
            .windows(2)
            .map(|x| {
                let corners =
                    [[x[0], -1.0], [x[1], -1.0], [x[1], height(x[1])], [x[0], height(x[0])]];
                let corners = corners.map(|[x, y]| Vector2::new(x, y));
                let tile = PlanarShape::polygon(&corners).unwrap();
                PlanarCollider::fixed(PlanarMotion::identity(), tile)
            })
            .collect();
        let (shape, up) = match k / 8 % 3 {
            0 => (PlanarShape::disc(0.25).unwrap(), 0.25),
            1 => (PlanarShape::cuboid([0.2, 0.25]).unwrap(), 0.25),
            _ => (PlanarShape::capsule(0.2, 0.15).unwrap(), 0.15),
        };
        let name = shape.name();
        colliders.push(PlanarCollider::on_body(0, shape).with_friction(0.0));
        let metric = DiagonalMetric::new(vec![1.0, 1.0, 0.1]).unwrap();
        let weight = PlanarWeight { gravity: -Vector2::y() * G, masses: vec![1.0] };
        let system = System::new(metric, weight).unwrap();
        let detector = PlanarDetector::new(colliders, 1).unwrap();
        let mut world = PlanarWorld::new(system, detector).unwrap();
        let above = up + 0.03 * curvature.abs();
        let mut state = State::new(vec![0.0, above, 0.0], Covector(vec![SPEED, 0.0, 0.0]));
        let energy = |state: &State<Vec<f64>>| {
            let [x, y, turn] = [0, 1, 2].map(|c| state.p.0[c]);
            0.5 * (x * x + y * y + turn * turn / 0.1) + G * state.q[1]
        };
        let start = energy(&state);
        for _ in 0..STEPS {
            world.step(&mut state, STEP).unwrap();
        }
        let lost = (energy(&state) - start).abs();
        let bound = if curvature == 0.0 { 1e-9 * SPEED * SPEED } else { allowed(curvature.abs()) };
        assert!(lost <= bound, "{k}: a {name}, curvature {curvature}: {lost:e} of {bound:e}");
    }
}
