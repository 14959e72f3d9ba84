//! SO(3), the rotations of space, each stored as a unit quaternion.
//!
//! ```text
//! q = (w, x) = (cos(a/2), sin(a/2) n)                  turns by the angle a about the unit axis n
//! q v q^-1 = v + 2 w (x cross v) + 2 x cross (x cross v)
//! exp(theta) = (cos(|theta|/2), sin(|theta|/2)/|theta| theta)                        (9.1)
//! log(q) = 2 atan2(|x|, w)/|x| x
//! ```
//! `theta` the axis times the angle, radians, by the right-hand rule. `q` and `-q` are the same rotation. A product
//! of n rotations is off length 1 by n roundings: [`Rotation::normalized`] divides by it. The algebra is R^3 with the
//! cross product; hat is the cross-product matrix.
//!
//! Both maps are accurate to a few roundings of each component, exp from angles of 1e-300 to 1e15,
//! beside whole and half turns as well, where less than 1e-31 of the angle is not told from nothing. The
//! logarithm is the shortest: its length is at most pi, so `log(exp(theta))` differs from `theta`
//! by whole turns about its axis once `|theta| > pi`. At exactly half a turn (`w` zero, of either
//! sign) both axes are equally far, and the one whose first component that is not zero is positive
//! is taken. Near it the sign of `w` decides, and the logarithm jumps by a whole turn.
//!
//! Source: notes 9.1, errata 8.2.3 and 9.1; Grassia 1998 on the small angles.

use nalgebra::{Matrix3, Vector3};

use crate::error::check_finite;
use crate::stumpff::{SMALL_BELOW, small};
use crate::twofold::HalfAngle;
use crate::{LieGroup, RigidError};

/// A rotation of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rotation {
    w: f64,
    x: Vector3<f64>,
}

/// How far a quaternion's length may be from 1: what a file with ten digits has.
const UNIT: f64 = 1e-9;

impl Rotation {
    /// The rotation of a quaternion (scalar first) of length 1, up to what printed digits lose.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`]; [`RigidError::NotUnit`] for a length that is off 1 by more than
    /// 1e-9.
    pub fn from_quaternion(q: [f64; 4]) -> Result<Self, RigidError> {
        check_finite("the quaternion", &q)?;
        let length = q.iter().map(|c| c * c).sum::<f64>().sqrt();
        if (length - 1.0).abs() <= UNIT {
            return Ok(Rotation::unchecked(q).normalized());
        }
        Err(RigidError::NotUnit { length })
    }

    /// The turn by `angle` radians about `axis`, whose length does not matter.
    ///
    /// # Errors
    /// [`RigidError::NonFinite`] for an axis or an angle that is not finite; [`RigidError::NoAxis`]
    /// for an axis that is zero.
    pub fn about(axis: Vector3<f64>, angle: f64) -> Result<Self, RigidError> {
        check_finite("the axis", axis.as_slice())?;
        check_finite("the angle", &[angle])?;
        let largest = axis.amax();
        if largest == 0.0 {
            return Err(RigidError::NoAxis(axis.into()));
        }
        let axis = (axis / largest).normalize();
        let (sine, cosine) = (0.5 * angle).sin_cos();
        Ok(Rotation { w: cosine, x: axis * sine })
    }

    /// The quaternion, scalar first, of length 1 to rounding.
    #[inline]
    pub fn quaternion(&self) -> [f64; 4] {
        [self.w, self.x.x, self.x.y, self.x.z]
    }

    /// The axis and the angle in [0, pi]; the identity has the third axis.
    pub fn axis_angle(&self) -> (Vector3<f64>, f64) {
        let v = self.log();
        let angle = length(&v);
        if angle == 0.0 { (Vector3::z(), 0.0) } else { (v / angle, angle) }
    }

    /// A vector of the body as seen from the world.
    #[inline]
    pub fn rotate(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let t = 2.0 * self.x.cross(v);
        v + self.w * t + self.x.cross(&t)
    }

    /// A vector of the world as seen from the body.
    #[inline]
    pub fn rotate_back(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.inverse().rotate(v)
    }

    /// The quaternion divided by its length.
    #[inline]
    pub fn normalized(&self) -> Self {
        let scale = 1.0 / (self.w * self.w + self.x.norm_squared()).sqrt();
        Rotation { w: self.w * scale, x: self.x * scale }
    }

    /// The rotation of a quaternion that is known to have length 1.
    #[inline]
    pub(crate) fn unchecked([w, x, y, z]: [f64; 4]) -> Self {
        Rotation { w, x: Vector3::new(x, y, z) }
    }
}

impl LieGroup for Rotation {
    type Algebra = Vector3<f64>;
    type Matrix = Matrix3<f64>;

    #[inline]
    fn identity() -> Self {
        Rotation { w: 1.0, x: Vector3::zeros() }
    }

    #[inline]
    fn inverse(&self) -> Self {
        Rotation { w: self.w, x: -self.x }
    }

    #[inline]
    fn compose(&self, first: &Self) -> Self {
        let (a, b) = (self, first);
        Rotation { w: a.w * b.w - a.x.dot(&b.x), x: b.x * a.w + a.x * b.w + a.x.cross(&b.x) }
    }

    #[inline]
    fn exp(theta: Vector3<f64>) -> Self {
        let s = theta.norm_squared();
        if s < 4.0 * SMALL_BELOW {
            let [cosine, ratio] = small(0.25 * s);
            return Rotation { w: cosine, x: theta * (0.5 * ratio) };
        }
        if s < NEAR {
            let angle = s.sqrt();
            let (sine, cosine) = (0.5 * angle).sin_cos();
            return Rotation { w: cosine, x: theta * (sine / angle) };
        }
        let HalfAngle { angle, sine, cosine } = HalfAngle::of(&theta);
        Rotation { w: cosine, x: theta * (sine / angle) }
    }

    #[inline]
    fn log(&self) -> Vector3<f64> {
        let s = self.x.norm_squared();
        let inverse = 1.0 / self.w;
        let tangent = s * inverse * inverse;
        if tangent < SHORT {
            return self.x * (2.0 * inverse * arctangent(tangent));
        }
        let sine = s.sqrt();
        let angle = 2.0 * sine.atan2(self.w.abs());
        self.x * (self.side() * angle / sine)
    }

    #[inline]
    fn adjoint(&self, v: Vector3<f64>) -> Vector3<f64> {
        self.rotate(&v)
    }

    #[inline]
    fn bracket(v: Vector3<f64>, w: Vector3<f64>) -> Vector3<f64> {
        v.cross(&w)
    }

    #[inline]
    fn matrix(&self) -> Matrix3<f64> {
        self.rotation_matrix()
    }

    fn hat(v: Vector3<f64>) -> Matrix3<f64> {
        v.cross_matrix()
    }
}

impl Rotation {
    /// 1 where the logarithm points along `x`, -1 where it points against it.
    #[inline]
    fn side(&self) -> f64 {
        if self.w == 0.0 {
            let first = self.x.iter().copied().find(|&c| c != 0.0);
            return first.unwrap_or(1.0).signum();
        }
        self.w.signum()
    }
}

/// A squared angle below which neither sine nor cosine of half of it is nearly zero.
const NEAR: f64 = 4.0;

/// The square of half a turn's tangent below which a few terms of the arctangent's series are exact to rounding, with
/// neither root nor library: the turns of a step.
const SHORT: f64 = 1e-3;

/// `atan(x) / x` at `x^2 < SHORT`.
#[inline]
fn arctangent(s: f64) -> f64 {
    1.0 - s * (1.0 / 3.0 - s * (1.0 / 5.0 - s * (1.0 / 7.0 - s * (1.0 / 9.0 - s * (1.0 / 11.0)))))
}

/// The length of a vector, whatever its size.
pub(crate) fn length(v: &Vector3<f64>) -> f64 {
    let largest = v.amax();
    if largest == 0.0 || !largest.is_finite() { largest } else { (v / largest).norm() * largest }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_logarithm_of_a_short_turn_is_that_of_the_library_on_both_sides_of_the_switch() {
        for x in [1e-200, 1e-9, 1e-3, 0.03, SHORT.sqrt().next_down()] {
            assert!((arctangent(x * x) * x / x.atan() - 1.0).abs() < 4e-16, "{x}");
        }
        for angle in [1.999, 1.9999, 2.0001, 2.001].map(|half| half * SHORT.sqrt().atan()) {
            for turned in [1.0, -1.0] {
                let q = Rotation::exp(Vector3::new(0.6, 0.0, 0.8) * angle).quaternion();
                let back = Rotation::unchecked(q.map(|c| c * turned)).log();
                assert!((back.norm() / angle - 1.0).abs() < 5e-16, "{angle}");
            }
        }
    }
}
