//! Steps chosen by error: what comes out is as good as was asked.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, Metric, System};
use stationary_contact::{
    Collider, ContactError, Detector, ErrorControlled, EventKind, PlanarCollider, PlanarDetector,
    PlanarShape, PlanarWorld, Shape, SpatialWorld,
};
use stationary_integrators::State;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, Free, LieGroup, PlanarMotion, PlanarWeight, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

use crate::event_driven::{momenta, two_boxes};

const G: f64 = 9.81;

/// A cube of 1 kg and 1 m on an incline: gravity is tilted instead.
fn on_incline(
    angle: f64,
    friction: f64,
    speed: f64,
) -> (SpatialWorld<Weight<Poses>>, State<Vec<f64>>) {
    let body = Body::solid_box(1.0, [0.5; 3]).unwrap();
    let cube = Shape::cuboid([0.5; 3]).unwrap();
    let floor = Shape::half_space(Vector3::z()).unwrap();
    let colliders = vec![
        Collider::on_body(0, cube).with_friction(friction),
        Collider::fixed(RigidMotion::identity(), floor).with_friction(friction),
    ];
    let metric = BodyMetric::<Poses>::new(vec![body]);
    let motion = BodyMotion {
        pose: RigidMotion { translation: Vector3::z() * 0.5, rotation: Rotation::identity() },
        velocity: Vector3::x() * speed,
        angular_velocity: Vector3::zeros(),
    };
    let state = metric.state(&[motion]).unwrap();
    let masses = vec![PointMass { mass: 1.0, point: Vector3::zeros() }];
    let gravity = Vector3::new(-G * angle.sin(), 0.0, -G * angle.cos());
    let system = metric.under(Weight { gravity, masses, space: Poses }).unwrap();
    (SpatialWorld::new(system, Detector::new(colliders, 1).unwrap()).unwrap(), state)
}

/// Where a block that starts up an incline is: it slows down, and stays or slides back.
fn sliding(angle: f64, friction: f64, speed: f64, t: f64) -> f64 {
    let (pull, rub) = (G * angle.sin(), friction * G * angle.cos());
    let stop = speed / (pull + rub);
    let up = |t: f64| speed * t - 0.5 * (pull + rub) * t * t;
    if t <= stop {
        return up(t);
    }
    let back = (pull - rub).max(0.0);
    up(stop) - 0.5 * back * (t - stop).powi(2)
}

#[test]
fn a_block_that_slides_sticks_and_slides_back_is_as_accurate_as_asked() {
    for (angle, friction) in [(0.2_f64, 0.4), (0.5, 0.3), (0.0, 0.2)] {
        let mut steps = Vec::new();
        for accuracy in [1e-2, 1e-3, 1e-4, 1e-5] {
            let (world, mut state) = on_incline(angle, friction, 3.0);
            let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
            let (mut worst, mut taken) = (0.0_f64, 0);
            for _ in 0..20 {
                let report = chosen.advance(&mut state, 0.1).unwrap();
                assert!(report.settled);
                taken += report.steps;
                for part in [0.3, 0.6, 1.0] {
                    let t = state.t - 0.1 * (1.0 - part);
                    let seen = chosen.state_at(t).unwrap();
                    worst = worst.max((seen.q[0] - sliding(angle, friction, 3.0, t)).abs());
                }
            }
            assert!(worst < accuracy, "{angle} {friction} {accuracy}: {worst}");
            steps.push(taken);
        }
        // Order 2 between events: a hundredth of the error for about ten times the steps, not a hundred.
        assert!(steps[3] < 40 * steps[1], "{steps:?}");
    }
}

/// A block of half sizes 0.1 m and 0.4 m that rocks on its corners; inelastic, rough.
fn rocking(tilt: f64) -> (PlanarWorld<PlanarWeight>, State<Vec<f64>>) {
    let (b, h, mass) = (0.1, 0.4, 1.0);
    let inertia = mass * (b * b + h * h) / 3.0;
    let metric = DiagonalMetric::new(vec![mass, mass, inertia]).unwrap();
    let weight = PlanarWeight { gravity: -Vector2::y() * G, masses: vec![mass] };
    let block = PlanarShape::cuboid([b, h]).unwrap();
    let ground = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, block).with_friction(1.0),
        PlanarCollider::fixed(PlanarMotion::identity(), ground).with_friction(1.0),
    ];
    let detector = PlanarDetector::new(colliders, 1).unwrap();
    let world = PlanarWorld::new(System::new(metric, weight).unwrap(), detector).unwrap();
    // It stands on its left corner, at the origin, tilted to the left.
    let (sine, cosine) = tilt.sin_cos();
    let q = vec![b * cosine - h * sine, b * sine + h * cosine, tilt];
    (world, State::new(q, Covector(vec![0.0; 3])))
}

#[test]
fn a_rocking_block_loses_the_energy_of_housner_at_each_impact() {
    let (b, h) = (0.1_f64, 0.4_f64);
    let radius = b.hypot(h);
    let alpha = b.atan2(h);
    // Angular momentum about the new corner: r = 1 - 3/2 sin^2 alpha of the speed is left.
    let kept = 1.0 - 1.5 * alpha.sin().powi(2);
    let tilt = 0.1;
    for (accuracy, bound) in [(1e-3, 0.03), (1e-4, 0.03), (1e-5, 0.01)] {
        let (world, mut state) = rocking(tilt);
        let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
        // Heights of the centre of the successive swings over that of rest, from the largest tilt.
        let (mut largest, mut peaks, mut side) = (tilt, Vec::new(), 1.0);
        for _ in 0..150 {
            chosen.advance(&mut state, 1e-2).unwrap();
            let angle = state.q[2];
            if angle * side < 0.0 {
                peaks.push(largest);
                (largest, side) = (0.0, -side);
            }
            largest = angle.abs().max(largest);
        }
        assert!(peaks.len() >= 2, "{peaks:?}");
        let height = |angle: f64| radius * ((alpha - angle).cos() - alpha.cos());
        for pair in peaks.windows(2) {
            let ratio = (height(pair[1]) / height(pair[0])).sqrt();
            assert!(
                (ratio / kept - 1.0).abs() < 10.0 * bound,
                "{accuracy}: {ratio} {kept} {peaks:?}"
            );
        }
    }
}

#[test]
fn a_ball_that_bounces_without_gravity_is_as_accurate_as_asked() {
    for accuracy in [1e-2, 1e-4, 1e-6] {
        let ball = Collider::on_body(0, Shape::ball(0.1).unwrap()).with_restitution(1.0);
        let mut colliders = vec![ball];
        for normal in [Vector3::x(), -Vector3::x()] {
            let place = RigidMotion { translation: normal * -0.6, ..RigidMotion::identity() };
            colliders.push(Collider::fixed(place, Shape::half_space(normal).unwrap()));
        }
        let metric = BodyMetric::<Poses>::new(vec![Body::new(1.0, [0.004; 3]).unwrap()]);
        let motion = BodyMotion {
            pose: RigidMotion::identity(),
            velocity: Vector3::x(),
            angular_velocity: Vector3::zeros(),
        };
        let mut state = metric.state(&[motion]).unwrap();
        let system = metric.under(Free { freedoms: 6 }).unwrap();
        let world = SpatialWorld::new(system, Detector::new(colliders, 1).unwrap()).unwrap();
        let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
        for _ in 0..40 {
            chosen.advance(&mut state, 0.1).unwrap();
            // Between the planes a triangle wave; each of four impacts may be off by a tenth.
            let phase = (state.t + 0.5).rem_euclid(2.0);
            let off = (state.q[0] - (phase.min(2.0 - phase) - 0.5)).abs();
            assert!(off < accuracy, "{accuracy}: {off} at {}", state.t);
        }
    }
}

#[test]
fn events_are_noted_and_what_cannot_be_met_is_an_error_that_leaves_the_state() {
    let (world, mut state) = on_incline(0.0, 0.2, 3.0);
    state.q[2] += 0.1;
    let mut chosen = ErrorControlled::new(world, 1e-4).unwrap();
    chosen.advance(&mut state, 0.5).unwrap();
    let fall = (0.2 / G).sqrt();
    let lands = chosen.events().iter().find(|event| event.kind == EventKind::ContactStarts);
    assert!((lands.unwrap().time - fall).abs() < 1e-3, "{lands:?}");
    let before = state.clone();
    for accuracy in [0.0, -1.0, f64::NAN] {
        let (world, _) = on_incline(0.0, 0.2, 3.0);
        let refused = ErrorControlled::new(world, accuracy);
        assert!(matches!(refused, Err(ContactError::Accuracy(_))));
    }
    for duration in [0.0, f64::NAN, -1.0] {
        assert!(matches!(chosen.advance(&mut state, duration), Err(ContactError::Step(_))));
        assert_eq!(state, before);
    }
    // The rounding of a place is no accuracy.
    let (world, mut state) = on_incline(0.0, 0.2, 3.0);
    state.q[0] = 1e6;
    let refused = ErrorControlled::new(world, 1e-9).unwrap().advance(&mut state, 0.5);
    assert!(matches!(refused, Err(ContactError::Tolerance(_))), "{refused:?}");
    // An overlap is lifted by a part of it in every step, however short.
    let (world, mut state) = on_incline(0.0, 0.2, 3.0);
    state.q[2] -= 0.05;
    let before = state.clone();
    let refused = ErrorControlled::new(world, 1e-4).unwrap().advance(&mut state, 0.5);
    assert!(matches!(refused, Err(ContactError::StepTooShort { .. })), "{refused:?}");
    assert_eq!(state, before);
}

#[test]
fn steps_chosen_by_error_keep_both_momenta_and_gain_no_energy() {
    for accuracy in [1e-2, 1e-4] {
        let (detector, metric, mut state) = two_boxes();
        let system = metric.under(Free { freedoms: 12 }).unwrap();
        let kinetic = |state: &State<Vec<f64>>| system.metric().kinetic_energy(state.p.view());
        let (first, before) = (momenta(&state), kinetic(&state));
        let world = SpatialWorld::new(system.clone(), detector).unwrap();
        let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
        chosen.advance(&mut state, 1.5).unwrap();
        assert!(chosen.events().iter().any(|event| event.kind == EventKind::Impact));
        let [linear, angular] = momenta(&state);
        assert!((linear - first[0]).norm() < 1e-11, "{linear}");
        // Extrapolated poses and momenta do not belong to each other to rounding: to the accuracy.
        assert!((angular - first[1]).norm() < accuracy * first[0].norm(), "{angular} {}", first[1]);
        assert!(kinetic(&state) < before * (1.0 - 1e-3), "{} {before}", kinetic(&state));
    }
}

/// What slides loses what friction takes, and what the floor gives is the weight times the time: of any interval.
#[test]
fn works_and_impulses_are_those_of_coulomb_and_of_the_weight() {
    let (angle, friction, speed) = (0.2_f64, 0.4, 3.0);
    let rub = friction * G * angle.cos();
    for accuracy in [1e-2, 1e-4] {
        let (world, mut state) = on_incline(angle, friction, speed);
        let mut chosen = ErrorControlled::new(world, accuracy).unwrap();
        let (mut works, mut given) = ([0.0; 3], Vector3::zeros());
        for _ in 0..20 {
            let t = state.t;
            chosen.advance(&mut state, 0.1).unwrap();
            for ends in [[t, t + 0.013], [t + 0.013, t + 0.07], [t + 0.07, state.t]] {
                chosen.add_works(ends.into(), &mut works);
                chosen.show_touches(ends.into(), &mut |time, touch| {
                    assert!(time > ends[0] && time <= ends[1]);
                    // The cube is the first collider of the two: what it is given is the opposite.
                    given -= touch.contact.normal * (touch.normal + touch.impact) + touch.friction;
                });
                let way = sliding(angle, friction, speed, ends[1]);
                assert!((works[0] + rub * way).abs() < 10.0 * accuracy, "{works:?} {way}");
                assert!((given.z - G * angle.cos() * ends[1]).abs() < 1e-9, "{given} {}", ends[1]);
                // On the way up the floor and the slope stop it, then it stays.
                let v = chosen.state_at(ends[1]).unwrap().p.0[0];
                assert!(
                    (v - speed - given.x + G * angle.sin() * ends[1]).abs() < 1e-9,
                    "{v} {given}"
                );
            }
        }
        let stops = 0.5 * speed * speed / (rub + G * angle.sin());
        assert!((works[0] + rub * stops).abs() < accuracy, "{works:?}");
        assert!(works[1].abs() < 1e-12 && works[2].abs() < 1e-12, "{works:?}");
    }
}

#[test]
fn a_disc_that_rolls_counts_its_whole_turns_at_every_moment() {
    let metric = DiagonalMetric::new(vec![1.0, 1.0, 0.02]).unwrap();
    let gravity = Vector2::new(0.0, -9.81);
    let system = System::new(metric, PlanarWeight { gravity, masses: vec![1.0] }).unwrap();
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::disc(0.2).unwrap()).with_friction(0.5),
        PlanarCollider::fixed(PlanarMotion::identity(), floor),
    ];
    let world = PlanarWorld::new(system, PlanarDetector::new(colliders, 1).unwrap()).unwrap();
    let mut chosen = ErrorControlled::new(world, 1e-4).unwrap();
    let mut state = State::new(vec![0.0, 0.2, 0.0], Covector(vec![1.0, 0.0, -0.1]));
    for second in 0..4 {
        let start = f64::from(second);
        chosen.advance(&mut state, 1.0).unwrap();
        assert!((state.q[2] + 5.0 * state.t).abs() < 1e-3, "{}", state.q[2]);
        for k in 0..=10 {
            let t = start + 0.1 * f64::from(k);
            let Ok(seen) = chosen.state_at(t) else { continue };
            assert!((seen.q[2] + 5.0 * t).abs() < 1e-3, "{t}: {}", seen.q[2]);
        }
    }
}

#[test]
fn no_accuracy_is_refused_because_of_how_far_a_small_disc_has_turned() {
    let size = 1e-6;
    let disc = PlanarCollider::on_body(0, PlanarShape::disc(size).unwrap());
    let detector = PlanarDetector::new(vec![disc], 1).unwrap();
    let metric = DiagonalMetric::new(vec![1e-12, 1e-12, 1e-24]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![1e-12] };
    let world = PlanarWorld::new(System::new(metric, weight).unwrap(), detector).unwrap();
    let mut steps = ErrorControlled::new(world, 1e-6 * size).unwrap();
    let mut state = State::new(vec![0.0, size, 1000.0], Covector(vec![1e-18, 0.0, 0.0]));
    steps.advance(&mut state, 1.0).unwrap();
    let mut state = State::new(vec![100.0, size, 0.0], Covector(vec![1e-18, 0.0, 0.0]));
    let refused = steps.advance(&mut state, 1.0);
    assert!(matches!(refused, Err(ContactError::Tolerance(_))), "{refused:?}");
}
