//! Error against step and cost: what a method delivers on a problem, measured.
//!
//! ```text
//! error(h) = largest distance from the true configuration along the trajectory
//! error(h) ~ C h^k at a fixed end time                        k the order (errata 4.5)
//! ```
//! The largest error along the way is taken because an error at the end alone may pass through zero
//! and mislead. A run that fails is kept with its reason.

use std::ops::ControlFlow;

use stationary_calculus::{Metric, Potential, Storage};
use stationary_measure::{Cell, Column, Table, loglog_slope};

use crate::problems::Problem;
use crate::{Cost, Horizon, Integrator, Method, SimulationError, simulate};

/// What a run delivers and costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Delivered {
    /// The largest error along the trajectory, relative to the problem's scale; `None` where the true
    /// motion is known at no step of it.
    pub error: Option<f64>,
    /// The largest change of energy along the trajectory, joules.
    pub energy_error: f64,
    /// What it cost.
    pub cost: Cost,
}

/// Runs an integrator over a problem's horizon in this many steps.
///
/// # Errors
/// Those of [`simulate`].
pub fn deliver<M: Metric, P: Potential, C: Storage>(
    problem: &Problem<M, P, C>,
    integrator: &mut (impl Integrator<C> + ?Sized),
    steps: Horizon,
) -> Result<Delivered, SimulationError> {
    let mut state = problem.initial.clone();
    let start = problem.energy(&state);
    let (mut error, mut energy_error) = (None, 0.0_f64);
    let cost = simulate(integrator, &mut state, steps, |now| {
        if let Some(distance) = problem.error(now.state.t, &now.state.q) {
            error = Some(distance.max(error.unwrap_or(0.0)));
        }
        energy_error = energy_error.max((problem.energy(now.state) - start).abs());
        ControlFlow::Continue(())
    })?;
    Ok(Delivered { error, energy_error, cost })
}

/// One row of a [`Convergence`].
#[derive(Clone, Debug, PartialEq)]
pub struct ConvergenceRow {
    /// The steps.
    pub horizon: Horizon,
    /// What they delivered, or why they failed.
    pub outcome: Result<Delivered, SimulationError>,
}

/// A method on a problem at several steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// The method.
    pub method: Method,
    /// Coarse steps first, if the caller asked so.
    pub rows: Vec<ConvergenceRow>,
}

/// Errors above this are as large as the motion, and say nothing of the order.
const ASYMPTOTIC: f64 = 0.03;
/// Runs of the finest steps that an order is measured from.
const FINEST: usize = 5;
/// Errors below this are rounding, added up over many steps.
const ROUNDING: f64 = 2e-12;

impl Convergence {
    /// Runs a method on a problem at each of these numbers of steps.
    ///
    /// # Errors
    /// Where the problem's storage is not of its size, or its horizon is not that many steps. A run
    /// that fails is a row.
    pub fn measure<M: Metric, P: Potential, C: Storage>(
        problem: &Problem<M, P, C>,
        method: Method,
        steps: impl IntoIterator<Item = u64>,
    ) -> Result<Self, crate::StudyError> {
        let mut rows = Vec::new();
        for steps in steps {
            let horizon = Horizon::divided(problem.horizon, steps)?;
            let mut integrator = method.integrator(&problem.system)?;
            let outcome = deliver(problem, &mut *integrator, horizon);
            rows.push(ConvergenceRow { horizon, outcome });
        }
        Ok(Convergence { method, rows })
    }

    /// The steps and errors of the runs that succeeded, where the true motion is known.
    pub fn errors(&self) -> Vec<(f64, f64)> {
        let delivered = |row: &ConvergenceRow| {
            let outcome = row.outcome.as_ref().ok()?;
            Some((row.horizon.step(), outcome.error?))
        };
        self.rows.iter().filter_map(delivered).collect()
    }

    /// The slope of the error over the last four halvings before rounding: where it is neither as
    /// large as the motion nor as small as rounding.
    pub fn order(&self) -> Option<f64> {
        let mut points = self.errors();
        points.retain(|&(_, error)| error < ASYMPTOTIC);
        points.sort_by(|a, b| b.0.total_cmp(&a.0));
        // Steps finer than the first that meets rounding add up more of it.
        let rounding = points.iter().position(|&(_, error)| error < ROUNDING);
        points.truncate(rounding.unwrap_or(points.len()));
        loglog_slope(&points[points.len().saturating_sub(FINEST)..])
    }

    /// The rows as a table, rounded to what another processor reproduces.
    pub fn table(&self) -> Table {
        let mut table = Table::new([
            Column::exact("steps"),
            Column::rounded("step [s]", 4, 0.0),
            Column::rounded("error", 2, ROUNDING),
            Column::rounded("energy error [J]", 2, ROUNDING),
            Column::exact("differentials"),
            Column::exact("hessians"),
        ]);
        for ConvergenceRow { horizon, outcome } in &self.rows {
            let mut cells: Vec<Cell> = vec![horizon.steps().into(), horizon.step().into()];
            match outcome {
                Ok(Delivered { error, energy_error, cost }) => cells.extend([
                    error.map_or("not known".into(), Cell::from),
                    Cell::from(*energy_error),
                    Cell::from(cost.differentials),
                    Cell::from(cost.hessians),
                ]),
                Err(error) => cells.push(format!("failed at step {}", error.step).into()),
            }
            table.push(cells);
        }
        table
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{henon_heiles, kepler};

    #[test]
    fn the_measured_order_is_the_claimed_one() {
        // One orbit: over many, RK4's loss of energy, of order 5, outgrows the rest.
        let mut problem = kepler(0.3).unwrap();
        problem.horizon = problem.period;
        for method in Method::TABLE_4_1 {
            let coarsest = if method.facts().order == 1 { 6400 } else { 400 };
            let steps = (0..4).map(|i| coarsest << i);
            let order = Convergence::measure(&problem, method, steps).unwrap().order().unwrap();
            assert!((order - f64::from(method.facts().order)).abs() < 0.1, "{method}: {order}");
        }
    }

    #[test]
    fn where_the_true_motion_is_not_known_no_error_is() {
        let star = henon_heiles(0.1).unwrap();
        let study = Convergence::measure(&star, Method::StormerVerlet, [200, 400]).unwrap();
        for row in &study.rows {
            let delivered = row.outcome.as_ref().unwrap();
            assert!(delivered.error.is_none() && delivered.energy_error > 1e-4, "{delivered:?}");
        }
        assert_eq!((study.errors(), study.order()), (Vec::new(), None));
        assert!(study.table().to_string().contains("not known"), "{}", study.table());
    }

    #[test]
    fn a_run_that_fails_stays_in_the_table() {
        let problem = kepler(0.6).unwrap();
        let study = Convergence::measure(&problem, Method::ImplicitEuler, [20_000]).unwrap();
        assert!(study.rows[0].outcome.is_err());
        assert!(study.table().to_string().contains("failed at step"), "{}", study.table());
    }
}
