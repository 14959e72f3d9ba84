//! Euler angles: a way to print a rotation, and no way to simulate one.
//!
//! ```text
//! R = Rz(yaw) Ry(pitch) Rx(roll)          roll first, then pitch, then yaw, about world axes
//! ```
//! Radians; roll and yaw in (-pi, pi], pitch in [-pi/2, pi/2]. At a pitch of a quarter turn, up or
//! down, roll and yaw turn about the same axis and only their difference or sum is determined:
//! gimbal lock. Reading angles there is an error that gives what is left. Within 1e-7 of it the
//! angles are roll and yaw to seven digits fewer than the rotation has. Source: notes 9.1.

use crate::error::check_finite;
use crate::{LieGroup, RigidError, Rotation};
use nalgebra::Vector3;

/// Roll, pitch and yaw, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EulerAngles {
    /// About the first axis, done first.
    pub roll: f64,
    /// About the second axis.
    pub pitch: f64,
    /// About the third axis, done last.
    pub yaw: f64,
}

/// Cosine of the pitch below which roll and yaw are lost to rounding.
const LOCK: f64 = 1e-8;

impl EulerAngles {
    /// The rotation that the angles describe.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for an angle that is not finite.
    pub fn rotation(&self) -> Result<Rotation, RigidError> {
        check_finite("the Euler angles", &[self.roll, self.pitch, self.yaw])?;
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let (roll, pitch) = (Rotation::exp(x * self.roll), Rotation::exp(y * self.pitch));
        Ok(Rotation::exp(z * self.yaw).compose(&pitch).compose(&roll))
    }

    /// The angles of a rotation, or gimbal lock.
    ///
    /// # Errors
    /// [`RigidError::GimbalLock`] where the cosine of the pitch is below 1e-8.
    pub fn of(rotation: &Rotation) -> Result<Self, RigidError> {
        let r = rotation.matrix();
        let cosine = r[(0, 0)].hypot(r[(1, 0)]);
        let pitch = (-r[(2, 0)]).atan2(cosine);
        if cosine < LOCK {
            let turn = (-r[(0, 1)]).atan2(r[(1, 1)]);
            return Err(RigidError::GimbalLock { pitch, turn });
        }
        let yaw = r[(1, 0)].atan2(r[(0, 0)]);
        let roll = r[(2, 1)].atan2(r[(2, 2)]);
        Ok(EulerAngles { roll, pitch, yaw })
    }
}
