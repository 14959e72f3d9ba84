//! Rods, held by their forces or by a projection after each step.

use stationary_calculus::{DiagonalMetric, Flat};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, Constraint, ConstraintError, Many, Rattle, Rods,
    SchurMultipliers, StepAndProject,
};
use stationary_integrators::{Facts, Integrator, Method, Saved, State, StepError, StepReport};

use crate::assemble::system::{ScenePotential, SceneProblem, Vertices, leading};
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::equal_steps::Equal;
use crate::run::error::AssemblyError;
use crate::run::error::StepFailure;
use crate::run::lasting_steps::{Lasting, counted};
use crate::run::samples::BrokenRod;
use crate::run::steps::{Chosen, Stepped, Steps, Way};
use crate::words::integrator::{Constrained, Stepping};

/// How rods are held.
#[derive(Clone, Copy)]
enum Held {
    Projected(Method),
    Constrained(Constrained),
}

/// This way, where there are rods.
pub(crate) fn way<const D: usize>(scene: &Scene, _: &SceneProblem<D>) -> Chosen<D> {
    Ok(match scene.stepping() {
        Stepping::Equal(method) if !scene.rods().is_empty() => {
            Some(Box::new(Held::Projected(method)))
        }
        Stepping::Constrained(method) => Some(Box::new(Held::Constrained(method))),
        _ => None,
    })
}

impl<const D: usize> Way<D> for Held {
    fn steps<'s>(
        &'s self,
        scene: &'s Scene,
        problem: &'s SceneProblem<D>,
    ) -> Result<Box<dyn Steps + 's>, AssemblyError> {
        let (system, initial) = (&problem.system, &problem.initial);
        let (rods, many) = (scene.constraint::<D>()?, Many::default());
        // The equations are solved by a sparse matrix of their own.
        let built = Built { equations: rods.count() as u64, sparse_solvers: 1, ..Built::default() };
        let integrator: Box<dyn ConstrainedIntegrator<Vec<f64>> + 's> = match *self {
            Held::Constrained(Constrained::Rattle) => {
                let rattle = Rattle::new(system, rods, initial, many)?;
                return Ok(Box::new(Breaking { scene, rattle, built }));
            }
            Held::Constrained(Constrained::Hamilton) => {
                Box::new(ConstrainedHamilton::new(system, rods, initial, many)?)
            }
            Held::Projected(method) => {
                let Equal { integrator, built: own } = Equal::new(problem, method)?;
                let built = built + own;
                let kept = StepAndProject::new(Owned(integrator), system, rods, initial, many)?;
                return Ok(Box::new(Lasting { integrator: Box::new(kept), built }));
            }
        };
        Ok(Box::new(Lasting { integrator, built }))
    }
}

type Masses = DiagonalMetric<Vec<f64>>;

/// Steps of rods that break where they have a strength.
struct Breaking<'s, const D: usize> {
    scene: &'s Scene,
    rattle: Rattle<'s, Masses, ScenePotential<D>, Flat, Rods<D>, Vec<f64>, SchurMultipliers>,
    built: Built,
}

impl<const D: usize> Steps for Breaking<'_, D> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let (report, broken) = self.rattle.step_and_break(state, h, Many::default())?;
        let broken = broken.map(|rod| BrokenRod { rod: rod.index, time: to, tension: rod.tension });
        Ok(Stepped { broken, ..Stepped::done(counted(&report)) })
    }

    fn multipliers(&self) -> &[f64] {
        self.rattle.multipliers()
    }

    fn save(&mut self) -> Saved {
        self.rattle.save()
    }

    /// Rods are in no list of numbers: those that broke say which are left.
    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.rattle.load(&before.memory)?;
        if !before.broken.is_empty() {
            let mut rods = self.scene.constraint::<D>()?;
            rods.retain(|rod| before.broken.iter().all(|broken| broken.rod != rod));
            self.rattle.set_constraint(rods, &before.state, Many::default())?;
        }
        Ok(())
    }

    fn built(&self) -> Built {
        self.built
    }
}

/// An integrator behind a pointer is one.
struct Owned<'s>(Box<dyn Integrator<Vec<f64>> + 's>);

impl Integrator<Vec<f64>> for Owned<'_> {
    fn facts(&self) -> Facts {
        self.0.facts()
    }

    fn step(&mut self, state: &mut State<Vec<f64>>, h: f64) -> Result<StepReport, StepError> {
        self.0.step(state, h)
    }

    fn save(&self) -> Saved {
        self.0.save()
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.0.load(saved)
    }
}

impl Scene {
    /// The scene's rods as a constraint on its problem.
    ///
    /// # Errors
    /// [`AssemblyError::Dimension`] where D is not the scene's; [`AssemblyError::Constraint`] as of
    /// [`Rods::new`], none that a checked scene has.
    pub fn constraint<const D: usize>(&self) -> Result<Rods<D>, AssemblyError> {
        if D != self.dimension {
            return Err(AssemblyError::Dimension { scene: self.dimension, asked: D });
        }
        let vertices = Vertices::new(self);
        let pinned = &vertices.particles[vertices.free..];
        let fixed = pinned.iter().map(|&pin| leading::<D>(self.particles[pin].position)).collect();
        let rods = self.rods.iter().map(|rod| {
            let ends = rod.ends.map(|end| vertices.of_particle[end]);
            stationary_constraints::Rod::new(ends, rod.length).with_strength(rod.strength)
        });
        Ok(Rods::new(vertices.free, fixed, rods.collect())?)
    }
}

impl From<ConstraintError> for StepFailure {
    fn from(error: ConstraintError) -> Self {
        match error {
            ConstraintError::Step(error) => StepFailure::Step(error),
            other => StepFailure::Constraint(other),
        }
    }
}

/// The equation of a constraint that cannot be held, which is the rod's place among those left.
pub(crate) fn equation(error: &ConstraintError) -> Option<usize> {
    match error {
        ConstraintError::Infeasible { row, .. }
        | ConstraintError::InfeasibleVelocity { row, .. }
        | ConstraintError::Singular { row, .. }
        | ConstraintError::NotConverged { row, .. }
        | ConstraintError::Diverged { row, .. } => Some(*row),
        ConstraintError::Dependent { row } => *row,
        _ => None,
    }
}
