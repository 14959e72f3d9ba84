//! Where a scene comes to rest.
//!
//! ```text
//! dV(q) = 0        to |M^-1 dV| <= eps lambda |q| sqrt(m)
//! ```
//! `lambda` the largest eigenvalue of `M^-1 H`, |q| the scene's size, m its mass: below that the
//! differential is rounding. Source: notes 4.4.

use stationary_calculus::{
    DiagonalMetric, Equilibrium, Newton, NewtonReport, Potential, SparseSolver,
};
use stationary_modal::Linearized;

use crate::assemble::acceleration::most_accelerated;
use crate::assemble::error::AssemblyError;
use crate::model::built::Built;

/// Where a scene comes to rest.
pub(crate) struct Rest {
    pub(crate) q: Vec<f64>,
    /// The size of the differential that is rounding.
    pub(crate) tolerance: f64,
    pub(crate) newton: NewtonReport,
    pub(crate) built: Built,
}

/// Where particles of D freedoms each come to rest from their start, in a scene of this size.
pub(crate) fn rest<const D: usize>(
    metric: &DiagonalMetric<Vec<f64>>,
    potential: &impl Potential,
    start: &[f64],
    size: f64,
) -> Result<Rest, AssemblyError> {
    let mut q = start.to_vec();
    let mass: f64 = metric.masses().iter().sum::<f64>() / D as f64;
    let scale = Linearized::at(metric, potential, &q, f64::MAX)?.scale();
    let tolerance = f64::EPSILON * scale * size * mass.sqrt();
    let newton = Newton { tolerance, ..Newton::default() };
    let solver = SparseSolver::new(metric, potential, &q)?;
    let found = Equilibrium::new(metric, potential, solver, newton)?.find(&mut q);
    let report = found.map_err(|source| {
        let (freedom, freedoms) = (most_accelerated(metric, potential, &q), q.len());
        AssemblyError::Equilibrium { freedom, freedoms, source }
    })?;
    let built = Built { sparse_solvers: 1, ..Built::default() };
    Ok(Rest { q, tolerance, newton: report.newton, built })
}
