//! Rods, held by their forces or by a projection after each step.

use stationary_calculus::{DiagonalMetric, Flat};
use stationary_constraints::{
    ConstrainedHamilton, ConstrainedIntegrator, ConstraintError, DiagonalMultipliers, Rattle, Rods,
    SparseDiagonal, StepAndProject, Straight,
};
use stationary_integrators::{Facts, Integrator, Method, Saved, State, StepError, StepReport};

use crate::assemble::error::AssemblyError;
use crate::assemble::rods::Pins;
use crate::assemble::system::{ScenePotential, SceneProblem};
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::model::stepping::Constrained;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::driven::{Application, Driven, Kicked, shared};
use crate::run::equal::Equal;
use crate::run::error::StepFailure;
use crate::run::lasting::{Lasting, counted};
use crate::run::samples::BrokenRod;
use crate::run::stepper::{Stepped, Stepper};

/// Rods held by their forces.
pub(crate) fn held<'s, const D: usize>(
    scene: &'s Scene,
    problem: &'s SceneProblem,
    method: Constrained,
) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
    let (rods, built) = (scene.constraint::<D>()?, built(scene));
    let (system, initial, equations) =
        (&problem.system, &problem.initial, SparseDiagonal::default());
    Ok(match method {
        Constrained::Rattle => {
            let acting = shared(scene);
            let motion = Kicked { motion: Straight, acting: acting.clone() };
            let rattle = Rattle::along(motion, system, rods, initial, equations)?;
            let breaking = Box::new(Breaking { scene, rattle, built, work: 0.0 });
            match acting {
                Some(acting) => Driven::new(breaking, acting, Application::Within),
                None => breaking,
            }
        }
        Constrained::Hamilton => {
            let integrator = Box::new(ConstrainedHamilton::new(system, rods, initial, equations)?);
            Box::new(Lasting::new(integrator, built))
        }
    })
}

/// Rods held by a projection after each step of a method.
pub(crate) fn projected<'s, const D: usize>(
    scene: &'s Scene,
    problem: &'s SceneProblem,
    method: Method,
) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
    let (rods, equations) = (scene.constraint::<D>()?, SparseDiagonal::default());
    let Equal { integrator, built: own } = Equal::new(problem, method)?;
    let (system, initial) = (&problem.system, &problem.initial);
    let integrator =
        Box::new(StepAndProject::new(Owned(integrator), system, rods, initial, equations)?);
    Ok(Box::new(Lasting::new(integrator, built(scene) + own)))
}

/// The equations are solved by a sparse matrix of their own.
fn built(scene: &Scene) -> Built {
    Built { equations: scene.rods.len() as u64, sparse_solvers: 1, ..Built::default() }
}

type Masses = DiagonalMetric<Vec<f64>>;

/// Rods held along a motion between kicks.
type Held<'s, const D: usize> = Rattle<
    's,
    Masses,
    ScenePotential,
    Flat,
    Rods<D, Pins<D>>,
    Vec<f64>,
    DiagonalMultipliers,
    Kicked<Straight>,
>;

/// Steps of rods that break where they have a strength.
struct Breaking<'s, const D: usize> {
    scene: &'s Scene,
    rattle: Held<'s, D>,
    built: Built,
    /// Of pins that move, in the last step.
    work: f64,
}

impl<const D: usize> Stepper for Breaking<'_, D> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        let (report, broken) = self.rattle.step_and_break(state, h, SparseDiagonal::default())?;
        self.work = report.work;
        let broken = broken.map(|rod| BrokenRod { rod: rod.index, time: to, tension: rod.tension });
        Ok(Stepped { broken, ..Stepped::done(counted(&report)) })
    }

    fn multipliers(&self) -> &[f64] {
        self.rattle.multipliers()
    }

    fn driven_work(&self) -> f64 {
        self.work
    }

    fn save(&mut self) -> Saved {
        self.rattle.save()
    }

    /// To go back where a rod may have broken makes the rods anew, too much for parts of every step.
    fn takes_parts(&self) -> bool {
        self.scene.rods.iter().all(|rod| rod.strength.is_infinite())
    }

    /// Rods are in no list of numbers: those that broke say which are left.
    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        if self.scene.rods.iter().any(|rod| rod.strength.is_finite()) {
            let mut rods = self.scene.constraint::<D>()?;
            rods.retain(|rod| before.broken.iter().all(|broken| broken.rod != rod));
            self.rattle.set_constraint(rods, &before.state, SparseDiagonal::default())?;
        }
        Ok(self.rattle.load(&before.memory)?)
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
