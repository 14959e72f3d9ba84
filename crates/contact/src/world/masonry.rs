//! A masonry arch: wedges that touch, on the ground, under their weight.
//!
//! ```text
//! wedge k   between the rays at k pi/n and (k + 1) pi/n, and between the radii r and r + t
//! t/(r + t/2) > 0.107,   mu > 0.31          what a round arch of many wedges asks for to stand
//! ```
//! `n` wedges of density 1 kg/m^2, `r` the inner radius and `t` the thickness (m), `mu` the
//! friction of every joint and of the ground. Joints match exactly and carry nothing but contact.
//! The two numbers are those of a half circle: the thrust stays inside (Milankovitch 1907; Heyman
//! 1969), and nowhere leans too far from a joint's normal (Sinopoli, Corradi and Foce 1997; the
//! study of the arch finds it by statics and by letting arches go).

use nalgebra::Vector2;
use stationary_calculus::{Covector, DiagonalMetric, System};
use stationary_integrators::State;
use stationary_mesh::Polygon;
use stationary_rigid::{LieGroup, PlanarMass, PlanarMotion, PlanarWeight};

use crate::{ContactError, PlanarCollider, PlanarDetector, PlanarShape, PlanarWorld, World};

/// Wedges on the ground, and where they are.
type Built = (PlanarWorld<PlanarWeight>, State<Vec<f64>>);

/// A half-circular arch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arch {
    /// Its wedges.
    pub wedges: usize,
    /// The inner radius, m.
    pub radius: f64,
    /// The thickness, m.
    pub thickness: f64,
    /// The friction of joints and ground.
    pub friction: f64,
    /// The acceleration of gravity, m/s^2.
    pub gravity: f64,
}

impl Arch {
    /// The arch as it is built, at rest.
    ///
    /// # Errors
    /// [`ContactError::Outline`], [`ContactError::Flat`], [`ContactError::Rigid`] and
    /// [`ContactError::Mass`] where radius and thickness leave a wedge without area or mass;
    /// [`ContactError::Friction`] where it is negative or not finite.
    pub fn built(&self) -> Result<Built, ContactError> {
        let (mut masses, mut inertias, mut q) = (Vec::new(), Vec::new(), Vec::new());
        let mut colliders = Vec::new();
        for wedge in 0..self.wedges {
            let corners = self.corners(wedge);
            let mass = PlanarMass::of(1.0, &Polygon::new(vec![corners.clone()])?.moments())?;
            let own: Vec<_> = corners.iter().map(|corner| corner - mass.centre).collect();
            let shape = PlanarShape::polygon(&own)?;
            colliders.push(PlanarCollider::on_body(wedge, shape).with_friction(self.friction));
            inertias.extend([mass.mass, mass.mass, mass.inertia]);
            masses.push(mass.mass);
            q.extend([mass.centre.x, mass.centre.y, 0.0]);
        }
        let ground = PlanarShape::half_plane(Vector2::y())?;
        let ground = PlanarCollider::fixed(PlanarMotion::identity(), ground);
        colliders.push(ground.with_friction(self.friction));
        let gravity = Vector2::new(0.0, -self.gravity);
        let system = System::new(DiagonalMetric::new(inertias)?, PlanarWeight { gravity, masses })?;
        let detector = PlanarDetector::new(colliders, self.wedges)?;
        let rest = vec![0.0; q.len()];
        Ok((World::new(system, detector)?, State::new(q, Covector(rest))))
    }

    /// The corners of a wedge, counterclockwise.
    fn corners(&self, wedge: usize) -> Vec<Vector2<f64>> {
        let ray = |k: usize| {
            // The springings lie on the ground exactly.
            let angle = std::f64::consts::PI * k as f64 / self.wedges as f64;
            let height = if k == 0 || k == self.wedges { 0.0 } else { angle.sin() };
            Vector2::new(angle.cos(), height)
        };
        let (inner, outer) = (self.radius, self.radius + self.thickness);
        let (from, to) = (ray(wedge), ray(wedge + 1));
        vec![from * inner, from * outer, to * outer, to * inner]
    }

    /// How far the centre of the middle wedge has sunk, m.
    pub fn sunk(&self, start: &State<Vec<f64>>, now: &State<Vec<f64>>) -> f64 {
        let middle = 3 * (self.wedges / 2) + 1;
        start.q[middle] - now.q[middle]
    }
}
