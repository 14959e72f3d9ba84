//! Inverse dynamics: the joint forces that a motion takes, by Newton's and Euler's equations.
//!
//! ```text
//! A = X A_p + S v. + c                                                 outward
//! F = m (a - g) - F_e,     N = I alpha + w x I w - N_e                  body by body
//! f = (F, N) + sum of the children's X^T f,    tau = S^T f             inward
//! ```
//! `F_e N_e` the forces and torques on the body. All about the body's centre, in world axes. Source:
//! Luh, Walker and Paul 1980; Featherstone 2008, 5.3.

use super::error::{TreeError, check_numbers};
use super::forces::TreeForces;
use super::motion::TreeMotion;
use super::spatial::{SpatialForce, Twist};

impl TreeMotion {
    /// Writes the force of each joint, beyond those among `forces`, that makes the tree accelerate
    /// so: m/s^2 or rad/s^2 of each speed.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite.
    pub fn inverse_dynamics(
        &mut self,
        forces: &TreeForces,
        acceleration: &[f64],
        joint_forces: &mut [f64],
    ) -> Result<(), TreeError> {
        forces.check(&self.tree)?;
        self.tree.check_speeds("the acceleration", acceleration)?;
        stationary_calculus::SizeError::check(
            "the joint forces",
            self.columns.len(),
            joint_forces.len(),
        )?;
        self.accelerate(acceleration);
        for (body, link) in self.tree.links.iter().enumerate() {
            let (placed, a) = (&self.placed[body], self.accelerations[body]);
            let SpatialForce { force, torque } = forces.bodies[body];
            let w = self.moving[body].twist.angular;
            let gyroscopic = w.cross(&placed.moments_times(&link.moments, &w));
            self.forces[body] = SpatialForce {
                force: (a.linear - forces.gravity) * link.mass - force,
                torque: placed.moments_times(&link.moments, &a.angular) + gyroscopic - torque,
            };
        }
        self.gather(joint_forces);
        joint_forces.iter_mut().zip(&forces.joints).for_each(|(tau, given)| *tau -= given);
        check_numbers("the joint forces", self.columns.len(), joint_forces)
    }

    /// The bodies' accelerations, of those of the speeds.
    fn accelerate(&mut self, acceleration: &[f64]) {
        self.accelerate_where(acceleration, |_, _| true);
    }

    /// The same, where what is held accelerates by the bias alone.
    pub(super) fn accelerate_free(&mut self, acceleration: &[f64]) {
        self.accelerate_where(acceleration, |held, speed| !held.contains(&speed));
    }

    #[inline]
    fn accelerate_where(&mut self, acceleration: &[f64], counts: impl Fn(&[usize], usize) -> bool) {
        for (body, link) in self.tree.links.iter().enumerate() {
            let mut a = match link.parent {
                Some(parent) => self.accelerations[parent].outward(&self.placed[body].offset()),
                None => Twist::zero(),
            } + self.moving[body].bias;
            for k in link.speeds.clone().filter(|&k| counts(&self.held, k)) {
                a += self.columns[k] * acceleration[k];
            }
            self.accelerations[body] = a;
        }
    }

    /// Sums the bodies' forces inward, and writes what each speed feels of them.
    pub(super) fn gather(&mut self, joint_forces: &mut [f64]) {
        for (body, link) in self.tree.links.iter().enumerate().rev() {
            let f = self.forces[body];
            for k in link.speeds.clone() {
                joint_forces[k] = f.along(&self.columns[k]);
            }
            if let Some(parent) = link.parent {
                self.forces[parent] += f.inward(&self.placed[body].offset());
            }
        }
    }
}
