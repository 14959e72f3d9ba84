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
    let fastest = ((1.0 + e) / (1.0 - e)).sqrt();
    Ok(Problem {
        name: "kepler",
        system: System::new(DiagonalMetric::new([1.0; 2])?, CentralGravity { strength: 1.0 })?,
        initial: State::new([1.0 - e, 0.0], Covector([0.0, fastest])),
        horizon: 10.0 * TAU,
        period: TAU,
        scale: 1.0,
        solution: Box::new(move |t| {
            let anomaly = eccentric_anomaly(e, t);
            Some([anomaly.cos() - e, minor * anomaly.sin()])
        }),
        // What rounds the time to that of the year moves the planet by its speed, most near the sun.
        solution_error: (ROUNDED_TIME * fastest).max(1e-14),
    })
}

/// How far rounding puts the time within ten years off, seconds.
const ROUNDED_TIME: f64 = 5e-15;

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
    fn the_solution_is_as_good_as_it_says_near_the_sun() {
        // What double precision leaves of 2 pi.
        const REST: f64 = 2.449_293_598_294_706_4e-16;
        for e in [0.0, 0.6, 0.9, 0.99, 0.9999] {
            let problem = kepler(e).unwrap();
            let mut worst = 0.0_f64;
            for year in 0..=10 {
                for i in -200..=200 {
                    let (year, t) = (f64::from(year), 1e-9 * f64::from(i) * f64::from(i).abs());
                    let t = year * TAU + t;
                    let mean = year.mul_add(-TAU, t) - year * REST;
                    let exact = problem.error(t, &(problem.solution)(mean).unwrap()).unwrap();
                    worst = worst.max(exact);
                }
            }
            let promise = problem.solution_error;
            assert!(worst < promise && promise < 5.0 * worst, "e = {e}: {worst} of {promise}");
        }
    }

    #[test]
    fn the_planet_starts_where_its_solution_says() {
        let problem = kepler(0.6).unwrap();
        assert_eq!((problem.solution)(0.0), Some(problem.initial.q));
        assert!((problem.energy(&problem.initial) + 0.5).abs() < 1e-15);
    }
}
