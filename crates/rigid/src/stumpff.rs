//! Stumpff's functions: what rotations need of sine and cosine, accurate at every angle.
//!
//! ```text
//! c_n(s) = sum_k (-s)^k / (2k + n)!,       s = x^2
//! c0 = cos x    c1 = sin x / x    c2 = (1 - cos x)/x^2    c3 = (x - sin x)/x^3
//! c_n = 1/n! - s c_(n+2),                  d c_n / ds = (n c_(n+2) - c_(n+1))/2
//! ```
//! `x` an angle in radians. The closed forms of c3, c4 and c5 cancel at small angles, and that of c2
//! near a whole turn as well. Below `s = 4` each is summed by its series; above, `1 - cos x` is taken
//! as `2 sin^2(x/2)`, and the closed forms hold to a few roundings.
//! Source: Stumpff 1947; Battin, An Introduction to the Mathematics and Methods of Astrodynamics, 4.7
//! (where they are named for universal variables).

/// Squared angle below which the series is summed.
pub(crate) const SERIES_BELOW: f64 = 4.0;

/// Squared angle below which a few terms are enough: those of a step that resolves its motion.
const FEW_BELOW: f64 = 0.25;
/// So many.
const FEW: usize = 7;

/// `[c2, c3]` at a squared angle of a rotation.
#[inline]
pub(crate) fn c2_c3(s: f64) -> [f64; 2] {
    if s < FEW_BELOW {
        return [series(s, &SECOND[..FEW]), series(s, &THIRD[..FEW])];
    }
    if s < SERIES_BELOW {
        return [series(s, &SECOND), series(s, &THIRD)];
    }
    let x = s.sqrt();
    let sine = (0.5 * x).sin();
    [2.0 * sine * sine / s, (1.0 - x.sin() / x) / s]
}

/// `[c4, c5]` at a squared angle of a rotation.
#[inline]
pub(crate) fn c4_c5(s: f64) -> [f64; 2] {
    if s < SERIES_BELOW {
        return [series(s, &FOURTH), series(s, &FIFTH)];
    }
    let [c2, c3] = c2_c3(s);
    [(0.5 - c2) / s, (1.0 / 6.0 - c3) / s]
}

/// `sin x / x` at a squared angle.
#[inline]
pub(crate) fn c1(s: f64) -> f64 {
    if s < SERIES_BELOW { 1.0 - s * series(s, &THIRD) } else { s.sqrt().sin() / s.sqrt() }
}

/// Squared angle below which [`small`] is exact to rounding.
pub(crate) const SMALL_BELOW: f64 = 9e-4;

/// `[cos x, sin x / x]` at a squared angle below [`SMALL_BELOW`], with neither root nor division.
#[inline]
pub(crate) fn small(s: f64) -> [f64; 2] {
    let cosine = 1.0 - s * (0.5 - s * (1.0 / 24.0 - s * (1.0 / 720.0 - s * (1.0 / 40320.0))));
    let ratio = 1.0 - s * (1.0 / 6.0 - s * (1.0 / 120.0 - s * (1.0 / 5040.0)));
    [cosine, ratio]
}

/// `(sin x, cos x)`, fast where the angle is that of a short step.
#[inline]
pub(crate) fn sine_cosine(x: f64) -> (f64, f64) {
    let s = x * x;
    if s < SMALL_BELOW {
        let [cosine, ratio] = small(s);
        return (x * ratio, cosine);
    }
    x.sin_cos()
}

const TERMS: usize = 12;
const SECOND: [f64; TERMS] = coefficients(2);
const THIRD: [f64; TERMS] = coefficients(3);
const FOURTH: [f64; TERMS] = coefficients(4);
const FIFTH: [f64; TERMS] = coefficients(5);

/// `(-1)^k / (2k + n)!`, each rounded once: 27! is the largest, and exceeds no 128-bit number.
const fn coefficients(n: u32) -> [f64; TERMS] {
    let mut coefficients = [0.0; TERMS];
    let mut factorial: u128 = 1;
    let (mut k, mut m) = (0, 0);
    while k < TERMS {
        while m < 2 * k as u32 + n {
            m += 1;
            factorial *= m as u128;
        }
        let sign = if k % 2 == 0 { 1.0 } else { -1.0 };
        coefficients[k] = sign / factorial as f64;
        k += 1;
    }
    coefficients
}

#[inline]
fn series(s: f64, coefficients: &[f64]) -> f64 {
    coefficients.iter().rev().fold(0.0, |sum, c| sum * s + c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn series_and_closed_forms_meet() {
        let (below, above) = (SERIES_BELOW.next_down(), SERIES_BELOW);
        let pairs = [c2_c3(below), c4_c5(below), [c1(below), 1.0]];
        let closed = [c2_c3(above), c4_c5(above), [c1(above), 1.0]];
        for (a, b) in pairs.iter().flatten().zip(closed.iter().flatten()) {
            assert!((a / b - 1.0).abs() < 3e-15, "{a} {b}");
        }
    }

    #[test]
    fn short_and_long_series_and_library_meet() {
        let (below, above) = (c2_c3(FEW_BELOW.next_down()), c2_c3(FEW_BELOW));
        assert!((0..2).all(|k| (below[k] / above[k] - 1.0).abs() < 1e-15));
        for i in 0..1000 {
            let x = 0.03 * (f64::from(i) / 999.0);
            let (sine, cosine) = sine_cosine(-x);
            assert!((sine + x.sin()).abs() <= 2.5e-16 * x && (cosine - x.cos()).abs() < 2.3e-16);
        }
    }

    #[test]
    fn the_recurrence_holds_at_every_angle() {
        for i in 0..400 {
            let s = 0.1 * f64::from(i);
            let ([c2, c3], [c4, c5]) = (c2_c3(s), c4_c5(s));
            assert!((c2 + s * c4 - 0.5).abs() < 1e-15, "{s}");
            assert!((c3 + s * c5 - 1.0 / 6.0).abs() < 1e-15, "{s}");
            assert!((c1(s) + s * c3 - 1.0).abs() < 1e-15, "{s}");
            assert!((1.0 - s * c2 - s.sqrt().cos()).abs() < 2e-15, "{s}");
        }
    }
}
