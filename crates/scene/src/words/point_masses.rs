//! Particles beside bodies: point masses that do not turn, moved as bodies are.
//!
//! ```text
//! M = (m, m, m, I, I, I) with I w = 0 always: nothing gives a particle a torque
//! ```
//! A spring, a rod or a load pulls at its centre, and what touches it does so along its radius, for a particle
//! has no friction: its moments are never asked for. Rods between particles that touch, and pins that move and touch,
//! make of all of them point masses too, since joints, obstacles and contact are solved together for bodies.

use crate::model::body_shape::BodyShape;
use crate::model::items::RigidBody;
use crate::model::particle::Motion;
use crate::words::draft::{DeclaredBody, Draft};

impl Draft<'_> {
    /// Makes of every free particle a body that does not turn, where there are bodies, or rods beside
    /// contact, or pins that move and touch.
    pub(crate) fn embody_particles(&mut self, contact: bool, pushed: bool) {
        let joined = contact && (pushed || !self.rods.is_empty()) && self.dimension > 1;
        if self.heat.is_some() || (self.bodies.is_empty() && !joined) {
            return;
        }
        for particle in &mut self.particles.particles {
            let Motion::Free { mass, momentum } = particle.motion else { continue };
            // Of a point any moment will do: that of a ball of length one.
            let radius = if particle.radius > 0.0 { particle.radius } else { 1.0 };
            let moment = 0.4 * mass * radius * radius;
            let (body, point) = (self.bodies.len(), [0.0; 3]);
            let shape = match particle.radius > 0.0 {
                true => BodyShape::Ball(particle.radius),
                false => BodyShape::Moments,
            };
            particle.motion = Motion::Carried { body, point };
            let body = RigidBody {
                name: particle.name.clone(),
                mass,
                shape,
                moments: if self.dimension == 3 { [moment; 3] } else { [0.0, 0.0, moment] },
                position: particle.position,
                rotation: [0.0; 3],
                velocity: momentum.map(|p| p / mass),
                angular_velocity: [0.0; 3],
                points: Vec::new(),
                point_mass: true,
            };
            self.bodies.push(DeclaredBody { body, has_velocity: true, has_spin: true });
        }
    }
}
