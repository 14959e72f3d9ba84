//! exp, log and the Jacobians of rotations against references of 120 digits, at every angle.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use stationary_rigid::problems::{LOGARITHMS, REFERENCES, Reference};
use stationary_rigid::{
    LieGroup, Rotation, left_jacobian, left_jacobian_inverse, right_jacobian,
    right_jacobian_derivative, right_jacobian_inverse,
};

/// The largest error relative to the largest entry.
fn relative(got: &[f64], expected: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let off = got.iter().zip(expected).fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
    off / largest
}

fn angle(reference: &Reference) -> f64 {
    let [x, y, z] = reference.theta;
    let largest = x.abs().max(y.abs()).max(z.abs());
    if largest == 0.0 {
        0.0
    } else {
        (reference.theta.map(|c| c / largest)).iter().map(|c| c * c).sum::<f64>().sqrt() * largest
    }
}

fn by_rows(m: &Matrix3<f64>) -> Vec<f64> {
    m.transpose().as_slice().to_vec()
}

#[test]
fn exp_is_accurate_to_rounding_at_every_angle() {
    for reference in REFERENCES {
        let theta = Vector3::from(reference.theta);
        let [w, x @ ..] = Rotation::exp(theta).quaternion();
        // The scalar and the vector each on their own: at small angles the vector is what matters.
        let a = angle(reference);
        // An angle itself is known to half a rounding only.
        let tolerance = 4e-16 * (1.0 + a);
        assert!((w - reference.exp[0]).abs() <= tolerance, "w at {a:e}");
        let off = if a == 0.0 { x[0].abs() } else { relative(&x, &reference.exp[1..]) };
        assert!(off <= 1e-15, "vector at {a:e}: {off:e}");
    }
}

#[test]
fn jacobians_are_accurate_to_1e_14_of_their_largest_entry_at_every_angle() {
    for reference in REFERENCES {
        let (theta, a) = (Vector3::from(reference.theta), angle(reference));
        let off = relative(&by_rows(&right_jacobian(&theta)), &reference.jacobian);
        assert!(off < 1e-14, "T at {a:e}: {off:e}");
        let off = relative(&by_rows(&left_jacobian(&-theta)), &reference.jacobian);
        assert!(off < 1e-14, "J at {a:e}: {off:e}");
        let (v, delta) = (Vector3::new(0.3, -1.1, 0.7), Vector3::new(-0.6, 0.2, 0.9));
        let derivative = right_jacobian_derivative(&theta, &v, &delta);
        let off = relative(derivative.as_slice(), &reference.derivative);
        assert!(off < 1e-14, "dT at {a:e}: {off:e}");
    }
}

#[test]
fn the_inverse_is_as_accurate_as_the_distance_to_a_whole_turn_lets_it_be() {
    for reference in REFERENCES {
        let (theta, a) = (Vector3::from(reference.theta), angle(reference));
        // The inverse has poles at whole turns, and amplifies the rounding of the angle.
        let turns = (a / (2.0 * PI)).round().max(1.0);
        let condition = (a / (2.0 * PI * turns - a)).abs().max(1.0);
        for inverse in [right_jacobian_inverse(&theta), left_jacobian_inverse(&-theta)] {
            let off = relative(&by_rows(&inverse), &reference.inverse);
            assert!(off < 1e-14 * condition, "at {a:e}: {off:e}");
        }
    }
}

#[test]
fn at_small_angles_the_part_beyond_the_identity_is_accurate_too() {
    // An identity of size 1 hides a wrong sign at 1e-8; a difference of the mirror entries does
    // not.
    for reference in REFERENCES.iter().filter(|r| angle(r) > 0.0 && angle(r) < 1.0) {
        let theta = Vector3::from(reference.theta);
        let twist = |m: &[f64]| [m[7] - m[5], m[2] - m[6], m[3] - m[1]];
        let off = relative(&twist(&by_rows(&right_jacobian(&theta))), &twist(&reference.jacobian));
        assert!(off < 1e-14, "T at {:e}: {off:e}", angle(reference));
        let inverse = by_rows(&right_jacobian_inverse(&theta));
        let off = relative(&twist(&inverse), &twist(&reference.inverse));
        assert!(off < 1e-14, "T^-1 at {:e}: {off:e}", angle(reference));
    }
}

#[test]
fn log_is_accurate_to_rounding_from_1e_minus_300_to_pi() {
    for reference in LOGARITHMS {
        for sign in [1.0, -1.0] {
            let q = reference.quaternion.map(|c| sign * c);
            let log = Rotation::from_quaternion(q).unwrap().log();
            let off = relative(log.as_slice(), &reference.log);
            assert!(off < 1e-15, "{:?}: {off:e}", reference.log);
        }
    }
}

#[test]
fn log_undoes_exp_up_to_half_a_turn_and_takes_the_short_way_beyond() {
    for reference in REFERENCES {
        let (theta, a) = (Vector3::from(reference.theta), angle(reference));
        let log = Rotation::exp(theta).log();
        if a <= PI {
            assert!((log - theta).amax() <= 1e-15 * a, "{a:e}");
        } else {
            let turns = (a / (2.0 * PI)).round();
            let short = theta * ((a - 2.0 * PI * turns) / a);
            assert!((log - short).amax() < 1e-14, "{a:e}: {log} {short}");
        }
    }
}

#[test]
fn at_exactly_half_a_turn_the_first_component_of_the_axis_is_positive() {
    for axis in
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.6, -0.8, 0.0], [0.0, 0.6, -0.8]]
    {
        for sign in [1.0, -1.0] {
            for zero in [0.0, -0.0] {
                let q = [zero, sign * axis[0], sign * axis[1], sign * axis[2]];
                let log = Rotation::from_quaternion(q).unwrap().log();
                assert!((log - Vector3::from(axis) * PI).amax() < 1e-15, "{q:?}: {log}");
            }
        }
        // The same axis through the matrix, which is symmetric there.
        let n = Vector3::from(axis);
        let half = 2.0 * n * n.transpose() - Matrix3::identity();
        let log = Rotation::from_matrix(&half).unwrap().log();
        assert!((log - n * PI).amax() < 1e-15, "{axis:?}: {log}");
    }
}

#[test]
fn the_right_jacobian_is_the_differential_of_exp_in_body_axes() {
    for reference in REFERENCES.iter().filter(|r| angle(r) < 7.5) {
        let theta = Vector3::from(reference.theta);
        let (delta, e) = (Vector3::new(-0.6, 0.2, 0.9), 1e-5);
        let walk = |s: f64| Rotation::exp(theta).direction_to(&Rotation::exp(theta + delta * s));
        let turned = (walk(e) - walk(-e)) / (2.0 * e);
        let off = (right_jacobian(&theta) * delta - turned).amax();
        assert!(off < 1e-9, "{:e}: {off:e}", angle(reference));
    }
}

#[test]
fn at_a_whole_turn_the_jacobian_has_rank_one() {
    let theta = Vector3::new(0.36, -0.48, 0.8) * (2.0 * PI);
    let values = right_jacobian(&theta).singular_values();
    assert!((values[0] - 1.0).abs() < 1e-14 && values[1] < 1e-15, "{values}");
    assert!(right_jacobian_inverse(&theta).amax() > 1e14);
}

#[test]
fn the_jacobians_of_the_two_sides_are_transposes_and_differ_by_the_rotation() {
    for reference in REFERENCES {
        let theta = Vector3::from(reference.theta);
        let (t, j) = (right_jacobian(&theta), left_jacobian(&theta));
        assert_eq!(t.transpose(), j);
        assert!((Rotation::exp(theta).matrix() * t - j).amax() < 1e-14);
        assert!((t * theta - theta).amax() <= 1e-14 * angle(reference));
    }
}
