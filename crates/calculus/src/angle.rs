//! The angle between two vectors in space, by `atan2` and never by `acos`.
//!
//! ```text
//! unsigned    atan2(|u x v|, u.v)           in [0, pi]
//! signed      atan2((u x v).n, u.v)         in (-pi, pi], about the unit normal n
//! ```
//! `u v` any lengths but zero, `n` normal to both, right-hand rule, radians. `acos` of the cosine
//! loses half the digits near 0 and pi, and is undefined where rounding lifts the cosine above 1.
//! The vectors are scaled first, so that neither large nor tiny ones leave the range of numbers.
//! Source: notes A.2, which has the range of the first wrong, and for the second a half-angle form
//! that loses half the digits near pi and gives 0 for opposite vectors (errata A.2).

/// The angle between `u` and `v`, from 0 to pi. A vector without direction has no angle.
pub fn angle(u: &[f64; 3], v: &[f64; 3]) -> Option<f64> {
    let (u, v) = (scaled(u)?, scaled(v)?);
    let w = cross(&u, &v);
    Some(length(&w).atan2(dot(&u, &v)))
}

/// The angle that turns `u` towards `v` about `normal`, counterclockwise positive, pi where they are
/// opposite. A vector without direction has no angle.
pub fn signed_angle(u: &[f64; 3], v: &[f64; 3], normal: &[f64; 3]) -> Option<f64> {
    let (u, v, n) = (scaled(u)?, scaled(v)?, scaled(normal)?);
    // Adding zero turns -0 into 0: opposite vectors are pi apart, not -pi.
    let sine = dot(&cross(&u, &v), &n) / length(&n) + 0.0;
    Some(sine.atan2(dot(&u, &v)))
}

/// The vector over its largest component, unless that is zero or not finite.
fn scaled(u: &[f64; 3]) -> Option<[f64; 3]> {
    let largest = u.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let direction = largest > 0.0 && u.iter().all(|x| x.is_finite());
    direction.then(|| u.map(|x| x / largest))
}

/// Without squares, which would underflow for nearly parallel vectors.
fn length(u: &[f64; 3]) -> f64 {
    u[0].hypot(u[1]).hypot(u[2])
}

fn dot(u: &[f64; 3], v: &[f64; 3]) -> f64 {
    u.iter().zip(v).map(|(a, b)| a * b).sum()
}

fn cross(u: &[f64; 3], v: &[f64; 3]) -> [f64; 3] {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    const U: [f64; 3] = [2.0, 0.0, 0.0];
    const Z: [f64; 3] = [0.0, 0.0, 3.0];

    fn at(theta: f64) -> [f64; 3] {
        [theta.cos(), theta.sin(), 0.0]
    }

    #[test]
    fn the_angle_is_accurate_from_zero_to_pi() {
        for theta in [0.0, 1e-200, 1e-12, 1e-8, 0.3, 1.5, 3.0, PI - 1e-8, PI - 1e-12] {
            let got = angle(&U, &at(theta)).unwrap();
            assert!((got - theta).abs() <= 4e-16 * theta.max(f64::MIN_POSITIVE), "{theta} {got}");
            assert_eq!(signed_angle(&U, &at(theta), &Z), Some(got));
            assert_eq!(signed_angle(&at(theta), &U, &Z), Some(-got));
        }
    }

    #[test]
    fn acos_of_the_cosine_loses_half_the_digits_at_both_ends() {
        let acos = |theta: f64| (dot(&U, &at(theta)) / 2.0).acos();
        for theta in [1e-9, PI - 1e-9] {
            assert!((acos(theta) - theta).abs() > 0.9e-9);
            assert!((angle(&U, &at(theta)).unwrap() - theta).abs() < 1e-15);
        }
        let u = [1.0_f64, 2.0, 0.3];
        let cosines = (1..200).map(|k| {
            let v = u.map(|x| f64::from(k) * x);
            dot(&u, &v) / (length(&u) * length(&v))
        });
        assert!(cosines.map(f64::acos).any(f64::is_nan));
    }

    #[test]
    fn four_radians_are_seen_as_the_smaller_turn_or_with_their_sign() {
        let unsigned = angle(&U, &at(4.0)).unwrap();
        assert!((unsigned - (2.0 * PI - 4.0)).abs() < 1e-15);
        let signed = signed_angle(&U, &at(4.0), &Z).unwrap();
        assert!((signed - (4.0 - 2.0 * PI)).abs() < 1e-15);
    }

    #[test]
    fn opposite_vectors_are_pi_apart_from_either_side() {
        let v = [-5.0, 0.0, 0.0];
        assert_eq!(angle(&U, &v), Some(PI));
        for n in [Z, Z.map(|x| -x)] {
            assert_eq!(signed_angle(&U, &v, &n), Some(PI));
            assert_eq!(signed_angle(&v, &U, &n), Some(PI));
        }
    }

    #[test]
    fn lengths_at_the_ends_of_the_range_of_numbers_do_not_matter() {
        for (a, b) in [(1e200, 1e200), (1e-200, 1e-200), (1e-310, 1e300)] {
            let got = angle(&at(0.2).map(|x| a * x), &at(1.2).map(|x| b * x)).unwrap();
            assert!((got - 1.0).abs() < 1e-9, "{got}");
        }
    }

    #[test]
    fn a_vector_without_direction_has_no_angle() {
        for bad in [[0.0; 3], [f64::NAN, 1.0, 0.0], [1.0, f64::INFINITY, 0.0]] {
            assert_eq!(angle(&U, &bad), None);
            assert_eq!(angle(&bad, &U), None);
            assert_eq!(signed_angle(&U, &Z, &bad), None);
        }
    }
}
