//! Numbers that kernels are written over: one `f64`, or four elements' worth of them at a time.
//!
//! ```text
//! Lanes [a b c d] op [e f g h] = [a op e, b op f, c op g, d op h]
//! ```
//! A kernel written once over [`Real`] serves a single element and four side by side. Four are a
//! vector to the compiler as well: left to itself it would look for vectors along other loops.
//! `multiply_add` fuses only where the machine that is compiled for has the instruction: without it
//! a fused product is a library call.
//! Not for numbers that carry derivatives: those are [`Number`](stationary_calculus::Number)s.

use stationary_calculus::array;
use std::fmt::Debug;
use std::ops::{Add, AddAssign, Mul, Neg, Sub};

use wide::f64x4;

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
    fn lane(&self, lane: usize) -> f64;

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
pub struct Lanes(f64x4);

impl From<[f64; LANES]> for Lanes {
    #[inline(always)]
    fn from(numbers: [f64; LANES]) -> Self {
        Lanes(f64x4::new(numbers))
    }
}

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
    fn lane(&self, _lane: usize) -> f64 {
        *self
    }

    #[inline(always)]
    fn set_lane(&mut self, _lane: usize, number: f64) {
        *self = number;
    }
}

impl Real for Lanes {
    #[inline(always)]
    fn splat(number: f64) -> Self {
        Lanes(f64x4::splat(number))
    }

    #[inline(always)]
    fn multiply_add(self, factor: Self, summand: Self) -> Self {
        if cfg!(target_feature = "fma") {
            Lanes(self.0.mul_add(factor.0, summand.0))
        } else {
            self * factor + summand
        }
    }

    #[inline(always)]
    fn reciprocal(self) -> Self {
        Lanes(f64x4::splat(1.0) / self.0)
    }

    #[inline(always)]
    fn square_root(self) -> Self {
        Lanes(self.0.sqrt())
    }

    #[inline(always)]
    fn magnitude(self) -> Self {
        Lanes(self.0.abs())
    }

    #[inline(always)]
    fn signed_by(self, other: Self) -> Self {
        Lanes(self.0 ^ (other.0 & f64x4::splat(-0.0)))
    }

    #[inline(always)]
    fn larger(self, other: Self) -> Self {
        Lanes(self.0.max(other.0))
    }

    #[inline(always)]
    fn where_above(self, bound: Self, above: Self, otherwise: Self) -> Self {
        Lanes(self.0.simd_gt(bound.0).select(above.0, otherwise.0))
    }

    #[inline(always)]
    fn positive_part(self) -> Self {
        let zero = f64x4::splat(0.0);
        Lanes(self.0.simd_lt(zero).select(zero, self.0))
    }

    #[inline(always)]
    fn each<const I: usize, const O: usize>(
        inputs: &[Self; I],
        f: impl Fn(&[f64; I]) -> [f64; O],
    ) -> [Self; O] {
        let mut outputs = [Lanes::default(); O];
        for lane in 0..LANES {
            let values = f(&array(|i| inputs[i].lane(lane)));
            for (output, value) in outputs.iter_mut().zip(values) {
                output.set_lane(lane, value);
            }
        }
        outputs
    }

    const WIDTH: usize = LANES;

    #[inline(always)]
    fn lane(&self, lane: usize) -> f64 {
        self.0.as_array()[lane]
    }

    #[inline(always)]
    fn set_lane(&mut self, lane: usize, number: f64) {
        self.0.as_mut_array()[lane] = number;
    }
}

macro_rules! lanewise {
    ($($operator:ident $method:ident),*) => {$(
        impl $operator for Lanes {
            type Output = Lanes;

            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                Lanes(self.0.$method(other.0))
            }
        }
    )*};
}

lanewise!(Add add, Sub sub, Mul mul);

impl Mul<f64> for Lanes {
    type Output = Lanes;

    #[inline(always)]
    fn mul(self, factor: f64) -> Lanes {
        self * Lanes::splat(factor)
    }
}

impl Neg for Lanes {
    type Output = Lanes;

    #[inline(always)]
    fn neg(self) -> Lanes {
        Lanes(-self.0)
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
        let (x, y) = (Lanes::from([1.0, -2.0, 0.3, 7.5]), Lanes::from([0.1, 4.0, -1.0, 2.0]));
        let side_by_side = polynomial(x, y);
        for lane in 0..LANES {
            assert_eq!(side_by_side.lane(lane), polynomial(x.lane(lane), y.lane(lane)));
        }
        assert!(x.all(|x| x < 8.0) && !x.all(|x| x > 0.0));
    }
}
