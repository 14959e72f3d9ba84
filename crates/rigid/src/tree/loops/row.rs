//! One row of a joint that closes a loop: its gap, rate and acceleration, and what it pushes.
//!
//! ```text
//! g(q, x(t)),    g. = J v + J_x x.,    g.. = J v. + J_x x.. + (v, x.) d2g (v, x.)       x its end in the world
//! ```

use nalgebra::{SVector, Vector3};

use super::super::motion::TreeMotion;
use super::super::spatial::{SpatialForce, Twist};
use super::path::EndNow;
use crate::joint::{Local, Placed, Row, along};
use crate::{JointEnd, Wrench};

#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::tree) struct LoopRow {
    pub(super) ends: [JointEnd; 2],
    pub(super) row: Row,
    /// Along which path its end in the world moves, and where that is now.
    pub(super) path: Option<usize>,
    pub(super) now: EndNow,
}

impl LoopRow {
    fn placed(&self, motion: &TreeMotion) -> [Placed; 2] {
        self.ends.each_ref().map(|end| match end.body {
            None => {
                let mut placed = end.in_world();
                placed.place += self.now.shift;
                placed
            }
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

    /// What a gap is rounded against, in a tree of this [extent](TreeMotion::extent).
    pub(in crate::tree) fn size(&self, motion: &TreeMotion, extent: f64) -> f64 {
        let far = |at: Placed| at.place.norm().max(at.arm.norm());
        // Points at the origin are as far from it as they gape, and rounded as what leads there.
        let length =
            self.row.length(self.placed(motion).map(far).into_iter().fold(extent, f64::max));
        length.filter(|length| *length > 0.0).unwrap_or(1.0)
    }

    /// The motion of each end in the row's axes: that of the centre in the world's, turns in the body's.
    fn local(
        &self,
        motion: &TreeMotion,
        of: impl Fn(usize) -> Twist,
        of_world: Vector3<f64>,
    ) -> SVector<f64, 12> {
        along(&self.ends.each_ref().map(|end| match end.body {
            None => Wrench { force: of_world, torque: Vector3::zeros() },
            Some(body) => {
                let Twist { linear, angular } = of(body);
                Wrench { force: linear, torque: motion.placed[body].matrix.tr_mul(&angular) }
            }
        }))
    }

    /// How fast the row opens where the bodies move so and the world stays.
    pub(in crate::tree) fn rate(&self, motion: &TreeMotion, of: impl Fn(usize) -> Twist) -> f64 {
        along(&self.differential(motion)).dot(&self.local(motion, of, Vector3::zeros()))
    }

    /// The same where the tree moves as it does.
    pub(in crate::tree) fn slope(&self, motion: &TreeMotion) -> f64 {
        self.rate(motion, |body| motion.moving[body].twist)
    }

    /// How fast its end in the world alone opens it.
    pub(in crate::tree) fn led(&self, motion: &TreeMotion) -> f64 {
        self.along_world(motion, self.now.velocity)
    }

    fn along_world(&self, motion: &TreeMotion, of_world: Vector3<f64>) -> f64 {
        if self.path.is_none() {
            return 0.0;
        }
        along(&self.differential(motion)).dot(&self.local(motion, |_| Twist::zero(), of_world))
    }

    pub(in crate::tree) fn speed(&self, motion: &TreeMotion) -> f64 {
        self.slope(motion) + self.led(motion)
    }

    pub(in crate::tree) fn acceleration(&self, motion: &TreeMotion) -> f64 {
        let mut bend = Local::zeros();
        self.row.add_hessian(&self.placed(motion), 1.0, &mut bend);
        let velocity = self.local(motion, |body| motion.moving[body].twist, self.now.velocity);
        self.rate(motion, |body| motion.accelerations[body])
            + self.along_world(motion, self.now.acceleration)
            + velocity.dot(&(bend * velocity))
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
