//! Motion near rest in closed form: a few modes instead of all freedoms, and no steps.
//!
//! ```text
//! dV(q0) = 0,    H v_i = lambda_i M v_i,    q(t) = q0 + sum_i v_i alpha_i(t)           (14.1, 14.2)
//! ```
//! `q0` is where the scene comes to rest from its start, `alpha` begins with what the start has of
//! each mode. Rigid motions that cost nothing are added to the number that was asked for. The
//! energy that a run writes down is that of the scene itself at q(t): where it is not constant, the
//! motion is too large for its modes.

use stationary_calculus::{Covector, DiagonalMetric, Metric, SymmetricMatrix, Vector};
use stationary_integrators::{State, StepReport};
use stationary_modal::{Linearized, ModalError, Modes, Motion, RigidMotions};

use crate::assemble::rest;
use crate::assemble::rest::Rest;
use crate::assemble::system::SceneProblem;
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::error::AssemblyError;
use crate::run::error::StepFailure;
use crate::run::steps::{Chosen, Stepped, Steps, Way};
use crate::words::integrator::Stepping;

/// The modes of a scene and its start among them.
struct LinearModes {
    rest: Vec<f64>,
    modes: Modes,
    mass: SymmetricMatrix,
    displacement: Vector<Vec<f64>>,
    velocity: Vector<Vec<f64>>,
    prepared: StepReport,
    built: Built,
}

/// This way, of a scene that is moved by its modes.
pub(crate) fn way<const D: usize>(scene: &Scene, problem: &SceneProblem<D>) -> Chosen<D> {
    Ok(match scene.stepping {
        Stepping::LinearModes { count } => Some(Box::new(LinearModes::of(problem, count)?)),
        _ => None,
    })
}

impl LinearModes {
    /// So many modes of a problem, besides rigid motions.
    fn of<const D: usize>(problem: &SceneProblem<D>, count: usize) -> Result<Self, AssemblyError> {
        let (system, initial) = (&problem.system, &problem.initial);
        let (metric, potential) = (system.metric(), system.potential());
        let Rest { q: rest, tolerance, newton, built } = rest::rest(problem)?;
        // The factor is for a tolerance that differs in its last digit.
        let mut near_rest = Linearized::at(metric, potential, &rest, 2.0 * tolerance)?;
        let rigid = RigidMotions::of_points::<D>(&near_rest, rest.as_chunks().0)?;
        let modes = near_rest.lowest(count, &rigid)?.with_rigid(&rigid)?;
        let displacement = initial.q.iter().zip(&rest).map(|(q, rest)| q - rest).collect();
        let mut velocity = Vector(vec![0.0; rest.len()]);
        metric.sharp(initial.p.view(), velocity.view_mut());
        let mass = near_rest.mass().clone();
        let prepared = StepReport {
            differentials: newton.residuals + modes.solves() as u32,
            hessians: newton.iterations + modes.factorizations() as u32,
            energies: newton.energies,
            ..StepReport::default()
        };
        let displacement = Vector(displacement);
        let made = Built { modes: modes.len() as u64, sparse_solvers: 1, ..Built::default() };
        let built = built + made;
        Ok(LinearModes { rest, modes, mass, displacement, velocity, prepared, built })
    }
}

impl<const D: usize> Way<D> for LinearModes {
    /// A solve with a factor counts as a differential.
    fn prepared(&self) -> StepReport {
        self.prepared
    }

    fn steps<'s>(
        &'s self,
        _: &'s Scene,
        problem: &'s SceneProblem<D>,
    ) -> Result<Box<dyn Steps + 's>, AssemblyError> {
        let (d, v) = (self.displacement.view(), self.velocity.view());
        let motion = Motion::new(&self.modes, &self.mass, d, v)?;
        let velocity = Vector(vec![0.0; self.rest.len()]);
        let metric = problem.system.metric();
        Ok(Box::new(Moving { rest: &self.rest, motion, velocity, metric, built: self.built }))
    }
}

/// A motion about its rest.
struct Moving<'s> {
    rest: &'s [f64],
    motion: Motion<'s>,
    velocity: Vector<Vec<f64>>,
    metric: &'s DiagonalMetric<Vec<f64>>,
    built: Built,
}

impl Moving<'_> {
    /// Writes the state at the time `to`.
    fn at(&mut self, to: f64, state: &mut State<Vec<f64>>) -> Result<(), ModalError> {
        self.motion.at(to, Vector(state.q.as_mut_slice()), self.velocity.view_mut())?;
        for (q, rest) in state.q.iter_mut().zip(self.rest) {
            *q += rest;
        }
        self.metric.flat(self.velocity.view(), Covector(state.p.components_mut()));
        Ok(())
    }
}

impl Steps for Moving<'_> {
    fn start(&mut self, state: &mut State<Vec<f64>>) -> Result<(), AssemblyError> {
        Ok(self.at(0.0, state)?)
    }

    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        _: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure> {
        self.at(to, state)?;
        Ok(Stepped::done(StepReport::default()))
    }

    fn reads_off(&self) -> bool {
        true
    }

    fn built(&self) -> Built {
        self.built
    }
}
