//! The heavy symmetric top on its tip: how fast it precesses, how far it nods.
//!
//! ```text
//! I1 cos(theta) W^2 - I3 w3 W + m g l = 0                 steady precession at the rate W
//! u.^2 = f(u) = (1 - u^2)(alpha - beta u) - (b - a u)^2,   u = cos theta          nutation
//! alpha = (2E - I3 w3^2)/I1,  beta = 2 m g l/I1,  a = I3 w3/I1,  b = Lz/I1
//! ```
//! `theta` the angle of the axis from upright, `w3` the spin about it (rad/s, constant), `I1 = I2`
//! and `I3` moments about the tip (kg m^2), `m g l` the weight's moment (N m), `E` energy (J), `Lz`
//! the angular momentum about the vertical, constant too. Between two roots of f in [-1, 1] the
//! axis nods. Source: Goldstein, Classical Mechanics, 5.7; Landau and Lifshitz, Mechanics, 35.

use nalgebra::Vector3;

use crate::{Body, LieGroup, Rotation};

/// A symmetric body with its third axis as its own, its tip at the origin of its axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SymmetricTop {
    /// The moment about axes across its own, about the tip, kg m^2.
    pub across: f64,
    /// The moment about its own axis, kg m^2.
    pub along: f64,
    /// Mass times gravity times the distance of the centre from the tip, N m.
    pub weight_moment: f64,
}

impl SymmetricTop {
    /// The slow and the fast rate of steady precession at this tilt and spin, rad/s; `None` where
    /// the spin is too slow. A level top has one rate, and the fast one is infinite.
    pub fn steady_precession(&self, theta: f64, spin: f64) -> Option<[f64; 2]> {
        let (momentum, lever) = (self.along * spin, self.across * theta.cos());
        let root = (momentum * momentum - 4.0 * lever * self.weight_moment).sqrt();
        if root.is_nan() {
            return None;
        }
        // The root of one sign with the momentum does not cancel.
        let sum = momentum + root.copysign(momentum);
        Some([2.0 * self.weight_moment / sum, 0.5 * sum / lever])
    }

    /// The smallest and the largest tilt that the axis reaches, radians, from an orientation and an
    /// angular momentum (body axes) at any time. At steady precession they agree to the square root
    /// of rounding.
    pub fn nutation(&self, rotation: &Rotation, m: &Vector3<f64>) -> [f64; 2] {
        let up = rotation.rotate_back(&Vector3::z());
        let kinetic = (m.x * m.x + m.y * m.y) / self.across;
        let alpha = kinetic / self.across + 2.0 * self.weight_moment * up.z / self.across;
        let beta = 2.0 * self.weight_moment / self.across;
        let (a, b) = (m.z / self.across, up.dot(m) / self.across);
        let roots = real_roots(beta, -(alpha + a * a), 2.0 * a * b - beta, alpha - b * b);
        [roots[1], roots[0]].map(|u| u.clamp(-1.0, 1.0).acos())
    }

    /// The body, of a mass that does not matter to it.
    ///
    /// # Errors
    /// [`RigidError::Moment`](crate::RigidError::Moment) for a moment that is not positive and
    /// finite, [`RigidError::TriangleInequality`](crate::RigidError::TriangleInequality) where
    /// `along` exceeds twice `across`.
    pub fn body(&self) -> Result<Body, crate::RigidError> {
        Body::new(1.0, [self.across, self.across, self.along])
    }
}

/// The tilt of a body's third axis from upright, radians.
pub fn tilt(rotation: &Rotation) -> f64 {
    let axis = rotation.matrix().column(2).into_owned();
    axis.x.hypot(axis.y).atan2(axis.z)
}

/// The roots, ascending, of `c3 u^3 + c2 u^2 + c1 u + c0`, `c3 > 0`, all of which are real.
fn real_roots(c3: f64, c2: f64, c1: f64, c0: f64) -> [f64; 3] {
    let (p, q, r) = (c2 / c3, c1 / c3, c0 / c3);
    let shift = p / 3.0;
    let radius = (shift * shift - q / 3.0).max(0.0).sqrt();
    let product = shift * shift * shift - shift * q / 2.0 + r / 2.0;
    let angle = if radius > 0.0 { (product / radius.powi(3)).clamp(-1.0, 1.0).acos() } else { 0.0 };
    let root = |k: f64| {
        let turn = (angle + k * std::f64::consts::TAU) / 3.0;
        -2.0 * radius * turn.cos() - shift
    };
    let mut roots = [root(0.0), root(1.0), root(-1.0)];
    roots.sort_by(f64::total_cmp);
    roots
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_real_roots_are_found() {
        for expected in [[-2.0, 0.5, 3.0], [-1.0, -0.9, 10.0], [1.0, 2.0, 2.5]] {
            let [x, y, z] = expected;
            let c = [2.0, -2.0 * (x + y + z), 2.0 * (x * y + y * z + z * x), -2.0 * x * y * z];
            let roots = real_roots(c[0], c[1], c[2], c[3]);
            for (a, b) in roots.iter().zip(&expected) {
                assert!((a - b).abs() < 1e-9, "{roots:?}");
            }
        }
    }

    #[test]
    fn a_top_that_spins_too_slowly_has_no_steady_precession() {
        let top = SymmetricTop { across: 1.0, along: 0.5, weight_moment: 2.0 };
        let limit = (4.0 * 1.0 * 2.0 * 0.5_f64.cos()).sqrt() / 0.5;
        assert!(top.steady_precession(0.5, 0.99 * limit).is_none());
        let [slow, fast] = top.steady_precession(0.5, 1.01 * limit).unwrap();
        for rate in [slow, fast] {
            let balance = 0.5_f64.cos() * rate * rate - 0.5 * 1.01 * limit * rate + 2.0;
            assert!(balance.abs() < 1e-13, "{balance:e}");
        }
    }
}
