//! What acts on a tree: weight, forces and torques on bodies, forces of joints.
//!
//! ```text
//! (F, N) <- (F, N) + (f, c x f)      a force f at a point c from the centre, world axes
//! ```
//! Newtons and newton metres. The force of a joint belongs to a speed: along an axis N, about it
//! N m, of a ball the torque in the body's axes. They are given; what a joint holds by itself is no
//! force here.

use nalgebra::Vector3;

use super::builder::Tree;
use super::error::{TreeError, check_numbers};
use super::motion::TreeMotion;
use super::spatial::SpatialForce;

/// Forces on a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct TreeForces {
    pub(super) gravity: Vector3<f64>,
    /// About each body's centre, in world axes.
    pub(super) bodies: Vec<SpatialForce>,
    pub(super) joints: Vec<f64>,
}

impl TreeForces {
    /// None.
    pub fn none(tree: &Tree) -> Self {
        TreeForces {
            gravity: Vector3::zeros(),
            bodies: vec![SpatialForce::zero(); tree.bodies()],
            joints: vec![0.0; tree.speeds()],
        }
    }

    /// The weight of all bodies under an acceleration of gravity, m/s^2.
    ///
    /// # Errors
    /// A gravity that is not finite.
    pub fn weight(tree: &Tree, gravity: Vector3<f64>) -> Result<Self, TreeError> {
        check_numbers("the gravity", 3, gravity.as_slice())?;
        Ok(TreeForces { gravity, ..TreeForces::none(tree) })
    }

    /// Takes all of them away but the gravity.
    pub(super) fn clear(&mut self) {
        self.bodies.fill(SpatialForce::zero());
        self.joints.fill(0.0);
    }

    /// The acceleration of gravity, m/s^2.
    pub fn gravity(&self) -> Vector3<f64> {
        self.gravity
    }

    /// Adds a force (N, world axes) at a point of a body (m, body axes), where the motion has it.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`], numbers that are not finite.
    pub fn add_force(
        &mut self,
        motion: &TreeMotion,
        body: usize,
        point: &Vector3<f64>,
        force: Vector3<f64>,
    ) -> Result<(), TreeError> {
        check_numbers("the point", 3, point.as_slice())?;
        check_numbers("the force", 3, force.as_slice())?;
        let arm = motion.placed(body)?.matrix * point;
        let at = SpatialForce { force, torque: Vector3::zeros() };
        *self.body_mut(body)? += at.inward(&arm);
        Ok(())
    }

    /// Adds a torque (N m, world axes) on a body.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`], numbers that are not finite.
    pub fn add_torque(&mut self, body: usize, torque: Vector3<f64>) -> Result<(), TreeError> {
        check_numbers("the torque", 3, torque.as_slice())?;
        self.body_mut(body)?.torque += torque;
        Ok(())
    }

    /// The force of each joint along its speeds.
    pub fn joints(&self) -> &[f64] {
        &self.joints
    }

    /// The force of each joint along its speeds, to be set.
    pub fn joints_mut(&mut self) -> &mut [f64] {
        &mut self.joints
    }

    fn body_mut(&mut self, body: usize) -> Result<&mut SpatialForce, TreeError> {
        let bodies = self.bodies.len();
        self.bodies.get_mut(body).ok_or(TreeError::NoSuchBody { body, bodies })
    }

    /// An error unless they are those of a tree of this size, with finite forces of joints.
    pub(super) fn check(&self, tree: &Tree) -> Result<(), TreeError> {
        stationary_calculus::SizeError::check(
            "the forces' bodies",
            tree.bodies(),
            self.bodies.len(),
        )?;
        check_numbers("the forces of joints", tree.speeds(), &self.joints)
    }
}
