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
        let rates = [2.0 * self.weight_moment / sum, 0.5 * sum / lever];
        rates.iter().all(|rate| !rate.is_nan()).then_some(rates)
    }

    /// The smallest and the largest tilt that the axis reaches, radians, from an orientation and an
    /// angular momentum (body axes) at any time. About steady precession they agree to the square root
    /// of rounding.
    pub fn nutation(&self, rotation: &Rotation, m: &Vector3<f64>) -> [f64; 2] {
        let up = rotation.rotate_back(&Vector3::z());
        let [x, y, a] = [m.x, m.y, m.z].map(|m| m / self.across);
        let beta = 2.0 * self.weight_moment / self.across;
        let (swing, lean) = (x * x + y * y, up.x * up.x + up.y * up.y);
        let slope = 2.0 * a * (up.x * x + up.y * y) - 2.0 * up.z * swing - beta * lean;
        let bend = 2.0 * up.z * beta - swing - a * a;
        // 1 - u and 1 + u, neither by a difference that cancels.
        let nearer = lean / (1.0 + up.z.abs());
        let (above, below) =
            if up.z > 0.0 { (nearer, 2.0 - nearer) } else { (2.0 - nearer, nearer) };
        let rate = (up.x * y - up.y * x).powi(2);
        let rise = reach([rate, slope, bend, beta], above);
        let fall = reach([rate, -slope, bend, -beta], below);
        let angle = |above: f64, below: f64| 2.0 * above.sqrt().atan2(below.sqrt());
        [angle(above - rise, below + rise), angle(above + fall, below - fall)]
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

/// Where `c0 + c1 w + c2 w^2 + c3 w^3`, positive from w = 0 on, becomes negative before `end`.
fn reach([c0, c1, c2, c3]: [f64; 4], end: f64) -> f64 {
    let cubic = |w: f64| c0 + w * (c1 + w * (c2 + w * c3));
    let beyond = |w: f64| c1 + w * (c2 + w * c3);
    if c0 == 0.0 && c1 <= 0.0 {
        return 0.0;
    }
    let (mut inside, mut outside) = (0.0, end);
    loop {
        let middle = 0.5 * (inside + outside);
        if middle <= inside || middle >= outside || middle.is_nan() {
            return middle;
        }
        // From a turning point the root at w = 0 is divided out.
        let positive = if c0 == 0.0 { beyond(middle) > 0.0 } else { cubic(middle) > 0.0 };
        *(if positive { &mut inside } else { &mut outside }) = middle;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_nodding_of_fast_and_of_lightly_loaded_tops_is_not_lost() {
        let start = Rotation::exp(Vector3::x() * 0.5);
        for (weight_moment, spin) in [(0.5, 6e3), (0.5, 6e5), (1e-6, 6e3), (0.0, 6e3), (1e-3, 1e8)]
        {
            let top = SymmetricTop { across: 0.02, along: 0.005, weight_moment };
            let [least, most] = top.nutation(&start, &Vector3::new(0.0, 0.0, 0.005 * spin));
            // Let go from rest a fast top nods by the angle beta sin(theta)/a^2.
            let a: f64 = 0.25 * spin;
            let nod = 2.0 * weight_moment / 0.02 * 0.5_f64.sin() / (a * a);
            assert!((least - 0.5).abs() < 1e-15, "{least}");
            assert!(
                (most - 0.5 - nod).abs() < 1e-15 + 10.0 * nod * nod,
                "{weight_moment} {spin}: {most}"
            );
        }
    }

    #[test]
    fn a_pendulum_reaches_the_same_angle_on_both_sides_and_a_fast_one_goes_over() {
        let top = SymmetricTop { across: 1.0, along: 0.5, weight_moment: 2.0 };
        let down = Rotation::exp(Vector3::x() * std::f64::consts::PI);
        for speed in [1e-6_f64, 0.1, 1.0, 2.0] {
            let [least, most] = top.nutation(&down, &Vector3::new(speed, 0.0, 0.0));
            assert!((most - std::f64::consts::PI).abs() < 1e-15);
            let height = speed * speed / 4.0;
            let expected = std::f64::consts::PI - 2.0 * (0.5 * height).sqrt().asin();
            assert!((least - expected).abs() < 1e-14, "{speed}: {least} {expected}");
        }
        assert_eq!(top.nutation(&down, &Vector3::new(5.0, 0.0, 0.0))[0], 0.0);
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
