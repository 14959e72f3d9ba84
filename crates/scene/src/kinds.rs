//! The kinds of scenes: what moves decides which methods there are, and how it is run.

use crate::march::Watcher;
use crate::{Checkpoint, Fault, Run, RunError, Scene};

/// A kind of scene.
pub(crate) struct Kind {
    /// Whether a scene is of it.
    of: fn(&Scene) -> bool,
    /// An error where the scene's method cannot step what the scene has.
    pub(crate) check: fn(&Scene) -> Result<(), Fault>,
    /// Runs the scene to its horizon, or until the watcher breaks off.
    pub(crate) run: fn(&Scene, Option<Checkpoint>, &mut dyn Watcher) -> Result<Run, RunError>,
}

/// What is neither heat nor bodies is particles.
const KINDS: &[Kind] = &[
    #[cfg(feature = "laplacian")]
    Kind { of: |scene| scene.heat.is_some(), check: Scene::check_particles, run: Scene::run_heat },
    #[cfg(feature = "rigid")]
    Kind {
        of: |scene| !scene.bodies.is_empty(),
        check: Scene::check_bodies,
        run: Scene::run_bodies,
    },
];

const PARTICLES: Kind =
    Kind { of: |_| true, check: Scene::check_particles, run: Scene::run_particles };

impl Scene {
    /// Its kind.
    pub(crate) fn kind(&self) -> &'static Kind {
        KINDS.iter().find(|kind| (kind.of)(self)).unwrap_or(&PARTICLES)
    }
}
