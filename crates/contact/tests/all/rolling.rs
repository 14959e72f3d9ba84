//! Rolling and torsional friction: closed forms of balls and discs, and energy that never grows.

use nalgebra::{Vector2, Vector3};
use stationary_calculus::{Covector, DiagonalMetric, Metric, Potential, System, Vector};
use stationary_contact::problems::falling_boxes;
use stationary_contact::{
    Collider, ContactError, Detector, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld,
    Shape, SpatialWorld,
};
use stationary_integrators::State;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    Body, BodyMetric, BodyMotion, LieGroup, PlanarMotion, PlanarWeight, PointMass, Poses,
    RigidMotion, Rotation, Weight,
};

type V = Vector3<f64>;

const G: f64 = 9.81;
const R: f64 = 0.2;
const MASS: f64 = 3.0;

/// A ball on a half-space, with these lengths, and its state.
fn ball(
    gravity: V,
    [rolling, torsion]: [f64; 2],
    v: V,
    w: V,
) -> (SpatialWorld<Weight<Poses>>, State<Vec<f64>>) {
    let moment = 0.4 * MASS * R * R;
    let metric = BodyMetric::<Poses>::new(vec![Body::new(MASS, [moment; 3]).unwrap()]);
    let pose = RigidMotion { translation: V::z() * R, rotation: Rotation::identity() };
    let state = metric.state(&[BodyMotion { pose, velocity: v, angular_velocity: w }]).unwrap();
    let masses = vec![PointMass { mass: MASS, point: V::zeros() }];
    let floor = Shape::half_space(V::z()).unwrap();
    let colliders = vec![
        Collider::on_body(0, Shape::ball(R).unwrap()).with_friction(0.8),
        Collider::fixed(RigidMotion::identity(), floor).with_friction(0.8),
    ];
    let detector = Detector::new(colliders, 1).unwrap().with_rolling([1, 0], rolling, torsion);
    let system = metric.under(Weight { gravity, masses, space: Poses }).unwrap();
    (SpatialWorld::new(system, detector.unwrap()).unwrap(), state)
}

/// `(I + m R^2) w. = -m g r`: it stops after `v^2 R (1 + 2/5)/(2 g r)`, off by less than a step's way.
#[test]
fn a_ball_rolls_out_over_the_distance_of_the_closed_form_and_the_error_falls_with_the_step() {
    let (speed, length) = (1.5, 0.01);
    let expected = speed * speed * R * 1.4 / (2.0 * G * length);
    let mut errors = Vec::new();
    for h in [1e-2, 1e-3] {
        let (mut world, mut state) =
            ball(V::z() * -G, [length, 0.0], V::x() * speed, V::y() * (speed / R));
        let stop = speed * R * 1.4 / (G * length);
        while state.t < stop + 0.5 {
            let report = world.step(&mut state, h).unwrap();
            assert!(report.settled, "{report:?} at {}", state.t);
        }
        errors.push((state.q[0] - expected).abs());
        assert!(errors.last().unwrap() <= &(0.6 * speed * h), "{errors:?} of {expected}");
        assert!(state.p.0.iter().all(|p| p.abs() < 1e-9), "{:?}", state.p.0);
    }
    assert!(errors[1] < 0.15 * errors[0], "{errors:?}");
}

/// `I w. = -m g s`: it stops after `2/5 R^2 w/(g s)`.
#[test]
fn a_ball_that_spins_on_the_spot_is_stopped_by_torsion_at_the_time_of_the_closed_form() {
    let (spin, length, h) = (5.0, 2e-3, 1e-3);
    let expected = 0.4 * R * R * spin / (G * length);
    let (mut world, mut state) = ball(V::z() * -G, [0.0, length], V::zeros(), V::z() * spin);
    let rate = MASS * G * length;
    while state.t < 2.0 * expected {
        assert!(world.step(&mut state, h).unwrap().settled);
        let left = (0.4 * MASS * R * R * spin - rate * state.t).max(0.0);
        assert!((state.p.0[5] - left).abs() < 1e-9, "{} {left} at {}", state.p.0[5], state.t);
    }
}

/// On a slope a ball stays while `tan a <= r/R`, and rolls beyond it by `g (sin a - r/R cos a)/(7/5)`.
#[test]
fn a_ball_on_a_slope_stays_below_the_angle_of_rolling_friction_and_rolls_beyond_it() {
    let length = 0.02;
    for part in [0.3, 0.99, 1.01, 2.0] {
        let angle = (part * length / R).atan();
        let (sin, cos) = angle.sin_cos();
        let gravity = V::new(sin, 0.0, -cos) * G;
        let (mut world, mut state) = ball(gravity, [length, 0.0], V::zeros(), V::zeros());
        for _ in 0..500 {
            assert!(world.step(&mut state, 2e-3).unwrap().settled);
        }
        let expected = (G * (sin - length / R * cos) / 1.4).max(0.0) * state.t;
        assert!(
            (state.p.0[0] / MASS - expected).abs() < 1e-7,
            "{part}: {} {expected}",
            state.p.0[0]
        );
    }
}

#[test]
fn a_disc_of_the_plane_rolls_out_and_one_against_a_disc_loses_momentum_to_none() {
    let (speed, length, h) = (1.0, 0.01, 1e-3);
    let inertia = 0.5 * MASS * R * R;
    let metric = DiagonalMetric::new(vec![MASS, MASS, inertia]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::y() * -G, masses: vec![MASS] };
    let floor = PlanarShape::half_plane(Vector2::y()).unwrap();
    let colliders = vec![
        PlanarCollider::on_body(0, PlanarShape::disc(R).unwrap()).with_friction(0.5),
        PlanarCollider::fixed(PlanarMotion::identity(), floor).with_friction(0.5),
    ];
    let detector = PlanarDetector::new(colliders, 1).unwrap().with_rolling([0, 1], length, 0.0);
    let system = System::new(metric, weight).unwrap();
    let mut world = PlanarWorld::new(system, detector.unwrap()).unwrap();
    let p = vec![MASS * speed, 0.0, -inertia * speed / R];
    let mut state = State::new(vec![0.0, R, 0.0], Covector(p));
    let expected = speed * speed * R * 1.5 / (2.0 * G * length);
    while state.t < 2.0 * speed * R * 1.5 / (G * length) {
        assert!(world.step(&mut state, h).unwrap().settled);
    }
    assert!((state.q[0] - expected).abs() < 0.6 * speed * h, "{} {expected}", state.q[0]);
}

/// Balls, then boxes, that fall on each other: the balance of the report holds, and nothing is gained.
#[test]
fn energy_never_grows_by_moments_of_random_piles_and_the_reports_balance_holds() {
    let mut random = SplitMix64::new(17);
    let mut settled = [0; 2];
    for k in 0..4 {
        let boxes = falling_boxes(8).unwrap();
        let colliders = boxes.detector().unwrap().colliders().to_vec();
        let rounded = colliders.into_iter().map(|collider| match collider.body() {
            Some(_) if k % 2 == 0 => Collider { shape: Shape::ball(0.5).unwrap(), ..collider },
            _ => collider,
        });
        let colliders: Vec<_> = rounded.collect();
        let count = colliders.len();
        let mut detector = Detector::new(colliders, 8).unwrap();
        for (a, b) in (0..count).flat_map(|a| (0..a).map(move |b| (a, b))) {
            let mut length = || 0.1 * random.symmetric().abs();
            let lengths = [length(), length()];
            detector = detector.with_rolling([a, b], lengths[0], lengths[1]).unwrap();
        }
        let mut state = boxes.state.clone();
        state.q.chunks_exact_mut(7).for_each(|pose| pose[2] -= 0.4);
        state.p.0.iter_mut().for_each(|p| *p += random.symmetric());
        let (metric, potential) = (boxes.system.metric().clone(), boxes.system.potential().clone());
        let (kinetic, h) = (|state: &State<Vec<f64>>| metric.kinetic_energy(state.p.view()), 1e-2);
        let mut world = SpatialWorld::new(boxes.system, detector).unwrap();
        for _ in 0..[50, 15][k % 2] {
            let start = state.clone();
            let report = world.step(&mut state, h).unwrap();
            // The weight is paid at the mean of the velocities before and after it.
            let mut weight = Covector(vec![0.0; state.p.0.len()]);
            potential.add_differential(&start.q, weight.view_mut());
            let mut mean = Vector(vec![0.0; state.p.0.len()]);
            let p: Vec<f64> =
                state.p.0.iter().zip(&start.p.0).map(|(a, b)| 0.5 * (a + b)).collect();
            metric.sharp(Covector(&p), mean.view_mut());
            let worked = -h * weight.0.iter().zip(&mean.0).map(|(f, v)| f * v).sum::<f64>();
            let took = report.friction_energy + report.impact_energy;
            assert!(took > -1e-9, "{report:?}");
            let off = kinetic(&state) - kinetic(&start) - worked + took;
            assert!(off.abs() < 1e-9 * (1.0 + kinetic(&start)), "{off}: {report:?}");
            settled[k % 2] += usize::from(report.settled);
        }
    }
    // By turns between moments and impulses boxes did in half of the steps.
    assert!(settled[0] > 95 && settled[1] > 26, "{settled:?}");
}

#[test]
fn lengths_that_are_none_are_refused_by_name() {
    let floor = || Collider::fixed(RigidMotion::identity(), Shape::half_space(V::z()).unwrap());
    let detector = || Detector::new(vec![floor(), floor()], 0).unwrap();
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        for lengths in [[bad, 0.0], [0.0, bad]] {
            let refused = detector().with_rolling([0, 1], lengths[0], lengths[1]).unwrap_err();
            assert!(matches!(refused, ContactError::Rolling { .. }), "{refused}");
        }
    }
    let refused = detector().with_rolling([0, 2], 0.1, 0.1).unwrap_err();
    assert!(matches!(refused, ContactError::Size(_)), "{refused}");
}
