//! The turn of a body in a variational step: its momentum, and the derivative of that.
//!
//! ```text
//! theta = log(R^T R'),     T(-theta)^-T I theta = u + theta x u / 2 + c theta x (theta x u),    u = I theta
//! ```
//! in body axes at the start; `T` the right Jacobian, `I` the moments.

use nalgebra::{Matrix3, Vector3};

use super::super::motion::Placed;
use crate::LieGroup;
use crate::jacobian::{inverse_coefficient, polynomial};

/// The turn of a body in a step.
pub(super) struct Turn {
    pub(super) theta: Vector3<f64>,
    /// `I theta`
    u: Vector3<f64>,
    c: f64,
}

impl Turn {
    #[inline]
    pub(super) fn between(before: &Placed, after: &Placed, moments: &Vector3<f64>) -> Self {
        let theta = before.rotation.direction_to(&after.rotation);
        let c = inverse_coefficient(theta.norm_squared());
        Turn { theta, u: moments.component_mul(&theta), c }
    }

    /// `T(-theta)^-T I theta`
    #[inline]
    pub(super) fn momentum(&self) -> Vector3<f64> {
        let once = self.theta.cross(&self.u);
        self.u + once * 0.5 + self.theta.cross(&once) * self.c
    }

    /// The derivative of `T(-theta)^-T I theta` along turns of the body at the end.
    #[inline]
    pub(super) fn slope(&self, moments: &Vector3<f64>) -> Matrix3<f64> {
        let Turn { theta: x, u, c } = self;
        let s = x.norm_squared();
        // The slope of c with the squared angle, to 1e-5 of itself at a whole radian.
        let change = (1.0 + s * (1.0 / 21.0 + s * (1.0 / 560.0 + s / 16_632.0))) / 720.0;
        let inner = polynomial(x, 0.5, *c);
        let outer = u.cross_matrix() * -0.5
            + (x * u.transpose() + Matrix3::from_diagonal_element(x.dot(u))
                - u * x.transpose() * 2.0)
                * *c
            + x.cross(&x.cross(u)) * x.transpose() * (2.0 * change);
        (inner * Matrix3::from_diagonal(moments) + outer) * inner
    }
}
