//! How wrong may a derivative be, and how far away a guess? Two tables on one small problem.
//!
//! ```text
//! f(q) = m l^2 (q - y) + h^2 m g l sin q = 0        one step of implicit Euler of a pendulum
//! df_used = (1 + e) df                              e the injected relative error
//! ```
//! `q` the angle from hanging (radians), `y` where inertia alone would carry it, `h` the step. In
//! units of `m l^2`, with `k = h^2 g/l`: `f = q - y + k sin q`. With a wrong derivative
//! the error of an iterate shrinks by `|e / (1 + e)|` a step instead of being squared, unless the line
//! search steps in: linear convergence that still ends at the right root. That is the blessing and the
//! curse of notes 4.4: a derivative that is wrong by half still passes, and only the count of
//! iterations tells (`more_than_a_dozen_iterations_mean_that_a_tenth_is_wrong`).

use crate::{FunctionEquation, Newton, NewtonError, NewtonMemory, NewtonReport};
use stationary_measure::{Cell, Column, Table};

/// The stiffness `h^2 g/l` of the step: at 1 a step is a radian of small oscillation.
const K: f64 = 1.0;
/// Where inertia alone would carry the pendulum, radians.
const Y: f64 = 1.2;
/// Solved to this, and within this many iterations.
const NEWTON: Newton = Newton { tolerance: 1e-13, iterations: 200 };

struct Run {
    result: Result<NewtonReport, NewtonError>,
    history: Vec<f64>,
    q: f64,
}

/// Solves the step with stiffness k and the derivative times `factor` from a guess.
fn run(k: f64, factor: f64, guess: f64) -> Option<Run> {
    let mut equation = FunctionEquation::new(
        1,
        |q: &[f64], f: &mut [f64]| f[0] = q[0] - Y + k * q[0].sin(),
        |q: &[f64], df: &mut [f64]| df[0] = factor * (1.0 + k * q[0].cos()),
    );
    let mut memory = NewtonMemory::<[f64; 1]>::new(1, NEWTON.iterations)?;
    let mut q = [guess];
    let result = NEWTON.solve(&mut equation, &mut q, &mut memory);
    Some(Run { result, history: memory.history().to_vec(), q: q[0] })
}

impl Run {
    fn outcome(&self) -> Cell {
        match &self.result {
            Ok(_) => "root".into(),
            Err(error) => error.failure.to_string().into(),
        }
    }

    /// How many steps led to the root; how many led nowhere depends on rounding.
    fn iterations(&self) -> Cell {
        match &self.result {
            Ok(report) => Cell::Count(report.iterations.into()),
            Err(_) => "-".into(),
        }
    }

    /// The factor by which the residual shrank a step, over the last steps above rounding.
    fn rate(&self) -> Option<f64> {
        let above: Vec<f64> = self.history.iter().copied().filter(|&size| size > 1e-12).collect();
        let [.., before, last] = above[..] else { return None };
        Some(last / before)
    }
}

/// Iterations against an injected relative error of the derivative, from the guess y.
pub fn newton_against_wrong_derivatives() -> Table {
    let mut table = Table::new([
        Column::rounded("relative error of df", 3, 0.0),
        Column::exact("iterations"),
        Column::exact("outcome"),
        Column::rounded("last ratio of residuals", 2, 1e-12),
        Column::rounded("|e / (1 + e)|", 2, 0.0),
    ]);
    for error in [0.0, 1e-8, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 0.9, -0.1, -0.5, -0.9, -2.0] {
        let Some(run) = run(K, 1.0 + error, Y) else { continue };
        let rate = run.rate().map_or(Cell::Text("-".to_owned()), Cell::Number);
        let predicted = (error / (1.0 + error)).abs();
        table.push([error.into(), run.iterations(), run.outcome(), rate, predicted.into()]);
    }
    table
}

/// Iterations and outcome against the initial guess, for a soft and a stiff step.
///
/// The soft step has one root; the stiff one has several, the guess decides which is found, and from
/// far away the search may be caught where |f| is smallest without being zero.
pub fn newton_against_initial_guesses() -> Table {
    let mut table = Table::new([
        Column::rounded("h^2 g/l", 2, 0.0),
        Column::rounded("guess [rad]", 3, 0.0),
        Column::exact("iterations"),
        Column::exact("outcome"),
        Column::rounded("q [rad]", 6, 1e-9),
    ]);
    for k in [K, 20.0] {
        for guess in [Y, 0.0, 0.5, 1.5, 3.0, -3.0, 10.0, 100.0] {
            let Some(run) = run(k, 1.0, guess) else { continue };
            let q = if run.result.is_ok() { run.q.into() } else { "-".into() };
            table.push([k.into(), guess.into(), run.iterations(), run.outcome(), q]);
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NewtonFailure;

    fn number(cell: &Cell) -> f64 {
        match cell {
            Cell::Number(x) => *x,
            Cell::Count(n) => *n as f64,
            Cell::Text(_) => f64::NAN,
        }
    }

    /// Error, iterations, last ratio and predicted ratio of each row that found the root.
    fn converged() -> Vec<[f64; 4]> {
        let table = newton_against_wrong_derivatives();
        let rows = table.rows().iter().filter(|row| row[2] == Cell::from("root"));
        rows.map(|row| [0, 1, 3, 4].map(|j| number(&row[j]))).collect()
    }

    #[test]
    fn a_wrong_derivative_converges_linearly_at_the_predicted_rate() {
        for [error, _, measured, predicted] in converged() {
            if (1e-4..1.0).contains(&error) {
                assert!((measured / predicted - 1.0).abs() < 0.05, "{error}: {measured}");
            }
        }
    }

    #[test]
    fn more_than_a_dozen_iterations_mean_that_a_tenth_is_wrong() {
        let rows = converged();
        assert_eq!(rows.len(), 11);
        for [error, iterations, ..] in rows {
            if error.abs() <= 1e-2 {
                assert!(iterations <= 8.0);
            } else if error != -0.5 {
                // At -0.5 every half step of the line search is the exact Newton step.
                assert!(iterations > 12.0, "{error}: {iterations}");
            }
        }
    }

    #[test]
    fn the_wrong_sign_is_caught() {
        let table = newton_against_wrong_derivatives();
        let row = table.rows().last().unwrap();
        assert_eq!(row[2], Cell::from(NewtonFailure::Stalled.to_string()));
        let run = run(K, -1.0, Y).unwrap();
        assert_eq!((run.history.len(), run.q), (1, Y));
    }

    #[test]
    fn a_soft_step_has_one_root_and_a_stiff_one_several() {
        let table = newton_against_initial_guesses();
        let soft = number(&table.rows()[0][4]);
        let mut stiff = Vec::new();
        for row in table.rows() {
            let [k, guess, q] = [0, 1, 4].map(|j| number(&row[j]));
            if k > K && guess == 100.0 {
                assert_eq!(row[3], Cell::from(NewtonFailure::Stalled.to_string()));
                continue;
            }
            assert!((q - Y + k * q.sin()).abs() < 1e-12);
            if k == K {
                assert!((q - soft).abs() < 1e-12);
            } else if stiff.iter().all(|other: &f64| (other - q).abs() > 1e-6) {
                stiff.push(q);
            }
        }
        assert!(stiff.len() >= 4, "{stiff:?}");
    }
}
