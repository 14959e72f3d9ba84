//! SO(2) and SE(2): turning and moving in the plane.
//!
//! ```text
//! SO(2)   (c, s) = (cos a, sin a)              exp(a) = (cos a, sin a),    log = atan2(s, c)
//! SE(2)   x -> R x + t                         algebra (v, a): velocity of the body, rate of turn
//! exp(v, a) = (t, R(a)),   t = (sin(a/2)/(a/2)) (cos(a/2) v + sin(a/2) Z v),   Z a quarter turn
//! ```
//! Angles in radians, counterclockwise, logarithms in (-pi, pi]. Translation first. Source: notes
//! 7, 8.2; errata chapter 8.

use nalgebra::{Matrix2, Matrix3, Vector2, Vector3};

use crate::LieGroup;
use crate::jacobian::inverse_coefficient;

/// A rotation of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarRotation {
    cosine: f64,
    sine: f64,
}

impl PlanarRotation {
    /// The angle in (-pi, pi], radians.
    pub fn angle(&self) -> f64 {
        self.log()
    }

    /// A vector of the body as seen from the world.
    #[inline]
    pub fn rotate(&self, v: &Vector2<f64>) -> Vector2<f64> {
        let (c, s) = (self.cosine, self.sine);
        Vector2::new(c * v.x - s * v.y, s * v.x + c * v.y)
    }

    /// A vector of the world as seen from the body.
    #[inline]
    pub fn rotate_back(&self, v: &Vector2<f64>) -> Vector2<f64> {
        self.inverse().rotate(v)
    }
}

impl LieGroup for PlanarRotation {
    type Algebra = f64;
    type Matrix = Matrix2<f64>;

    fn identity() -> Self {
        PlanarRotation { cosine: 1.0, sine: 0.0 }
    }

    fn inverse(&self) -> Self {
        PlanarRotation { cosine: self.cosine, sine: -self.sine }
    }

    fn compose(&self, first: &Self) -> Self {
        let (a, b) = (self, first);
        PlanarRotation {
            cosine: a.cosine * b.cosine - a.sine * b.sine,
            sine: a.sine * b.cosine + a.cosine * b.sine,
        }
    }

    fn exp(angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        PlanarRotation { cosine, sine }
    }

    fn log(&self) -> f64 {
        // Half a turn is +pi even where the sine is a negative zero.
        (self.sine + 0.0).atan2(self.cosine)
    }

    /// The identity: turns of the plane commute.
    fn adjoint(&self, v: f64) -> f64 {
        v
    }

    fn bracket(_v: f64, _w: f64) -> f64 {
        0.0
    }

    fn matrix(&self) -> Matrix2<f64> {
        Matrix2::new(self.cosine, -self.sine, self.sine, self.cosine)
    }

    fn hat(v: f64) -> Matrix2<f64> {
        Matrix2::new(0.0, -v, v, 0.0)
    }
}

/// A rigid motion of the plane: `x -> R x + t`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlanarMotion {
    /// The translation t, metres.
    pub translation: Vector2<f64>,
    /// The rotation R.
    pub rotation: PlanarRotation,
}

impl PlanarMotion {
    /// Where a point of the body is in the world.
    #[inline]
    pub fn apply(&self, point: &Vector2<f64>) -> Vector2<f64> {
        self.rotation.rotate(point) + self.translation
    }
}

/// A quarter turn.
fn quarter(v: Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

impl LieGroup for PlanarMotion {
    /// The body's velocity (2) and its rate of turn.
    type Algebra = Vector3<f64>;
    type Matrix = Matrix3<f64>;

    fn identity() -> Self {
        PlanarMotion { translation: Vector2::zeros(), rotation: PlanarRotation::identity() }
    }

    fn inverse(&self) -> Self {
        let rotation = self.rotation.inverse();
        PlanarMotion { translation: -rotation.rotate(&self.translation), rotation }
    }

    fn compose(&self, first: &Self) -> Self {
        PlanarMotion {
            translation: self.apply(&first.translation),
            rotation: self.rotation.compose(&first.rotation),
        }
    }

    fn exp(v: Vector3<f64>) -> Self {
        let (velocity, a) = (v.xy(), v.z);
        let (sine, cosine) = (0.5 * a).sin_cos();
        let shrink = if a.abs() < f64::EPSILON { 1.0 } else { 2.0 * sine / a };
        let translation = (velocity * cosine + quarter(velocity) * sine) * shrink;
        PlanarMotion { translation, rotation: PlanarRotation::exp(a) }
    }

    fn log(&self) -> Vector3<f64> {
        let a = self.rotation.log();
        let t = self.translation;
        let v = t * (1.0 - a * a * inverse_coefficient(a * a)) - quarter(t) * (0.5 * a);
        Vector3::new(v.x, v.y, a)
    }

    fn adjoint(&self, v: Vector3<f64>) -> Vector3<f64> {
        let moved = self.rotation.rotate(&v.xy()) - quarter(self.translation) * v.z;
        Vector3::new(moved.x, moved.y, v.z)
    }

    fn bracket(v: Vector3<f64>, w: Vector3<f64>) -> Vector3<f64> {
        let velocity = quarter(w.xy()) * v.z - quarter(v.xy()) * w.z;
        Vector3::new(velocity.x, velocity.y, 0.0)
    }

    fn matrix(&self) -> Matrix3<f64> {
        let mut matrix = self.rotation.matrix().to_homogeneous();
        matrix.fixed_view_mut::<2, 1>(0, 2).copy_from(&self.translation);
        matrix
    }

    fn hat(v: Vector3<f64>) -> Matrix3<f64> {
        Matrix3::new(0.0, -v.z, v.x, v.z, 0.0, v.y, 0.0, 0.0, 0.0)
    }
}
