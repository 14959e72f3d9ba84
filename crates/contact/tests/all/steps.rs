//! Steps that are too large, start in overlap, or pass by: what a world must not do.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{
    Collider, ContactError, Detector, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld,
    Shape, SpatialWorld, World,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Free, LieGroup, PlanarMotion, PlanarWeight, Poses, RigidMotion,
    Rotation,
};

const G: f64 = 10.0;

/// Boxes of 1 kg and 1 m in the plane, over a floor where there is gravity.
fn boxes(
    places: &[[f64; 2]],
    gravity: f64,
    friction: f64,
) -> (PlanarWorld<PlanarWeight>, State<Vec<f64>>) {
    let count = places.len();
    let metric = DiagonalMetric::new([1.0, 1.0, 1.0 / 6.0].repeat(count)).unwrap();
    let weight = PlanarWeight { gravity: Vector2::y() * -gravity, masses: vec![1.0; count] };
    let square = PlanarShape::cuboid([0.5; 2]).unwrap();
    let on = |body| PlanarCollider::on_body(body, square.clone()).with_friction(friction);
    let mut colliders: Vec<_> = (0..count).map(on).collect();
    if gravity > 0.0 {
        let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
        let floor = PlanarCollider::fixed(PlanarMotion::identity(), floor);
        colliders.push(floor.with_friction(friction));
    }
    let detector = PlanarDetector::new(colliders, count).unwrap();
    let world = World::new(System::new(metric, weight).unwrap(), detector).unwrap();
    let q: Vec<f64> = places.iter().flat_map(|&[x, y]| [x, y, 0.0]).collect();
    (world, State::new(q, Covector(vec![0.0; 3 * count])))
}

#[test]
fn boxes_that_overlap_are_lifted_and_gain_no_kinetic_energy_at_any_step() {
    for h in [1e-2, 1e-3, 1e-4] {
        let (mut world, mut state) = boxes(&[[0.0, 0.0], [0.1, 0.5]], 0.0, 0.5);
        for _ in 0..100 {
            let report = world.step(&mut state, h).unwrap();
            assert!(report.settled && report.lifting_energy == 0.0, "{report:?}");
            assert!(state.p.0.iter().all(|&p| p == 0.0), "{h}: {:?}", state.p.0);
        }
        assert!(world.detector().overlaps(&state.q, 1e-6).unwrap().is_empty(), "{h}");
        // Under gravity, what is lifted is the whole of the energy that comes in.
        let (mut world, mut state) = boxes(&[[0.0, 0.5], [0.0, 1.0]], G, 0.5);
        let energy = |s: &State<Vec<f64>>| {
            let kinetic: f64 = s.p.0.chunks(3).map(|p| p[0] * p[0] + p[1] * p[1]).sum();
            0.5 * kinetic + G * (s.q[1] + s.q[4])
        };
        let (before, mut lifted) = (energy(&state), 0.0);
        for _ in 0..100 {
            lifted += world.step(&mut state, h).unwrap().lifting_energy;
            assert!(energy(&state) <= before + lifted + 1e-9, "{h}");
        }
        assert!(lifted > 0.9 * 0.5 * G && lifted < 0.5 * G + 1e-6, "{h}: {lifted}");
    }
}

#[test]
fn a_disc_that_leaves_the_floor_is_not_rubbed_by_the_last_steps_impulse() {
    let metric = DiagonalMetric::new(vec![1.0, 1.0, 0.125]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::y() * -G, masses: vec![1.0] };
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::disc(0.5).unwrap()).with_friction(0.5),
        PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(0.5),
    ];
    let detector = PlanarDetector::new(colliders, 1).unwrap();
    let mut world = World::new(System::new(metric, weight).unwrap(), detector).unwrap();
    let mut state = State::new(vec![0.0, 0.5, 0.0], Covector(vec![1.0, 0.0, 0.0]));
    world.step(&mut state, 1e-3).unwrap();
    assert!(state.p.0[0] < 1.0);
    state.p.0[1] = 0.1;
    let before = state.clone();
    world.step(&mut state, 1e-3).unwrap();
    assert_eq!([state.p.0[0], state.p.0[2]], [before.p.0[0], before.p.0[2]]);
    assert!(world.touches().all(|touch| touch.friction.norm() == 0.0));
}

#[test]
fn what_flies_past_with_clearance_is_not_deflected_at_up_to_a_thousand_diameters_a_step() {
    for diameters in [0.3, 1.0, 3.0, 10.0, 100.0, 1000.0] {
        for clearance in [1e-3, 0.1, 0.5] {
            let (mut world, mut state) =
                boxes(&[[0.0, 0.0], [-0.4 * diameters - 1.0, 1.0 + clearance]], 0.0, 0.5);
            let h = 1e-2;
            state.p.0[3] = diameters / h;
            let before = state.p.0.clone();
            for _ in 0..3 {
                world.step(&mut state, h).unwrap();
            }
            assert_eq!(state.p.0, before, "{diameters} {clearance} in the plane");
            let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.1; 3]).unwrap(); 2]);
            let at = |x: f64, y: f64, speed: f64| BodyMotion {
                pose: RigidMotion {
                    translation: Vector3::new(x, y, 0.0),
                    rotation: Rotation::identity(),
                },
                velocity: Vector3::x() * speed,
                angular_velocity: Vector3::zeros(),
            };
            let far = -0.4 * diameters - 1.0;
            let motions = [at(0.0, 0.0, 0.0), at(far, 1.0 + clearance, diameters / h)];
            let mut state = metric.state(&motions).unwrap();
            let ball = Shape::ball(0.5).unwrap();
            let colliders = (0..2).map(|body| Collider::on_body(body, ball.clone())).collect();
            let detector = Detector::new(colliders, 2).unwrap();
            let free = metric.under(Free { freedoms: 12 }).unwrap();
            let mut world = SpatialWorld::new(free, detector).unwrap();
            let before = state.p.0.clone();
            for _ in 0..3 {
                world.step(&mut state, h).unwrap();
            }
            assert_eq!(state.p.0, before, "{diameters} {clearance} in space");
        }
    }
}

#[test]
fn a_bullet_that_flies_away_makes_no_contacts_of_those_it_leaves() {
    let mut places: Vec<[f64; 2]> =
        (0..100).map(|k| [1.5 * f64::from(k % 10), 1.5 * f64::from(k / 10)]).collect();
    places.push([30.0, 30.0]);
    let (mut world, mut state) = boxes(&places, 0.0, 0.5);
    state.p.0[300] = 1e4;
    let report = world.step(&mut state, 1e-2).unwrap();
    assert_eq!(report.contacts, 0, "{report:?}");
}

#[test]
fn a_step_beyond_the_residual_limit_fails_and_leaves_the_state() {
    let places: Vec<[f64; 2]> = (0..6).map(|k| [0.0, 0.5 + 0.999 * f64::from(k)]).collect();
    let (world, state) = boxes(&places, G, 0.5);
    let mut world = world.with_tolerance(1.0).unwrap().with_residual_limit(0.0).unwrap();
    let mut next = state.clone();
    next.p.0[0] = 3.0;
    let before = next.clone();
    let error = world.step(&mut next, 1e-3).unwrap_err();
    assert!(matches!(error, ContactError::NotConverged { .. }), "{error}");
    assert_eq!(next, before);
    for bad in [f64::NAN, -1.0] {
        let (world, _) = boxes(&places, G, 0.5);
        assert!(matches!(world.with_tolerance(bad), Err(ContactError::Settling(_))));
        let (world, _) = boxes(&places, G, 0.5);
        assert!(matches!(world.with_residual_limit(bad), Err(ContactError::Settling(_))));
    }
}

#[test]
fn however_loose_the_tolerance_what_moves_near_the_floor_keeps_its_weight() {
    let h = 1e-4;
    for tolerance in [1e-6, 1.0, 100.0] {
        let (world, mut state) = boxes(&[[0.0, 0.5 + 1e-6]], G, 0.5);
        let mut world = world.with_tolerance(tolerance).unwrap();
        state.p.0[1] = 0.2;
        for step in 1..=100 {
            world.step(&mut state, h).unwrap();
            let fallen = 0.2 - G * h * f64::from(step);
            assert!((state.p.0[1] - fallen).abs() < 1e-12, "{tolerance} {step}: {:?}", state.p.0);
        }
    }
}
