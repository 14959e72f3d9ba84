//! Energy and momenta of a tree in motion.
//!
//! ```text
//! T = sum 1/2 m |v|^2 + 1/2 w.I w,       V = -sum m g.x
//! P = sum m v,                           L = sum x x m v + I w             about the origin
//! p = S^T (m v, I w), summed inward      = M v: momenta of the joints
//! ```
//! Joules, kg m/s, kg m^2/s, world axes. A tree that hangs free keeps P where nothing acts and L
//! where no torque does. Source: notes 8.3, 9.4.

use nalgebra::Vector3;

use super::builder::Link;
use super::error::TreeError;
use super::motion::{Placed, TreeMotion};
use super::spatial::{SpatialForce, Twist};

impl TreeMotion {
    /// The kinetic energy, joules.
    pub fn kinetic_energy(&self) -> f64 {
        let one = |(link, placed, twist): (&Link, &Placed, &Twist)| {
            let w = placed.matrix.tr_mul(&twist.angular);
            link.mass * twist.linear.norm_squared() + link.moments.component_mul(&w).dot(&w)
        };
        0.5 * self.bodies().map(one).sum::<f64>()
    }

    /// The potential energy under an acceleration of gravity (m/s^2), joules; zero at the origin.
    pub fn potential_energy(&self, gravity: &Vector3<f64>) -> f64 {
        -self.bodies().map(|(link, placed, _)| link.mass * gravity.dot(&placed.centre)).sum::<f64>()
    }

    /// The linear momentum, kg m/s.
    pub fn linear_momentum(&self) -> Vector3<f64> {
        self.bodies().map(|(link, _, twist)| twist.linear * link.mass).sum()
    }

    /// The angular momentum about the origin, kg m^2/s.
    pub fn angular_momentum(&self) -> Vector3<f64> {
        let one = |(link, placed, twist): (&Link, &Placed, &Twist)| {
            let SpatialForce { force, torque } = momentum(link, placed, twist);
            torque + placed.centre.cross(&force)
        };
        self.bodies().map(one).sum()
    }

    /// Writes the momentum of each joint along its speeds, the mass matrix times the speeds.
    ///
    /// # Errors
    /// Another size.
    pub fn momenta(&mut self, momenta: &mut [f64]) -> Result<(), TreeError> {
        self.check_result("the momenta", momenta)?;
        let TreeMotion { tree, placed, moving, forces, .. } = self;
        let bodies = tree.links.iter().zip(&*placed).zip(&*moving);
        for (f, ((link, placed), moving)) in forces.iter_mut().zip(bodies) {
            *f = momentum(link, placed, &moving.twist);
        }
        self.gather(momenta);
        Ok(())
    }

    fn bodies(&self) -> impl Iterator<Item = (&Link, &Placed, &Twist)> {
        let bodies = self.tree.links.iter().zip(&self.placed).zip(&self.moving);
        bodies.map(|((link, placed), moving)| (link, placed, &moving.twist))
    }
}

/// The momentum of a body: linear, and angular about its centre.
#[inline]
fn momentum(link: &Link, placed: &Placed, twist: &Twist) -> SpatialForce {
    let torque = placed.moments_times(&link.moments, &twist.angular);
    SpatialForce { force: twist.linear * link.mass, torque }
}
