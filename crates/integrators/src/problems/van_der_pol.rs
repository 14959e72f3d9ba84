//! Van der Pol's oscillator: slow creeping, then a jump, the faster the larger mu is.
//!
//! ```text
//! x' = v,      v' = mu (1 - x^2) v - x
//! ```
//! For mu = 1000 the state at t = 2000 is known from the Test Set for IVP Solvers (Bari, release
//! 2.4), confirmed to 11 digits by Radau IIA and to 9 by BDF. For large mu one
//! period takes about (3 - 2 ln 2) mu, for small mu 2 pi.

use super::{ProblemError, StiffProblem, within};
use crate::{Jacobian, Moment, VectorField};

/// Van der Pol's right-hand side, y = (x, v).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VanDerPolField {
    /// The strength mu of the damping.
    pub mu: f64,
}

impl VectorField for VanDerPolField {
    fn dim(&self) -> usize {
        2
    }

    #[inline]
    fn evaluate(&self, _t: f64, y: &[f64], f: &mut [f64]) {
        f[0] = y[1];
        f[1] = self.mu * (1.0 - y[0] * y[0]) * y[1] - y[0];
    }

    fn jacobian(&self, _t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        df.copy_from_slice(&[
            0.0,
            -2.0 * self.mu * y[0] * y[1] - 1.0,
            1.0,
            self.mu * (1.0 - y[0] * y[0]),
        ]);
        Jacobian::Written
    }
}

/// From (2, 0) over 2 mu seconds: a little more than a period where mu is 10 or more, less than one where mu is
/// small.
///
/// # Errors
/// [`ProblemError::Parameter`] for a damping outside of (1e-100, 1e100).
pub fn van_der_pol(mu: f64) -> Result<StiffProblem<VanDerPolField, 2>, ProblemError> {
    within("mu", mu, "(1e-100, 1e100)", 1e-100..1e100)?;
    let known = [0.170_616_773_217_046_9e1, -0.892_809_701_024_812_5e-3];
    Ok(StiffProblem {
        name: "van-der-pol",
        field: VanDerPolField { mu },
        initial: Moment::new(0.0, [2.0, 0.0]),
        end: 2.0 * mu,
        scale: [1.0, 1.0 / mu],
        solution: (mu == 1000.0).then_some(known),
        solution_error: 1e-10,
    })
}
