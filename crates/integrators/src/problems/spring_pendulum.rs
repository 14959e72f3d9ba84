//! A unit mass that hangs on a stiff spring and swings: two time scales that are coupled.
//!
//! ```text
//! V(q) = k/2 (|q| - 1)^2 + q_2            (m = L = g = 1)
//! ```
//! It has no closed solution; it is there to break methods that are stable on linear systems. It
//! starts sideways, at a right angle to hanging, with the spring at rest. Source: errata 4.5.

use std::f64::consts::TAU;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};

use super::{Problem, ProblemError, SmallProblem, within};
use crate::State;

/// A spring of unit length from the origin, and unit gravity downward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TetherPotential {
    /// The stiffness k.
    pub stiffness: f64,
}

impl Potential for TetherPotential {
    fn dim(&self) -> usize {
        2
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let stretch = q[0].hypot(q[1]) - 1.0;
        0.5 * self.stiffness * stretch * stretch + q[1]
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let length = q[0].hypot(q[1]);
        let tension = self.stiffness * (length - 1.0) / length;
        dv.0[0] += tension * q[0];
        dv.0[1] += tension * q[1] + 1.0;
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let length = q[0].hypot(q[1]);
        let (x, y) = (q[0] / length, q[1] / length);
        let (along, across) = (self.stiffness, self.stiffness * (1.0 - 1.0 / length));
        let mixed = (along - across) * x * y;
        let block = [along * x * x + across * y * y, mixed, mixed, along * y * y + across * x * x];
        hessian.add_symmetric(&[0, 1], &block);
    }
}

/// The swinging mass on a spring of stiffness `k` (positive), over one swing of a rigid pendulum.
///
/// # Errors
/// [`ProblemError::Parameter`] for a stiffness outside of (1e-100, 1e100).
pub fn spring_pendulum(k: f64) -> Result<SmallProblem<TetherPotential, 2>, ProblemError> {
    within("k", k, "(1e-100, 1e100)", 1e-100..1e100)?;
    Ok(Problem {
        name: "spring-pendulum",
        system: System::new(DiagonalMetric::new([1.0; 2])?, TetherPotential { stiffness: k })?,
        initial: State::new([1.0, 0.0], Covector([0.0, 0.0])),
        horizon: TAU,
        period: TAU / k.sqrt(),
        scale: 1.0,
        solution: Box::new(|_| None),
        solution_error: f64::INFINITY,
    })
}
