//! The same scene with another step or horizon, within what may be sampled.

use crate::model::scene::{Scene, numbers_of_a_body};
use crate::model::timing::Timing;
use crate::text::fault::Fault;
use crate::text::limits;

impl Scene {
    /// The same scene with another step, sampled at about the same times.
    ///
    /// # Errors
    /// [`Fault::NotPositive`] also where it is not finite; [`Fault::NotWhole`] where the horizon is
    /// not a whole number of steps; [`Fault::TooMany`] steps; [`Fault::TooManySamples`].
    pub fn with_step(self, step: f64) -> Result<Scene, Fault> {
        let old = self.timing;
        let every = (old.sample_every as f64 * (old.step / step)).round().max(1.0) as u64;
        let scene = Scene { timing: Timing::new(step, old.horizon, every)?, ..self };
        scene.check_samples()?;
        Ok(scene)
    }

    /// The same scene to another horizon, a whole number of its steps.
    ///
    /// # Errors
    /// Those of [`Scene::with_step`].
    pub fn with_horizon(self, horizon: f64) -> Result<Scene, Fault> {
        let timing = Timing::new(self.timing.step, horizon, self.timing.sample_every)?;
        let scene = Scene { timing, ..self };
        scene.check_samples()?;
        Ok(scene)
    }

    /// An error where the samples would be more numbers than are kept.
    pub(crate) fn check_samples(&self) -> Result<(), Fault> {
        let columns: usize = self.observables.iter().map(|o| o.headings(self).len()).sum();
        // Positions, velocities and temperatures, observables, and the time, heat, energies and
        // momenta that every sample has.
        let velocities = if self.keeps_velocities() { self.dimension } else { 0 };
        let per_particle = self.dimension + velocities + usize::from(self.heat.is_some());
        let of_bodies = numbers_of_a_body(self.dimension) * self.bodies.len();
        let per_sample = (per_particle * self.particles.len() + of_bodies + columns + 10) as u64;
        let numbers = self.timing.samples().saturating_mul(per_sample);
        if numbers <= limits::SAMPLED_NUMBERS {
            return Ok(());
        }
        let rows = (limits::SAMPLED_NUMBERS / per_sample).saturating_sub(1).max(1);
        Err(Fault::TooManySamples { numbers, enough: self.timing.steps().div_ceil(rows) })
    }
}
