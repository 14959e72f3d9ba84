//! A spring that resists a turn about the axis of a joint, or a shift along it.
//!
//! ```text
//! V = k/2 x^2,      x = angle - rest,  the short way, or shift - rest
//! dV = k x dx,      d2V = k (dx dx^T + x d2x)
//! ```
//! `k` in N m/rad, or N/m. The angle is that of the second end about an axis of the first; it is known
//! up to whole turns, so that the spring acts within half a turn of its rest and not beyond. A joint
//! beside it holds the axis. Source: notes 3.1, 10.1.2.

use nalgebra::Vector3;
use stationary_calculus::{Covector, Potential, PotentialOn, Sink};

use super::kind::unit;
use super::row::{Along, Local, Row, along};
use super::{JointEnd, JointName, Placed, pair_freedoms};
use crate::error::check_finite;
use crate::point_force::add_wrench;
use crate::{BodySpace, RigidError};

/// A spring of a joint's coordinate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorsionSpring<S> {
    bodies: usize,
    stiffness: f64,
    rest: f64,
    ends: [JointEnd; 2],
    row: Row,
    space: S,
}

impl<S: BodySpace> TorsionSpring<S> {
    /// A spring of this stiffness and rest along an axis, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the spring and what is wrong with its ends or its axis; a stiffness
    /// or a rest that is not finite.
    pub fn new(
        space: S,
        bodies: usize,
        (along, axis): (Along, Vector3<f64>),
        ends: [JointEnd; 2],
        [stiffness, rest]: [f64; 2],
    ) -> Result<Self, RigidError> {
        let joint = JointName { kind: "torsion spring", bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        JointEnd::check_pair(&ends, bodies).map_err(fault)?;
        let row = Row::coordinate(&unit(axis).map_err(fault)?, along, &ends);
        check_finite("the torsion spring's stiffness", &[stiffness])?;
        check_finite("the torsion spring's rest", &[rest])?;
        Ok(TorsionSpring { bodies, stiffness, rest, ends, row, space })
    }

    /// The ends and what the spring is stretched by; not numbers where `q` does not hold them.
    fn stretched(&self, q: &[f64]) -> ([Placed; 2], f64) {
        let ends = self.ends.each_ref().map(|end| end.placed_or_none::<S>(q));
        (ends, self.row.value_beyond(&ends, self.rest))
    }
}

impl<S: BodySpace> PotentialOn<S> for TorsionSpring<S> {}

impl<S: BodySpace> Potential for TorsionSpring<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS.saturating_mul(self.bodies)
    }

    fn energy(&self, q: &[f64]) -> f64 {
        0.5 * self.stiffness * self.stretched(q).1.powi(2)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let (ends, stretch) = self.stretched(q);
        for (end, wrench) in self.ends.iter().zip(self.row.differential(&ends)) {
            add_wrench::<S>(dv.0, end.body, &wrench, self.stiffness * stretch);
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let (ends, stretch) = self.stretched(q);
        let slope = along(&self.row.differential(&ends));
        let mut local: Local = slope * slope.transpose() * self.stiffness;
        self.row.add_hessian(&ends, self.stiffness * stretch, &mut local);
        let freedoms = pair_freedoms::<S>(self.ends.map(|end| end.body));
        hessian.add_symmetric(&freedoms, local.as_slice());
    }
}
