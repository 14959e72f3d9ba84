//! The kinds of scenes: what moves decides which methods there are, and how it is run.
//!
//! What is neither heat nor bodies is particles. To check a scene does not name what runs it, so that
//! whoever only reads scenes compiles no steps.

use std::ops::ControlFlow;

use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::error::RunError;
use crate::run::observer::{Control, Observer, Progress};
use crate::run::samples::Run;

impl Scene {
    /// Runs the scene to its horizon.
    ///
    /// # Errors
    /// Those of [`Scene::run_watched`].
    pub fn run(&self) -> Result<Run, RunError> {
        self.run_watched(|_| ControlFlow::Continue(()))
    }

    /// Runs the scene to its horizon, or until the watcher breaks off; that is no error.
    ///
    /// # Errors
    /// [`RunError::Assembly`] where scene and method make no system. Where a step fails
    /// [`RunError::Interrupted`] of particles, [`RunError::Stopped`] of bodies and heat; the latter
    /// also where a sample is not finite. Both hold the run up to there.
    pub fn run_watched(
        &self,
        watch: impl FnMut(Progress<'_>) -> ControlFlow<()>,
    ) -> Result<Run, RunError> {
        self.run_from(None, &mut Callback(watch))
    }

    /// Runs the scene from its start or from a checkpoint, to its horizon or until the watcher
    /// stops.
    ///
    /// A run that is resumed has the samples, the counts and the bits of a whole one.
    ///
    /// # Errors
    /// Those of [`Scene::run_watched`]; [`RunError::Checkpoint`] where the checkpoint is not one of
    /// this scene, or where its last step leads to other bits here.
    pub fn run_from(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        self.run_kind(checkpoint, watcher).map_err(|error| self.named(error))
    }

    /// Runs the scene to its horizon, or until the watcher breaks off.
    pub(crate) fn run_kind(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        #[cfg(feature = "laplacian")]
        if self.heat.is_some() {
            return self.run_heat(checkpoint, watcher);
        }
        #[cfg(feature = "rigid")]
        if !self.bodies.is_empty() {
            return self.run_bodies(checkpoint, watcher);
        }
        self.run_particles(checkpoint, watcher)
    }
}

/// An observer that asks for no checkpoints.
struct Callback<F>(F);

impl<F: FnMut(Progress<'_>) -> ControlFlow<()>> Observer for Callback<F> {
    fn stepped(&mut self, now: Progress<'_>) -> Control {
        if self.0(now).is_break() { Control::Stop } else { Control::Continue }
    }

    fn keep(&mut self, _: &Checkpoint) {}
}
