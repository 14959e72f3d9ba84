//! Robertson's three reactions, whose rates differ by nine powers of ten.
//!
//! ```text
//! a' = -0.04 a + 10^4 b c,    c' = 3 10^7 b^2,    b' = -a' - c'
//! ```
//! `a b c` concentrations, with a + b + c = 1. The state at t = 10^11 is that of the Test Set for
//! IVP Solvers (Bari, release 2.4), confirmed to 11 digits by Radau IIA and to 9 by BDF; there b is
//! 8.3e-14, so that an absolute tolerance for b must be far below. Source: Robertson (1966); Hairer
//! and Wanner, Solving Ordinary Differential Equations II, IV.1.

use super::StiffProblem;
use crate::{Jacobian, Moment, VectorField};

/// The right-hand side of Robertson's reactions, y = (a, b, c).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RobertsonField;

impl VectorField for RobertsonField {
    fn dim(&self) -> usize {
        3
    }

    #[inline]
    fn evaluate(&self, _t: f64, y: &[f64], f: &mut [f64]) {
        f[0] = -0.04 * y[0] + 1e4 * y[1] * y[2];
        f[2] = 3e7 * y[1] * y[1];
        f[1] = -f[0] - f[2];
    }

    fn jacobian(&self, _t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        let (b, c) = (y[1], y[2]);
        df[..3].copy_from_slice(&[-0.04, 0.04, 0.0]);
        df[3..6].copy_from_slice(&[1e4 * c, -1e4 * c - 6e7 * b, 6e7 * b]);
        df[6..].copy_from_slice(&[1e4 * b, -1e4 * b, 0.0]);
        Jacobian::Written
    }
}

/// The same with the sum of the concentrations as a constraint in place of the third rate:
/// M y' = f with M = diag(1, 1, 0).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ConstrainedRobertsonField;

impl VectorField for ConstrainedRobertsonField {
    fn dim(&self) -> usize {
        3
    }

    #[inline]
    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        RobertsonField.evaluate(t, y, f);
        f[2] = y[0] + y[1] + y[2] - 1.0;
    }

    fn jacobian(&self, t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        let known = RobertsonField.jacobian(t, y, df);
        df.chunks_exact_mut(3).for_each(|column| column[2] = 1.0);
        known
    }

    fn mass(&self) -> Option<&[f64]> {
        Some(&[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0])
    }
}

/// From pure a, over 10^11 s.
pub fn robertson() -> StiffProblem<RobertsonField, 3> {
    StiffProblem {
        name: "robertson",
        field: RobertsonField,
        initial: Moment::new(0.0, [1.0, 0.0, 0.0]),
        end: 1e11,
        scale: [1e-7, 1e-13, 1.0],
        solution: Some([
            0.208_334_014_970_125_5e-7,
            0.833_336_077_033_471_3e-13,
            0.999_999_979_166_505,
        ]),
        solution_error: 1e-11,
    }
}

/// The same reactions with their sum as a constraint.
pub fn constrained_robertson() -> StiffProblem<ConstrainedRobertsonField, 3> {
    let StiffProblem { initial, end, scale, solution, solution_error, .. } = robertson();
    StiffProblem {
        name: "constrained-robertson",
        field: ConstrainedRobertsonField,
        initial,
        end,
        scale,
        solution,
        solution_error,
    }
}
