//! Implicit steps of many particles, by a sparse matrix: what does not touch has no entry in it.

use stationary_calculus::SparseSolver;
use stationary_integrators::{DampedPattern, Drag, Integrator, Method, Newmark, NewmarkWeights};

use crate::assemble::system::SceneProblem;
use crate::model::built::Built;
use crate::run::equal_steps::Equal;
use crate::run::error::AssemblyError;

/// Whether a matrix of so many freedoms can be factored.
pub(crate) fn can_factor(_freedoms: usize) -> bool {
    true
}

/// The integrator of an implicit method.
pub(crate) fn equal<const D: usize>(
    problem: &SceneProblem<D>,
    method: Method,
) -> Result<Equal<'_>, AssemblyError> {
    let system = &problem.system;
    let solver = SparseSolver::new(system.metric(), system.potential(), &problem.initial.q)?;
    Ok(with_solver(method.integrator_with(system, solver)?))
}

/// The same with the force of drag.
pub(crate) fn held_back<const D: usize>(
    problem: &SceneProblem<D>,
    weights: NewmarkWeights,
    drag: Drag<Vec<f64>>,
) -> Result<Equal<'_>, AssemblyError> {
    let system = &problem.system;
    let pattern = DampedPattern { potential: system.potential(), force: &drag };
    let solver = SparseSolver::new(system.metric(), &pattern, &problem.initial.q)?;
    let integrator = Newmark::with_force_and_solver(system, weights, drag, solver)?;
    Ok(with_solver(Box::new(integrator)))
}

fn with_solver<'s>(integrator: Box<dyn Integrator<Vec<f64>> + 's>) -> Equal<'s> {
    Equal { integrator, built: Built { sparse_solvers: 1, ..Built::default() } }
}
