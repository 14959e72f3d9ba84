//! Numbers for referees: plain ones, pairs of doubles with 32 digits, and their second derivatives.
//!
//! ```text
//! a + b = s + e,   a b = p + e                          exactly, s and p rounded
//! f(x + e1 a + e2 b) = f + e1 f'a + e2 f'b + e1 e2 f''ab
//! ```
//! Source: Dekker (1971); Fike and Alonso, The Development of Hyper-Dual Numbers (2011). Shares
//! nothing with the crates that it judges.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What densities are written over.
pub trait Field:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// A plain number, exactly.
    fn of(x: f64) -> Self;
    /// The nearest plain number.
    fn near(self) -> f64;
    /// The square root.
    fn root(self) -> Self;
    /// `x - log(1 + x)`, without cancellation near zero.
    fn excess_over_log(self) -> Self;
}

impl Field for f64 {
    fn of(x: f64) -> Self {
        x
    }

    fn near(self) -> f64 {
        self
    }

    fn root(self) -> Self {
        self.sqrt()
    }

    fn excess_over_log(self) -> Self {
        if self.abs() < 0.1 { excess_series(self) } else { self - self.ln_1p() }
    }
}

/// `x - 2 atanh r = x r - 2 sum r^(2k+1)/(2k+1)` with `r = x/(2 + x)`.
fn excess_series<S: Field>(x: S) -> S {
    let r = x / (S::of(2.0) + x);
    let square = r * r;
    let (mut sum, mut power) = (S::of(0.0), r);
    for k in 1..=24 {
        power = power * square;
        sum = sum + power / S::of(2.0 * f64::from(k) + 1.0);
    }
    x * r - sum - sum
}

/// A number as the sum of two doubles that do not overlap.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    high: f64,
    low: f64,
}

fn two_sum(a: f64, b: f64) -> Pair {
    let high = a + b;
    let part = high - a;
    Pair { high, low: (a - (high - part)) + (b - part) }
}

fn two_product(a: f64, b: f64) -> Pair {
    let high = a * b;
    Pair { high, low: a.mul_add(b, -high) }
}

impl Add for Pair {
    type Output = Pair;

    fn add(self, other: Pair) -> Pair {
        let (s, t) = (two_sum(self.high, other.high), two_sum(self.low, other.low));
        let once = two_sum(s.high, s.low + t.high);
        two_sum(once.high, once.low + t.low)
    }
}

impl Neg for Pair {
    type Output = Pair;

    fn neg(self) -> Pair {
        Pair { high: -self.high, low: -self.low }
    }
}

impl Sub for Pair {
    type Output = Pair;

    fn sub(self, other: Pair) -> Pair {
        self + -other
    }
}

impl Mul for Pair {
    type Output = Pair;

    fn mul(self, other: Pair) -> Pair {
        let p = two_product(self.high, other.high);
        two_sum(p.high, p.low + (self.high * other.low + self.low * other.high))
    }
}

impl Div for Pair {
    type Output = Pair;

    fn div(self, other: Pair) -> Pair {
        let first = self.high / other.high;
        let rest = self - other * Pair::of(first);
        let second = rest.high / other.high;
        let rest = rest - other * Pair::of(second);
        Pair::of(first) + Pair::of(second) + Pair::of(rest.high / other.high)
    }
}

impl Field for Pair {
    fn of(x: f64) -> Self {
        Pair { high: x, low: 0.0 }
    }

    fn near(self) -> f64 {
        self.high + self.low
    }

    fn root(self) -> Self {
        if self.high == 0.0 {
            return self;
        }
        let guess = Pair::of(self.high.sqrt());
        let once = (guess + self / guess) * Pair::of(0.5);
        (once + self / once) * Pair::of(0.5)
    }

    fn excess_over_log(self) -> Self {
        const LN_2: Pair = Pair { high: std::f64::consts::LN_2, low: 2.319_046_813_846_299_6e-17 };
        if self.high.abs() < 0.3 {
            return excess_series(self);
        }
        // 1 + x = 2^k m with m close to one: x - k log 2 - log m.
        let one = Pair::of(1.0) + self;
        let k = one.high.log2().round();
        let scale = (-k).exp2();
        let m = Pair { high: one.high * scale, low: one.low * scale };
        let beyond = m - Pair::of(1.0);
        self - Pair::of(k) * LN_2 - (beyond - excess_series(beyond))
    }
}

/// A number with its derivatives along two directions, and the mixed second one.
#[derive(Clone, Copy, Debug)]
pub struct Hyper<S> {
    pub value: S,
    pub first: S,
    pub second: S,
    pub both: S,
}

impl<S: Field> Hyper<S> {
    /// A constant.
    pub fn constant(value: S) -> Self {
        let zero = S::of(0.0);
        Hyper { value, first: zero, second: zero, both: zero }
    }

    /// `g(x)` from g, g' and g'' at x.
    fn chain(self, [g, dg, ddg]: [S; 3]) -> Self {
        Hyper {
            value: g,
            first: dg * self.first,
            second: dg * self.second,
            both: dg * self.both + ddg * self.first * self.second,
        }
    }
}

impl<S: Field> Add for Hyper<S> {
    type Output = Self;

    fn add(self, o: Self) -> Self {
        Hyper {
            value: self.value + o.value,
            first: self.first + o.first,
            second: self.second + o.second,
            both: self.both + o.both,
        }
    }
}

impl<S: Field> Neg for Hyper<S> {
    type Output = Self;

    fn neg(self) -> Self {
        Hyper { value: -self.value, first: -self.first, second: -self.second, both: -self.both }
    }
}

impl<S: Field> Sub for Hyper<S> {
    type Output = Self;

    fn sub(self, o: Self) -> Self {
        self + -o
    }
}

impl<S: Field> Mul for Hyper<S> {
    type Output = Self;

    fn mul(self, o: Self) -> Self {
        Hyper {
            value: self.value * o.value,
            first: self.first * o.value + self.value * o.first,
            second: self.second * o.value + self.value * o.second,
            both: self.both * o.value
                + self.first * o.second
                + self.second * o.first
                + self.value * o.both,
        }
    }
}

impl<S: Field> Div for Hyper<S> {
    type Output = Self;

    fn div(self, o: Self) -> Self {
        let inverse = S::of(1.0) / o.value;
        let square = inverse * inverse;
        self * o.chain([inverse, -square, S::of(2.0) * square * inverse])
    }
}

impl<S: Field> Field for Hyper<S> {
    fn of(x: f64) -> Self {
        Hyper::constant(S::of(x))
    }

    fn near(self) -> f64 {
        self.value.near()
    }

    fn root(self) -> Self {
        let root = self.value.root();
        let half = S::of(0.5) / root;
        self.chain([root, half, -half / (S::of(2.0) * self.value)])
    }

    fn excess_over_log(self) -> Self {
        let inverse = S::of(1.0) / (S::of(1.0) + self.value);
        self.chain([self.value.excess_over_log(), self.value * inverse, inverse * inverse])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_have_thirty_digits() {
        let third = Pair::of(1.0) / Pair::of(3.0);
        assert!((third * Pair::of(3.0) - Pair::of(1.0)).near().abs() < 1e-31);
        let root = Pair::of(2.0).root();
        assert!((root * root - Pair::of(2.0)).near().abs() < 1e-31);
        // x^2/2 - x^3/3 + x^4/4 near zero, and on both sides of the border of the series.
        let small = Pair::of(1e-12).excess_over_log().near();
        assert!((small / (0.5e-24 - 1e-36 / 3.0) - 1.0).abs() < 1e-15);
        let ln = |x: Pair| (x - x.excess_over_log()).near();
        assert!((ln(Pair::of(1.0)) - std::f64::consts::LN_2).abs() < 1e-16);
        for x in [0.2999, 0.3001, -0.2999, -0.3001, 40.0] {
            assert!((ln(Pair::of(x)) - x.ln_1p()).abs() < 4e-16 * x.ln_1p().abs(), "{x}");
        }
    }

    #[test]
    fn second_derivatives_are_those_of_the_formula() {
        let one = Hyper { value: 3.0, first: 1.0, second: 1.0, both: 0.0 };
        let y = (one * one * one).root() / (Hyper::of(1.0) + one);
        // d2/dx2 of x^1.5/(1 + x) at 3.
        let f = |x: f64| x.powf(1.5) / (1.0 + x);
        let h = 1e-4;
        assert!((y.first - (f(3.0 + h) - f(3.0 - h)) / (2.0 * h)).abs() < 1e-8);
        assert!((y.both - (f(3.0 + h) - 2.0 * f(3.0) + f(3.0 - h)) / (h * h)).abs() < 1e-6);
    }
}
