//! Kovalevskaya's top: the third heavy top that has a fourth integral.
//!
//! ```text
//! I1 = I2 = 2 I3,   centre of mass on the first axis
//! K = |(w1 + i w2)^2 - c (G1 + i G2)|^2,    c = m g l/I3,    G = R^T ez
//! ```
//! `w` angular velocity and `G` the upward vertical in body axes, `m g l` the weight's moment (N
//! m). `K`, in s^-4, is constant beside energy, `L.G` and `|G|`. It comes from no symmetry, so no
//! integrator keeps it to rounding. Source: Kowalevski, Acta Mathematica 12 (1889).

use nalgebra::Vector3;

use crate::{Body, RigidError, Rotation};

/// Kovalevskaya's top with its smallest moment and its weight's moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KovalevskayaTop {
    /// The moment about the third axis, kg m^2; the others are twice as large.
    pub along: f64,
    /// Mass times gravity times the distance of the centre from the fixed point, N m.
    pub weight_moment: f64,
}

impl KovalevskayaTop {
    /// The body, of a mass that does not matter to it.
    ///
    /// # Errors
    /// [`RigidError::Moment`] for a moment that is not positive and finite, with its reciprocal.
    pub fn body(&self) -> Result<Body, RigidError> {
        Body::new(1.0, [2.0 * self.along, 2.0 * self.along, self.along])
    }

    /// The fourth integral, s^-4, at an orientation and an angular velocity (body axes).
    pub fn integral(&self, rotation: &Rotation, w: &Vector3<f64>) -> f64 {
        let (up, c) = (rotation.rotate_back(&Vector3::z()), self.weight_moment / self.along);
        let real = w.x * w.x - w.y * w.y - c * up.x;
        let imaginary = 2.0 * w.x * w.y - c * up.y;
        real * real + imaginary * imaginary
    }
}
