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
//! A motor of given speed is a [`Steady`] schedule. In space it is a [`Drive`](crate::Drive), in the plane a
//! [`PlanarDrive`](crate::PlanarDrive): one equation of two [coordinates](DrivenCoordinate). Source: notes 6.5, 10.1.

use stationary_calculus::{Number, Sink, SizeError, Vector, directional_derivative};
use stationary_constraints::{Constraint, Rows, Scale, check_multipliers, check_values};

use super::JointName;

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

/// A coordinate of a mechanism that can be made to follow a schedule.
pub trait DrivenCoordinate {
    /// How a message names its drive.
    fn name(&self) -> JointName;

    /// The freedoms of the velocities that it is one of.
    fn dim(&self) -> usize;

    /// How far it is beyond a target at a configuration: of a turn radians, of a shift metres.
    ///
    /// # Errors
    /// A configuration that does not hold its bodies.
    fn beyond(&self, q: &[f64], target: f64) -> Result<f64, SizeError>;

    /// Brings its differential, as a row 0.
    ///
    /// # Errors
    /// A configuration that does not hold its bodies.
    fn bring(&self, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError>;

    /// Adds `scale` times its second derivatives.
    ///
    /// # Errors
    /// A configuration that does not hold its bodies.
    fn add_hessian(&self, q: &[f64], scale: f64, hessian: &mut impl Sink) -> Result<(), SizeError>;

    /// How large its numbers are.
    fn scale(&self) -> Scale;
}

/// A coordinate that follows a schedule, as a constraint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrescribedCoordinate<G, T> {
    coordinate: G,
    schedule: T,
}

impl<G: DrivenCoordinate, T: Schedule> PrescribedCoordinate<G, T> {
    pub(crate) fn of(coordinate: G, schedule: T) -> Self {
        PrescribedCoordinate { coordinate, schedule }
    }

    /// How a message names it.
    pub fn name(&self) -> JointName {
        self.coordinate.name()
    }

    /// The rate that the schedule has at a time, radians or metres a second.
    pub fn speed(&self, t: f64) -> f64 {
        directional_derivative(|[t]| self.schedule.at(t), [t], Vector([1.0]))
    }
}

impl<G: DrivenCoordinate, T: Schedule> Constraint for PrescribedCoordinate<G, T> {
    fn dim(&self) -> usize {
        self.coordinate.dim()
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(1, g)?;
        g[0] = self.coordinate.beyond(q, self.schedule.at(t))?;
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        self.coordinate.bring(q, rows)
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(1, lambda)?;
        self.coordinate.add_hessian(q, lambda[0], hessian)
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
        self.coordinate.scale()
    }
}
