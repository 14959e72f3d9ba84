//! Two unit masses on unit rods, one hanging from the other: a mass that depends on q.
//!
//! ```text
//! L = a'^2 + 1/2 b'^2 + a' b' cos(a - b) + 2 cos a + cos b          (m = L = g = 1)
//! ```
//! `a` and `b` the angles of the upper and the lower rod from hanging, radians, counterclockwise.
//! Chaotic at high energy, so that a trajectory is compared with another only while both are tame.

use stationary_calculus::Number;

use crate::Lagrangian;

/// The Lagrangian of a double pendulum, with the upper and the lower angle as its freedoms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DoublePendulum;

impl Lagrangian<2> for DoublePendulum {
    fn value<R: Number>(&self, [a, b]: [R; 2], [da, db]: [R; 2]) -> R {
        let kinetic = da * da + db * db * 0.5 + da * db * (a - b).cos();
        kinetic + a.cos() * 2.0 + b.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::EulerLagrange;
    use stationary_calculus::{Vector, directional_derivative};

    /// Where the two masses are at angles `a` and `b`.
    fn positions<R: Number>([a, b]: [R; 2]) -> [[R; 2]; 2] {
        let upper = [a.sin(), -a.cos()];
        [upper, [upper[0] + b.sin(), upper[1] - b.cos()]]
    }

    #[test]
    fn it_is_the_kinetic_energy_of_its_masses_less_their_height() {
        let (q, v) = ([0.7, -1.9], Vector([0.4, 1.3]));
        let velocities = directional_derivative(positions, q, v);
        let square = |x: [f64; 2]| x[0] * x[0] + x[1] * x[1];
        let kinetic = 0.5 * (square(velocities[0]) + square(velocities[1]));
        let [upper, lower] = positions(q);
        let expected = kinetic - upper[1] - lower[1];
        assert!((DoublePendulum.value(q, v.0) - expected).abs() < 1e-15);
    }

    #[test]
    fn small_swings_have_the_two_known_frequencies() {
        // omega^2 = 2 -+ sqrt 2, with the lower angle +-sqrt 2 times the upper one.
        let mut equations = EulerLagrange::new(DoublePendulum);
        for sign in [1.0, -1.0] {
            let q = [1e-5, sign * 2.0_f64.sqrt() * 1e-5];
            let a = equations.acceleration(q, Vector([0.0; 2])).unwrap();
            let square = 2.0 - sign * 2.0_f64.sqrt();
            assert!((0..2).all(|i| (a.0[i] + square * q[i]).abs() < 1e-13));
        }
    }
}
