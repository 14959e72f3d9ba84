//! The harmonic oscillator: a unit mass on a spring without rest length.
//!
//! ```text
//! V(q) = 1/2 omega^2 q^2        q(t) = cos(omega t),  p(t) = -omega sin(omega t)
//! ```
//! Source: notes 4.2, figure 4.1.

use std::f64::consts::TAU;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};

use super::{Problem, ProblemError, SmallProblem, within};
use crate::State;

/// A linear spring between the origin and each of N freedoms: `V = 1/2 k |q|^2`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Linear<const N: usize> {
    /// The stiffness k, N/m.
    pub stiffness: f64,
}

impl<const N: usize> Potential for Linear<N> {
    fn dim(&self) -> usize {
        N
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * self.stiffness * q.iter().map(|q| q * q).sum::<f64>()
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for (row, q) in dv.0.iter_mut().zip(q) {
            *row += self.stiffness * q;
        }
    }

    #[inline]
    fn add_hessian(&self, _q: &[f64], hessian: &mut impl Sink) {
        for freedom in 0..N {
            hessian.add_symmetric(&[freedom], &[self.stiffness]);
        }
    }
}

/// An oscillator of angular frequency `omega` (rad/s, positive) that starts at rest at q = 1.
///
/// # Errors
/// [`ProblemError::Parameter`] for a frequency outside of (1e-100, 1e100).
pub fn oscillator(omega: f64) -> Result<SmallProblem<Linear<1>, 1>, ProblemError> {
    within("omega", omega, "(1e-100, 1e100)", 1e-100..1e100)?;
    Ok(Problem {
        name: "oscillator",
        system: System::new(DiagonalMetric::new([1.0; 1])?, Linear { stiffness: omega * omega })?,
        initial: State::new([1.0], Covector([0.0])),
        horizon: TAU / omega,
        period: TAU / omega,
        scale: 1.0,
        solution: Box::new(move |t| Some([(omega * t).cos()])),
        solution_error: 1e-15,
    })
}
