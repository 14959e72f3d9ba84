//! Fields of a run: what particles, bodies, vertices and elements have besides their places.
//!
//! ```text
//! v = dx/dt                     of particles, and of points on bodies:  v + R (w x p)
//! (w, x, y, z), v, w            orientation, velocity and angular velocity of bodies
//! u = x - X                     of vertices of solids, X at rest
//! sigma = P F^T / J             of elements, the mean over an element
//! ```
//! A quaternion turns body axes into the world's, scalar first; `w` is in body axes (radians over
//! time), in the plane one number, as is the angle there. The stress of a bar or a sheet is per
//! section at rest, and that of a sheet in space leaves out its bending. Displacement and stress are
//! made from the places when they are asked for, so that a run does not keep them.

use crate::assemble::error::AssemblyError;
#[cfg(feature = "elasticity")]
use crate::assemble::{elastic::Which, vertices::Vertices};
use crate::model::contact_side::ContactSide;
use crate::model::items::Stress;
use crate::model::particle::Motion;
use crate::model::scene::{Scene, numbers_of_a_body};
use crate::model::turned::{cross, turn};
use crate::run::samples::Run;
use crate::text::file_error::WriteError;
use stationary_calculus::array;

/// The stress of every element at the places of all particles, D numbers each.
pub(crate) type StressField = Box<dyn Fn(&[f64]) -> Vec<Stress>>;

/// How a body moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BodyField {
    /// What turns body axes into those of the world: a quaternion of length one, scalar first.
    pub orientation: [f64; 4],
    /// The angle by which it is turned, in the plane; whole turns count.
    pub angle: f64,
    /// The velocity of its centre.
    pub velocity: [f64; 3],
    /// Its angular velocity, in body axes.
    pub angular_velocity: [f64; 3],
}

impl BodyField {
    /// What a pinned particle has beside bodies.
    pub(crate) const AT_REST: BodyField = BodyField {
        orientation: [1.0, 0.0, 0.0, 0.0],
        angle: 0.0,
        velocity: [0.0; 3],
        angular_velocity: [0.0; 3],
    };
}

impl Scene {
    /// The stress of the elements of all solids, in their order.
    #[cfg(feature = "elasticity")]
    pub(crate) fn stress_field(&self) -> Result<StressField, AssemblyError> {
        match self.dimension {
            1 => self.stress_field_in::<1>(),
            2 => self.stress_field_in::<2>(),
            _ => self.stress_field_in::<3>(),
        }
    }

    #[cfg(not(feature = "elasticity"))]
    pub(crate) fn stress_field(&self) -> Result<StressField, AssemblyError> {
        Err(AssemblyError::NotCompiled("solids"))
    }

    #[cfg(feature = "elasticity")]
    fn stress_field_in<const D: usize>(&self) -> Result<StressField, AssemblyError> {
        let vertices = Vertices::with_moving(self);
        let elastic = self.elastic_bodies::<D>(Which::All, &vertices)?;
        Ok(Box::new(move |places| {
            let free = &vertices.particles[..vertices.free];
            let place = |&particle: &usize| &places[D * particle..D * (particle + 1)];
            elastic.stresses(&free.iter().flat_map(place).copied().collect::<Vec<_>>())
        }))
    }
}

impl Run {
    /// The velocities of all particles at a sample, and of the centres and points of bodies, in the
    /// scene's order. Empty where there is no such sample, and of heat.
    pub fn velocities(&self, sample: usize) -> Vec<[f64; 3]> {
        let (scene, d) = (&self.scene, self.scene.dimension);
        if scene.keeps_velocities() {
            let n = d * scene.particles.len();
            let of_sample = self.samples.velocities.get(n * sample..n * (sample + 1));
            return of_sample.unwrap_or_default().chunks_exact(d).map(in_space).collect();
        }
        let bodies = self.bodies(sample);
        if bodies.is_empty() {
            return Vec::new();
        }
        let of = |motion: &Motion| match *motion {
            Motion::Carried { body, point } => bodies[body].velocity_of(point),
            _ => [0.0; 3],
        };
        let mut all: Vec<[f64; 3]> =
            scene.particles.iter().map(|particle| of(&particle.motion)).collect();
        let time = self.times()[sample];
        for motion in &scene.drives.motions {
            all[motion.particle] = motion.velocity(time);
        }
        all
    }

    /// How all bodies move at a sample, in the scene's order. Empty where there is no such sample.
    pub fn bodies(&self, sample: usize) -> Vec<BodyField> {
        let d = self.scene.dimension;
        let each = numbers_of_a_body(d);
        let n = each * self.scene.bodies.len();
        let of_sample = self.samples.bodies.get(n * sample..n * (sample + 1));
        let body = |x: &[f64]| match *x {
            [w, x, y, z, ref velocities @ ..] => match d {
                3 => BodyField {
                    orientation: [w, x, y, z],
                    angle: 0.0,
                    velocity: in_space(&velocities[..3]),
                    angular_velocity: in_space(&velocities[3..]),
                },
                _ => BodyField {
                    orientation: [(0.5 * w).cos(), 0.0, 0.0, (0.5 * w).sin()],
                    angle: w,
                    velocity: [x, y, 0.0],
                    angular_velocity: [0.0, 0.0, z],
                },
            },
            _ => BodyField {
                orientation: [1.0, 0.0, 0.0, 0.0],
                angle: 0.0,
                velocity: [0.0; 3],
                angular_velocity: [0.0; 3],
            },
        };
        of_sample.unwrap_or_default().chunks_exact(each).map(body).collect()
    }

    /// How far each particle is from where it is when its solid is at rest; zero of those of none.
    pub(crate) fn displacements(&self, sample: usize) -> Vec<[f64; 3]> {
        let mut displacements = vec![[0.0; 3]; self.scene.particles.len()];
        for solid in &self.scene.solids {
            for (particle, rest) in (solid.first..).zip(&solid.rest) {
                let place = self.position(sample, particle);
                displacements[particle] = array(|c| place[c] - rest[c]);
            }
        }
        displacements
    }

    /// The contact impulses that all particles and bodies were given since the sample before, those
    /// of a body at its centre.
    pub(crate) fn impulses_on(&self, sample: usize) -> Vec<[f64; 3]> {
        let scene = &self.scene;
        let mut given = vec![[0.0; 3]; scene.particles.len()];
        let rows = &self.samples.contacts.rows;
        let first = rows.partition_point(|row| row.sample < sample);
        for row in rows[first..].iter().take_while(|row| row.sample == sample) {
            for (side, sign) in row.between.into_iter().zip([-1.0, 1.0]) {
                // A body's is its centre.
                let middle = match side {
                    ContactSide::Body(body) => Some(scene.centre(body)),
                    ContactSide::Particle(particle) => Some(particle),
                    _ => None,
                };
                if let Some(middle) = middle {
                    given[middle] = array(|c| given[middle][c] + sign * row.impulse[c]);
                }
            }
        }
        given
    }

    /// The stress of the elements at any places, to be written to a file.
    pub(crate) fn stress_to(&self, path: &std::path::Path) -> Result<StressField, WriteError> {
        let failed = |error| WriteError {
            path: path.to_owned(),
            source: std::io::Error::other(format!("{error}")),
        };
        self.scene.stress_field().map_err(failed)
    }
}

impl BodyField {
    /// The velocity of a point, in body axes.
    pub(crate) fn velocity_of(&self, point: [f64; 3]) -> [f64; 3] {
        let swept = turn(self.orientation, cross(self.angular_velocity, point));
        array(|c| self.velocity[c] + swept[c])
    }
}

/// A vector of as many components as the scene has dimensions, in space.
fn in_space(x: &[f64]) -> [f64; 3] {
    array(|c| x.get(c).copied().unwrap_or(0.0))
}
