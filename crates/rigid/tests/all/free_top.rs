//! The closed form of the free top against its equations, and every integrator against it.

use nalgebra::Vector3;
use stationary_rigid::{
    Body, BodyMethod, BodyMetric, BodyMotion, BodySpace, ExactRotation, Free, FreeRotation,
    FreeTop, LieGroup, Orientations, RigidError, RigidMotion, Rotation, problems::thrown_racket,
};

const BOX: [f64; 3] = [0.1, 0.2, 0.3];

/// Moments and angular velocities on both sides of the separatrix, on it, and where moments agree.
fn tops() -> Vec<(Body, Vector3<f64>)> {
    let body = |moments| Body::new(1.0, moments).unwrap();
    let w = Vector3::new;
    let asymmetric = body([1.0, 2.0, 2.5]);
    let orders =
        [[1.0, 2.0, 2.5], [2.0, 1.0, 2.5], [2.5, 2.0, 1.0], [1.0, 2.5, 2.0], [2.5, 1.0, 2.0]];
    let mut tops: Vec<_> = orders.iter().map(|&i| (body(i), w(1.0, 2.0, 3.0))).collect();
    tops.extend(orders.iter().map(|&i| (body(i), w(3.0, -0.3, -0.2))));
    tops.extend([
        (asymmetric, w(0.01, 2.0, -0.001)),
        (asymmetric, w(1e-9, 2.0, 0.0)),
        (asymmetric, w(0.0, 2.0, 0.0)),
        (asymmetric, w(0.0, 0.0, -3.0)),
        (asymmetric, w(1e-8, -1e-8, 3.0)),
        (body([1.0, 1.0, 1.5]), w(1.0, 2.0, 3.0)),
        (body([1.5, 1.0, 1.5]), w(1.0, 2.0, -3.0)),
        (body([1.5, 1.0, 1.5]), w(1.0, 0.0, -3.0)),
        (body([2.0, 2.0, 2.0]), w(1.0, 2.0, 3.0)),
        (body([3.0, 3.75, 5.0]), w(-1.0 / 3.0, 0.1, 0.2)),
        (body([3.0, 3.75, 5.0]), w(1.0 / 3.0, 0.1, -0.2)),
        (asymmetric, w(0.0, 0.0, 0.0)),
        (Body::solid_box(1.0, BOX).unwrap(), w(1.0, 2.0, 3.0)),
    ]);
    tops
}

#[test]
fn the_closed_form_solves_the_equations_of_motion() {
    let start = Rotation::exp(Vector3::new(0.5, -0.2, 1.1));
    for (body, w) in tops() {
        let top = FreeTop::new(body, start, w).unwrap();
        assert!(
            (top.momentum(0.0).unwrap() - body.angular_momentum(&w)).norm()
                <= 1e-14 * (1.0 + w.norm())
        );
        assert!(start.direction_to(&top.orientation(0.0).unwrap()).norm() < 1e-7, "{body:?} {w}");
        let spatial = start.rotate(&body.angular_momentum(&w));
        for t in [0.0, 0.3, 1.0, 5.0, 20.0] {
            let (m, r, h) = (top.momentum(t).unwrap(), top.orientation(t).unwrap(), 1e-4);
            let scale = 1.0 + w.norm_squared();
            let slope = (top.momentum(t + h).unwrap() - top.momentum(t - h).unwrap()) / (2.0 * h);
            let euler = m.cross(&top.angular_velocity(t).unwrap());
            assert!((slope - euler).norm() < 1e-6 * scale, "{body:?} {w} {t}: {slope} {euler}");
            let (before, after) =
                (top.orientation(t - h).unwrap(), top.orientation(t + h).unwrap());
            let turned = before.direction_to(&after) / (2.0 * h);
            let off = (turned - top.angular_velocity(t).unwrap()).norm();
            assert!(
                off < 1e-6 * scale,
                "{body:?} {w} {t}: {turned} {}",
                top.angular_velocity(t).unwrap()
            );
            assert!((r.rotate(&m) - spatial).norm() < 1e-13 * (1.0 + spatial.norm()) * (1.0 + t));
        }
    }
}

#[test]
fn a_time_without_a_phase_is_refused() {
    let body = Body::solid_box(1.0, BOX).unwrap();
    for w in [Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.0, 0.0, 2.0), Vector3::zeros()] {
        let top = FreeTop::new(body, Rotation::identity(), w).unwrap();
        for t in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            assert!(top.orientation(t).is_err() && top.momentum(t).is_err(), "{w} {t}");
            assert!(top.angular_velocity(t).is_err(), "{w} {t}");
        }
        for t in [1e16, f64::MAX] {
            assert_eq!(top.orientation(t).is_err(), w.norm() > 0.0, "{w} {t}");
        }
    }
}

#[test]
fn a_turn_far_longer_than_the_phase_of_the_angular_velocity_is_refused_as_well() {
    // Nearly a ball: the axis of rotation wanders in the body a million times slower than that turns.
    let body = Body::new(1.0, [1.0, 1.0 + 1e-6, 1.0 + 2.5e-6]).unwrap();
    let top = FreeTop::new(body, Rotation::identity(), Vector3::new(0.3, 0.7, 0.4)).unwrap();
    for t in [1e13, -1e13] {
        assert!(top.orientation(t).is_ok());
    }
    for t in [2e14, -1e18] {
        assert!(top.momentum(t).is_ok());
        let refused = top.orientation(t);
        assert!(matches!(refused, Err(RigidError::PhaseLost { .. })), "{t:e}: {refused:?}");
    }
}

#[test]
fn beside_the_separatrix_two_halves_of_a_motion_make_the_whole_to_rounding() {
    // A flat body whose middle and smallest moments are far apart: from between the outer axes, as fast
    // about each as the separatrix asks, to beside the middle one.
    let moments = [691.0, 709.0, 19.8];
    let body = Body::new(1.0, moments).unwrap();
    let start = Rotation::exp(Vector3::new(0.3, -0.8, 0.2));
    let [b, c, a] = moments;
    let ratio = (c * (c - b) / (a * (b - a))).sqrt();
    for off in [0.0, 1e-15, -1e-15, 1e-9, -1e-9] {
        let top = FreeTop::new(body, start, Vector3::new(0.0, 1.0, ratio * (1.0 + off))).unwrap();
        for t in [1.0, 2.0, 4.0, 6.0] {
            let (half, w) =
                (top.orientation(0.5 * t).unwrap(), top.angular_velocity(0.5 * t).unwrap());
            let rest = FreeTop::new(body, half, w).unwrap();
            let apart = rest
                .orientation(0.5 * t)
                .unwrap()
                .direction_to(&top.orientation(t).unwrap())
                .norm();
            assert!(apart < 4e-16 * (1.0 + t) * t.exp() + 1e-13, "{off:e} {t}: {apart:e}");
        }
    }
}

/// The attitude's and the angular velocity's largest error over ten seconds.
fn error(method: BodyMethod, body: Body, w: Vector3<f64>, steps: u32) -> (f64, f64) {
    let metric = BodyMetric::<Orientations>::new(vec![body]);
    let pose = RigidMotion {
        translation: Vector3::zeros(),
        rotation: Rotation::exp(Vector3::new(0.5, -0.2, 1.1)),
    };
    let motion = BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: w };
    let mut state = metric.state(&[motion]).unwrap();
    let top = FreeTop::new(body, pose.rotation, w).unwrap();
    let system = metric.under(Free { freedoms: 3 }).unwrap();
    let mut integrator = method.integrator(&system).unwrap();
    let h = 10.0 / f64::from(steps);
    let mut largest = (0.0_f64, 0.0_f64);
    for step in 1..=steps {
        integrator.step(&mut state, h).unwrap();
        let t = h * f64::from(step);
        let r = Orientations::pose_at(&state.q, 0).rotation;
        largest.0 = largest.0.max(r.direction_to(&top.orientation(t).unwrap()).norm());
        let m = Vector3::from_column_slice(state.p.components());
        let off = body.angular_velocity(&m) - top.angular_velocity(t).unwrap();
        largest.1 = largest.1.max(off.norm());
    }
    largest
}

#[test]
fn the_closed_form_agrees_with_a_fine_integration() {
    for (body, w) in tops().into_iter().filter(|(_, w)| w.norm() < 4.0) {
        let (attitude, velocity) = error(BodyMethod::MuntheKaas4, body, w, 20_000);
        // The integration itself is off by the fourth power of its step, more near the separatrix.
        assert!(attitude < 2e-9 && velocity < 2e-9, "{body:?} {w}: {attitude:e} {velocity:e}");
    }
}

#[test]
fn the_error_against_the_closed_form_has_the_claimed_order() {
    let body = Body::solid_box(1.0, BOX).unwrap();
    // The exact one has no error to take an order of: its order shows on heavy tops.
    for &method in BodyMethod::ALL.iter().filter(|&&m| m != BodyMethod::ExactRotation) {
        let order = f64::from(method.facts().order);
        let steps = match method.facts().order {
            1 => 160_000,
            2 => 4_000,
            _ => 1_000,
        };
        let w = Vector3::new(1.0, 2.0, 3.0);
        let (coarse, fine) = (error(method, body, w, steps), error(method, body, w, 2 * steps));
        let measured = ((coarse.0 / fine.0).log2(), (coarse.1 / fine.1).log2());
        assert!((measured.0 - order).abs() < 0.1, "{method} attitude: {}", measured.0);
        assert!((measured.1 - order).abs() < 0.1, "{method} velocity: {}", measured.1);
    }
}

#[test]
fn exact_rotation_has_no_error_at_any_step() {
    for (body, w) in tops() {
        let off = error(BodyMethod::ExactRotation, body, w, 20);
        // A motion that leaves the separatrix multiplies rounding by exp(rate t).
        let tolerance = if w.x.abs() < 0.1 && w.z.abs() < 0.1 { 1e-4 } else { 1e-12 };
        assert!(off.0 < tolerance && off.1 < tolerance, "{body:?} {w}: {off:?}");
    }
}

#[test]
fn a_thrown_racket_flips_over_twice_a_period() {
    let racket = thrown_racket().unwrap();
    let w = racket.motion.angular_velocity;
    let top = FreeTop::new(*racket.body(), racket.motion.pose.rotation, w).unwrap();
    let period = top.period().unwrap();
    let middle = |t: f64| top.angular_velocity(t).unwrap().y;
    assert!((middle(0.5 * period) + middle(0.0)).abs() < 1e-9 && middle(0.0) > 9.9);
    // Near the separatrix K = ln(4/kc): the flip takes four over the rate times that, slowly
    // growing as the throw gets better.
    let better = FreeTop::new(*racket.body(), Rotation::identity(), Vector3::new(0.001, 10.0, 0.0));
    let rate = 10.0 * ((6.0 - 1.0) * (7.0 - 6.0) / (1.0_f64 * 7.0)).sqrt();
    let longer = better.unwrap().period().unwrap() - period;
    assert!((longer / (4.0 * 10.0_f64.ln() / rate) - 1.0).abs() < 1e-4, "{longer}");
    // And the variational integrator flips at the same moments.
    let mut state = racket.initial.clone();
    let mut flips = Vec::new();
    let method = BodyMethod::VariationalRotation;
    let mut integrator = method.integrator(&racket.system).unwrap();
    for _ in 0..50_000 {
        let before = state.p.components()[1];
        integrator.step(&mut state, 1e-4).unwrap();
        if before * state.p.components()[1] < 0.0 {
            flips.push(state.t);
        }
    }
    assert!(flips.len() >= 3);
    for (k, flip) in flips.iter().enumerate() {
        let expected = period * (0.25 + 0.5 * k as f64);
        assert!((flip - expected).abs() < 2e-3, "flip {k} at {flip}, expected {expected}");
    }
}

#[test]
fn a_top_that_turns_a_thousand_times_as_fast_is_there_a_thousand_times_as_soon() {
    let start = Rotation::exp(Vector3::new(0.5, -0.2, 1.1));
    // The last all but a ball, which tumbles once in years.
    let ball = Body::new(1.0, [2.0, 2.0 + 1e-9, 2.0 + 2e-9]).unwrap();
    for (body, w) in tops().into_iter().chain([(ball, Vector3::new(1.0, 2.0, 3.0))]) {
        let top = FreeTop::new(body, start, w).unwrap();
        for factor in [1e-3, 30.0, 1e3] {
            let fast = FreeTop::new(body, start, w * factor).unwrap();
            for t in [0.1, 1.5, 20.0, 70.0] {
                let (one, other) = (top.orientation(t), fast.orientation(t / factor));
                let apart = one.unwrap().direction_to(&other.unwrap()).norm();
                assert!(apart < 1e-11 * (1.0 + t), "{body:?} {w} {factor} {t}: {apart:e}");
            }
        }
    }
}

#[test]
fn from_step_to_step_the_quaternion_of_the_closed_form_does_not_jump() {
    let bodies = [[1.0, 2.0, 2.5], [0.1, 0.2, 0.15], [1.0, 1.0, 1.5], [2.0, 2.0, 2.0]];
    for (k, moments) in bodies.into_iter().enumerate() {
        let body = Body::new(1.0, moments).unwrap();
        // Along every direction, so that some lie beside the axes and the separatrix.
        for step in 0..2000 {
            let (s, c) = (0.37 * f64::from(step)).sin_cos();
            let (a, b) = (1e-3 * f64::from(step + 1)).sin_cos();
            let momentum = Vector3::new(s * b, c * b, a) * moments[k % 3];
            let h = if step % 2 == 0 { 0.01 } else { -0.02 };
            let turned =
                ExactRotation::turn(&body, Rotation::identity(), momentum, h).unwrap().rotation;
            let scalar = turned.quaternion()[0];
            assert!(scalar > 0.9, "{moments:?} {momentum:?} {h}: {scalar}");
        }
    }
}
