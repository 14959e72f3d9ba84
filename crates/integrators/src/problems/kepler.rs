//! A planet about a fixed sun, on an ellipse of eccentricity e.
//!
//! ```text
//! V(q) = -1/|q|,    E - e sin E = t,    q(t) = (cos E - e, sqrt(1 - e^2) sin E)
//! ```
//! The semimajor axis, the mass and the field's strength are 1, so that the period is 2 pi. It
//! starts where it is nearest to the sun. Energy -1/2, angular momentum sqrt(1 - e^2).

use std::f64::consts::TAU;

use stationary_calculus::{Covector, DiagonalMetric, System};

use super::{Problem, ProblemError, SmallProblem, within};
use crate::{CentralGravity, State};

/// The planet of eccentricity `e` in [0, 1) over ten of its years.
///
/// # Errors
/// [`ProblemError::Parameter`] for another eccentricity.
pub fn kepler(e: f64) -> Result<SmallProblem<CentralGravity<2>, 2>, ProblemError> {
    let minor = ((1.0 - e) * (1.0 + e)).sqrt();
    within("e", e, "[0, 1)", -f64::MIN_POSITIVE..1.0)?;
    Ok(Problem {
        name: "kepler",
        system: System::new(DiagonalMetric::new([1.0; 2])?, CentralGravity { strength: 1.0 })?,
        initial: State::new([1.0 - e, 0.0], Covector([0.0, ((1.0 + e) / (1.0 - e)).sqrt()])),
        horizon: 10.0 * TAU,
        period: TAU,
        scale: 1.0,
        solution: Box::new(move |t| {
            let anomaly = eccentric_anomaly(e, t);
            Some([anomaly.cos() - e, minor * anomaly.sin()])
        }),
        solution_error: 1e-14,
    })
}

/// Newton's steps for Kepler's equation: from this guess a dozen reach rounding for every e < 1.
const STEPS: usize = 60;

/// Solves `E - e sin E = t` for the eccentric anomaly E.
fn eccentric_anomaly(e: f64, t: f64) -> f64 {
    let mean = t - TAU * (t / TAU).round();
    // The equation is odd, and convex above zero: from pi Newton's method descends to the root.
    let mut anomaly = std::f64::consts::PI;
    for _ in 0..STEPS {
        let step = (anomaly - e * anomaly.sin() - mean.abs()) / (1.0 - e * anomaly.cos());
        anomaly -= step;
        if step.abs() <= 2.0 * f64::EPSILON {
            break;
        }
    }
    anomaly.copysign(mean)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keplers_equation_is_solved_at_every_eccentricity() {
        for e in [0.0, 0.3, 0.6, 0.9, 0.99, 0.9999] {
            for i in -300..300 {
                let t = 0.02 * f64::from(i) + 1e-9;
                let anomaly = eccentric_anomaly(e, t);
                let mean = anomaly - e * anomaly.sin();
                assert!((mean - (t - TAU * (t / TAU).round())).abs() < 4e-15, "e = {e}, t = {t}");
            }
        }
    }

    #[test]
    fn the_planet_starts_where_its_solution_says() {
        let problem = kepler(0.6).unwrap();
        assert_eq!((problem.solution)(0.0), Some(problem.initial.q));
        assert!((problem.energy(&problem.initial) + 0.5).abs() < 1e-15);
    }
}
