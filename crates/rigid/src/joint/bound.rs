//! Limits and friction of a joint, as rows of inequalities for who solves them.
//!
//! ```text
//! low <= x <= high      J v >= -(x - low)/h,   -J v >= -(high - x)/h       impulses >= 0
//! |f| <= bound          J v = 0                                            |impulse| <= bound h
//! ```
//! `x` a turn (rad) or a shift (m) along an axis and `J` its differential, `f` against its rate (N m or
//! N), `h` a step. A limit pushes only, friction either way up to its bound. Whatever is a constraint of
//! one row may be such a coordinate: a [`Drive`] or a [`PlanarDrive`] that stands at zero. Equalities
//! alone are solved by RATTLE, which takes no inequality: neither is a [`Constraint`].
//! ```compile_fail
//! use stationary_constraints::Constraint;
//! use stationary_rigid::{Drive, JointLimits, Poses, Steady};
//! fn kept_by_rattle<K: Constraint>(_: K) {}
//! fn limits(limits: JointLimits<Drive<Poses, Steady>>) {
//!     kept_by_rattle(limits);
//! }
//! ```
//! Turns of space are known up to whole ones, so that their limits lie within half a turn of zero.
//! Source: notes 10; Haug (1989), 9; Anitescu and Potra 1997 (limits by velocities).

use std::f64::consts::PI;

use nalgebra::{Vector2, Vector3};
use stationary_calculus::SizeError;
use stationary_constraints::{Constraint, ConstraintError, RowLaw, Rows, VelocityRows};

use super::row::Along;
use super::{Drive, JointEnd, JointFault, JointName, Steady};
use crate::error::check_not_negative;
use crate::{BodySpace, PlanarDrive, PlanarEnd, RigidError};

/// A coordinate that stands at zero.
const STANDS: Steady = Steady { start: 0.0, speed: 0.0 };

/// How far a joint turns or shifts.
#[derive(Clone, Debug, PartialEq)]
pub struct JointLimits<C> {
    coordinate: C,
    limits: [f64; 2],
}

impl<S: BodySpace> JointLimits<Drive<S, Steady>> {
    /// The lower and the upper limit of a turn or a shift along an axis, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with it: limits that are not numbers, or
    /// in the wrong order; of a turn limits beyond half a turn.
    pub fn new(
        space: S,
        bodies: usize,
        (along, axis): (Along, Vector3<f64>),
        ends: [JointEnd; 2],
        limits: [f64; 2],
    ) -> Result<Self, RigidError> {
        let coordinate = Drive::new(space, bodies, along, axis, ends, STANDS);
        let most = if along == Along::Turn { PI } else { f64::INFINITY };
        JointLimits::of(coordinate, ends.map(|end| end.body), limits, most)
    }
}

impl JointLimits<PlanarDrive<Steady>> {
    /// The lower and the upper limit of a turn in the plane, among `bodies` bodies; any number of turns.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with it: limits that are not numbers, or
    /// in the wrong order.
    pub fn in_plane(
        bodies: usize,
        ends: [PlanarEnd; 2],
        limits: [f64; 2],
    ) -> Result<Self, RigidError> {
        let coordinate = PlanarDrive::new(bodies, ends, STANDS);
        JointLimits::of(coordinate, ends.map(|end| end.body), limits, f64::INFINITY)
    }

    /// Those of a shift along an axis, told in the joint's frames.
    ///
    /// # Errors
    /// Those of [`JointLimits::in_plane`], and an axis without a direction.
    pub fn in_plane_along(
        bodies: usize,
        axis: Vector2<f64>,
        ends: [PlanarEnd; 2],
        limits: [f64; 2],
    ) -> Result<Self, RigidError> {
        let coordinate = PlanarDrive::along(bodies, axis, ends, STANDS);
        JointLimits::of(coordinate, ends.map(|end| end.body), limits, f64::INFINITY)
    }
}

impl<C> JointLimits<C> {
    fn of(
        coordinate: Result<C, RigidError>,
        bodies: [Option<usize>; 2],
        limits: [f64; 2],
        most: f64,
    ) -> Result<Self, RigidError> {
        let joint = JointName { kind: "limits", bodies };
        let coordinate = coordinate.map_err(|error| named(error, joint))?;
        let [low, high] = limits;
        // Infinite limits are none.
        if low.is_nan() || high.is_nan() || low >= high || low < -most || high > most {
            return Err(RigidError::Joint { joint, fault: JointFault::Limits { low, high } });
        }
        Ok(JointLimits { coordinate, limits })
    }
}

impl<C: Constraint> JointLimits<C> {
    /// The turn (rad) or the shift (m).
    ///
    /// # Errors
    /// A configuration with fewer numbers than the coordinate reads.
    pub fn coordinate(&self, q: &[f64]) -> Result<f64, SizeError> {
        value(&self.coordinate, q)
    }

    /// Appends the rows of the lower and of the upper limit over a step of `h` seconds; at `h = 1` what
    /// moves bodies back to them.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the coordinate reads, and one that is not finite.
    pub fn push_rows(
        &self,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        let x = self.coordinate(q)?;
        for (limit, sign) in self.limits.into_iter().zip([1.0, -1.0]) {
            if limit.is_finite() {
                let entries = entries(&self.coordinate, q, sign)?;
                rows.push(RowLaw::Limit, &[(&entries, -sign * (x - limit) / h)])?;
            }
        }
        Ok(())
    }
}

/// Dry friction of a joint's turn or shift.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFriction<C> {
    coordinate: C,
    bound: f64,
}

impl<S: BodySpace> JointFriction<Drive<S, Steady>> {
    /// Friction of at most `bound` (N m, or N) along an axis, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with its ends or axis; a bound that is
    /// negative or not finite.
    pub fn new(
        space: S,
        bodies: usize,
        (along, axis): (Along, Vector3<f64>),
        ends: [JointEnd; 2],
        bound: f64,
    ) -> Result<Self, RigidError> {
        let coordinate = Drive::new(space, bodies, along, axis, ends, STANDS);
        JointFriction::of(coordinate, ends.map(|end| end.body), bound)
    }
}

impl JointFriction<PlanarDrive<Steady>> {
    /// Friction of at most `bound` (N m) of a turn in the plane, among `bodies` bodies.
    ///
    /// # Errors
    /// [`RigidError::Joint`] names the joint and what is wrong with its ends; a bound that is negative or
    /// not finite.
    pub fn in_plane(bodies: usize, ends: [PlanarEnd; 2], bound: f64) -> Result<Self, RigidError> {
        let coordinate = PlanarDrive::new(bodies, ends, STANDS);
        JointFriction::of(coordinate, ends.map(|end| end.body), bound)
    }

    /// Friction of at most `bound` (N) of a shift along an axis, told in the joint's frames.
    ///
    /// # Errors
    /// Those of [`JointFriction::in_plane`], and an axis without a direction.
    pub fn in_plane_along(
        bodies: usize,
        axis: Vector2<f64>,
        ends: [PlanarEnd; 2],
        bound: f64,
    ) -> Result<Self, RigidError> {
        let coordinate = PlanarDrive::along(bodies, axis, ends, STANDS);
        JointFriction::of(coordinate, ends.map(|end| end.body), bound)
    }
}

impl<C> JointFriction<C> {
    fn of(
        coordinate: Result<C, RigidError>,
        bodies: [Option<usize>; 2],
        bound: f64,
    ) -> Result<Self, RigidError> {
        check_not_negative("the friction's bound", bound)?;
        let joint = JointName { kind: "friction", bodies };
        let coordinate = coordinate.map_err(|error| named(error, joint))?;
        Ok(JointFriction { coordinate, bound })
    }
}

impl<C: Constraint> JointFriction<C> {
    /// Appends its row over a step of `h` seconds.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the coordinate reads, and one that is not finite.
    pub fn push_rows(
        &self,
        q: &[f64],
        h: f64,
        rows: &mut VelocityRows,
    ) -> Result<(), ConstraintError> {
        let entries = entries(&self.coordinate, q, 1.0)?;
        rows.push(RowLaw::Bounded(self.bound * h), &[(&entries, 0.0)])
    }
}

/// The same fault under the name of what the coordinate is for.
fn named(error: RigidError, joint: JointName) -> RigidError {
    match error {
        RigidError::Joint { fault, .. } => RigidError::Joint { joint, fault },
        other => other,
    }
}

fn value(coordinate: &impl Constraint, q: &[f64]) -> Result<f64, SizeError> {
    let mut x = [0.0];
    coordinate.value(0.0, q, &mut x)?;
    Ok(x[0])
}

/// The differential of a coordinate, with this sign.
fn entries(
    coordinate: &impl Constraint,
    q: &[f64],
    sign: f64,
) -> Result<Vec<(usize, f64)>, SizeError> {
    let mut entries = Entries { sign, list: Vec::new() };
    coordinate.differential(0.0, q, &mut entries)?;
    Ok(entries.list)
}

struct Entries {
    sign: f64,
    list: Vec<(usize, f64)>,
}

impl Rows for Entries {
    fn add(&mut self, _row: usize, freedom: usize, value: f64) {
        self.list.push((freedom, self.sign * value));
    }
}
