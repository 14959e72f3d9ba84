//! What the particles of a scene do in a step: move, and tell the recorder what their rods felt.

use stationary_integrators::{Saved, State, StepReport};

use crate::RunError;
use crate::checkpoint::{Before, CheckpointError};
use crate::error::StepFailure;
use crate::march::Moving;
use crate::run::{BrokenRod, Failed, Recorder, Run, Samples};
use crate::stepper::{Stepped, Stepper};

/// The particles of a scene on their way.
pub(crate) struct Particles<'a, const D: usize> {
    pub(crate) state: State<Vec<f64>>,
    pub(crate) stepper: Stepper<'a, D>,
    pub(crate) recorder: Recorder<'a, D>,
    pub(crate) prepared: StepReport,
}

impl<const D: usize> Moving for Particles<'_, D> {
    fn state(&self) -> &State<Vec<f64>> {
        &self.state
    }

    fn step(&mut self, h: f64, to: f64) -> Result<Stepped, StepFailure> {
        let stepped = self.stepper.step(&mut self.state, h, to)?;
        self.state.t = to;
        self.recorder.feel(self.stepper.multipliers(), stepped.broken);
        Ok(stepped)
    }

    fn prepared(&self) -> StepReport {
        self.prepared
    }

    fn sample(&mut self, _: f64, samples: &mut Samples) {
        self.recorder.sample(&self.state, samples);
    }

    fn broken(&self) -> &[BrokenRod] {
        &self.recorder.broken
    }

    fn failed(&self, step: u64, time: f64, source: StepFailure, run: Run) -> RunError {
        self.recorder.interrupt(Failed { step, time, source }, &self.state, run)
    }

    fn save(&mut self) -> Saved {
        self.stepper.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.stepper.load(self.recorder.scene, before)?;
        self.state.clone_from(&before.state);
        self.recorder.left.retain(|rod| before.broken.iter().all(|broken| broken.rod != *rod));
        self.recorder.broken.clone_from(&before.broken);
        Ok(())
    }
}
