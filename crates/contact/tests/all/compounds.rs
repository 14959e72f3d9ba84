//! Compounds: several convex colliders of one body.

use nalgebra::Vector3;
use stationary_contact::{Collider, Detector, Shape, SpatialWorld};
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PointMass, Poses, RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

fn at(x: f64, y: f64, z: f64) -> RigidMotion {
    RigidMotion { translation: V::new(x, y, z), rotation: Rotation::identity() }
}

/// A top and four round legs, its centre of mass 0.6 m above the feet.
fn table(body: usize) -> Vec<Collider> {
    let leg = Shape::cylinder(0.3, 0.05).unwrap();
    let top = Shape::cuboid([0.5, 0.5, 0.05]).unwrap();
    let place = |shape: &Shape, place: RigidMotion| Collider {
        place,
        ..Collider::on_body(body, shape.clone()).with_friction(0.5)
    };
    let corners = [[0.4, 0.4], [0.4, -0.4], [-0.4, 0.4], [-0.4, -0.4]];
    let legs = corners.iter().map(|[x, y]| place(&leg, at(*x, *y, -0.3)));
    legs.chain([place(&top, at(0.0, 0.0, 0.05))]).collect()
}

#[test]
fn two_tables_of_five_solids_each_stand_on_each_other_and_the_feet_carry_both() {
    const G: f64 = 10.0;
    const STEP: f64 = 1e-3;
    let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1, 0.1, 0.12]).unwrap(); 2]);
    let still = |z: f64| BodyMotion {
        pose: at(0.0, 0.0, z),
        velocity: V::zeros(),
        angular_velocity: V::zeros(),
    };
    // The top of a table is 0.7 m high.
    let mut state = metric.state(&[still(0.6), still(1.3)]).unwrap();
    let start = state.clone();
    let masses = vec![PointMass { mass: 1.0, point: V::zeros() }; 2];
    let weight = Weight { gravity: -V::z() * G, masses, space: Poses };
    let floor = Shape::half_space(V::z()).unwrap();
    let floor = Collider::fixed(RigidMotion::identity(), floor).with_friction(0.5);
    let colliders = [table(0), table(1), vec![floor]].concat();
    let detector = Detector::new(colliders, 2).unwrap();
    let mut world = SpatialWorld::new(metric.under(weight).unwrap(), detector).unwrap();
    for _ in 0..500 {
        world.step(&mut state, STEP).unwrap();
    }
    let moved = state.q.iter().zip(&start.q).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(moved < 1e-9, "{moved:e}");
    // No solid touches another of its own body, and the feet carry both tables about their middle.
    let (mut sum, mut lever) = (0.0, V::zeros());
    for touch in world.touches() {
        let [a, b] = touch.contact.id.colliders;
        assert_ne!(a / 5, b / 5);
        if b == 10 {
            assert!(a < 4, "a foot of the lower table");
            sum += touch.normal;
            lever += touch.contact.points[1] * touch.normal;
        }
    }
    assert!((sum / (2.0 * G * STEP) - 1.0).abs() < 1e-6, "{sum}");
    assert!(lever.norm() < 1e-6 * sum, "{lever:?}");
}
