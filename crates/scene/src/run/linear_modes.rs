//! Steps of a motion by its modes: none, each moment is read off.

use stationary_calculus::{Covector, DiagonalMetric, Metric, Vector};
use stationary_integrators::{State, StepReport};
use stationary_modal::{ModalError, Motion};

use crate::assemble::error::AssemblyError;
use crate::assemble::linear_modes::LinearModes;
use crate::assemble::system::SceneProblem;
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// The motion of these modes.
pub(crate) fn stepper<'s>(
    modes: &'s LinearModes,
    problem: &'s SceneProblem,
) -> Result<Box<dyn Stepper + 's>, AssemblyError> {
    let (d, v) = (modes.displacement.view(), modes.velocity.view());
    let motion = Motion::new(&modes.modes, &modes.mass, d, v)?;
    let velocity = Vector(vec![0.0; modes.rest.len()]);
    let metric = problem.system.metric();
    Ok(Box::new(ModalMotion { modes, motion, velocity, metric }))
}

/// A motion about its rest.
struct ModalMotion<'s> {
    modes: &'s LinearModes,
    motion: Motion<'s>,
    velocity: Vector<Vec<f64>>,
    metric: &'s DiagonalMetric<Vec<f64>>,
}

impl ModalMotion<'_> {
    /// Writes the state at the time `to`.
    fn at(&mut self, to: f64, state: &mut State<Vec<f64>>) -> Result<(), ModalError> {
        self.motion.at(to, Vector(state.q.as_mut_slice()), self.velocity.view_mut())?;
        for (q, rest) in state.q.iter_mut().zip(&self.modes.rest) {
            *q += rest;
        }
        self.metric.flat(self.velocity.view(), Covector(state.p.components_mut()));
        Ok(())
    }
}

impl Stepper for ModalMotion<'_> {
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

    /// A solve with a factor counts as a differential.
    fn prepared(&self) -> StepReport {
        self.modes.prepared
    }
}
