//! Particles: point masses, vertices, and points of bodies.

use serde::Serialize;

/// A point mass. Vectors have three components; those beyond the scene's dimension are zero.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Particle {
    /// Its name; the vertices of a net are called `net.row.column`, the points of a body
    /// `body.number`, counted from 0.
    pub name: String,
    /// Where it starts.
    pub position: [f64; 3],
    /// How it starts to move, or that it does not.
    pub motion: Motion,
    /// Its radius where things touch; zero of a point.
    pub radius: f64,
}

/// Whether a particle has freedoms of its own.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Motion {
    /// It moves.
    Free {
        /// Its mass.
        mass: f64,
        /// Its momentum at the start.
        momentum: [f64; 3],
    },
    /// It stays where it is, whatever pulls.
    Pinned,
    /// It is a point of a rigid body.
    Carried {
        /// The body, by its place in [`Scene::bodies`](crate::Scene::bodies).
        body: usize,
        /// The point, in body axes.
        point: [f64; 3],
    },
}
