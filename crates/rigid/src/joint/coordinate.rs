//! The turn of the second end of a joint about an axis of the first, or its shift along it.

use nalgebra::Vector3;
use stationary_calculus::{Sink, SizeError};
use stationary_constraints::{ConstraintOn, Rows, Scale, check_read};

use super::drive::{DrivenCoordinate, PrescribedCoordinate, Schedule};
use super::kind::unit;
use super::row::{Along, Local, Row};
use super::{JointEnd, JointName, Placed, pair_freedoms};
use crate::{BodySpace, RigidError};

/// A turn about an axis, or a shift along it, between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointCoordinate<S> {
    bodies: usize,
    along: Along,
    ends: [JointEnd; 2],
    row: Row,
    space: S,
}

/// A turn about an axis, or a shift along it, that follows a schedule.
pub type Drive<S, T> = PrescribedCoordinate<JointCoordinate<S>, T>;

impl<S: BodySpace, T: Schedule> PrescribedCoordinate<JointCoordinate<S>, T> {
    /// A drive between two ends, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the drive and what is wrong with it.
    pub fn new(
        space: S,
        bodies: usize,
        along: Along,
        axis: Vector3<f64>,
        ends: [JointEnd; 2],
        schedule: T,
    ) -> Result<Self, RigidError> {
        let joint = JointName { kind: along.drive(), bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        JointEnd::check_pair(&ends, bodies).map_err(fault)?;
        let row = Row::coordinate(&unit(axis).map_err(fault)?, along, &ends);
        Ok(Self::of(JointCoordinate { bodies, along, ends, row, space }, schedule))
    }
}

impl<S: BodySpace> JointCoordinate<S> {
    fn placed(&self, q: &[f64]) -> Result<[Placed; 2], SizeError> {
        check_read(S::STORED.saturating_mul(self.bodies), q)?;
        Ok(self.ends.each_ref().map(|end| end.placed::<S>(q)))
    }
}

impl<S: BodySpace, T: Schedule> ConstraintOn<S> for PrescribedCoordinate<JointCoordinate<S>, T> {}

impl<S: BodySpace> DrivenCoordinate for JointCoordinate<S> {
    fn name(&self) -> JointName {
        JointName { kind: self.along.drive(), bodies: self.ends.map(|end| end.body) }
    }

    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn beyond(&self, q: &[f64], target: f64) -> Result<f64, SizeError> {
        Ok(self.row.value_beyond(&self.placed(q)?, target))
    }

    fn bring(&self, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        self.row.bring::<S>(0, &self.ends, &self.placed(q)?, rows);
        Ok(())
    }

    fn add_hessian(&self, q: &[f64], scale: f64, hessian: &mut impl Sink) -> Result<(), SizeError> {
        let mut local = Local::zeros();
        self.row.add_hessian(&self.placed(q)?, scale, &mut local);
        let freedoms = pair_freedoms::<S>(self.ends.map(|end| end.body));
        hessian.add_symmetric(&freedoms, local.as_slice());
        Ok(())
    }

    fn scale(&self) -> Scale {
        self.row.scale::<S>(&self.ends, self.bodies)
    }
}
