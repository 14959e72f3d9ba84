//! Prescribed turn in the plane: the angle between two ends follows a function of time.
//!
//! ```text
//! g = theta_2 - theta_1 - (theta_2 - theta_1 at the start) - angle(t)
//! ```
//! `theta` the angles of the ends' axes (rad), where a joint's axes are the world's at the start. The torque
//! that the drive exerts on the second end is minus its multiplier (N m). Linear: it has no Hessian. The
//! pin beside it holds the place. In space it is [`Drive`](crate::Drive), which see. Source: notes 6.5, 10.1.

use stationary_calculus::{Flat, Sink, SizeError};
use stationary_constraints::{ConstraintOn, Rows, Scale, check_read};

use super::PlanarEnd;
use crate::{
    Along, DrivenCoordinate, JointFault, JointName, PrescribedCoordinate, RigidError, Schedule,
};

/// The turn of a second end against a first, in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarTurn {
    bodies: usize,
    ends: [PlanarEnd; 2],
}

/// A turn of the second end against the first that follows a schedule.
pub type PlanarDrive<T> = PrescribedCoordinate<PlanarTurn, T>;

impl<T: Schedule> PrescribedCoordinate<PlanarTurn, T> {
    /// A drive between two ends, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the drive and what is wrong with it.
    pub fn new(bodies: usize, ends: [PlanarEnd; 2], schedule: T) -> Result<Self, RigidError> {
        let turn = PlanarTurn { bodies, ends };
        let fault = |fault| RigidError::Joint { joint: turn.name(), fault };
        ends.iter().try_for_each(|end| end.check(bodies)).map_err(fault)?;
        if ends[0].body == ends[1].body {
            return Err(fault(JointFault::ToItself));
        }
        Ok(Self::of(turn, schedule))
    }
}

impl<T: Schedule> ConstraintOn<Flat> for PrescribedCoordinate<PlanarTurn, T> {}

impl DrivenCoordinate for PlanarTurn {
    fn name(&self) -> JointName {
        JointName { kind: Along::Turn.drive(), bodies: self.ends.map(|end| end.body) }
    }

    fn dim(&self) -> usize {
        self.bodies.saturating_mul(3)
    }

    fn beyond(&self, q: &[f64], target: f64) -> Result<f64, SizeError> {
        check_read(self.dim(), q)?;
        let angle = |end: &PlanarEnd| end.angle + end.body.map_or(0.0, |body| q[3 * body + 2]);
        Ok(angle(&self.ends[1]) - angle(&self.ends[0]) - target)
    }

    fn bring(&self, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        for (end, sign) in self.ends.iter().zip([-1.0, 1.0]) {
            if let Some(body) = end.body {
                rows.add(0, 3 * body + 2, sign);
            }
        }
        Ok(())
    }

    fn add_hessian(&self, q: &[f64], _: f64, _: &mut impl Sink) -> Result<(), SizeError> {
        check_read(self.dim(), q)
    }

    fn scale(&self) -> Scale {
        Scale::default()
    }
}
