//! The kinds of scenes: what moves decides which methods there are, and how it is run.
//!
//! What is neither heat nor bodies is particles. To check a scene does not name what runs it, so that
//! whoever only reads scenes compiles no steps.

use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::error::RunError;
use crate::run::march::Watcher;
use crate::run::samples::Run;
use crate::text::fault::Fault;

impl Scene {
    /// An error where the scene's method cannot step what the scene has.
    pub(crate) fn check_kind(&self) -> Result<(), Fault> {
        #[cfg(feature = "rigid")]
        if !self.bodies.is_empty() {
            return self.check_bodies();
        }
        self.check_particles()
    }

    /// Runs the scene to its horizon, or until the watcher breaks off.
    pub(crate) fn run_kind(
        &self,
        checkpoint: Option<Checkpoint>,
        watcher: &mut dyn Watcher,
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
