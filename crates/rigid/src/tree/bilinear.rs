//! A bilinear form of two twists, one at each end of a step: an inertia that is not symmetric.
//!
//! ```text
//! F = A v + B w,    N = C v + D w                  a force at the start, of a motion at the end
//! A' = A,  B' = B - A [r+],  C' = C + [r-] A,  D' = D - C [r+] + [r-] B'
//! U+ = H s+,  U- = H^T s-,  D = s-^T U+,   H - U+ U-^T / D          a freedom gives way
//! ```
//! `r-` and `r+` from the parent's centre to the body's, before the step and after it, `s-` and
//! `s+` the twists of a freedom there. See [`TreeVariational`](super::TreeVariational).

use nalgebra::{Matrix3, Vector3};

use super::inertia::cross_columns;
use super::spatial::{SpatialForce, Twist};

/// A force at the start of a step for each motion at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bilinear {
    pub linear: Matrix3<f64>,
    pub upper: Matrix3<f64>,
    pub lower: Matrix3<f64>,
    pub angular: Matrix3<f64>,
}

impl Bilinear {
    pub(super) fn zero() -> Self {
        Bilinear {
            linear: Matrix3::zeros(),
            upper: Matrix3::zeros(),
            lower: Matrix3::zeros(),
            angular: Matrix3::zeros(),
        }
    }

    #[inline]
    pub(super) fn times(&self, after: &Twist) -> SpatialForce {
        SpatialForce {
            force: self.linear * after.linear + self.upper * after.angular,
            torque: self.lower * after.linear + self.angular * after.angular,
        }
    }

    #[inline]
    pub(super) fn transposed_times(&self, before: &Twist) -> SpatialForce {
        SpatialForce {
            force: self.linear.tr_mul(&before.linear) + self.lower.tr_mul(&before.angular),
            torque: self.upper.tr_mul(&before.linear) + self.angular.tr_mul(&before.angular),
        }
    }

    /// What is left when a freedom gives way.
    #[inline]
    pub(super) fn give_way(&mut self, plus: &SpatialForce, minus: &SpatialForce, inverse: f64) {
        let plus = *plus * inverse;
        self.linear -= plus.force * minus.force.transpose();
        self.upper -= plus.force * minus.torque.transpose();
        self.lower -= plus.torque * minus.force.transpose();
        self.angular -= plus.torque * minus.torque.transpose();
    }

    /// The same form about points `before` and `after` further back.
    #[inline]
    pub(super) fn inward(&self, before: &Vector3<f64>, after: &Vector3<f64>) -> Self {
        // -M [r] = ([r] M^T)^T
        let behind = |m: &Matrix3<f64>| cross_columns(after, &m.transpose()).transpose();
        let upper = self.upper + behind(&self.linear);
        let lower = self.lower + cross_columns(before, &self.linear);
        let angular = self.angular + behind(&self.lower) + cross_columns(before, &upper);
        Bilinear { linear: self.linear, upper, lower, angular }
    }

    /// Adds that of a body about its centre.
    #[inline]
    pub(super) fn add_body(&mut self, linear: f64, angular: &Matrix3<f64>) {
        (0..3).for_each(|k| self.linear[(k, k)] += linear);
        self.angular += angular;
    }

    #[inline]
    pub(super) fn add(&mut self, other: &Bilinear) {
        self.linear += other.linear;
        self.upper += other.upper;
        self.lower += other.lower;
        self.angular += other.angular;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_form_of_two_motions_is_the_same_about_every_pair_of_points() {
        let form = Bilinear {
            linear: Matrix3::new(1.0, 0.2, 0.0, -0.3, 2.0, 0.1, 0.0, 0.4, 1.5),
            upper: Matrix3::new(0.1, 0.2, 0.3, -0.4, 0.5, 0.6, 0.7, -0.8, 0.9),
            lower: Matrix3::new(0.3, -0.2, 0.1, 0.4, 0.2, -0.6, 0.7, 0.1, 0.0),
            angular: Matrix3::new(0.5, 0.0, 0.2, 0.1, 0.6, 0.0, -0.2, 0.0, 0.7),
        };
        let (r, s) = (Vector3::new(0.3, -1.0, 0.5), Vector3::new(0.2, -1.1, 0.8));
        let a =
            Twist { linear: Vector3::new(1.0, 2.0, 3.0), angular: Vector3::new(-1.0, 0.5, 0.2) };
        let b =
            Twist { linear: Vector3::new(0.3, -2.0, 1.0), angular: Vector3::new(0.7, 0.1, -2.0) };
        let there = form.times(&b.outward(&s)).along(&a.outward(&r));
        let here = form.inward(&r, &s).times(&b).along(&a);
        assert!((there / here - 1.0).abs() < 1e-14, "{there} {here}");
        let turned = form.transposed_times(&a).along(&b);
        assert!((form.times(&b).along(&a) / turned - 1.0).abs() < 1e-15);
    }
}
