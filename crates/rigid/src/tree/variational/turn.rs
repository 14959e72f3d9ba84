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
    /// `theta x u` and `theta x (theta x u)`.
    crosses: [Vector3<f64>; 2],
    c: f64,
}

impl Turn {
    #[inline]
    pub(super) fn between(before: &Placed, after: &Placed, moments: &Vector3<f64>) -> Self {
        let theta = before.rotation.direction_to(&after.rotation);
        let c = inverse_coefficient(theta.norm_squared());
        let u = moments.component_mul(&theta);
        let once = theta.cross(&u);
        Turn { theta, u, crosses: [once, theta.cross(&once)], c }
    }

    /// `T(-theta)^-T I theta`
    #[inline]
    pub(super) fn momentum(&self) -> Vector3<f64> {
        let [once, twice] = &self.crosses;
        self.u + once * 0.5 + twice * self.c
    }

    /// The derivative of `T(-theta)^-T I theta` along turns of the body at the end.
    #[inline]
    pub(super) fn slope(&self, moments: &Vector3<f64>) -> Matrix3<f64> {
        let Turn { theta: x, u, crosses: [_, twice], c } = self;
        let s = x.norm_squared();
        // The slope of c with the squared angle, to 1e-5 of itself at a whole radian.
        let growth = 1.0 + s * (1.0 / 21.0 + s * (1.0 / 560.0 + s * (1.0 / 16_632.0)));
        let change = growth * (1.0 / 720.0);
        let inner = polynomial(x, 0.5, *c);
        let (along, across, bent) =
            (*c * x.dot(u), x * *c, twice * (2.0 * change) - u * (2.0 * *c));
        let half = u * 0.5;
        // Column by column: I, half of -[u], c (x u^T + <x, u> - 2 u x^T), and what c changes by.
        let column = |k: usize| {
            let mut column = inner.column(k) * moments[k] + across * u[k] + bent * x[k];
            column[k] += along;
            let (next, last) = ((k + 1) % 3, (k + 2) % 3);
            column[next] -= half[last];
            column[last] += half[next];
            column
        };
        Matrix3::from_columns(&[column(0), column(1), column(2)]) * inner
    }
}
