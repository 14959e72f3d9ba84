//! Numbers as unevaluated sums of two doubles, for what cancels.
//!
//! ```text
//! a + b = hi + lo,    a b = hi + lo      exactly, |lo| at most half a rounding of hi
//! |v| = hi + lo                          the length of a vector, to the square of a rounding
//! sin(a/2), cos(a/2)                     each to a few roundings of itself, a = |v|
//! ```
//! An angle that is rounded once is off by `a/2` roundings where its sine vanishes: beside whole turns
//! the sine is nothing but that. Costs some fifty operations; small angles do not need it.
//! Source: Dekker, A floating-point technique for extending the available precision (1971).

use nalgebra::Vector3;

/// An unevaluated sum.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twofold {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

impl Twofold {
    /// `a + b`, exactly.
    #[inline]
    pub(crate) fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let part = hi - a;
        Twofold { hi, lo: (a - (hi - part)) + (b - part) }
    }

    /// `a b`, exactly.
    #[inline]
    pub(crate) fn product(a: f64, b: f64) -> Self {
        let hi = a * b;
        Twofold { hi, lo: a.mul_add(b, -hi) }
    }

    #[inline]
    pub(crate) fn plus(self, other: Self) -> Self {
        let sum = Twofold::sum(self.hi, other.hi);
        Twofold::sum(sum.hi, sum.lo + (self.lo + other.lo))
    }

    #[inline]
    pub(crate) fn times(self, other: Self) -> Self {
        let product = Twofold::product(self.hi, other.hi);
        Twofold::sum(product.hi, product.lo + (self.hi * other.lo + self.lo * other.hi))
    }
}

/// The largest power of two that is not above a positive number.
pub(crate) fn power_below(x: f64) -> f64 {
    2.0_f64.powi((x.log2().floor() as i32).clamp(-1022, 1023))
}

/// The length of a vector that is not zero, and sine and cosine of half of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct HalfAngle {
    pub(crate) angle: f64,
    pub(crate) sine: f64,
    pub(crate) cosine: f64,
}

impl HalfAngle {
    pub(crate) fn of(theta: &Vector3<f64>) -> Self {
        let scale = power_below(theta.amax());
        let [x, y, z] = [0, 1, 2].map(|c| theta[c] / scale);
        let square =
            Twofold::product(x, x).plus(Twofold::product(y, y)).plus(Twofold::product(z, z));
        let hi = square.hi.sqrt();
        let lo = ((-hi).mul_add(hi, square.hi) + square.lo) / (2.0 * hi);
        let (sine, cosine) = (0.5 * scale * hi).sin_cos();
        let (little, much) = (0.5 * scale * lo).sin_cos();
        HalfAngle {
            angle: scale * hi,
            sine: sine * much + cosine * little,
            cosine: cosine * much - sine * little,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sine_beside_a_whole_turn_is_right_in_its_own_digits() {
        // |(3, 4, 0) s| = 5 s exactly for s a power of two less than a rounding off 2 pi / 5.
        let s = 1.25;
        let half = HalfAngle::of(&Vector3::new(3.0 * s, 4.0 * s, 0.0));
        assert_eq!((half.angle, half.sine), (6.25, 3.125_f64.sin()));
        // A length whose square is no double: 2 pi along (1, 1, 0)/sqrt 2 is off by its rounding.
        let x = std::f64::consts::TAU / 2.0_f64.sqrt();
        let half = HalfAngle::of(&Vector3::new(x, x, 0.0));
        // sqrt 2 x / 2 = x / sqrt 2, and pi, each to 32 digits.
        let root = 2.0_f64.sqrt();
        let root_lo = (2.0 - Twofold::product(root, root).hi - Twofold::product(root, root).lo)
            / (2.0 * root);
        let angle =
            Twofold::product(x, 0.5 * root).plus(Twofold { hi: 0.5 * x * root_lo, lo: 0.0 });
        let rest = (angle.hi - std::f64::consts::PI) + angle.lo - 1.224_646_799_147_353_2e-16;
        assert!((half.sine / -rest - 1.0).abs() < 1e-14, "{} {rest}", half.sine);
    }
}
