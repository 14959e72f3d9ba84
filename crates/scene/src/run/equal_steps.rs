//! Equal steps of a method, of particles that are held back by drag or by nothing.

use stationary_integrators::{
    Drag, Evaluation, Integrator, Method, Newmark, NewmarkWeights, Saved, State,
};

use crate::assemble::system::{SceneProblem, few};
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::error::AssemblyError;
use crate::run::error::StepFailure;
use crate::run::sparse_steps;
use crate::run::steps::{Chosen, Stepped, Steps, Way};
use crate::words::integrator::Stepping;

impl Scene {
    /// A method on the scene's problem, with a sparse solver where that pays.
    ///
    /// # Errors
    /// [`AssemblyError::Sparse`] where the matrix of an implicit method does not fit into memory.
    pub fn integrator<'s, const D: usize>(
        &self,
        problem: &'s SceneProblem<D>,
        method: Method,
    ) -> Result<Box<dyn Integrator<Vec<f64>> + 's>, AssemblyError> {
        Ok(Equal::new(problem, method)?.integrator)
    }
}

struct Equally(Method);

/// This way, of a method of equal steps.
pub(crate) fn way<const D: usize>(scene: &Scene, _: &SceneProblem<D>) -> Chosen<D> {
    Ok(match scene.stepping() {
        Stepping::Equal(method) => Some(Box::new(Equally(method))),
        _ => None,
    })
}

impl<const D: usize> Way<D> for Equally {
    fn steps<'s>(
        &'s self,
        scene: &'s Scene,
        problem: &'s SceneProblem<D>,
    ) -> Result<Box<dyn Steps + 's>, AssemblyError> {
        let equal = match scene.drag() {
            Some(coefficient) => Equal::held_back(problem, self.0, coefficient)?,
            None => Equal::new(problem, self.0)?,
        };
        Ok(Box::new(equal))
    }
}

/// Steps of an integrator.
pub(crate) struct Equal<'s> {
    pub(crate) integrator: Box<dyn Integrator<Vec<f64>> + 's>,
    pub(crate) built: Built,
}

impl<'s> Equal<'s> {
    /// The integrator of a method.
    pub(crate) fn new<const D: usize>(
        problem: &'s SceneProblem<D>,
        method: Method,
    ) -> Result<Self, AssemblyError> {
        let explicit = method.facts().evaluation == Evaluation::Explicit;
        if !explicit && !few(problem.system.dim()) {
            return sparse_steps::equal(problem, method);
        }
        Ok(Equal::without_solver(method.integrator(&problem.system)?))
    }

    /// The integrator of a method that takes the force of drag.
    fn held_back<const D: usize>(
        problem: &'s SceneProblem<D>,
        method: Method,
        coefficient: f64,
    ) -> Result<Self, AssemblyError> {
        let system = &problem.system;
        // The scene has been asked whether its method takes forces.
        let weights = method.newmark_weights().unwrap_or(NewmarkWeights::AVERAGE_ACCELERATION);
        let drag = Drag::new(vec![coefficient; system.dim()])?;
        if !few(system.dim()) {
            return sparse_steps::held_back(problem, weights, drag);
        }
        Ok(Equal::without_solver(Box::new(Newmark::with_force(system, weights, drag)?)))
    }

    /// The steps of an integrator that has no sparse solver.
    pub(crate) fn without_solver(integrator: Box<dyn Integrator<Vec<f64>> + 's>) -> Self {
        Equal { integrator, built: Built::default() }
    }
}

impl Steps for Equal<'_> {
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
