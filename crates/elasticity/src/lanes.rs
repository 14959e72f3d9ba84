//! Numbers that kernels are written over: one `f64`, or four elements' worth of them at a time.
//!
//! ```text
//! Lanes [a b c d] op [e f g h] = [a op e, b op f, c op g, d op h]
//! ```
//! A kernel written once over [`Real`] serves a single element and four side by side, which the
//! compiler turns into vector instructions. `multiply_add` fuses only where the machine that is
//! compiled for has the instruction: without it a fused product is a library call.
//! Not for numbers that carry derivatives: those are [`Number`](stationary_calculus::Number)s.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

/// How many elements are computed side by side.
pub(crate) const LANES: usize = 4;

/// A number, or one for each of a few elements.
pub trait Real:
    Copy
    + Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Mul<f64, Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + sealed::Sealed
{
    /// The same number for every element.
    fn splat(number: f64) -> Self;

    /// `self factor + summand`, in one rounding where the target has the instruction.
    #[must_use]
    fn multiply_add(self, factor: Self, summand: Self) -> Self;

    /// One divided by it.
    #[must_use]
    fn reciprocal(self) -> Self;

    /// The square root.
    #[must_use]
    fn square_root(self) -> Self;

    /// Its absolute value.
    #[must_use]
    fn magnitude(self) -> Self;

    /// The same with its sign turned where the other is negative.
    #[must_use]
    fn signed_by(self, other: Self) -> Self;

    /// The larger of the two; the other where one is NaN.
    #[must_use]
    fn larger(self, other: Self) -> Self;

    /// One number where it is above a bound, else the other.
    #[must_use]
    fn where_above(self, bound: Self, above: Self, otherwise: Self) -> Self;

    /// Zero where it is negative.
    #[must_use]
    fn positive_part(self) -> Self;

    /// A function of plain numbers, applied to one element after the other.
    #[must_use]
    fn each<const I: usize, const O: usize>(
        inputs: &[Self; I],
        f: impl Fn(&[f64; I]) -> [f64; O],
    ) -> [Self; O];

    /// How many elements go side by side.
    const WIDTH: usize;

    /// The number of one element.
    fn lane(self, lane: usize) -> f64;

    /// Sets the number of one element.
    fn set_lane(&mut self, lane: usize, number: f64);

    /// Whether a statement holds of every element's number.
    #[inline(always)]
    fn all(self, holds: impl Fn(f64) -> bool) -> bool {
        (0..Self::WIDTH).all(|lane| holds(self.lane(lane)))
    }

    /// Whether a statement holds of some element's number.
    #[inline(always)]
    fn any(self, holds: impl Fn(f64) -> bool) -> bool {
        // Without a branch for each of them.
        (0..Self::WIDTH).fold(false, |any, lane| any | holds(self.lane(lane)))
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f64 {}
    impl Sealed for super::Lanes {}
}

/// Four numbers, one for each of four elements.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[repr(align(32))]
pub struct Lanes(pub [f64; LANES]);

#[inline(always)]
fn fused(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") { a.mul_add(b, c) } else { a * b + c }
}

#[inline(always)]
fn signed_by(x: f64, other: f64) -> f64 {
    f64::from_bits(x.to_bits() ^ (other.to_bits() & (1 << 63)))
}

/// NaN stays NaN.
#[inline(always)]
fn positive_part(x: f64) -> f64 {
    if x < 0.0 { 0.0 } else { x }
}

impl Real for f64 {
    #[inline(always)]
    fn splat(number: f64) -> Self {
        number
    }

    #[inline(always)]
    fn multiply_add(self, factor: Self, summand: Self) -> Self {
        fused(self, factor, summand)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        self.recip()
    }

    #[inline(always)]
    fn square_root(self) -> Self {
        self.sqrt()
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }

    #[inline(always)]
    fn signed_by(self, other: Self) -> Self {
        signed_by(self, other)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        self.max(other)
    }

    #[inline(always)]
    fn where_above(self, bound: Self, above: Self, otherwise: Self) -> Self {
        if self > bound { above } else { otherwise }
    }

    #[inline(always)]
    fn positive_part(self) -> Self {
        positive_part(self)
    }

    #[inline(always)]
    fn each<const I: usize, const O: usize>(
        inputs: &[Self; I],
        f: impl Fn(&[f64; I]) -> [f64; O],
    ) -> [Self; O] {
        f(inputs)
    }

    const WIDTH: usize = 1;

    #[inline(always)]
    fn lane(self, _lane: usize) -> f64 {
        self
    }

    #[inline(always)]
    fn set_lane(&mut self, _lane: usize, number: f64) {
        *self = number;
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn splat(number: f64) -> Self {
        Lanes([number; LANES])
    }

    #[inline(always)]
    fn multiply_add(self, factor: Self, summand: Self) -> Self {
        let mut result = [0.0; LANES];
        for (lane, result) in result.iter_mut().enumerate() {
            *result = fused(self.0[lane], factor.0[lane], summand.0[lane]);
        }
        Lanes(result)
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        let mut result = [0.0; LANES];
        for (result, number) in result.iter_mut().zip(self.0) {
            *result = 1.0 / number;
        }
        Lanes(result)
    }

    #[inline(always)]
    fn square_root(self) -> Self {
        self.lanewise(f64::sqrt)
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        self.lanewise(f64::abs)
    }

    #[inline(always)]
    fn signed_by(self, other: Self) -> Self {
        let mut result = self.0;
        for (result, other) in result.iter_mut().zip(other.0) {
            *result = signed_by(*result, other);
        }
        Lanes(result)
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        let mut result = self.0;
        for (result, other) in result.iter_mut().zip(other.0) {
            *result = result.max(other);
        }
        Lanes(result)
    }

    #[inline(always)]
    fn where_above(self, bound: Self, above: Self, otherwise: Self) -> Self {
        let mut result = [0.0; LANES];
        for (lane, result) in result.iter_mut().enumerate() {
            *result = self.0[lane].where_above(bound.0[lane], above.0[lane], otherwise.0[lane]);
        }
        Lanes(result)
    }

    #[inline(always)]
    fn positive_part(self) -> Self {
        self.lanewise(positive_part)
    }

    #[inline(always)]
    fn each<const I: usize, const O: usize>(
        inputs: &[Self; I],
        f: impl Fn(&[f64; I]) -> [f64; O],
    ) -> [Self; O] {
        let mut outputs = [Lanes::default(); O];
        for lane in 0..LANES {
            let values = f(&std::array::from_fn(|i| inputs[i].0[lane]));
            for (output, value) in outputs.iter_mut().zip(values) {
                output.0[lane] = value;
            }
        }
        outputs
    }

    const WIDTH: usize = LANES;

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        self.0[lane]
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: f64) {
        self.0[lane] = number;
    }
}

impl Lanes {
    #[inline(always)]
    fn lanewise(mut self, f: impl Fn(f64) -> f64) -> Self {
        for number in &mut self.0 {
            *number = f(*number);
        }
        self
    }
}

macro_rules! lanewise {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for Lanes {
            type Output = Lanes;

            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                let mut result = [0.0; LANES];
                for (lane, result) in result.iter_mut().enumerate() {
                    *result = self.0[lane].$method(other.0[lane]);
                }
                Lanes(result)
            }
        }
    )*};
}

lanewise!(Add add, Sub sub, Mul mul);

impl Mul<f64> for Lanes {
    type Output = Lanes;

    #[inline(always)]
    fn mul(self, factor: f64) -> Lanes {
        self * Lanes([factor; LANES])
    }
}

impl Neg for Lanes {
    type Output = Lanes;

    #[inline(always)]
    fn neg(self) -> Lanes {
        let mut result = [0.0; LANES];
        for (result, number) in result.iter_mut().zip(self.0) {
            *result = -number;
        }
        Lanes(result)
    }
}

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Lanes) {
        *self = *self + other;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn polynomial<T: Real>(x: T, y: T) -> T {
        (-x).multiply_add(y, x * 3.0) - T::splat(0.5) * y
            + T::each(&[x, y], |[x, y]| [x.atan2(*y)])[0]
            + x.magnitude().square_root().signed_by(y) * x.larger(y).positive_part()
            + x.where_above(y, x * y, y)
    }

    #[test]
    fn every_lane_is_what_it_would_be_alone() {
        let (x, y) = (Lanes([1.0, -2.0, 0.3, 7.5]), Lanes([0.1, 4.0, -1.0, 2.0]));
        let side_by_side = polynomial(x, y);
        for lane in 0..LANES {
            assert_eq!(side_by_side.0[lane], polynomial(x.0[lane], y.0[lane]));
        }
        assert!(x.all(|x| x < 8.0) && !x.all(|x| x > 0.0));
    }
}
