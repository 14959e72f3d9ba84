//! Free rotation backward in time, as composed steps ask for it.

use nalgebra::Vector3;
use stationary_measure::SplitMix64;
use stationary_rigid::{
    AxisRotations, Body, ConstantVelocity, ExactRotation, FreeRotation, LieGroup, Rotation,
};

/// Turns there and back, and tells how far from the start a body and its momentum end.
fn missed<R: FreeRotation>(body: &Body, start: Rotation, m: Vector3<f64>, h: f64) -> f64 {
    let there = R::turn(body, start, m, h).unwrap();
    let back = R::turn(body, there.rotation, there.momentum, -h).unwrap();
    start.direction_to(&back.rotation).norm() + (back.momentum - m).norm() / m.norm()
}

#[test]
fn a_step_backward_undoes_one_forward_whichever_map_turns_the_body() {
    let mut noise = SplitMix64::new(11);
    for _ in 0..200 {
        let mut draw = || Vector3::from_fn(|_, _| noise.symmetric());
        let half = draw().map(|a| 0.1 + a.abs());
        let body = Body::solid_box(1.0, half.into()).unwrap();
        let (start, w) = (Rotation::exp(draw() * 3.0), draw());
        let m = body.angular_momentum(&w);
        let missed = [
            missed::<AxisRotations>(&body, start, m, 0.5),
            missed::<ConstantVelocity>(&body, start, m, 0.5),
            missed::<ExactRotation>(&body, start, m, 0.5),
        ];
        assert!(missed.iter().all(|missed| *missed < 1e-13), "{half:?} {w:?}: {missed:?}");
    }
}

#[test]
fn a_step_of_constant_velocity_by_more_than_half_a_turn_is_refused_forward_and_backward() {
    let body = Body::solid_box(1.0, [0.1, 0.2, 0.3]).unwrap();
    let m = body.angular_momentum(&Vector3::new(0.0, 0.0, 1.0));
    for (turn, is_made) in [(3.1, true), (3.2, false), (6.0, false)] {
        for h in [turn, -turn] {
            let turned = ConstantVelocity::turn(&body, Rotation::identity(), m, h);
            assert_eq!(turned.is_ok(), is_made, "{h}: {turned:?}");
        }
    }
}
