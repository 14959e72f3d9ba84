//! What a scene's method remembers from step to step, saved and taken back.
//!
//! Rods are in no list of numbers: those that broke say which are left.

use stationary_constraints::ConstrainedIntegrator;
use stationary_constraints::Many;
use stationary_integrators::Saved;

use crate::Scene;
use crate::checkpoint::{Before, CheckpointError};
use crate::stepper::Stepper;

impl<const D: usize> Stepper<'_, D> {
    /// What the next steps depend on beside the state.
    pub(crate) fn save(&mut self) -> Saved {
        match self {
            Stepper::Equal(integrator) => integrator.save(),
            Stepper::Adaptive(reading) if reading.before.is_empty() => reading.method.save(),
            // Its last step is taken once more, for the polynomial within it.
            Stepper::Adaptive(reading) => Saved {
                method: reading.method.facts().name.to_owned(),
                numbers: reading.before.clone(),
            },
            Stepper::Constrained(integrator) => integrator.save(),
            Stepper::Rattle(rattle) => rattle.save(),
            // Modes and impacts depend on the state alone.
            Stepper::LinearModes(..) | Stepper::Impacting(_) => Saved::default(),
        }
    }

    /// Goes on from another state with what was saved there.
    pub(crate) fn load(&mut self, scene: &Scene, before: &Before) -> Result<(), CheckpointError> {
        let memory = &before.memory;
        match self {
            Stepper::Equal(integrator) => integrator.load(memory)?,
            Stepper::Adaptive(reading) => reading.method.load(memory)?,
            Stepper::Constrained(integrator) => integrator.load(memory)?,
            Stepper::LinearModes(..) | Stepper::Impacting(_) => {}
            Stepper::Rattle(rattle) => {
                rattle.load(memory)?;
                if !before.broken.is_empty() {
                    let mut rods = scene.constraint::<D>()?;
                    rods.retain(|rod| before.broken.iter().all(|broken| broken.rod != rod));
                    rattle.set_constraint(rods, &before.state, Many::default())?;
                }
            }
        }
        Ok(())
    }
}
