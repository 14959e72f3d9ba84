//! A joint between bodies as a constraint on their poses.
//!
//! Rows are the [equations of the kind](crate::JointKind), in metres, angles as cosines; all are
//! regular where the joint is closed. A hinge's axis may also point the other way, and a weld has
//! other solutions, such as half a turn off: a motion that starts closed stays where it started.
//!
//! Multipliers are forces: those of points that stay together the force of end 2 on end 1, with its
//! sign turned, in newtons and world axes; those of angles torques. [`Rattle`] along [`FreeBodies`]
//! moves jointed bodies; straight motions, which would lose their gyroscopic torque, are not theirs.
//! Source: notes 6, 9.2.

use stationary_calculus::{Sink, SizeError};
use stationary_constraints::{
    Constraint, ConstraintOn, Rows, Scale, check_multipliers, check_read, check_values,
};

use super::end::pair_freedoms;
use super::row::Local;
use super::{JointEnd, JointKind, JointName, Placed, Row};
#[cfg(doc)]
use crate::FreeBodies;
use crate::{BodySpace, RigidError};
#[cfg(doc)]
use stationary_constraints::Rattle;

/// A joint between two bodies, or a body and the world.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint<S> {
    bodies: usize,
    kind: JointKind,
    ends: [JointEnd; 2],
    rows: Vec<Row>,
    space: S,
}

impl<S: BodySpace> Joint<S> {
    /// A joint of this kind between two ends, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with it.
    pub fn new(
        space: S,
        bodies: usize,
        kind: JointKind,
        ends: [JointEnd; 2],
    ) -> Result<Self, RigidError> {
        let joint = JointName { kind: kind.name(), bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        JointEnd::check_pair(&ends, bodies).map_err(fault)?;
        let kind = kind.checked().map_err(fault)?;
        Ok(Joint { bodies, kind, ends, rows: Row::all(&kind, &ends), space })
    }

    /// How a message names it.
    pub fn name(&self) -> JointName {
        JointName { kind: self.kind.name(), bodies: self.ends.map(|end| end.body) }
    }

    /// What it leaves free, with axes of length 1.
    pub fn kind(&self) -> &JointKind {
        &self.kind
    }

    /// Its ends.
    pub fn ends(&self) -> &[JointEnd; 2] {
        &self.ends
    }

    /// An error where a configuration has fewer bodies.
    #[inline]
    fn check_bodies(&self, q: &[f64]) -> Result<(), SizeError> {
        check_read(S::STORED.saturating_mul(self.bodies), q)
    }

    /// Both ends at a configuration that was checked.
    #[inline(always)]
    fn placed(&self, q: &[f64]) -> [Placed; 2] {
        let [one, other] = &self.ends;
        [one.placed::<S>(q), other.placed::<S>(q)]
    }
}

impl<S: BodySpace> ConstraintOn<S> for Joint<S> {}

impl<S: BodySpace> Constraint for Joint<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn count(&self) -> usize {
        self.rows.len()
    }

    #[inline]
    fn value(&self, _t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(self.count(), g)?;
        self.check_bodies(q)?;
        let ends = self.placed(q);
        g.iter_mut().zip(&self.rows).for_each(|(g, row)| *g = row.value(&ends));
        Ok(())
    }

    #[inline]
    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        self.check_bodies(q)?;
        let ends = self.placed(q);
        for (number, row) in self.rows.iter().enumerate() {
            row.bring::<S>(number, &self.ends, &ends, rows);
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(self.count(), lambda)?;
        self.check_bodies(q)?;
        let ends = self.placed(q);
        let mut local = Local::zeros();
        for (row, &lambda) in self.rows.iter().zip(lambda) {
            row.add_hessian(&ends, lambda, &mut local);
        }
        let freedoms = pair_freedoms::<S>(self.ends.map(|end| end.body));
        hessian.add_symmetric(&freedoms, local.as_slice());
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        match self.rows.get(row) {
            Some(row) => row.scale::<S>(&self.ends, self.bodies),
            None => Scale::default(),
        }
    }

    fn describe(&self, _row: usize) -> Option<String> {
        Some(self.name().to_string())
    }
}
