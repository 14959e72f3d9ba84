//! A Lie group: motions that compose, and the straight paths among them.
//!
//! ```text
//! exp: algebra -> group,   log its inverse near the identity                       (8.2.2, 8.2.3)
//! g exp(s v)                      the path from g in the body direction v
//! g exp(s log(g^-1 k))            the path from g to k, 0 <= s <= 1
//! g v^                            the tangent at g of body direction v              (8.2.1)
//! (k g^-1)(g v^) = k v^           transport from g to k: the same body direction
//! Ad_g v:  g v^ g^-1 = (Ad_g v)^,    [v, w]^ = v^ w^ - w^ v^
//! ```
//! `g k` elements, `v w` coordinates of the algebra, `v^` the matrix that they stand for.
//! Directions are those of the body: multiplied from the right, as everywhere in this crate. The
//! path from `g` to `k` is the notes' `exp(s log(k g^-1)) g` as well (errata 8.2.3).
//!
//! Such a path is a geodesic where the metric is invariant from both sides: for rotations where all
//! moments of inertia are equal (errata 8.2.2). The group of all invertible matrices, which has no
//! coordinates of its own, has functions instead:
//! [`matrix_exponential`](crate::matrix_exponential).

use std::ops::{Add, Mul, Neg, Sub};

/// A group of motions with coordinates on its algebra.
pub trait LieGroup: Copy + PartialEq {
    /// Coordinates of the Lie algebra.
    type Algebra: Copy
        + Add<Output = Self::Algebra>
        + Sub<Output = Self::Algebra>
        + Neg<Output = Self::Algebra>
        + Mul<f64, Output = Self::Algebra>;
    /// The square matrices that elements and directions stand for.
    type Matrix: Clone + Mul<Output = Self::Matrix>;

    /// The motion that moves nothing.
    fn identity() -> Self;

    /// The motion back.
    fn inverse(&self) -> Self;

    /// The motion that does `first` and then `self`: the product `self first`.
    fn compose(&self, first: &Self) -> Self;

    /// Where the straight path from the identity in the direction `v` is after unit time.
    fn exp(v: Self::Algebra) -> Self;

    /// The shortest `v` with `exp(v) = self`.
    fn log(&self) -> Self::Algebra;

    /// `Ad_g v`: the body direction v as it is seen from the world.
    fn adjoint(&self, v: Self::Algebra) -> Self::Algebra;

    /// The Lie bracket of two directions.
    fn bracket(v: Self::Algebra, w: Self::Algebra) -> Self::Algebra;

    /// The matrix of a motion.
    fn matrix(&self) -> Self::Matrix;

    /// The matrix of a direction.
    fn hat(v: Self::Algebra) -> Self::Matrix;

    /// The element `self exp(v)`: a step in the body direction v.
    fn walk(&self, v: Self::Algebra) -> Self {
        self.compose(&Self::exp(v))
    }

    /// The body direction whose unit walk leads from `self` to `to`.
    fn direction_to(&self, to: &Self) -> Self::Algebra {
        self.inverse().compose(to).log()
    }

    /// The point a fraction `s` along the straight path from `self` to `to`.
    fn interpolate(&self, to: &Self, s: f64) -> Self {
        self.walk(self.direction_to(to) * s)
    }

    /// The tangent matrix at `self` of the body direction v.
    fn tangent(&self, v: Self::Algebra) -> Self::Matrix {
        self.matrix() * Self::hat(v)
    }

    /// A tangent matrix at `self` carried to the element `to`, where it has the same body
    /// direction.
    fn transport(&self, to: &Self, tangent: Self::Matrix) -> Self::Matrix {
        to.compose(&self.inverse()).matrix() * tangent
    }
}
