//! What takes samples of a state, and says in the names of the scene what failed in it.

use stationary_integrators::State;

use crate::run::error::{RunError, StepFailure, Stop};
use crate::run::samples::{BrokenRod, Run, Samples};

/// Takes samples of the states of a run.
pub(crate) trait Recorder {
    /// Adds a sample of the state at a time.
    fn sample(&mut self, state: &State<Vec<f64>>, time: f64, samples: &mut Samples);

    /// An error where a state is one of which the scene knows no forces.
    fn check(&self, _state: &State<Vec<f64>>) -> Result<(), StepFailure> {
        Ok(())
    }

    /// Takes what rods felt in a step: their multipliers, and the one that broke.
    fn feel(&mut self, _multipliers: &[f64], _broken: Option<BrokenRod>) {}

    /// The rods that broke so far.
    fn broken(&self) -> &[BrokenRod] {
        &[]
    }

    /// Goes back to where these rods had broken.
    fn restore(&mut self, _broken: &[BrokenRod]) {}

    /// The error of a run of which a step failed.
    fn failed(&self, failed: Failed, state: &State<Vec<f64>>, run: Run) -> RunError;
}

/// A step that failed.
pub(crate) struct Failed {
    pub(crate) step: u64,
    pub(crate) time: f64,
    pub(crate) source: StepFailure,
}

impl Failed {
    /// The error of the run up to there, in words of its own or in those of the failure.
    pub(crate) fn stops(self, run: Run, named: Option<String>) -> RunError {
        let Failed { step, time, source } = self;
        let rods: Vec<usize> = (0..run.scene.rods.len()).collect();
        let named = named.or_else(|| run.scene.failure_named(&source, &rods));
        let unit = run.scene.units.time.clone();
        let reason = named.unwrap_or_else(|| source.to_string());
        let unstable = run.scene.unstable_step();
        let run = Box::new(run);
        RunError::Stopped(Box::new(Stop { step, time, unit, reason, unstable, source, run }))
    }
}
