//! Equal steps of a method, of particles on which forces act beside the potential, or none do.

#[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
use stationary_calculus::SparseSolver;
#[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
use stationary_integrators::{DampedPattern, Evaluation};
use stationary_integrators::{Integrator, Method, Newmark, NewmarkWeights, Saved, State};

use crate::assemble::acting::Acting;
use crate::assemble::error::AssemblyError;
use crate::assemble::system::SceneProblem;
#[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
use crate::assemble::vertices::few;
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::driven::{Application, Driven};
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

impl Scene {
    /// A method on the scene's problem, with a sparse solver where that pays.
    ///
    /// # Errors
    /// [`AssemblyError::Sparse`] where the matrix of an implicit method does not fit into memory.
    pub fn integrator<'s>(
        &self,
        problem: &'s SceneProblem,
        method: Method,
    ) -> Result<Box<dyn Integrator<Vec<f64>> + 's>, AssemblyError> {
        Ok(Equal::new(problem, method)?.integrator)
    }
}

/// Steps of an integrator.
pub(crate) struct Equal<'s> {
    pub(crate) integrator: Box<dyn Integrator<Vec<f64>> + 's>,
    pub(crate) built: Built,
}

impl<'s> Equal<'s> {
    /// The steps of a scene's method, with what acts on it.
    pub(crate) fn of(
        scene: &Scene,
        problem: &'s SceneProblem,
        method: Method,
    ) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
        let Some(acting) = Acting::of(scene) else {
            return Ok(Box::new(Equal::new(problem, method)?));
        };
        // What depends on pins that move is stiff as the rest is, and no kick of an implicit method's step.
        let led = !scene.drives.motions.is_empty();
        let weights = if led { method.weights_with_force() } else { method.newmark_weights() };
        let Some(weights) = weights else {
            let steps = Box::new(Equal::new(problem, method)?);
            return Ok(Driven::new(steps, acting, Application::Kicks));
        };
        // Newmark remembers accelerations, so that it takes the forces itself.
        let acting = acting.with_width(scene.timing.stepping().step());
        let steps = Box::new(Equal::forced(problem, weights, acting.clone())?);
        Ok(Driven::new(steps, acting, Application::Taken))
    }

    /// The integrator of a method.
    pub(crate) fn new(problem: &'s SceneProblem, method: Method) -> Result<Self, AssemblyError> {
        #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
        let explicit = method.facts().evaluation == Evaluation::Explicit;
        #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
        if !explicit && !few(problem.system.dim()) {
            return Equal::sparse(problem, method);
        }
        Ok(Equal::without_solver(method.integrator(&problem.system)?))
    }

    /// The integrator of a method that takes forces.
    fn forced(
        problem: &'s SceneProblem,
        weights: NewmarkWeights,
        force: Acting,
    ) -> Result<Self, AssemblyError> {
        let system = &problem.system;
        #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
        if !few(system.dim()) {
            return Equal::sparse_forced(problem, weights, force);
        }
        Ok(Equal::without_solver(Box::new(Newmark::with_force(system, weights, force)?)))
    }

    /// The integrator of an implicit method of many particles, by a sparse matrix: what does not
    /// touch has no entry in it.
    #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
    fn sparse(problem: &'s SceneProblem, method: Method) -> Result<Self, AssemblyError> {
        let system = &problem.system;
        let solver = SparseSolver::new(system.metric(), system.potential(), &problem.initial.q)?;
        Ok(Equal::with_solver(method.integrator_with(system, solver)?))
    }

    /// The same with forces.
    #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
    fn sparse_forced(
        problem: &'s SceneProblem,
        weights: NewmarkWeights,
        force: Acting,
    ) -> Result<Self, AssemblyError> {
        let system = &problem.system;
        let pattern = DampedPattern { potential: system.potential(), force: &force };
        let solver = SparseSolver::new(system.metric(), &pattern, &problem.initial.q)?;
        let integrator = Newmark::with_force_and_solver(system, weights, force, solver)?;
        Ok(Equal::with_solver(Box::new(integrator)))
    }

    #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
    fn with_solver(integrator: Box<dyn Integrator<Vec<f64>> + 's>) -> Self {
        Equal { integrator, built: Built { sparse_solvers: 1, ..Built::default() } }
    }

    /// The steps of an integrator that has no sparse solver.
    pub(crate) fn without_solver(integrator: Box<dyn Integrator<Vec<f64>> + 's>) -> Self {
        Equal { integrator, built: Built::default() }
    }
}

impl Stepper for Equal<'_> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        Ok(Stepped::done(self.integrator.step(state, h)?))
    }

    fn save(&mut self) -> Saved {
        self.integrator.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        Ok(self.integrator.load(&before.memory)?)
    }

    fn built(&self) -> Built {
        self.built
    }
}
