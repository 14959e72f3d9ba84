//! What a run of particles borrows: their problem, and the gaps or the modes by which it is stepped.

#[cfg(feature = "contact")]
use stationary_contact::{Balls, Inequality};

use crate::assemble::error::AssemblyError;
#[cfg(feature = "modal")]
use crate::assemble::linear_modes::LinearModes;
use crate::assemble::system::SceneProblem;
use crate::model::built::Built;
use crate::model::scene::Scene;
#[cfg(feature = "modal")]
use crate::model::stepping::Stepping;

/// The particles of a scene, assembled.
pub(crate) struct ParticleSystem<const D: usize> {
    pub(crate) problem: SceneProblem,
    /// The gaps that impulses keep open.
    #[cfg(feature = "contact")]
    pub(crate) gaps: Option<Inequality<Balls<D>>>,
    #[cfg(feature = "modal")]
    pub(crate) modes: Option<LinearModes>,
}

impl<const D: usize> ParticleSystem<D> {
    pub(crate) fn of(scene: &Scene) -> Result<Self, AssemblyError> {
        let problem = scene.problem()?;
        #[cfg(feature = "modal")]
        let modes = match scene.stepping {
            Stepping::LinearModes { count } => Some(LinearModes::of::<D>(&problem, count)?),
            _ => None,
        };
        #[cfg(feature = "contact")]
        let gaps = if scene.has_impulses() { scene.gaps()? } else { None };
        Ok(ParticleSystem {
            problem,
            #[cfg(feature = "contact")]
            gaps,
            #[cfg(feature = "modal")]
            modes,
        })
    }

    /// What was built besides the problem.
    pub(crate) fn built(&self) -> Built {
        #[cfg(feature = "modal")]
        if let Some(modes) = &self.modes {
            return modes.built;
        }
        Built::default()
    }
}
