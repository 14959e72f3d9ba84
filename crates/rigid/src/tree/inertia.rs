//! The inertia of a body, of a branch as one body, and of a branch whose joints give way.
//!
//! ```text
//! I = [ A    B ]      F = A v + B w                                about a point of reference
//!     [ B^T  C ]      N = B^T v + C w
//! A = m,  B = 0,  C = R diag(I1, I2, I3) R^T                        a body about its centre
//! B' = B - A [r],   C' = C - B^T [r] + [r] B'                       about a point r further back
//! I - U U^T / D,    U = I s,   D = s^T I s                          one freedom s gives way
//! ```
//! `A` kg, `B` kg m, `C` kg m^2, in world axes; `[r]` the cross-product matrix. `A` and `C` are symmetric: 21 numbers
//! in all. What is left of an inertia when a freedom gives way resists no motion along it. Source: Featherstone 2008,
//! 2.13 and 7.1.

use nalgebra::{Matrix3, Vector3};

use super::spatial::{SpatialForce, Twist};

/// A symmetric matrix, by its diagonal and the entries (y, z), (z, x) and (x, y).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Symmetric {
    diagonal: Vector3<f64>,
    off: Vector3<f64>,
}

/// A symmetric inertia in three blocks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia {
    linear: Symmetric,
    mixed: Matrix3<f64>,
    angular: Symmetric,
}

/// `[r] M`: the cross product with every column.
#[inline]
pub(super) fn cross_columns(r: &Vector3<f64>, m: &Matrix3<f64>) -> Matrix3<f64> {
    let cross = |k: usize| r.cross(&m.column(k));
    Matrix3::from_columns(&[cross(0), cross(1), cross(2)])
}

impl Symmetric {
    fn zero() -> Self {
        Symmetric { diagonal: Vector3::zeros(), off: Vector3::zeros() }
    }

    /// `R diag(moments) R^T`
    #[inline]
    pub(super) fn turned(moments: &Vector3<f64>, r: &Matrix3<f64>) -> Self {
        let weighted = |row: usize| {
            Vector3::new(r[(row, 0)] * moments.x, r[(row, 1)] * moments.y, r[(row, 2)] * moments.z)
        };
        let by_row = |a: &Vector3<f64>, row: usize| {
            a.x * r[(row, 0)] + a.y * r[(row, 1)] + a.z * r[(row, 2)]
        };
        let [x, y, z] = [weighted(0), weighted(1), weighted(2)];
        Symmetric {
            diagonal: Vector3::new(by_row(&x, 0), by_row(&y, 1), by_row(&z, 2)),
            off: Vector3::new(by_row(&y, 2), by_row(&z, 0), by_row(&x, 1)),
        }
    }

    #[inline]
    pub(super) fn times(&self, v: &Vector3<f64>) -> Vector3<f64> {
        let (d, o) = (&self.diagonal, &self.off);
        Vector3::new(
            d.x * v.x + o.z * v.y + o.y * v.z,
            o.z * v.x + d.y * v.y + o.x * v.z,
            o.y * v.x + o.x * v.y + d.z * v.z,
        )
    }

    #[inline]
    fn column(&self, k: usize) -> Vector3<f64> {
        let (d, o) = (&self.diagonal, &self.off);
        match k {
            0 => Vector3::new(d.x, o.z, o.y),
            1 => Vector3::new(o.z, d.y, o.x),
            _ => Vector3::new(o.y, o.x, d.z),
        }
    }

    #[inline]
    fn add(&mut self, other: &Symmetric) {
        self.diagonal += other.diagonal;
        self.off += other.off;
    }

    /// Takes away `a a^T` times a factor.
    #[inline]
    fn take_square(&mut self, a: &Vector3<f64>, factor: f64) {
        self.diagonal -= a.component_mul(a) * factor;
        self.off -= Vector3::new(a.y * a.z, a.z * a.x, a.x * a.y) * factor;
    }
}

impl Inertia {
    pub(super) fn zero() -> Self {
        Inertia { linear: Symmetric::zero(), mixed: Matrix3::zeros(), angular: Symmetric::zero() }
    }

    /// That of a body about its centre.
    #[inline]
    pub(super) fn of_body(mass: f64, angular: Symmetric) -> Self {
        let linear = Symmetric { diagonal: Vector3::repeat(mass), off: Vector3::zeros() };
        Inertia { linear, mixed: Matrix3::zeros(), angular }
    }

    #[inline]
    pub(super) fn times(&self, motion: &Twist) -> SpatialForce {
        let Twist { linear: v, angular: w } = motion;
        SpatialForce {
            force: self.linear.times(v) + self.mixed * w,
            torque: self.mixed.tr_mul(v) + self.angular.times(w),
        }
    }

    /// What is left when a freedom gives way, of which `u` is the inertia times its twist and
    /// `inverse` one over the inertia that it meets.
    #[inline]
    pub(super) fn give_way(&mut self, u: &SpatialForce, inverse: f64) {
        self.linear.take_square(&u.force, inverse);
        // Products first: what they are multiplied by comes last, from a division.
        self.mixed -= (u.force * u.torque.transpose()) * inverse;
        self.angular.take_square(&u.torque, inverse);
    }

    /// Adds another inertia, told about a point `r` further back.
    #[inline]
    pub(super) fn add_inward(&mut self, other: &Inertia, r: &Vector3<f64>) {
        let Inertia { linear, mixed: before, angular } = other;
        // A is symmetric: A [r] = -([r] A)^T.
        let turned = [0, 1, 2].map(|k| r.cross(&linear.column(k)));
        let mixed = Matrix3::from_fn(|k, j| before[(k, j)] + turned[k][j]);
        // Entry (i, j) of -B^T [r] is that of r x B_i at j, and of [r] B' that of r x B'_j at i.
        let crossed = |m: &Matrix3<f64>, column: usize, at: usize| {
            let (next, last) = ((at + 1) % 3, (at + 2) % 3);
            r[next] * m[(last, column)] - r[last] * m[(next, column)]
        };
        let entry = |i: usize, j: usize| crossed(before, i, j) + crossed(&mixed, j, i);
        self.linear.add(linear);
        self.mixed += mixed;
        self.angular.add(angular);
        self.angular.add(&Symmetric {
            diagonal: Vector3::new(entry(0, 0), entry(1, 1), entry(2, 2)),
            off: Vector3::new(entry(1, 2), entry(2, 0), entry(0, 1)),
        });
    }

    /// A bound on the inertia that a twist meets, in whatever axes, of those that the two traces of an inertia give.
    #[inline]
    pub(super) fn bound([linear, angular]: [f64; 2], s: &Twist) -> f64 {
        2.0 * (linear * s.linear.norm_squared() + angular * s.angular.norm_squared())
    }

    /// The traces of the linear and of the angular block.
    #[inline]
    pub(super) fn traces(&self) -> [f64; 2] {
        [self.linear.diagonal.sum(), self.angular.diagonal.sum()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{LieGroup, Rotation};

    fn lopsided() -> Inertia {
        let angular = Symmetric {
            diagonal: Vector3::new(0.5, 0.4, 0.6),
            off: Vector3::new(-0.05, 0.02, 0.1),
        };
        let body = Inertia::of_body(2.0, angular);
        inward(&body, &Vector3::new(0.3, -0.2, 0.9))
    }

    fn inward(inertia: &Inertia, r: &Vector3<f64>) -> Inertia {
        let mut sum = Inertia::zero();
        sum.add_inward(inertia, r);
        sum
    }

    #[test]
    fn moments_are_turned_as_by_full_matrices() {
        let turn = Rotation::exp(Vector3::new(0.3, -1.1, 0.7)).matrix();
        let (moments, v) = (Vector3::new(0.4, 0.9, 1.2), Vector3::new(1.0, -2.0, 0.5));
        let full = turn * Matrix3::from_diagonal(&moments) * turn.transpose();
        let symmetric = Symmetric::turned(&moments, &turn);
        assert!((symmetric.times(&v) - full * v).amax() < 1e-15);
        for k in 0..3 {
            assert!((symmetric.column(k) - full.column(k)).amax() < 1e-15);
        }
    }

    #[test]
    fn the_energy_of_a_motion_is_the_same_about_every_point() {
        let r = Vector3::new(1.0, 0.4, -0.6);
        let motion =
            Twist { linear: Vector3::new(0.2, 1.0, 3.0), angular: Vector3::new(-1.0, 2.0, 0.5) };
        let energy = |inertia: &Inertia, motion: &Twist| inertia.times(motion).along(motion);
        let (there, here) =
            (energy(&lopsided(), &motion.outward(&r)), energy(&inward(&lopsided(), &r), &motion));
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
