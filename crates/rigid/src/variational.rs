//! The variational rotation of 9.5: angular velocity is constant over a step.
//!
//! ```text
//! S = exp(h w),     T(-h w)^-T I w = m                solved for w by Newton's method
//! T(-x)^-T = I + [x]/2 + c(|x|^2) [x]^2
//! ```
//! `w` the angular velocity over the step and `m` the momentum at its start, both in body axes; `I`
//! the moments, `T` the right Jacobian, `h` seconds. With `m' = S^T m` at its end the discrete
//! Euler equations of the notes, `T(-h w')^-T I w' = T(h w)^-T I w - h dV`, say that momenta agree
//! at each node. `m` is the discrete Legendre transform; a state that held `w` itself would be half
//! a step off (errata 5.5).
//!
//! Order 2, implicit, symmetric, symplectic; spatial angular momentum is kept to rounding even
//! where Newton's method is not. The turn of a step must stay below pi, where w stops being unique;
//! a step that fast is an error. Source: notes 9.5, whose update on p. 104 is right as printed.

use std::f64::consts::PI;

use nalgebra::{Matrix3, Vector3};
use stationary_calculus::{NewtonError, NewtonFailure, Unsolvable};
use stationary_integrators::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, StepError,
    Symplecticity,
};

use crate::free_rotation::{FreeRotation, Turned};
use crate::jacobian::inverse_coefficient;
use crate::{Body, LieGroup, Rotation};

/// The variational rotation of 9.5.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstantVelocity;

/// Most Newton iterations: steps of less than a quarter turn take four.
const ITERATIONS: u32 = 30;
/// A residual of this size relative to the momentum is rounding.
const ROUNDING: f64 = 4e-16;

impl FreeRotation for ConstantVelocity {
    const FACTS: Facts = Facts {
        name: "variational-rotation",
        order: 2,
        stages: 1,
        evaluation: Evaluation::Implicit,
        symmetric: true,
        symplecticity: Symplecticity::Symplectic,
        energy: EnergyBehavior::Bounded,
        linear_momentum: Conservation::Exact,
        angular_momentum: Conservation::Exact,
        stability: Stability::Below(2.0),
        damping: Damping::Conditional,
        error_growth: ErrorGrowth::Linear,
    };

    #[inline]
    fn turn(
        body: &Body,
        rotation: Rotation,
        momentum: Vector3<f64>,
        h: f64,
    ) -> Result<Turned, StepError> {
        let scale = momentum.amax();
        let mut w = body.angular_velocity(&momentum);
        // Half a step of Euler's equations, which the mean velocity is close to.
        w = body.angular_velocity(&(momentum + 0.5 * h * momentum.cross(&w)));
        let mut last = f64::INFINITY;
        let mut history = [0.0; ITERATIONS as usize];
        for iteration in 0..ITERATIONS {
            let (residual, jacobian) = equation(body, &w, &momentum, h);
            let size = residual.amax();
            history[iteration as usize] = size;
            let settled = size <= ROUNDING * scale || (size >= 0.5 * last && size <= 1e-13 * scale);
            if settled && (h * w.norm()).abs() < PI {
                let turned = Turned::by(Rotation::exp(w * h), rotation, momentum);
                let residual = if scale > 0.0 { size / scale } else { 0.0 };
                return Ok(Turned { iterations: iteration, residual, ..turned });
            }
            if !size.is_finite() {
                return Err(failed(NewtonFailure::NonFinite(0), &history[..=iteration as usize]));
            }
            last = size;
            let Some(inverse) = jacobian.try_inverse() else {
                let singular = NewtonFailure::Unsolvable(Unsolvable::Singular);
                return Err(failed(singular, &history[..=iteration as usize]));
            };
            w -= inverse * residual;
        }
        Err(failed(NewtonFailure::NotConverged, &history))
    }
}

#[cold]
fn failed(failure: NewtonFailure, history: &[f64]) -> StepError {
    NewtonError { failure, history: history.to_vec() }.into()
}

/// `T(-h w)^-T I w - m`, and its derivative up to the slope of c, of order h^4.
#[inline]
fn equation(
    body: &Body,
    w: &Vector3<f64>,
    m: &Vector3<f64>,
    h: f64,
) -> (Vector3<f64>, Matrix3<f64>) {
    let (x, u) = (w * h, body.angular_momentum(w));
    let c = inverse_coefficient(x.norm_squared());
    let xu = x.cross(&u);
    let residual = (u - m) + xu * 0.5 + x.cross(&xu) * c;
    // By x cross (x cross u) = x (x.u) - u (x.x).
    let along = x.dot(&u);
    let moments = Matrix3::from_diagonal(&body.moments());
    let inner = Matrix3::identity()
        + x.cross_matrix() * 0.5
        + (x * x.transpose() - Matrix3::identity() * x.norm_squared()) * c;
    let outer = u.cross_matrix() * -0.5
        + (x * u.transpose() + Matrix3::identity() * along - u * x.transpose() * 2.0) * c;
    (residual, inner * moments + outer * h)
}
