//! How a rigid body moves between two moments: along a straight line while it turns, or on a screw.
//!
//! ```text
//! straight   t(s) = t0 + s v,   R(s) = R0 exp(s w)       v in world axes: a free body's step
//! screw      g(s) = g0 exp(s (v, w))                     v in body axes: a straight path of SE(3)
//! n.x(s + d) = n.x(s) + d n.x'(s) + r,   |r| <= d^2/2 (|w|^2 rho + |w x v|)        0 <= s <= 1
//! ```
//! `x` a point of the body at most `rho` from its origin (m), `n` a unit vector; `w` a turn in body
//! axes (radians), `v` a way (m); `w x v` belongs to the screw only. The remainder is what proofs
//! about whole intervals rest on. Source: notes 8.2, 9.4.

use nalgebra::{Vector3, Vector6};
use stationary_rigid::{LieGroup, RigidMotion, Rotation};

use crate::error::check_finite;
use crate::{ContactError, Moving};

/// A rigid motion over one unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPath {
    start: RigidMotion,
    velocity: Vector3<f64>,
    turn: Vector3<f64>,
    line: Line,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Line {
    Straight,
    Screw,
}

impl RigidPath {
    /// The origin moves straight by `way` (m, world axes) while the body turns by `turn` (radians,
    /// body axes).
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a start, a way or a turn that is not finite.
    pub fn straight(
        start: RigidMotion,
        way: Vector3<f64>,
        turn: Vector3<f64>,
    ) -> Result<Self, ContactError> {
        RigidPath { start, velocity: way, turn, line: Line::Straight }.checked()
    }

    /// The path `g0 exp(s (v, w))` of a twist: its way (m) and its turn (radians), body axes.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a start, a way or a turn that is not finite.
    pub fn screw(start: RigidMotion, twist: Vector6<f64>) -> Result<Self, ContactError> {
        let [velocity, turn] = [0, 3].map(|k| twist.fixed_rows::<3>(k).into_owned());
        RigidPath { start, velocity, turn, line: Line::Screw }.checked()
    }

    /// A body that stays.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a pose that is not finite.
    pub fn still(pose: RigidMotion) -> Result<Self, ContactError> {
        RigidPath::straight(pose, Vector3::zeros(), Vector3::zeros())
    }

    fn checked(self) -> Result<Self, ContactError> {
        check_finite("the pose of a path", self.start.translation.as_slice())?;
        check_finite("the pose of a path", &self.start.rotation.quaternion())?;
        check_finite("the way of a path", self.velocity.as_slice())?;
        check_finite("the turn of a path", self.turn.as_slice())?;
        Ok(self)
    }

    /// Where the body is at a fraction of the time.
    pub fn at(&self, s: f64) -> RigidMotion {
        match self.line {
            Line::Straight => RigidMotion {
                translation: self.start.translation + self.velocity * s,
                rotation: self.start.rotation.compose(&Rotation::exp(self.turn * s)),
            },
            Line::Screw => {
                let (v, w) = (self.velocity * s, self.turn * s);
                self.start.walk(Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z))
            }
        }
    }

    /// The body's turn, radians, body axes.
    pub(crate) fn turn(&self) -> &Vector3<f64> {
        &self.turn
    }

    /// How fast the origin moves along a direction of the world, at a pose of the path.
    pub(crate) fn origin_along(&self, pose: &RigidMotion, direction: &Vector3<f64>) -> f64 {
        match self.line {
            Line::Straight => self.velocity.dot(direction),
            Line::Screw => self.velocity.dot(&pose.rotation.rotate_back(direction)),
        }
    }

    /// A bound on the acceleration of points at most `radius` from the origin.
    pub(crate) fn acceleration(&self, radius: f64) -> f64 {
        self.turn.norm_squared() * radius + self.bend()
    }

    /// A bound on the acceleration of the origin.
    fn bend(&self) -> f64 {
        match self.line {
            Line::Straight => 0.0,
            Line::Screw => self.turn.cross(&self.velocity).norm(),
        }
    }

    /// The chord of the origin, and how far the origin may stray from it.
    pub(crate) fn chord(&self) -> (Moving, f64) {
        let ends = Moving { start: self.at(0.0).translation, end: self.at(1.0).translation };
        (ends, self.bend() / 8.0)
    }

    /// The largest coordinate on the way, for what rounding can do.
    pub(crate) fn largest(&self) -> f64 {
        self.start.translation.amax() + self.velocity.norm()
    }
}
