//! What the particles of a scene do in a step: move, and tell the recorder what their rods felt.

use stationary_integrators::{Saved, State, StepReport};

use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::RunError;
use crate::run::error::StepFailure;
use crate::run::march::{Moving, Watcher, march};
use crate::run::samples::{BrokenRod, Failed, Recorder, Run, Samples};
use crate::run::steps::{Stepped, Steps, way};

impl Scene {
    /// Runs a scene of particles to its horizon, or until the watcher breaks off.
    pub(crate) fn run_particles(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        match self.dimension {
            1 => self.run_in::<1>(checkpoint, watcher),
            2 => self.run_in::<2>(checkpoint, watcher),
            _ => self.run_in::<3>(checkpoint, watcher),
        }
    }

    fn run_in<const D: usize>(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
    ) -> Result<Run, RunError> {
        let problem = self.problem::<D>()?;
        let way = way(self, &problem)?;
        let mut steps = way.steps(self, &problem)?;
        let recorder = Recorder::new(self, &problem);
        let mut state = problem.initial.clone();
        steps.start(&mut state)?;
        let built = problem.system.potential().built + steps.built();
        let prepared = way.prepared();
        march(self, Particles { state, steps, recorder, prepared, built }, checkpoint, watcher)
    }
}

/// The particles of a scene on their way.
struct Particles<'a, const D: usize> {
    state: State<Vec<f64>>,
    steps: Box<dyn Steps + 'a>,
    recorder: Recorder<'a, D>,
    prepared: StepReport,
    built: Built,
}

impl<const D: usize> Moving for Particles<'_, D> {
    fn state(&self) -> &State<Vec<f64>> {
        &self.state
    }

    fn step(&mut self, h: f64, to: f64) -> Result<Stepped, StepFailure> {
        let stepped = self.steps.step(&mut self.state, h, to)?;
        self.state.t = to;
        self.recorder.feel(self.steps.multipliers(), stepped.broken);
        Ok(stepped)
    }

    fn prepared(&self) -> StepReport {
        self.prepared
    }

    /// A rod that broke does not mend.
    fn takes_parts(&self) -> bool {
        self.recorder.scene.rods.iter().all(|rod| rod.strength.is_infinite())
    }

    fn reads_off(&self) -> bool {
        self.steps.reads_off()
    }

    fn own_ends(&self) -> &[f64] {
        self.steps.own_ends()
    }

    fn pushes(&self, time: f64, see: &mut dyn FnMut(Push)) {
        self.steps.pushes(time, see);
    }

    fn built(&self) -> Built {
        self.built
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
        self.steps.save()
    }

    fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.steps.load(before)?;
        self.state.clone_from(&before.state);
        self.recorder.left.retain(|rod| before.broken.iter().all(|broken| broken.rod != *rod));
        self.recorder.broken.clone_from(&before.broken);
        Ok(())
    }
}
