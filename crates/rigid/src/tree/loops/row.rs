//! One row of a joint that closes a loop: its gap, rate and acceleration, and what it pushes.

use nalgebra::{SVector, Vector3};

use super::super::motion::TreeMotion;
use super::super::spatial::{SpatialForce, Twist};
use crate::joint::{Local, Placed, Row, along};
use crate::{JointEnd, Wrench};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::tree) struct LoopRow {
    pub(super) ends: [JointEnd; 2],
    pub(super) row: Row,
}

impl LoopRow {
    fn placed(&self, motion: &TreeMotion) -> [Placed; 2] {
        self.ends.each_ref().map(|end| match end.body {
            None => end.in_world(),
            Some(body) => {
                let at = &motion.placed[body];
                let arm = end.frame.translation;
                Placed { rotation: at.matrix, arm, place: at.centre + at.matrix * arm }
            }
        })
    }

    pub(in crate::tree) fn differential(&self, motion: &TreeMotion) -> [Wrench; 2] {
        self.row.differential(&self.placed(motion))
    }

    pub(in crate::tree) fn gap(&self, motion: &TreeMotion) -> f64 {
        self.row.value(&self.placed(motion))
    }

    /// What a gap is rounded against.
    pub(in crate::tree) fn size(&self, motion: &TreeMotion) -> f64 {
        let far = |at: Placed| at.place.norm().max(at.arm.norm());
        self.row.scale(self.placed(motion).map(far).into_iter().fold(0.0, f64::max)).length
    }

    /// Each body's motion in the row's axes: that of the centre in the world's, turns in the body's.
    fn local(&self, motion: &TreeMotion, of: impl Fn(usize) -> Twist) -> SVector<f64, 12> {
        along(&self.ends.each_ref().map(|end| match end.body {
            None => Wrench { force: Vector3::zeros(), torque: Vector3::zeros() },
            Some(body) => {
                let Twist { linear, angular } = of(body);
                Wrench { force: linear, torque: motion.placed[body].matrix.tr_mul(&angular) }
            }
        }))
    }

    pub(in crate::tree) fn rate(&self, motion: &TreeMotion, of: impl Fn(usize) -> Twist) -> f64 {
        along(&self.differential(motion)).dot(&self.local(motion, of))
    }

    pub(in crate::tree) fn speed(&self, motion: &TreeMotion) -> f64 {
        self.rate(motion, |body| motion.moving[body].twist)
    }

    pub(in crate::tree) fn acceleration(&self, motion: &TreeMotion) -> f64 {
        let mut bend = Local::zeros();
        self.row.add_hessian(&self.placed(motion), 1.0, &mut bend);
        let velocity = self.local(motion, |body| motion.moving[body].twist);
        self.rate(motion, |body| motion.accelerations[body]) + velocity.dot(&(bend * velocity))
    }

    /// Sets the tree's bias forces to a unit of this row's force.
    pub(in crate::tree) fn push(&self, motion: &mut TreeMotion) {
        motion.forces.fill(SpatialForce::zero());
        for (end, Wrench { force, torque }) in self.ends.iter().zip(self.differential(motion)) {
            let Some(body) = end.body else { continue };
            let torque = motion.placed[body].matrix * torque;
            motion.forces[body] += SpatialForce { force: -force, torque: -torque };
        }
    }
}
