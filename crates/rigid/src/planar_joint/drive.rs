//! Prescribed motion in the plane: a turn or a shift between two ends follows a function of time.
//!
//! ```text
//! g = theta_2 - theta_1 - (theta_2 - theta_1 at the start) - angle(t),      g = <a_1, x_2 - x_1> - s(t)
//! ```
//! `theta` the angles of the ends' axes (rad), where a joint's axes are the world's at the start, `x` their origins
//! (m) and `a` an axis of the first. The torque (N m) or the force (N) that the drive exerts on the second end is
//! minus its multiplier. The joint beside it holds the rest. In space it is [`Drive`](crate::Drive), which see.
//! Source: notes 6.5, 10.1.

use nalgebra::Vector2;
use stationary_calculus::{Flat, Sink, SizeError};
use stationary_constraints::{ConstraintOn, Rows, Scale, check_read};

use super::row::{Local, Row, unit};
use super::{PlanarEnd, arm, bring, check_ends, pair_freedoms};
use crate::{
    Along, DrivenCoordinate, JointName, LieGroup, PlanarRotation, PrescribedCoordinate, RigidError,
    Schedule,
};

/// The turn of a second end against a first, or its shift along an axis of the first, in the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarCoordinate {
    bodies: usize,
    ends: [PlanarEnd; 2],
    along: Along,
    /// Minus the coordinate.
    row: Row,
}

/// A turn or a shift of the second end against the first that follows a schedule.
pub type PlanarDrive<T> = PrescribedCoordinate<PlanarCoordinate, T>;

impl<T: Schedule> PrescribedCoordinate<PlanarCoordinate, T> {
    /// A drive of a turn between two ends, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the drive and what is wrong with it.
    pub fn new(bodies: usize, ends: [PlanarEnd; 2], schedule: T) -> Result<Self, RigidError> {
        let turn = PlanarCoordinate { bodies, ends, along: Along::Turn, row: Row::Turn };
        turn.checked().map(|turn| Self::of(turn, schedule))
    }

    /// A drive of a shift along an axis, told in the joint's frames.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the drive and what is wrong with it.
    pub fn along(
        bodies: usize,
        axis: Vector2<f64>,
        ends: [PlanarEnd; 2],
        schedule: T,
    ) -> Result<Self, RigidError> {
        let row = Row::Across { a: axis, offset: 0.0 };
        let shift = PlanarCoordinate { bodies, ends, along: Along::Shift, row }.checked()?;
        let fault = |fault| RigidError::Joint { joint: shift.name(), fault };
        let a = PlanarRotation::exp(ends[0].angle).rotate(&unit(axis).map_err(fault)?);
        Ok(Self::of(PlanarCoordinate { row: Row::Across { a, offset: 0.0 }, ..shift }, schedule))
    }
}

impl PlanarCoordinate {
    fn checked(self) -> Result<Self, RigidError> {
        let fault = |fault| RigidError::Joint { joint: self.name(), fault };
        check_ends(&self.ends, self.bodies).map_err(fault)?;
        Ok(self)
    }
}

impl<T: Schedule> ConstraintOn<Flat> for PrescribedCoordinate<PlanarCoordinate, T> {}

impl DrivenCoordinate for PlanarCoordinate {
    fn name(&self) -> JointName {
        JointName { kind: self.along.drive(), bodies: self.ends.map(|end| end.body) }
    }

    fn dim(&self) -> usize {
        self.bodies.saturating_mul(3)
    }

    fn beyond(&self, q: &[f64], target: f64) -> Result<f64, SizeError> {
        check_read(self.dim(), q)?;
        Ok(-self.row.value(&self.ends.each_ref().map(|end| end.placed(q))) - target)
    }

    fn bring(&self, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        bring(&self.row, -1.0, 0, (&self.ends, q), rows);
        Ok(())
    }

    fn add_hessian(&self, q: &[f64], scale: f64, hessian: &mut impl Sink) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        let mut local = Local::zeros();
        let ends = self.ends.each_ref().map(|end| end.placed(q));
        self.row.add_hessian(&ends, -scale, &mut local);
        hessian.add_symmetric(&pair_freedoms(&self.ends), local.as_slice());
        Ok(())
    }

    fn scale(&self) -> Scale {
        self.row.scale(arm(&self.ends), self.bodies)
    }
}
