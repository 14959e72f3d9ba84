//! Steps down to a microsecond: impulses of single impacts are those of the closed form.

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_contact::{PlanarCollider, PlanarDetector, PlanarShape, World};
use stationary_integrators::State;
use stationary_rigid::{LieGroup, PlanarMotion, PlanarWeight};

/// A rod of 2 kg that leans by `angle` falls at `speed` on its end; the impulse, and the velocities
/// after.
fn fall(angle: f64, speed: f64, c: f64, h: f64) -> (f64, Vec<f64>) {
    let (half, mass) = ([1.0, 0.05], 2.0);
    let inertia = mass * (half[0] * half[0] + half[1] * half[1]) / 3.0;
    let metric = DiagonalMetric::new(vec![mass, mass, inertia]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![mass] };
    let rod = PlanarCollider::on_body(0, PlanarShape::cuboid(half).unwrap());
    let ground = PlanarShape::half_plane(Vector2::y()).unwrap();
    let ground = PlanarCollider::fixed(PlanarMotion::identity(), ground);
    let colliders = vec![rod.with_restitution(c), ground.with_restitution(c)];
    let detector = PlanarDetector::new(colliders, 1).unwrap();
    let mut world = World::new(System::new(metric, weight).unwrap(), detector).unwrap();
    let low = half[0] * angle.sin().abs() + half[1] * angle.cos().abs();
    let mut state = State::new(
        vec![0.0, low + 3.3 * h * speed, angle],
        Covector(vec![0.0, -mass * speed, 0.0]),
    );
    let mut impulse = 0.0;
    for _ in 0..6 {
        world.step(&mut state, h).unwrap();
        impulse += world.touches().map(|touch| touch.impact + touch.normal).sum::<f64>();
    }
    (impulse, vec![state.p.0[1] / mass, state.p.0[2] / inertia])
}

#[test]
fn the_impulse_of_a_single_impact_is_that_of_the_closed_form_at_every_step_down_to_a_microsecond() {
    let (half, mass) = ([1.0_f64, 0.05], 2.0);
    let inertia = mass * (half[0] * half[0] + half[1] * half[1]) / 3.0;
    for h in [1e-3, 1e-4, 1e-5, 1e-6] {
        for angle in [0.3_f64, -0.8, 1.2] {
            for (speed, c) in [(1.0, 0.0), (3.0, 0.4), (0.2, 1.0)] {
                // The corner that is lowest, seen from the centre.
                let x = half[1] * angle.sin() - half[0] * angle.cos() * angle.signum();
                let d = 1.0 / mass + x * x / inertia;
                let expected = (1.0 + c) * speed / d;
                let (impulse, v) = fall(angle, speed, c, h);
                // Without restitution the gap is used up first, and the rod turns meanwhile.
                let bound = if c == 0.0 { 5.0 * h } else { 1e-9 };
                let part = impulse / expected - 1.0;
                assert!(part.abs() < bound, "{h} {angle} {c}: {impulse} {expected}");
                let after = [expected / mass - speed, expected * x / inertia];
                let off = (v[0] - after[0]).abs().max((v[1] - after[1]).abs());
                assert!(off < bound * speed, "{h} {angle} {c}: {v:?} {after:?}");
            }
        }
    }
}

#[test]
fn without_restitution_a_gap_is_used_up_before_a_body_is_stopped() {
    let metric = DiagonalMetric::new(vec![2.0, 2.0, 0.1]).unwrap();
    let weight = PlanarWeight { gravity: Vector2::zeros(), masses: vec![2.0] };
    let disc = PlanarCollider::on_body(0, PlanarShape::disc(0.5).unwrap());
    let ground = PlanarShape::half_plane(Vector2::y()).unwrap();
    let ground = PlanarCollider::fixed(PlanarMotion::identity(), ground);
    let detector = PlanarDetector::new(vec![disc, ground], 1).unwrap();
    let mut world = World::new(System::new(metric, weight).unwrap(), detector).unwrap();
    for part in [0.1, 0.9] {
        let h = 1e-3;
        let mut state = State::new(vec![0.0, 0.5 + part * h, 0.0], Covector(vec![0.0, -2.0, 0.0]));
        world.step(&mut state, h).unwrap();
        assert!((state.q[1] - 0.5).abs() < 1e-12, "{part}: {state:?}");
        world.step(&mut state, h).unwrap();
        assert!(state.p.0[1].abs() < 1e-12, "{part}: {state:?}");
    }
}
