//! Rays, closest points, overlaps, groups and sensors against closed forms, and what they refuse.

use nalgebra::{Vector2, Vector3};
use stationary_contact::{
    Collider, ContactError, Detector, PlanarCollider, PlanarDetector, PlanarShape, Shape,
    SpatialWorld,
};
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PlanarMotion, PlanarRotation, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

fn vector(random: &mut SplitMix64) -> V {
    V::from_fn(|_, _| random.symmetric())
}

fn at(x: f64, y: f64, z: f64) -> RigidMotion {
    RigidMotion { translation: V::new(x, y, z), rotation: Rotation::identity() }
}

/// The shapes of which a point's side is known: whether it is outside, by a function that is zero on the surface.
type Outside = Box<dyn Fn(&V) -> f64>;

fn solids() -> Vec<(Shape, Outside)> {
    let corners: Vec<V> =
        (0..8).map(|k| V::from_fn(|i, _| if k >> i & 1 == 0 { -0.5 } else { 0.5 })).collect();
    vec![
        (Shape::ball(0.7).unwrap(), Box::new(|x| x.norm() - 0.7)),
        (
            Shape::cuboid([0.5, 0.3, 0.8]).unwrap(),
            Box::new(|x| (x.x.abs() - 0.5).max(x.y.abs() - 0.3).max(x.z.abs() - 0.8)),
        ),
        (Shape::convex(&corners).unwrap(), Box::new(|x| x.amax() - 0.5)),
        (
            Shape::capsule(0.6, 0.2).unwrap(),
            Box::new(|x| (x - V::z() * x.z.clamp(-0.6, 0.6)).norm() - 0.2),
        ),
        (
            Shape::cylinder(0.4, 0.6).unwrap(),
            Box::new(|x| (x.xy().norm() - 0.6).max(x.z.abs() - 0.4)),
        ),
        (
            Shape::cone(1.2, 0.5).unwrap(),
            Box::new(|x| (x.xy().norm() - 0.5 * (0.9 - x.z) / 1.2).max(-0.3 - x.z)),
        ),
        (
            Shape::ellipsoid([0.9, 0.5, 0.2]).unwrap(),
            Box::new(|x| x.component_div(&V::new(0.9, 0.5, 0.2)).norm() - 1.0),
        ),
        (Shape::half_space(V::z()).unwrap(), Box::new(|x| x.z)),
    ]
}

#[test]
fn rays_end_on_the_surface_they_meet_first_and_pass_what_they_do_not_meet() {
    let mut random = SplitMix64::new(31);
    for (shape, outside) in solids() {
        let (mut hits, mut misses) = (0, 0);
        for _ in 0..400 {
            let place = RigidMotion {
                translation: vector(&mut random),
                rotation: Rotation::exp(vector(&mut random) * 3.0),
            };
            let collider = Collider::fixed(place, shape.clone());
            let mut detector = Detector::new(vec![collider], 0).unwrap();
            let start = vector(&mut random) * 3.0;
            let way = place.translation + vector(&mut random) - start;
            let longest = way.norm() * 2.0;
            let d = way.normalize();
            let side = |t: f64| outside(&place.inverse().apply(&(start + d * t)));
            let hit = detector.cast_ray(&[], start, way * 7.0, longest).unwrap();
            let until = hit.map_or(longest, |hit| hit.distance);
            // Free before it, and at the surface there.
            for k in 0..200 {
                let t = until * f64::from(k) / 200.0;
                assert!(until == 0.0 || side(t) > -1e-12, "{shape:?}: {t} before {until}");
            }
            let Some(hit) = hit else {
                misses += 1;
                continue;
            };
            hits += 1;
            assert!((hit.point - start - d * hit.distance).norm() < 1e-12);
            assert!((hit.normal.norm() - 1.0).abs() < 1e-12 && hit.normal.dot(&d) <= 1e-9);
            match hit.distance == 0.0 {
                true => assert!(side(0.0) <= 1e-12 && (hit.normal + d).norm() < 1e-12),
                false => {
                    assert!(side(hit.distance).abs() < 1e-9, "{shape:?}: {}", side(hit.distance));
                    // A little outside along the normal, a little inside against it.
                    let off =
                        |by: f64| outside(&place.inverse().apply(&(hit.point + hit.normal * by)));
                    assert!(off(1e-5) > 0.0 && off(-1e-7) < 1e-9, "{shape:?}");
                }
            }
        }
        assert!(hits > 50 && misses > 20, "{shape:?}: {hits} {misses}");
    }
}

#[test]
fn round_solids_are_met_from_far_away_as_from_near() {
    for (shape, outside) in solids() {
        let mut random = SplitMix64::new(32);
        let mut detector =
            Detector::new(vec![Collider::fixed(at(0.0, 0.0, 0.0), shape)], 0).unwrap();
        for _ in 0..200 {
            let (d, aim) = (vector(&mut random).normalize(), vector(&mut random) * 0.2);
            let far = 10.0_f64.powf(5.0 * random.symmetric().abs()).max(6.0);
            if outside(&aim) > 0.0 || outside(&(aim - d * far)) < 0.0 {
                continue;
            }
            let hit = detector.cast_ray(&[], aim - d * far, d, 2.0 * far).unwrap().unwrap();
            let off = outside(&(aim + d * (hit.distance - far)));
            // A start so far away is rounded itself, and a ray may graze.
            assert!(off.abs() < 1e-10 * far, "{far}: {off}");
        }
    }
}

#[test]
fn a_ray_meets_the_nearest_of_many_and_the_side_of_a_mesh_that_it_comes_from() {
    let triangle = [V::new(-1.0, -1.0, 0.0), V::new(1.0, -1.0, 0.0), V::new(0.0, 1.0, 0.0)];
    let colliders = vec![
        Collider::fixed(at(0.0, 0.0, 1.0), Shape::mesh(&triangle, &[[0, 1, 2]]).unwrap()),
        Collider::on_body(0, Shape::ball(0.5).unwrap()),
        Collider::fixed(at(0.0, 0.0, -4.0), Shape::cuboid([1.0; 3]).unwrap()).as_sensor(),
    ];
    let mut detector = Detector::new(colliders, 1).unwrap();
    let q = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0];
    let mut cast = |z: f64, down: f64, longest: f64| {
        let hit = detector.cast_ray(&q, V::new(0.0, 0.0, z), V::z() * down, longest).unwrap();
        hit.map(|hit| (hit.collider, hit.distance, hit.normal.z))
    };
    assert_eq!(cast(3.0, -2.0, 10.0), Some((0, 2.0, 1.0)));
    assert_eq!(cast(0.9, 0.1, 10.0).map(|hit| (hit.0, hit.2)), Some((0, -1.0)));
    assert_eq!(cast(0.9, -0.1, 10.0).map(|hit| hit.0), Some(1));
    assert_eq!(cast(-1.0, -1.0, 10.0), Some((2, 2.0, 1.0)));
    assert_eq!(cast(-1.0, -1.0, 1.9), None);
    let bad = [
        detector.cast_ray(&q, V::new(f64::NAN, 0.0, 0.0), V::z(), 1.0),
        detector.cast_ray(&q, V::zeros(), V::zeros(), 1.0),
        detector.cast_ray(&q, V::zeros(), V::new(0.0, f64::INFINITY, 0.0), 1.0),
        detector.cast_ray(&q, V::zeros(), V::z(), -1.0),
        detector.cast_ray(&q, V::zeros(), V::z(), f64::NAN),
        detector.cast_ray(&q[..6], V::zeros(), V::z(), 1.0),
    ];
    assert!(matches!(bad[0], Err(ContactError::NonFinite { .. })));
    for bad in &bad[1..3] {
        assert!(matches!(bad, Err(ContactError::Length { shape: "ray", .. })), "{bad:?}");
    }
    assert!(bad[3..5].iter().all(|bad| matches!(bad, Err(ContactError::Margin(_)))));
    assert!(matches!(bad[5], Err(ContactError::Size(_))));
}

#[test]
fn rays_of_the_plane_end_on_discs_capsules_polygons_and_half_planes() {
    let mut random = SplitMix64::new(5);
    type Flat = Box<dyn Fn(&Vector2<f64>) -> f64>;
    let notched = [[0.0, 0.2], [0.8, -0.6], [0.8, 0.9], [-0.8, 0.9], [-0.8, -0.6]];
    let notched = notched.map(Vector2::from);
    let shapes: Vec<(PlanarShape, Flat)> = vec![
        (PlanarShape::disc(0.6).unwrap(), Box::new(|x| x.norm() - 0.6)),
        (
            PlanarShape::capsule(0.7, 0.3).unwrap(),
            Box::new(|x| (x - Vector2::x() * x.x.clamp(-0.7, 0.7)).norm() - 0.3),
        ),
        (
            PlanarShape::polygon(&notched).unwrap(),
            Box::new(|x| (x.x.abs() - 0.8).max(x.y - 0.9).max(0.2 - x.x.abs() - x.y)),
        ),
        (PlanarShape::half_plane(Vector2::y()).unwrap(), Box::new(|x| x.y)),
    ];
    for (shape, outside) in shapes {
        let mut hits = 0;
        for _ in 0..300 {
            let mut two = || Vector2::new(random.symmetric(), random.symmetric());
            let (translation, start, end) = (two(), two() * 3.0, two() * 3.0);
            let rotation = PlanarRotation::exp(3.0 * translation.x);
            let place = PlanarMotion { translation, rotation };
            let collider = PlanarCollider::fixed(place, shape.clone());
            let mut detector = PlanarDetector::new(vec![collider], 0).unwrap();
            let d = (end - start).normalize();
            let side = |t: f64| outside(&place.inverse().apply(&(start + d * t)));
            let hit = detector.cast_ray(&[], start, d, 6.0).unwrap();
            let until = hit.map_or(6.0, |hit| hit.distance);
            for k in 0..200 {
                let t = until * f64::from(k) / 200.0;
                assert!(until == 0.0 || side(t) > -1e-12, "{shape:?}: {t} before {until}");
            }
            if let Some(hit) = hit.filter(|hit| hit.distance > 0.0) {
                hits += 1;
                assert!(side(hit.distance).abs() < 1e-12, "{shape:?}: {}", side(hit.distance));
                assert!((hit.normal.norm() - 1.0).abs() < 1e-12 && hit.normal.dot(&d) <= 0.0);
            }
        }
        assert!(hits > 50, "{shape:?}: {hits}");
    }
}

#[test]
fn closest_points_and_overlaps_are_those_of_closed_forms() {
    let floor = Shape::half_space(V::z()).unwrap();
    let colliders = vec![
        Collider::on_body(0, Shape::ball(0.5).unwrap()),
        Collider::on_body(1, Shape::cuboid([1.0, 1.0, 0.25]).unwrap()),
        Collider::fixed(at(0.0, 0.0, -10.0), floor.clone()),
        Collider::fixed(at(0.0, 0.0, -11.0), floor),
    ];
    let mut detector = Detector::new(colliders, 2).unwrap();
    let q = [[0.0, 0.0, 100.0, 1.0, 0.0, 0.0, 0.0], [1.5, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0]].concat();
    let between = detector.closest_points(&q, [1, 0]).unwrap();
    // The ball is beside the box's edge at x = 0.5.
    let expected = (V::new(0.5, 0.0, 2.25) - V::new(0.0, 0.0, 100.0)).norm() - 0.5;
    assert!((between.gap - expected).abs() < 1e-12 * 100.0, "{between:?}");
    assert!((between.points[1] - between.points[0] - between.normal * between.gap).norm() < 1e-9);
    assert!((detector.closest_points(&q, [0, 2]).unwrap().gap - 109.5).abs() < 1e-10);
    assert!((detector.closest_points(&q, [1, 2]).unwrap().gap - 11.75).abs() < 1e-10);
    let planes = detector.closest_points(&q, [2, 3]);
    assert!(matches!(planes, Err(ContactError::NoQuery { .. })), "{planes:?}");
    assert!(matches!(detector.closest_points(&q, [0, 4]), Err(ContactError::Size(_))));
    let probe = Shape::capsule(0.5, 0.1).unwrap();
    let mut overlapping = |z: f64| detector.overlapping(&q, &probe, &at(1.5, 0.0, z));
    assert_eq!(overlapping(2.0).unwrap(), [1]);
    assert_eq!(overlapping(2.85 - 1e-9).unwrap(), [1]);
    assert!(overlapping(2.85 + 1e-9).unwrap().is_empty());
    assert_eq!(overlapping(-10.0).unwrap(), [2]);
    assert_eq!(overlapping(-10.7).unwrap(), [2, 3]);
    assert!(matches!(overlapping(f64::NAN), Err(ContactError::NonFinite { .. })));
}

/// Three balls fall: through a sensor onto a floor, past a floor of another group, and onto a floor of their own.
#[test]
fn groups_pass_through_each_other_and_sensors_feel_without_an_impulse() {
    let cuboid = || Shape::cuboid([1.0, 1.0, 0.1]).unwrap();
    let ball = |body: usize| Collider::on_body(body, Shape::ball(0.2).unwrap());
    let colliders = vec![
        ball(0),
        ball(1).in_groups(1, 1),
        ball(2).in_groups(2, 2),
        Collider::fixed(at(0.0, 0.0, -1.0), cuboid()),
        Collider::fixed(at(0.0, 0.0, -0.5), cuboid()).as_sensor(),
        Collider::fixed(at(10.0, 0.0, -1.0), cuboid()).in_groups(2, u32::MAX),
        Collider::fixed(at(20.0, 0.0, -1.0), cuboid()).in_groups(2, u32::MAX),
        // A hidden tile level with the last floor takes no part in its surface.
        Collider::fixed(at(22.0, 0.0, -1.0), cuboid()).in_groups(1, 1),
    ];
    let bodies = vec![Body::solid_ball(1.0, 0.2).unwrap(); 3];
    let motions = [0.0, 10.0, 20.0].map(|x| BodyMotion {
        pose: at(x, 0.0, 0.0),
        velocity: V::zeros(),
        angular_velocity: V::zeros(),
    });
    let metric = BodyMetric::<Poses>::new(bodies);
    let mut state = metric.state(&motions).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: V::zeros() }; 3];
    let weight = Weight { gravity: -V::z() * 9.81, masses, space: Poses };
    let system = metric.under(weight).unwrap();
    let detector = Detector::new(colliders.clone(), 3).unwrap();
    let mut world = SpatialWorld::new(system, detector).unwrap();
    let mut sensing = Detector::new(colliders, 3).unwrap();
    let mut felt = Vec::new();
    for _ in 0..100 {
        world.step(&mut state, 1e-2).unwrap();
        felt.extend(sensing.sensed(&state.q).unwrap());
    }
    felt.dedup();
    let heights = [2, 9, 16].map(|k| state.q[k]);
    assert!((heights[0] + 0.7).abs() < 1e-3 && (heights[2] + 0.7).abs() < 1e-3, "{heights:?}");
    assert!(heights[1] < -4.0, "{heights:?}");
    // It rests on the floor with the sensor above: it still reaches into that.
    assert_eq!(felt, [[0, 4]]);
}

#[test]
fn rays_keep_their_digits_from_any_distance_and_whatever_the_length_of_their_direction() {
    let (far, aim) = (1e8, 0.6);
    let mut ball =
        Detector::new(vec![Collider::fixed(at(0.0, 0.0, 0.0), Shape::ball(1.0).unwrap())], 0)
            .unwrap();
    let hit = ball.cast_ray(&[], Vector3::new(-far, aim, 0.0), Vector3::x(), 2.0 * far);
    let hit = hit.unwrap().unwrap();
    assert!((hit.distance - (far - 0.8)).abs() < 1e-7, "{}", hit.distance);
    assert!((hit.normal - Vector3::new(-0.8, aim, 0.0)).norm() < 1e-7, "{}", hit.normal);
    assert_eq!(ball.cast_ray(&[], Vector3::new(-far, aim, 0.0), Vector3::x(), 0.9 * far), Ok(None));
    for length in [1e-300, 1e-160, 1e160, 1e300] {
        let start = Vector3::new(-3.0, aim, 0.0);
        let hit = ball.cast_ray(&[], start, Vector3::x() * length, 5.0).unwrap().unwrap();
        assert!((hit.distance - 2.2).abs() < 1e-12, "{length:e}: {}", hit.distance);
    }
    for shape in [PlanarShape::disc(1.0).unwrap(), PlanarShape::capsule(1e-9, 1.0).unwrap()] {
        let fixed = PlanarCollider::fixed(PlanarMotion::identity(), shape);
        let mut disc = PlanarDetector::new(vec![fixed], 0).unwrap();
        let start = Vector2::new(-far, aim);
        let hit = disc.cast_ray(&[], start, Vector2::x(), 2.0 * far).unwrap().unwrap();
        assert!((hit.distance - (far - 0.8)).abs() < 1e-7, "{}", hit.distance);
    }
}
