//! The inertia of a body, of a branch as one body, and of a branch whose joints give way.
//!
//! ```text
//! I = [ A    B ]      F = A v + B w                                about a point of reference
//!     [ B^T  C ]      N = B^T v + C w
//! A = m,  B = 0,  C = R diag(I1, I2, I3) R^T                        a body about its centre
//! B' = B - A [r],   C' = C - B^T [r] + [r] B'                       about a point r further back
//! I - U U^T / D,    U = I s,   D = s^T I s                          one freedom s gives way
//! ```
//! `A` kg, `B` kg m, `C` kg m^2, in world axes; `[r]` the cross-product matrix. What is left of an
//! inertia when a freedom gives way resists no motion along it. Source: Featherstone 2008, 2.13
//! and 7.1.

use nalgebra::{Matrix3, Vector3};

use super::spatial::{SpatialForce, Twist};

/// A symmetric inertia in three blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia {
    linear: Matrix3<f64>,
    mixed: Matrix3<f64>,
    angular: Matrix3<f64>,
}

/// `[r] M`: the cross product with every column.
#[inline]
pub(super) fn cross_columns(r: &Vector3<f64>, m: &Matrix3<f64>) -> Matrix3<f64> {
    let cross = |k: usize| r.cross(&m.column(k));
    Matrix3::from_columns(&[cross(0), cross(1), cross(2)])
}

impl Inertia {
    /// That of a body about its centre.
    #[inline]
    pub(super) fn of_body(mass: f64, angular: Matrix3<f64>) -> Self {
        Inertia { linear: Matrix3::from_diagonal_element(mass), mixed: Matrix3::zeros(), angular }
    }

    #[inline]
    pub(super) fn times(&self, motion: &Twist) -> SpatialForce {
        let Twist { linear: v, angular: w } = motion;
        SpatialForce {
            force: self.linear * v + self.mixed * w,
            torque: self.mixed.tr_mul(v) + self.angular * w,
        }
    }

    /// What is left when a freedom gives way, of which `u` is the inertia times its twist and
    /// `inverse` one over the inertia that it meets.
    #[inline]
    pub(super) fn give_way(&mut self, u: &SpatialForce, inverse: f64) {
        let (force, torque) = (u.force * inverse, u.torque * inverse);
        self.linear -= force * u.force.transpose();
        self.mixed -= force * u.torque.transpose();
        self.angular -= torque * u.torque.transpose();
    }

    /// The same inertia about a point `r` further back.
    #[inline]
    pub(super) fn inward(&self, r: &Vector3<f64>) -> Self {
        // A is symmetric: A [r] = -([r] A)^T.
        let mixed = self.mixed + cross_columns(r, &self.linear).transpose();
        let turned = cross_columns(r, &self.mixed).transpose();
        let angular = self.angular + turned + cross_columns(r, &mixed);
        Inertia { linear: self.linear, mixed, angular }
    }

    #[inline]
    pub(super) fn add(&mut self, other: &Inertia) {
        self.linear += other.linear;
        self.mixed += other.mixed;
        self.angular += other.angular;
    }

    /// A bound on the inertia that a twist meets, in whatever axes.
    #[inline]
    pub(super) fn bound(&self, s: &Twist) -> f64 {
        2.0 * (self.linear.trace() * s.linear.norm_squared()
            + self.angular.trace() * s.angular.norm_squared())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lopsided() -> Inertia {
        let body =
            Inertia::of_body(2.0, Matrix3::new(0.5, 0.1, 0.0, 0.1, 0.4, -0.05, 0.0, -0.05, 0.6));
        body.inward(&Vector3::new(0.3, -0.2, 0.9))
    }

    #[test]
    fn the_energy_of_a_motion_is_the_same_about_every_point() {
        let r = Vector3::new(1.0, 0.4, -0.6);
        let motion =
            Twist { linear: Vector3::new(0.2, 1.0, 3.0), angular: Vector3::new(-1.0, 2.0, 0.5) };
        let energy = |inertia: &Inertia, motion: &Twist| inertia.times(motion).along(motion);
        let (there, here) =
            (energy(&lopsided(), &motion.outward(&r)), energy(&lopsided().inward(&r), &motion));
        assert!((there / here - 1.0).abs() < 1e-15, "{there} {here}");
    }

    #[test]
    fn what_gives_way_resists_no_motion_along_its_freedom() {
        let mut inertia = lopsided();
        let s =
            Twist { linear: Vector3::new(0.1, 0.0, 2.0), angular: Vector3::new(0.3, -0.4, 0.5) };
        let u = inertia.times(&s);
        inertia.give_way(&u, 1.0 / u.along(&s));
        let left = inertia.times(&s);
        assert!(left.force.amax().max(left.torque.amax()) < 1e-15 * u.force.amax());
    }
}
