//! Numbers of 32 digits: the sum of two doubles.
//!
//! ```text
//! x = hi + lo,   |lo| <= ulp(hi)/2
//! ```
//! Source: Dekker 1971; Hida, Li and Bailey 2001.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// An unevaluated sum of two doubles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Twofold {
    pub(crate) hi: f64,
    pub(crate) lo: f64,
}

impl From<f64> for Twofold {
    fn from(hi: f64) -> Self {
        Twofold { hi, lo: 0.0 }
    }
}

fn two_sum(a: f64, b: f64) -> Twofold {
    let hi = a + b;
    let part = hi - a;
    Twofold { hi, lo: (a - (hi - part)) + (b - part) }
}

fn quick(a: f64, b: f64) -> Twofold {
    let hi = a + b;
    Twofold { hi, lo: b - (hi - a) }
}

impl Add for Twofold {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let (s, t) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let s = quick(s.hi, s.lo + t.hi);
        quick(s.hi, s.lo + t.lo)
    }
}

impl AddAssign for Twofold {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Neg for Twofold {
    type Output = Self;

    fn neg(self) -> Self {
        Twofold { hi: -self.hi, lo: -self.lo }
    }
}

impl Sub for Twofold {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let hi = self.hi * other.hi;
        let lo = self.hi.mul_add(other.hi, -hi) + (self.hi * other.lo + self.lo * other.hi);
        quick(hi, lo)
    }
}

impl Mul<f64> for Twofold {
    type Output = Self;

    fn mul(self, other: f64) -> Self {
        self * Twofold::from(other)
    }
}

impl Div for Twofold {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let rest = self - other * first;
        let second = rest.hi / other.hi;
        let last = (rest - other * second).hi / other.hi;
        quick(first, second) + Twofold::from(last)
    }
}

/// Half of pi in three doubles.
const HALF_PI: [f64; 3] =
    [std::f64::consts::FRAC_PI_2, 6.123_233_995_736_766e-17, -1.497_384_904_859_169_8e-33];

impl Twofold {
    pub(crate) fn sqrt(self) -> Self {
        if self.hi <= 0.0 {
            return Twofold::from(0.0);
        }
        let x = self.hi.sqrt();
        let rest = self - Twofold::from(x) * x;
        quick(x, rest.hi / (2.0 * x))
    }

    pub(crate) fn abs(self) -> Self {
        if self.hi < 0.0 { -self } else { self }
    }

    /// The nearest double.
    pub(crate) fn value(self) -> f64 {
        self.hi + self.lo
    }

    pub(crate) fn sin_cos(self) -> (Self, Self) {
        let turns = (self.hi / HALF_PI[0]).round();
        let rest = HALF_PI.iter().fold(self, |rest, &part| rest - Twofold::from(part) * turns);
        let square = -(rest * rest);
        let (mut sine, mut cosine) = (rest, Twofold::from(1.0));
        let (mut s, mut c) = (rest, Twofold::from(1.0));
        for k in 1..20 {
            let k = f64::from(k);
            c = c * square / Twofold::from((2.0 * k - 1.0) * (2.0 * k));
            s = s * square / Twofold::from((2.0 * k) * (2.0 * k + 1.0));
            cosine += c;
            sine += s;
        }
        match turns.rem_euclid(4.0) as u8 {
            0 => (sine, cosine),
            1 => (cosine, -sine),
            2 => (-sine, -cosine),
            _ => (-cosine, sine),
        }
    }

    /// The angle of the point (x, self).
    pub(crate) fn atan2(self, x: Self) -> Self {
        let guess = Twofold::from(self.hi.atan2(x.hi));
        let (sine, cosine) = guess.sin_cos();
        guess + (self * cosine - x * sine) / (self * self + x * x).sqrt()
    }
}

/// Three numbers.
pub(crate) type Triple = [Twofold; 3];

pub(crate) fn triple(v: [f64; 3]) -> Triple {
    v.map(Twofold::from)
}

pub(crate) fn dot(a: &Triple, b: &Triple) -> Twofold {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: &Triple, b: &Triple) -> Triple {
    let at = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [at(1, 2), at(2, 0), at(0, 1)]
}

pub(crate) fn add(a: &Triple, b: &Triple) -> Triple {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn scaled(a: &Triple, s: Twofold) -> Triple {
    a.map(|x| x * s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thirty_digits_are_right() {
        let three = Twofold::from(3.0);
        let root = three.sqrt();
        assert!((root * root - three).abs().hi < 1e-31);
        let (sine, cosine) = Twofold::from(1e5 + 0.3).sin_cos();
        assert!((sine * sine + cosine * cosine - Twofold::from(1.0)).abs().hi < 1e-30);
        let angle = Twofold::from(2.5);
        let (sine, cosine) = angle.sin_cos();
        assert!((sine.atan2(cosine) - angle).abs().hi < 1e-30);
        // sin 1 to 33 digits.
        let off = Twofold::from(1.0).sin_cos().0
            - Twofold { hi: 0.841_470_984_807_896_5, lo: 6.844_205_151_549_8e-18 };
        assert!(off.abs().hi < 1e-16);
    }
}
