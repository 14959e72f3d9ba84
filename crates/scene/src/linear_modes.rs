//! Motion near rest in closed form: a few modes instead of all freedoms, and no steps.
//!
//! ```text
//! dV(q0) = 0,    H v_i = lambda_i M v_i,    q(t) = q0 + sum_i v_i alpha_i(t)           (14.1, 14.2)
//! ```
//! `q0` is where the scene comes to rest from its start, `alpha` begins with what the start has of
//! each mode. Rigid motions that cost nothing are added to the number that was asked for. The
//! energy that a run writes down is that of the scene itself at q(t): where it is not constant, the
//! motion is too large for its modes.

use stationary_calculus::{Covector, Metric, SymmetricMatrix, Vector};
use stationary_integrators::{State, StepReport};
use stationary_modal::{Linearized, ModalError, Modes, Motion, RigidMotions};

use crate::rest::{self, Rest};
use crate::system::SceneProblem;
use crate::{AssemblyError, Scene, Stepping};

/// The modes of a scene and its start among them.
#[derive(Debug)]
pub(crate) struct LinearModes {
    rest: Vec<f64>,
    modes: Modes,
    mass: SymmetricMatrix,
    displacement: Vector<Vec<f64>>,
    velocity: Vector<Vec<f64>>,
    prepared: StepReport,
}

impl Scene {
    /// The modes by which the scene is moved, where it is.
    pub(crate) fn linear_modes<const D: usize>(
        &self,
        problem: &SceneProblem<D>,
    ) -> Result<Option<LinearModes>, AssemblyError> {
        let Stepping::LinearModes { count } = self.stepping else {
            return Ok(None);
        };
        let (system, initial) = (&problem.system, &problem.initial);
        let (metric, potential) = (system.metric(), system.potential());
        let Rest { q: rest, tolerance, newton } = rest::rest(problem)?;
        // The factor is for a tolerance that differs in its last digit.
        let mut near_rest = Linearized::at(metric, potential, &rest, 2.0 * tolerance)?;
        let rigid = RigidMotions::of_points::<D>(&near_rest, &rest)?;
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
        Ok(Some(LinearModes { rest, modes, mass, displacement, velocity, prepared }))
    }
}

impl LinearModes {
    /// What the rest and the modes took: a solve with a factor counts as a differential.
    pub(crate) fn prepared(&self) -> StepReport {
        self.prepared
    }

    /// The motion from the start.
    pub(crate) fn motion(&self) -> Result<Moving<'_>, AssemblyError> {
        let (d, v) = (self.displacement.view(), self.velocity.view());
        let motion = Motion::new(&self.modes, &self.mass, d, v)?;
        let n = self.rest.len();
        Ok(Moving { rest: &self.rest, motion, velocity: Vector(vec![0.0; n]) })
    }
}

/// A motion about its rest.
pub(crate) struct Moving<'s> {
    rest: &'s [f64],
    motion: Motion<'s>,
    velocity: Vector<Vec<f64>>,
}

impl Moving<'_> {
    /// Writes the state at the time `to`.
    pub(crate) fn at(
        &mut self,
        to: f64,
        metric: &impl Metric,
        state: &mut State<Vec<f64>>,
    ) -> Result<(), ModalError> {
        self.motion.at(to, Vector(state.q.as_mut_slice()), self.velocity.view_mut())?;
        for (q, rest) in state.q.iter_mut().zip(self.rest) {
            *q += rest;
        }
        metric.flat(self.velocity.view(), Covector(state.p.components_mut()));
        Ok(())
    }
}
