//! A sun and two heavy planets in the plane, on orbits that stay apart.
//!
//! ```text
//! V(q) = - sum_{i<j} m_i m_j / |q_i - q_j|          (G = 1)
//! ```
//! It has no closed solution; it is there for its invariants: energy, linear and angular momentum.

use std::f64::consts::TAU;

use stationary_calculus::{Covector, DiagonalMetric, System};

use super::{Problem, ProblemError, SmallProblem};
use crate::{NewtonianGravity, State};

/// Masses 1, 0.02 and 0.01 at distances 1 and 2.5, over about ten turns of the inner planet.
///
/// # Errors
/// None: all its numbers are given.
pub fn three_bodies() -> Result<SmallProblem<NewtonianGravity<2>, 6>, ProblemError> {
    let [sun, inner, outer] = [1.0, 0.02, 0.01];
    let gravity =
        NewtonianGravity { constant: 1.0, masses: vec![sun, inner, outer], fixed: Vec::new() };
    let metric = DiagonalMetric::new([sun, sun, inner, inner, outer, outer])?;
    Ok(Problem {
        name: "three-bodies",
        system: System::new(metric, gravity)?,
        initial: State::new(
            [0.0, 0.0, 1.0, 0.1, -2.5, 0.5],
            Covector([0.003, -0.01, 0.0, 0.018, -0.001, -0.006]),
        ),
        horizon: 10.0 * TAU,
        period: TAU,
        scale: 1.0,
        solution: Box::new(|_| None),
        solution_error: f64::INFINITY,
    })
}
