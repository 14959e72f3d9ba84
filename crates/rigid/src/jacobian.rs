//! The differential of exp on rotations: what turns a change of axis-angle into an angular
//! velocity.
//!
//! ```text
//! d/dt exp(theta) = exp(theta) [T(theta) theta.]     T = I - c2 [theta] + c3 [theta]^2   right
//!                 = [J(theta) theta.] exp(theta)     J = I + c2 [theta] + c3 [theta]^2   left
//! T^-1 = I + [theta]/2 + c [theta]^2,    c = (1 - (a/2) cot(a/2))/a^2,   a = |theta|
//! J(theta) = T(theta)^T = T(-theta) = exp(theta) T(theta)
//! ```
//! `theta` axis times angle, radians; `[theta]` the cross-product matrix; `c2 = (1 - cos a)/a^2`
//! and `c3 = (a - sin a)/a^3`. The notes call the right Jacobian `T`; `T(theta) theta.` is the
//! angular velocity in the body's axes, `J(theta) theta.` in the world's.
//!
//! Entries are accurate to a few roundings of the largest at every angle up to 1e15. `T` is singular at whole turns,
//! `a = 2 pi n`: there no change of theta turns the body about an axis across theta's, and the
//! inverse is not finite or, where rounding misses the turn, very large. A chart that stays below
//! `a = pi`, by going on from `theta - 2 pi theta/a`, never comes near.
//! Source: notes 9.3, errata 9.3; Gallego and Yezzi 2015.

use nalgebra::{Matrix3, Vector3};

use crate::stumpff::{SERIES_BELOW, c1, c2_c3, c4_c5};
use crate::twofold::HalfAngle;

/// The right Jacobian `T(theta)`; its transpose is the left one.
#[inline]
pub fn right_jacobian(theta: &Vector3<f64>) -> Matrix3<f64> {
    let [c2, c3] = c2_c3(theta.norm_squared());
    polynomial(theta, -c2, c3)
}

/// The left Jacobian `J(theta) = T(theta)^T`.
#[inline]
pub fn left_jacobian(theta: &Vector3<f64>) -> Matrix3<f64> {
    let [c2, c3] = c2_c3(theta.norm_squared());
    polynomial(theta, c2, c3)
}

/// The inverse of the right Jacobian; not finite at whole turns.
#[inline]
pub fn right_jacobian_inverse(theta: &Vector3<f64>) -> Matrix3<f64> {
    polynomial(theta, 0.5, inverse_coefficient_of(theta))
}

/// The inverse of the left Jacobian; not finite at whole turns.
#[inline]
pub fn left_jacobian_inverse(theta: &Vector3<f64>) -> Matrix3<f64> {
    polynomial(theta, -0.5, inverse_coefficient_of(theta))
}

/// The derivative of `T(theta) v` along `delta`: how an angular velocity changes with the chart.
///
/// ```text
/// -c2 delta x v + c3 (delta x (theta x v) + theta x (delta x v))
///   + 2 <theta, delta> (-c2' theta x v + c3' theta x (theta x v)),     ' = d/d(a^2)
/// ```
pub fn right_jacobian_derivative(
    theta: &Vector3<f64>,
    v: &Vector3<f64>,
    delta: &Vector3<f64>,
) -> Vector3<f64> {
    let ([c2, c3], [slope2, slope3]) = coefficients_and_slopes(theta);
    let (once, across) = (theta.cross(v), delta.cross(v));
    let turned = theta.cross(&once) * slope3 - once * slope2;
    (delta.cross(&once) + theta.cross(&across)) * c3 - across * c2
        + turned * (2.0 * theta.dot(delta))
}

/// `[c2, c3]` and their slopes with the squared angle.
fn coefficients_and_slopes(theta: &Vector3<f64>) -> ([f64; 2], [f64; 2]) {
    let s = theta.norm_squared();
    if s < SERIES_BELOW {
        let ([c2, c3], [c4, c5]) = (c2_c3(s), c4_c5(s));
        return ([c2, c3], [0.5 * (2.0 * c4 - c3), 0.5 * (3.0 * c5 - c4)]);
    }
    // By the recurrence, so that nothing cancels at large angles.
    let HalfAngle { angle, sine, cosine } = HalfAngle::of(theta);
    let (c1, c2) = (2.0 * sine * cosine / angle, 2.0 * (sine / angle) * (sine / angle));
    let c3 = (1.0 - c1) / s;
    ([c2, c3], [0.5 * (c1 - 2.0 * c2) / s, 0.5 * (c2 - 3.0 * c3) / s])
}

/// The same as [`inverse_coefficient`], right beside whole turns as well.
#[inline]
fn inverse_coefficient_of(theta: &Vector3<f64>) -> f64 {
    let s = theta.norm_squared();
    if s < SERIES_BELOW {
        return inverse_coefficient(s);
    }
    let HalfAngle { angle, sine, cosine } = HalfAngle::of(theta);
    (1.0 - 0.5 * angle * cosine / sine) / s
}

/// A squared angle below which a few terms are exact to rounding: that of a step that resolves its motion.
const SHORT: f64 = 4e-3;

/// `(1 - (a/2) cot(a/2))/a^2` at `s = a^2`, without the cancellation of either difference.
#[inline]
pub(crate) fn inverse_coefficient(s: f64) -> f64 {
    if s < SHORT {
        return 1.0 / 12.0 + s * (1.0 / 720.0 + s * (1.0 / 30_240.0 + s * (1.0 / 1_209_600.0)));
    }
    let half = 0.25 * s;
    let [c2, c3] = c2_c3(half);
    0.25 * (c2 - c3) / c1(half)
}

/// `I + b [theta] + c [theta]^2`, entry by entry.
#[inline]
pub(crate) fn polynomial(theta: &Vector3<f64>, b: f64, c: f64) -> Matrix3<f64> {
    let (bt, ct) = (theta * b, theta * c);
    let (xx, yy, zz) = (ct.x * theta.x, ct.y * theta.y, ct.z * theta.z);
    let (xy, yz, zx) = (ct.x * theta.y, ct.y * theta.z, ct.z * theta.x);
    Matrix3::new(
        1.0 - (yy + zz),
        xy - bt.z,
        zx + bt.y,
        xy + bt.z,
        1.0 - (zz + xx),
        yz - bt.x,
        zx - bt.y,
        yz + bt.x,
        1.0 - (xx + yy),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_series_of_a_short_turn_and_the_quotient_meet() {
        let [below, above] = [SHORT.next_down(), SHORT].map(inverse_coefficient);
        assert!((below / above - 1.0).abs() < 4e-16, "{below} {above}");
        assert_eq!(inverse_coefficient(0.0), 1.0 / 12.0);
    }
}
