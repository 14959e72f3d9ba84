//! What holds bodies where inequalities are solved: joints, rods that are left, motors with a speed, limits
//! and dry friction of joints.
//!
//! ```text
//! rows of joints, then of rods, of motors, of limits, of friction          one solve with contacts
//! T = -x/h          the tension of a rod, x the impulse of its row in a step of h seconds
//! ```

use nalgebra::{Vector2, Vector3};
use stationary_constraints::{Constraint, ConstraintError, VelocityRows};
use stationary_contact::{JointRows, Kept};
use stationary_rigid::{Along, JointFriction, JointLimits, Poses, RigidError};

use crate::JointKind;
use crate::assemble::body_system::{InSpace, InThePlane, ends_in_space, ends_in_the_plane};
use crate::assemble::error::AssemblyError;
use crate::model::items::SceneJoint;
use crate::model::scene::Scene;
use crate::run::samples::{BrokenRod, whole_rods};

/// What holds bodies, beside contacts.
pub(crate) struct JointSet {
    joints: Box<dyn JointRows>,
    /// Of all joints.
    equations_of_joints: usize,
    rods: Vec<Box<dyn JointRows>>,
    strengths: Vec<f64>,
    /// The rods that have not broken.
    left: Vec<usize>,
    motors: Box<dyn JointRows>,
    equations_of_motors: usize,
    bounds: Box<dyn JointRows>,
}

impl JointSet {
    pub(crate) fn in_space(scene: &Scene, of: &InSpace) -> Result<Self, AssemblyError> {
        let bodies = scene.bodies.len();
        let turn = |joint: &SceneJoint| {
            let along = if joint.kind == JointKind::Slider { Along::Shift } else { Along::Turn };
            ((along, Vector3::from(joint.axis)), ends_in_space(&scene.bodies, joint))
        };
        let limits = scene.limited().map(|(joint, limits)| {
            let (along, ends) = turn(joint);
            JointLimits::new(Poses, bodies, along, ends, limits)
        });
        let friction = scene.rubbing().map(|joint| {
            let (along, ends) = turn(joint);
            JointFriction::new(Poses, bodies, along, ends, joint.friction)
        });
        let bounds = (all(limits)?, all(friction)?);
        Ok(JointSet::of(scene, &of.joints.0, &of.joints.1, Box::new(bounds)))
    }

    pub(crate) fn in_the_plane(scene: &Scene, of: &InThePlane) -> Result<Self, AssemblyError> {
        let bodies = scene.bodies.len();
        let limits = scene.limited().map(|(joint, limits)| {
            let ends = ends_in_the_plane(&scene.bodies, joint);
            match joint.kind {
                JointKind::Slider => {
                    JointLimits::in_plane_along(bodies, planar_axis(joint), ends, limits)
                }
                _ => JointLimits::in_plane(bodies, ends, limits),
            }
        });
        let friction = scene.rubbing().map(|joint| {
            let ends = ends_in_the_plane(&scene.bodies, joint);
            match joint.kind {
                JointKind::Slider => {
                    let axis = planar_axis(joint);
                    JointFriction::in_plane_along(bodies, axis, ends, joint.friction)
                }
                _ => JointFriction::in_plane(bodies, ends, joint.friction),
            }
        });
        let bounds = (all(limits)?, all(friction)?);
        Ok(JointSet::of(scene, &of.joints.0, &of.joints.1, Box::new(bounds)))
    }

    /// Rods come after joints.
    fn of<J, D>(scene: &Scene, held: &[J], motors: &[D], bounds: Box<dyn JointRows>) -> Self
    where
        J: Constraint + Clone + 'static,
        D: Constraint + Clone + 'static,
    {
        let (joints, rods) = held.split_at(scene.joints.len());
        let (joints, motors) = (joints.to_vec(), motors.to_vec());
        let rod = |rod: &J| -> Box<dyn JointRows> { Box::new(Kept(rod.clone())) };
        JointSet {
            equations_of_joints: joints.count(),
            equations_of_motors: motors.count(),
            joints: Box::new(Kept(joints)),
            rods: rods.iter().map(rod).collect(),
            strengths: scene.rods.iter().map(|rod| rod.strength).collect(),
            left: (0..rods.len()).collect(),
            motors: Box::new(Kept(motors)),
            bounds,
        }
    }

    /// Equations of joints, rods that are left and motors.
    pub(crate) fn equations(&self) -> usize {
        self.equations_of_joints + self.left.len() + self.equations_of_motors
    }

    /// Whether rods break.
    pub(crate) fn breaks(&self) -> bool {
        self.strengths.iter().any(|strength| strength.is_finite())
    }

    /// The forces of joints and the tensions of the rods that are left, by the impulses of a step.
    pub(crate) fn forces(&self, impulses: &[f64], h: f64, forces: &mut Vec<f64>) {
        let held = self.equations_of_joints + self.left.len();
        forces.clear();
        forces.extend(impulses.iter().take(held).map(|impulse| -impulse / h));
    }

    /// Takes out the rod whose tension or thrust exceeds its strength by the largest part, if one does. Its
    /// place is that among the rods that were left.
    pub(crate) fn break_one(&mut self, forces: &[f64], time: f64) -> Option<BrokenRod> {
        let tensions = forces.get(self.equations_of_joints..)?;
        let part = |place: usize| tensions[place].abs() / self.strengths[self.left[place]];
        let most = (0..tensions.len()).max_by(|&a, &b| part(a).total_cmp(&part(b)))?;
        if part(most) <= 1.0 {
            return None;
        }
        self.left.remove(most);
        Some(BrokenRod { rod: most, time, tension: tensions[most] })
    }

    /// Goes back to where these rods had broken.
    pub(crate) fn restore(&mut self, broken: &[BrokenRod]) {
        self.left = whole_rods(self.rods.len(), broken);
    }
}

fn planar_axis(joint: &SceneJoint) -> Vector2<f64> {
    Vector3::from(joint.axis).xy()
}

fn all<T>(made: impl Iterator<Item = Result<T, RigidError>>) -> Result<Vec<T>, RigidError> {
    made.collect()
}

impl Scene {
    /// Joints that have limits.
    fn limited(&self) -> impl Iterator<Item = (&SceneJoint, [f64; 2])> {
        self.joints.iter().filter_map(|joint| Some((joint, joint.limits?)))
    }

    /// Joints that have dry friction.
    fn rubbing(&self) -> impl Iterator<Item = &SceneJoint> {
        self.joints.iter().filter(|joint| joint.friction > 0.0)
    }
}

impl JointRows for JointSet {
    fn velocity_rows(
        &self,
        t: f64,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.joints.velocity_rows(t, q, h, rows)?;
        for &rod in &self.left {
            self.rods[rod].velocity_rows(t, q, h, rows)?;
        }
        self.motors.velocity_rows(t, q, h, rows)?;
        self.bounds.velocity_rows(t, q, h, rows)
    }

    fn position_rows(
        &self,
        t: f64,
        q: &[f64],
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        self.joints.position_rows(t, q, rows)?;
        for &rod in &self.left {
            self.rods[rod].position_rows(t, q, rows)?;
        }
        self.motors.position_rows(t, q, rows)?;
        self.bounds.position_rows(t, q, rows)
    }
}
