//! Particles as the vertices of a system.

use crate::model::particle::Motion;
use crate::model::scene::Scene;
use stationary_calculus::array;

/// The order of the particles as vertices: the free ones first, each part in the scene's order.
#[derive(Clone, Debug)]
pub(crate) struct Vertices {
    /// The vertex of each particle.
    pub(crate) of_particle: Vec<usize>,
    /// The particle of each vertex.
    pub(crate) particles: Vec<usize>,
    /// The number of free ones.
    pub(crate) free: usize,
}

impl Vertices {
    pub(crate) fn new(scene: &Scene) -> Self {
        let all = || 0..scene.particles.len();
        let pinned = |&particle: &usize| scene.particles[particle].motion == Motion::Pinned;
        let mut particles: Vec<usize> = all().filter(|particle| !pinned(particle)).collect();
        let free = particles.len();
        particles.extend(all().filter(pinned));
        let mut of_particle = vec![0; particles.len()];
        for (vertex, &particle) in particles.iter().enumerate() {
            of_particle[particle] = vertex;
        }
        Vertices { of_particle, particles, free }
    }

    /// The same with the pins that move behind the free ones and counted with them.
    #[cfg(feature = "elasticity")]
    pub(crate) fn with_moving(scene: &Scene) -> Self {
        let Vertices { mut of_particle, mut particles, free } = Vertices::new(scene);
        particles[free..].sort_by_key(|&particle| !scene.drives.moves(particle));
        let moving = particles[free..].iter().filter(|&&particle| scene.drives.moves(particle));
        let free = free + moving.count();
        for (vertex, &particle) in particles.iter().enumerate() {
            of_particle[particle] = vertex;
        }
        Vertices { of_particle, particles, free }
    }
}

/// Whether full matrices are factored, not sparse ones.
pub(crate) fn few(freedoms: usize) -> bool {
    freedoms <= 32
}

/// The first D components, D <= 3.
pub(crate) fn leading<const D: usize>(x: [f64; 3]) -> [f64; D] {
    array(|c| x.get(c).copied().unwrap_or(0.0))
}
