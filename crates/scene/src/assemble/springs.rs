//! Springs between particles.

use stationary_calculus::Stencils;
use stationary_elasticity::Spring;

use crate::assemble::error::AssemblyError;
use crate::assemble::vertices::{Vertices, leading};
use crate::model::built::Built;
use crate::model::items::Link;
use crate::model::scene::Scene;

/// The potential of a scene's springs.
pub(crate) type Springs<const D: usize> = Stencils<Spring, 2, D>;

impl Scene {
    /// The scene's springs between its vertices.
    pub(crate) fn springs<const D: usize>(
        &self,
        vertices: &Vertices,
        built: &mut Built,
    ) -> Result<Springs<D>, AssemblyError> {
        // Springs to pins that move are forces in time.
        let still = |link: &&Link| link.ends.iter().all(|&end| !self.drives.moves(end));
        let springs = self.links.iter().filter(still).map(|link| {
            let ends = link.ends.map(|end| vertices.of_particle[end]);
            Spring::new(ends, link.rest_length, link.stiffness, link.strain)
        });
        let springs = springs.collect::<Result<Vec<_>, _>>()?;
        built.springs += springs.len() as u64;
        let pinned = vertices.particles[vertices.free..].iter();
        let fixed = pinned.map(|&particle| leading::<D>(self.particles[particle].position));
        Ok(Stencils::new(vertices.free, fixed.collect(), springs)?)
    }
}
