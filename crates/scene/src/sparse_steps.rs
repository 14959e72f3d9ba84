//! Implicit steps of many particles, by a sparse matrix: what does not touch has no entry in it.

use stationary_calculus::SparseSolver;
use stationary_integrators::{DampedPattern, Drag, Method, Newmark, NewmarkWeights};

use crate::equal_steps::Equal;
use crate::system::SceneProblem;
use crate::{AssemblyError, Built};

const ONE_SOLVER: Built = Built { sparse_solvers: 1, ..Built::NOTHING };

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
    Ok(Equal { integrator: method.integrator_with(system, solver)?, built: ONE_SOLVER })
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
    Ok(Equal { integrator: Box::new(integrator), built: ONE_SOLVER })
}
