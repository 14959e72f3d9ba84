//! Rods as a constraint on a problem.

use stationary_constraints::Rods;

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::{Vertices, leading};
use crate::model::scene::Scene;

impl Scene {
    /// The scene's rods as a constraint on its problem.
    ///
    /// # Errors
    /// [`AssemblyError::Dimension`] where D is not the scene's; [`AssemblyError::Constraint`] as of
    /// [`Rods::new`], none that a checked scene has.
    pub fn constraint<const D: usize>(&self) -> Result<Rods<D>, AssemblyError> {
        if D != self.dimension {
            return Err(AssemblyError::Dimension { scene: self.dimension, asked: D });
        }
        let vertices = Vertices::new(self);
        let pinned = &vertices.particles[vertices.free..];
        let fixed = pinned.iter().map(|&pin| leading::<D>(self.particles[pin].position)).collect();
        let rods = self.rods.iter().map(|rod| {
            let ends = rod.ends.map(|end| vertices.of_particle[end]);
            stationary_constraints::Rod::new(ends, rod.length).with_strength(rod.strength)
        });
        Ok(Rods::new(vertices.free, fixed, rods.collect())?)
    }
}
