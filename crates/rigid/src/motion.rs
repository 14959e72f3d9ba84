//! SE(3), the rigid motions of space: `x -> R x + t`.
//!
//! ```text
//! exp(v, w) = (J(w) v, exp(w)),        log(t, R) = (J(w)^-1 t, w),   w = log R
//! Ad_g (v, w) = (R v + t x R w, R w)
//! [(v, w), (v', w')] = (w x v' - w' x v, w x w')
//! ```
//! `t` metres, `R` a rotation; the algebra has the body's velocity `v` first, its angular velocity
//! `w` second; `J` the left Jacobian. A path `exp(s (v, w))` is a screw. A free body does not
//! follow it: its centre moves straight while it turns, which is [`Poses`](crate::Poses), the
//! product of R^3 and SO(3) with the same elements and other paths. Source: notes 8.2.

use nalgebra::{Matrix4, Vector3, Vector6};

use crate::{LieGroup, Rotation, left_jacobian, left_jacobian_inverse};

/// A rigid motion of space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidMotion {
    /// The translation t, metres.
    pub translation: Vector3<f64>,
    /// The rotation R.
    pub rotation: Rotation,
}

impl RigidMotion {
    /// Where a point of the body is in the world.
    #[inline]
    pub fn apply(&self, point: &Vector3<f64>) -> Vector3<f64> {
        self.rotation.rotate(point) + self.translation
    }
}

#[inline]
fn halves(v: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (v.fixed_rows::<3>(0).into(), v.fixed_rows::<3>(3).into())
}

#[inline]
fn joined(v: Vector3<f64>, w: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
}

impl LieGroup for RigidMotion {
    /// The body's velocity (3) and its angular velocity (3).
    type Algebra = Vector6<f64>;
    type Matrix = Matrix4<f64>;

    #[inline]
    fn identity() -> Self {
        RigidMotion { translation: Vector3::zeros(), rotation: Rotation::identity() }
    }

    #[inline]
    fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        RigidMotion { translation: -rotation.rotate(&self.translation), rotation }
    }

    #[inline]
    fn compose(&self, first: &Self) -> Self {
        RigidMotion {
            translation: self.apply(&first.translation),
            rotation: self.rotation.compose(&first.rotation),
        }
    }

    fn exp(v: Vector6<f64>) -> Self {
        let (v, w) = halves(&v);
        RigidMotion { translation: left_jacobian(&w) * v, rotation: Rotation::exp(w) }
    }

    fn log(&self) -> Vector6<f64> {
        let w = self.rotation.log();
        joined(left_jacobian_inverse(&w) * self.translation, w)
    }

    fn adjoint(&self, v: Vector6<f64>) -> Vector6<f64> {
        let (v, w) = halves(&v);
        let w = self.rotation.rotate(&w);
        joined(self.rotation.rotate(&v) + self.translation.cross(&w), w)
    }

    fn bracket(v: Vector6<f64>, w: Vector6<f64>) -> Vector6<f64> {
        let ((v, a), (w, b)) = (halves(&v), halves(&w));
        joined(a.cross(&w) - b.cross(&v), a.cross(&b))
    }

    fn matrix(&self) -> Matrix4<f64> {
        let mut matrix = self.rotation.matrix().to_homogeneous();
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&self.translation);
        matrix
    }

    fn hat(v: Vector6<f64>) -> Matrix4<f64> {
        let (v, w) = halves(&v);
        let mut matrix = Matrix4::zeros();
        matrix.fixed_view_mut::<3, 3>(0, 0).copy_from(&w.cross_matrix());
        matrix.fixed_view_mut::<3, 1>(0, 3).copy_from(&v);
        matrix
    }
}
