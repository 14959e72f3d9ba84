//! Boxes of any size: contacts and stacks of 1e-6 m to 1e6 m are those of a metre.

use nalgebra::Vector3;
use stationary_contact::{Collider, Detector, Shape, SpatialWorld};
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

const SIZES: [f64; 8] = [1e-6, 2e-6, 3e-5, 1e-4, 1e-2, 1.0, 1e3, 1e6];

fn vector(random: &mut SplitMix64) -> V {
    V::from_fn(|_, _| random.symmetric())
}

/// The gaps and places of the contacts of two boxes, as parts of the size.
fn contacts(size: f64, halves: [V; 2], pose: &RigidMotion) -> Vec<[f64; 4]> {
    let shape = |half: V| Shape::cuboid((half * size).into()).unwrap();
    let fixed = Collider::fixed(
        RigidMotion { translation: V::zeros(), rotation: Rotation::identity() },
        shape(halves[0]),
    );
    let mut detector =
        Detector::new(vec![fixed, Collider::on_body(0, shape(halves[1]))], 1).unwrap();
    let t = pose.translation * size;
    let q: Vec<f64> = [t.x, t.y, t.z].into_iter().chain(pose.rotation.quaternion()).collect();
    let found = detector.detect(&q, 0.5 * size).unwrap();
    let place = |p: V, gap: f64| [p.x / size, p.y / size, p.z / size, gap / size];
    found.iter().map(|c| place(c.points[0], c.gap)).collect()
}

#[test]
fn boxes_of_any_size_have_the_contacts_of_boxes_of_a_metre() {
    let mut random = SplitMix64::new(5);
    let mut seen = 0;
    for k in 0..400 {
        let mut half = || vector(&mut random) * 0.3 + V::repeat(0.7);
        let halves = [half(), half()];
        let tilt = [V::zeros(), vector(&mut random) * 1e-9, vector(&mut random) * 2.0][k % 3];
        let yaw = Rotation::exp(V::z() * (3.0 * random.symmetric()) + tilt);
        let mut translation = vector(&mut random);
        // On top of each other, to rounding or a little apart.
        translation.z = halves[0].z + halves[1].z + [0.0, 0.01, 0.3, -0.01][k % 4];
        let pose = RigidMotion { translation, rotation: yaw };
        let expected = contacts(1.0, halves, &pose);
        for size in SIZES {
            let found = contacts(size, halves, &pose);
            assert_eq!(
                found.len(),
                expected.len(),
                "case {k}, size {size}: {found:?} {expected:?}"
            );
            let near =
                |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9);
            let all = expected.iter().all(|b| found.iter().any(|a| near(a, b)));
            assert!(all, "case {k}, size {size}: {found:?} {expected:?}");
        }
        seen += expected.len();
    }
    assert!(seen > 1000, "{seen}");
}

#[test]
fn stacks_of_cubes_of_any_size_stand() {
    const G: f64 = 10.0;
    for size in SIZES {
        let mass = 1e3 * size.powi(3);
        let moment = mass * size * size / 6.0;
        let cubes = 4;
        let metric = BodyMetric::<Poses>::new(vec![Body::new(mass, [moment; 3]).unwrap(); cubes]);
        let motion = |k: usize| BodyMotion {
            pose: RigidMotion {
                translation: V::new(0.1 * size * (k % 2) as f64, 0.0, size * (k as f64 + 0.5)),
                rotation: Rotation::exp(V::z() * (0.3 * k as f64)),
            },
            velocity: V::zeros(),
            angular_velocity: V::zeros(),
        };
        let start = metric.state(&(0..cubes).map(motion).collect::<Vec<_>>()).unwrap();
        let masses = vec![PointMass { mass, point: V::zeros() }; cubes];
        let weight = Weight { gravity: -V::z() * G, masses, space: Poses };
        let cube = Shape::cuboid([0.5 * size; 3]).unwrap();
        let mut colliders: Vec<_> =
            (0..cubes).map(|k| Collider::on_body(k, cube.clone()).with_friction(0.5)).collect();
        let below = RigidMotion { translation: -V::z() * size, rotation: Rotation::identity() };
        colliders
            .push(Collider::fixed(below, Shape::cuboid([3.0 * size, 3.0 * size, size]).unwrap()));
        let detector = Detector::new(colliders, cubes).unwrap();
        let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
        let mut state = start.clone();
        for _ in 0..100 {
            // A step of free fall is a thousandth of a cube.
            world.step(&mut state, 1e-2 * size.sqrt()).unwrap();
        }
        let moved = state.q.chunks_exact(7).zip(start.q.chunks_exact(7));
        let moved = moved.flat_map(|(a, b)| (0..3).map(|k| (a[k] - b[k]).abs()));
        let moved = moved.fold(0.0, f64::max) / size;
        assert!(moved < 1e-6, "cubes of {size} m move by {moved} of that");
    }
}
