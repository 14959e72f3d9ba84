//! Prescribed motion: a coordinate of a joint that follows a function of time, whatever it takes.
//!
//! ```text
//! g = s - s(t)  or  angle - angle(t),      dg/dt = -d/dt of the schedule
//! F = -lambda,    W = sum of <impulse, d/dt of the schedule>
//! ```
//! `s` the shift (m) and `angle` the turn (rad) of the second end along an axis of the first. The
//! force or torque that the drive exerts on the second end along the axis is minus its multiplier, and
//! its work is that of the [report](stationary_constraints::ConstrainedReport) of a step. A drive holds
//! one coordinate; the joint beside it holds the others, and the start must move as the schedule does.
//! A motor of given speed is a [`Steady`] schedule. Source: notes 6.5, 10.1.

use nalgebra::Vector3;
use stationary_calculus::{Number, Sink, SizeError, Vector, directional_derivative};
use stationary_constraints::{
    Constraint, ConstraintOn, Rows, Scale, check_multipliers, check_read, check_values,
};

use super::kind::unit;
use super::row::{Along, Local, Row};
use super::{JointEnd, JointName, Placed, pair_freedoms};
use crate::{BodySpace, RigidError};

/// A function of time, written once over any [`Number`] so that its rate is exact.
pub trait Schedule {
    /// The coordinate at a time (s): radians of a turn, metres of a shift.
    fn at<R: Number>(&self, t: R) -> R;
}

/// A constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady {
    /// The coordinate at time zero.
    pub start: f64,
    /// Radians or metres a second.
    pub speed: f64,
}

impl Schedule for Steady {
    fn at<R: Number>(&self, t: R) -> R {
        t * self.speed + self.start
    }
}

/// A turn about an axis, or a shift along it, that follows a schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<S, T> {
    bodies: usize,
    along: Along,
    ends: [JointEnd; 2],
    row: Row,
    schedule: T,
    space: S,
}

impl<S: BodySpace, T: Schedule> Drive<S, T> {
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
        Ok(Drive { bodies, along, ends, row, schedule, space })
    }

    /// How a message names it.
    pub fn name(&self) -> JointName {
        JointName { kind: self.along.drive(), bodies: self.ends.map(|end| end.body) }
    }

    /// The rate that the schedule has at a time, radians or metres a second.
    pub fn speed(&self, t: f64) -> f64 {
        directional_derivative(|[t]| self.schedule.at(t), [t], Vector([1.0]))
    }

    fn placed(&self, q: &[f64]) -> Result<[Placed; 2], SizeError> {
        check_read(S::STORED.saturating_mul(self.bodies), q)?;
        Ok(self.ends.each_ref().map(|end| end.placed::<S>(q)))
    }
}

impl<S: BodySpace, T: Schedule> ConstraintOn<S> for Drive<S, T> {}

impl<S: BodySpace, T: Schedule> Constraint for Drive<S, T> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(1, g)?;
        g[0] = self.row.value_beyond(&self.placed(q)?, self.schedule.at(t));
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        self.row.bring::<S>(0, &self.ends, &self.placed(q)?, rows);
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(1, lambda)?;
        let mut local = Local::zeros();
        self.row.add_hessian(&self.placed(q)?, lambda[0], &mut local);
        let freedoms = pair_freedoms::<S>(self.ends.map(|end| end.body));
        hessian.add_symmetric(&freedoms, local.as_slice());
        Ok(())
    }

    fn rate(&self, t: f64, _q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        check_values(1, rate)?;
        rate[0] = -self.speed(t);
        Ok(())
    }

    fn describe(&self, _row: usize) -> Option<String> {
        Some(self.name().to_string())
    }

    fn scale(&self, _row: usize) -> Scale {
        match self.along {
            Along::Turn => Scale::default(),
            Along::Shift => {
                self.row.scale(self.ends.iter().map(JointEnd::reach).fold(0.0, f64::max))
            }
        }
    }
}
