//! Rods as a constraint on a problem.

use stationary_constraints::{Hooks, Rods};

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::{Vertices, leading};
use crate::model::drives::PinMotion;
use crate::model::scene::Scene;

/// Pinned particles, some of which move as they are told.
#[derive(Clone, Debug, PartialEq)]
pub struct Pins<const D: usize>(Vec<Pin>);

/// Where one starts, and how it moves.
#[derive(Clone, Debug, PartialEq)]
struct Pin {
    start: [f64; 3],
    motion: Option<PinMotion>,
}

impl<const D: usize> Hooks<D> for Pins<D> {
    fn count(&self) -> usize {
        self.0.len()
    }

    fn place(&self, hook: usize, t: f64) -> [f64; D] {
        let Pin { start, motion } = &self.0[hook];
        leading(motion.as_ref().map_or(*start, |motion| motion.place(*start, t)))
    }

    fn velocity(&self, hook: usize, t: f64) -> [f64; D] {
        let motion = self.0[hook].motion.as_ref();
        motion.map_or([0.0; D], |motion| leading(motion.velocity(t)))
    }
}

impl Scene {
    /// The scene's rods as a constraint on its problem.
    ///
    /// # Errors
    /// [`AssemblyError::Dimension`] where D is not the scene's; [`AssemblyError::Constraint`] as of
    /// [`Rods::on`], none that a checked scene has.
    pub fn constraint<const D: usize>(&self) -> Result<Rods<D, Pins<D>>, AssemblyError> {
        if D != self.dimension {
            return Err(AssemblyError::Dimension { scene: self.dimension, asked: D });
        }
        let vertices = Vertices::new(self);
        let pins = vertices.particles[vertices.free..].iter().map(|&particle| Pin {
            start: self.particles[particle].position,
            motion: self.drives.motion_of(particle).cloned(),
        });
        let rods = self.rods.iter().map(|rod| {
            let ends = rod.ends.map(|end| vertices.of_particle[end]);
            stationary_constraints::Rod::new(ends, rod.length).with_strength(rod.strength)
        });
        Ok(Rods::on(vertices.free, Pins(pins.collect()), rods.collect())?)
    }
}
