//! Limits and friction of a joint, as rows of inequalities: data for who solves them.
//!
//! ```text
//! low <= x <= high,     x - low >= 0,  high - x >= 0       x a turn (rad) or a shift (m) along an axis
//! |f| <= bound                                             f against x., N m or N
//! ```
//! A limit's row pushes only, a friction's either way up to its bound. Equalities alone are solved by
//! RATTLE, which takes no inequality: neither is a [`Constraint`].
//! ```compile_fail
//! use stationary_constraints::Constraint;
//! use stationary_rigid::{JointLimits, Poses};
//! fn kept_by_rattle<K: Constraint>(_: K) {}
//! fn limits(limits: JointLimits<Poses>) {
//!     kept_by_rattle(limits);
//! }
//! ```
//! Turns are known up to whole ones, so that their limits lie within half a turn of zero.
//! Source: notes 10; Haug (1989), 9.

use std::f64::consts::PI;
use std::marker::PhantomData;

use nalgebra::Vector3;
#[cfg(doc)]
use stationary_constraints::Constraint;

use super::kind::unit;
use super::row::{Along, Row};
use super::{JointEnd, JointFault, JointName, Placed};
use crate::error::check_not_negative;
use crate::{BodySpace, RigidError, Wrench};

/// A row of an inequality between two bodies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BoundRow {
    /// The bodies; `None` is the world.
    pub bodies: [Option<usize>; 2],
    /// What a unit of the row's force does to them; their motions along it make its rate.
    pub wrenches: [Wrench; 2],
    /// How far the limit is, rad or m, negative beyond it; of friction zero.
    pub gap: f64,
    /// The largest force that the row exerts, infinite of a limit.
    pub bound: f64,
}

/// A coordinate of a joint between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Coordinate<S> {
    ends: [JointEnd; 2],
    row: Row,
    space: PhantomData<S>,
}

impl<S: BodySpace> Coordinate<S> {
    fn new(
        bodies: usize,
        kind: &'static str,
        (along, axis): (Along, Vector3<f64>),
        ends: [JointEnd; 2],
    ) -> Result<(Self, JointName), RigidError> {
        let joint = JointName { kind, bodies: ends.map(|end| end.body) };
        let fault = |fault| RigidError::Joint { joint, fault };
        JointEnd::check_pair(&ends, bodies).map_err(fault)?;
        let row = Row::coordinate(&unit(axis).map_err(fault)?, along, &ends);
        Ok((Coordinate { ends, row, space: PhantomData }, joint))
    }

    /// Its value, and what a unit of its force does; no numbers of bodies that `q` does not hold.
    fn at(&self, q: &[f64]) -> (f64, [Wrench; 2]) {
        let placed: [Placed; 2] = self.ends.each_ref().map(|end| end.placed_or_none::<S>(q));
        (self.row.value(&placed), self.row.differential(&placed))
    }

    fn bodies(&self) -> [Option<usize>; 2] {
        self.ends.map(|end| end.body)
    }
}

/// How far a joint turns or shifts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits<S> {
    coordinate: Coordinate<S>,
    limits: [f64; 2],
}

impl<S: BodySpace> JointLimits<S> {
    /// The lower and the upper limit of a turn or a shift along an axis, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with it: limits that are not numbers, or
    /// in the wrong order; of a turn limits beyond half a turn.
    pub fn new(
        _space: S,
        bodies: usize,
        (along, axis): (Along, Vector3<f64>),
        ends: [JointEnd; 2],
        limits: [f64; 2],
    ) -> Result<Self, RigidError> {
        let (coordinate, joint) = Coordinate::new(bodies, "limits", (along, axis), ends)?;
        let [low, high] = limits;
        let beyond = along == Along::Turn && (low < -PI || high > PI);
        // Infinite limits of a shift are none.
        if low.is_nan() || high.is_nan() || low >= high || beyond {
            return Err(RigidError::Joint { joint, fault: JointFault::Limits { low, high } });
        }
        Ok(JointLimits { coordinate, limits })
    }

    /// The turn (rad) or the shift (m).
    pub fn coordinate(&self, q: &[f64]) -> f64 {
        self.coordinate.at(q).0
    }

    /// The rows of the lower and of the upper limit.
    pub fn rows(&self, q: &[f64]) -> [BoundRow; 2] {
        let (value, wrenches) = self.coordinate.at(q);
        let back = wrenches.map(|w| Wrench { force: -w.force, torque: -w.torque });
        let row = |wrenches, gap| BoundRow {
            bodies: self.coordinate.bodies(),
            wrenches,
            gap,
            bound: f64::INFINITY,
        };
        [row(wrenches, value - self.limits[0]), row(back, self.limits[1] - value)]
    }
}

/// Dry friction of a joint's turn or shift.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointFriction<S> {
    coordinate: Coordinate<S>,
    bound: f64,
}

impl<S: BodySpace> JointFriction<S> {
    /// Friction of at most `bound` (N m, or N) along an axis, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with its ends or axis; a bound that is
    /// negative or not finite.
    pub fn new(
        _space: S,
        bodies: usize,
        along: (Along, Vector3<f64>),
        ends: [JointEnd; 2],
        bound: f64,
    ) -> Result<Self, RigidError> {
        check_not_negative("the friction's bound", bound)?;
        let (coordinate, _) = Coordinate::new(bodies, "friction", along, ends)?;
        Ok(JointFriction { coordinate, bound })
    }

    /// Its row.
    pub fn row(&self, q: &[f64]) -> BoundRow {
        let (_, wrenches) = self.coordinate.at(q);
        BoundRow { bodies: self.coordinate.bodies(), wrenches, gap: 0.0, bound: self.bound }
    }
}
