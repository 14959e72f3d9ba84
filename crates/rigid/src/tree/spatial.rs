//! Twists and wrenches: velocity and force of a body, each in two vectors of world axes.
//!
//! ```text
//! V = (v, w),    f = (F, N),    <f, V> = F.v + N.w                      power
//! v' = v + w x r,   w' = w           the same motion, told at a point r further on
//! F' = F,   N' = N + r x F           the same force, told at a point r further back
//! ```
//! `v` m/s at the point of reference and `w` rad/s; `F` newtons and `N` newton metres about it. The
//! two shifts are each other's transposes. Accelerations and virtual displacements are twists,
//! momenta are wrenches. Source: Featherstone 2008, 2.2 to 2.8.

use std::ops::{Add, AddAssign, Mul, Sub};

use nalgebra::Vector3;

/// A velocity: of the point of reference, and of rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Twist {
    pub linear: Vector3<f64>,
    pub angular: Vector3<f64>,
}

/// A force, and its torque about the point of reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SpatialForce {
    pub force: Vector3<f64>,
    pub torque: Vector3<f64>,
}

impl Twist {
    pub(super) fn zero() -> Self {
        Twist { linear: Vector3::zeros(), angular: Vector3::zeros() }
    }

    /// The same motion at a point `r` further on.
    #[inline]
    pub(super) fn outward(&self, r: &Vector3<f64>) -> Self {
        Twist { linear: self.linear + self.angular.cross(r), angular: self.angular }
    }
}

impl SpatialForce {
    pub(super) fn zero() -> Self {
        SpatialForce { force: Vector3::zeros(), torque: Vector3::zeros() }
    }

    /// The same force about a point `r` further back.
    #[inline]
    pub(super) fn inward(&self, r: &Vector3<f64>) -> Self {
        SpatialForce { force: self.force, torque: self.torque + r.cross(&self.force) }
    }

    /// The power of the force along a motion.
    #[inline]
    pub(super) fn along(&self, motion: &Twist) -> f64 {
        self.force.dot(&motion.linear) + self.torque.dot(&motion.angular)
    }
}

impl Add for Twist {
    type Output = Twist;

    #[inline]
    fn add(self, other: Twist) -> Twist {
        Twist { linear: self.linear + other.linear, angular: self.angular + other.angular }
    }
}

impl AddAssign for Twist {
    #[inline]
    fn add_assign(&mut self, other: Twist) {
        *self = *self + other;
    }
}

impl Mul<f64> for Twist {
    type Output = Twist;

    #[inline]
    fn mul(self, factor: f64) -> Twist {
        Twist { linear: self.linear * factor, angular: self.angular * factor }
    }
}

impl Add for SpatialForce {
    type Output = SpatialForce;

    #[inline]
    fn add(self, other: SpatialForce) -> SpatialForce {
        SpatialForce { force: self.force + other.force, torque: self.torque + other.torque }
    }
}

impl Sub for SpatialForce {
    type Output = SpatialForce;

    #[inline]
    fn sub(self, other: SpatialForce) -> SpatialForce {
        SpatialForce { force: self.force - other.force, torque: self.torque - other.torque }
    }
}

impl AddAssign for SpatialForce {
    #[inline]
    fn add_assign(&mut self, other: SpatialForce) {
        *self = *self + other;
    }
}

impl Mul<f64> for SpatialForce {
    type Output = SpatialForce;

    #[inline]
    fn mul(self, factor: f64) -> SpatialForce {
        SpatialForce { force: self.force * factor, torque: self.torque * factor }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_power_of_a_force_is_the_same_at_every_point() {
        let r = Vector3::new(0.3, -2.0, 0.7);
        let motion =
            Twist { linear: Vector3::new(1.0, 2.0, -1.0), angular: Vector3::new(0.4, -3.0, 2.0) };
        let further = SpatialForce {
            force: Vector3::new(-2.0, 0.5, 4.0),
            torque: Vector3::new(1.0, -0.3, 0.2),
        };
        let (there, here) = (further.along(&motion.outward(&r)), further.inward(&r).along(&motion));
        assert!((there - here).abs() < 1e-14 * there.abs().max(1.0), "{there} {here}");
    }
}
