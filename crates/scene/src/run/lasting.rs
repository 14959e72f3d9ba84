//! Steps under constraints that last: rods that do not break, and joints.

use stationary_constraints::{ConstrainedIntegrator, ConstrainedReport};
use stationary_integrators::{Saved, State, StepReport};

use crate::model::built::Built;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::error::StepFailure;
use crate::run::stepper::{Stepped, Stepper};

/// Steps of an integrator that holds constraints.
pub(crate) struct Lasting<'s> {
    pub(crate) integrator: Box<dyn ConstrainedIntegrator<Vec<f64>> + 's>,
    pub(crate) built: Built,
    work: f64,
}

impl<'s> Lasting<'s> {
    pub(crate) fn new(
        integrator: Box<dyn ConstrainedIntegrator<Vec<f64>> + 's>,
        built: Built,
    ) -> Self {
        Lasting { integrator, built, work: 0.0 }
    }
}

impl Stepper for Lasting<'_> {
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        _: f64,
    ) -> Result<Stepped, StepFailure> {
        let report = self.integrator.step(state, h)?;
        self.work = report.work;
        Ok(Stepped::done(counted(&report)))
    }

    fn multipliers(&self) -> &[f64] {
        self.integrator.multipliers()
    }

    fn driven_work(&self) -> f64 {
        self.work
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

/// A step towards a feasible configuration counts as a solve.
pub(crate) fn counted(report: &ConstrainedReport) -> StepReport {
    let &ConstrainedReport { differentials, iterations, .. } = report;
    StepReport { differentials, hessians: iterations, ..StepReport::default() }
}
