//! Prescribed turn in the plane: the angle between two ends follows a function of time.
//!
//! ```text
//! g = theta_2 - theta_1 - (theta_2 - theta_1 at the start) - angle(t),     dg/dt = -d/dt of the schedule
//! ```
//! `theta` the angles of the ends' axes (rad), where a joint's axes are the world's at the start. The torque
//! that the drive exerts on the second end is minus its multiplier (N m). Linear: it has no Hessian. The
//! pin beside it holds the place. In space it is [`Drive`](crate::Drive). Source: notes 6.5, 10.1.

use stationary_calculus::{Flat, Sink, SizeError};
use stationary_constraints::{
    Constraint, ConstraintOn, Rows, check_multipliers, check_read, check_values,
};

use super::PlanarEnd;
use crate::{Along, JointFault, JointName, RigidError, Schedule};

/// A turn of the second end against the first that follows a schedule.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarDrive<T> {
    bodies: usize,
    ends: [PlanarEnd; 2],
    schedule: T,
}

impl<T: Schedule> PlanarDrive<T> {
    /// A drive between two ends, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the drive and what is wrong with it.
    pub fn new(bodies: usize, ends: [PlanarEnd; 2], schedule: T) -> Result<Self, RigidError> {
        let joint = JointName { kind: Along::Turn.drive(), bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        ends.iter().try_for_each(|end| end.check(bodies)).map_err(fault)?;
        if ends[0].body == ends[1].body {
            return Err(fault(JointFault::ToItself));
        }
        Ok(PlanarDrive { bodies, ends, schedule })
    }

    /// How a message names it.
    pub fn name(&self) -> JointName {
        JointName { kind: Along::Turn.drive(), bodies: self.ends.map(|end| end.body) }
    }

    /// The rate that the schedule has at a time, radians a second.
    pub fn speed(&self, t: f64) -> f64 {
        stationary_calculus::directional_derivative(
            |[t]| self.schedule.at(t),
            [t],
            stationary_calculus::Vector([1.0]),
        )
    }
}

impl<T: Schedule> ConstraintOn<Flat> for PlanarDrive<T> {}

impl<T: Schedule> Constraint for PlanarDrive<T> {
    fn dim(&self) -> usize {
        self.bodies.saturating_mul(3)
    }

    fn count(&self) -> usize {
        1
    }

    fn value(&self, t: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(1, g)?;
        check_read(self.dim(), q)?;
        let angle = |end: &PlanarEnd| end.angle + end.body.map_or(0.0, |body| q[3 * body + 2]);
        g[0] = angle(&self.ends[1]) - angle(&self.ends[0]) - self.schedule.at(t);
        Ok(())
    }

    fn differential(&self, _t: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        for (end, sign) in self.ends.iter().zip([-1.0, 1.0]) {
            if let Some(body) = end.body {
                rows.add(0, 3 * body + 2, sign);
            }
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _t: f64,
        q: &[f64],
        lambda: &[f64],
        _hessian: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(1, lambda)?;
        check_read(self.dim(), q)
    }

    fn rate(&self, t: f64, _q: &[f64], rate: &mut [f64]) -> Result<(), SizeError> {
        check_values(1, rate)?;
        rate[0] = -self.speed(t);
        Ok(())
    }

    fn describe(&self, _row: usize) -> Option<String> {
        Some(self.name().to_string())
    }
}
