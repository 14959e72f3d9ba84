//! The four-bar linkage of bodies in the plane: crank, coupler and follower between two hooks.
//!
//! ```text
//! P = a e(u),    Q = P + b e(v) = D + c e(w),   D = (d, 0)       e an angle's unit vector
//! b v' <e'(v), e(w)> = -a <e'(u), e(w)>,   c w' <e'(w), e(v)> = a <e'(u), e(v)>       ' = d/du
//! T = 1/2 M(u) u.^2,     M = sum m |x'|^2 + I theta'^2
//! time of a revolution = integral over u of sqrt(M(u) / 2(E - V(u)))
//! ```
//! `a b c d` the lengths of crank, coupler, follower and ground (m), `u v w` the bars' angles
//! (rad); `x` their centres, `theta` their angles, `m` their masses and `I` their moments, those of
//! uniform thin rods. The linkage has one freedom, so that energy alone gives the time of a
//! revolution. For linkages whose crank goes round and whose coupler stays on one side (Grashof). Source: Haug,
//! Computer Aided Kinematics and Dynamics, 3; notes 6, 7.

use std::f64::consts::PI;

use nalgebra::Vector2;
use stationary_calculus::{DiagonalMetric, array};
use stationary_constraints::problems::time_of_revolution;

use crate::{PlanarEnd, PlanarJoint, PlanarJointKind, PlanarWeight, RigidError};

/// A crank, a coupler and a follower of uniform rods; the crank turns about the origin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    /// The lengths of crank, coupler, follower and ground, metres.
    pub lengths: [f64; 4],
    /// Mass a metre, kg/m.
    pub density: f64,
    /// The acceleration of gravity, m/s^2.
    pub gravity: Vector2<f64>,
}

/// The unit vector at an angle, and that a quarter turn ahead.
fn unit(angle: f64) -> [Vector2<f64>; 2] {
    let (s, c) = angle.sin_cos();
    [Vector2::new(c, s), Vector2::new(-s, c)]
}

impl FourBar {
    /// The masses of the bars, kg.
    pub fn masses(&self) -> [f64; 3] {
        [0, 1, 2].map(|bar| self.density * self.lengths[bar])
    }

    /// The moments of the bars about their centres, kg m^2.
    pub fn moments(&self) -> [f64; 3] {
        [0, 1, 2].map(|bar| self.masses()[bar] * self.lengths[bar].powi(2) / 12.0)
    }

    /// The angles of the bars where the crank is at an angle. Not a number where the linkage does
    /// not close.
    pub fn angles(&self, crank: f64) -> [f64; 3] {
        let [a, b, c, d] = self.lengths;
        let diagonal = Vector2::new(d, 0.0) - unit(crank)[0] * a;
        let r = diagonal.norm();
        let inner = ((b * b + r * r - c * c) / (2.0 * b * r)).acos();
        let coupler = diagonal.y.atan2(diagonal.x) + inner;
        let tip = unit(coupler)[0] * b - diagonal;
        [crank, coupler, tip.y.atan2(tip.x)]
    }

    /// The configuration (x, y, theta) of every bar where the crank is at an angle.
    pub fn configuration(&self, crank: f64) -> [f64; 9] {
        let [a, b, c, d] = self.lengths;
        let angles = self.angles(crank);
        let [along, coupler, follower] = angles.map(|angle| unit(angle)[0]);
        let centres = [
            along * (a / 2.0),
            along * a + coupler * (b / 2.0),
            Vector2::x() * d + follower * (c / 2.0),
        ];
        self.joined(centres, angles)
    }

    /// How the configuration changes with the crank's angle.
    pub fn slope(&self, crank: f64) -> [f64; 9] {
        let [a, b, c, _] = self.lengths;
        let [(_, u), (ev, v), (ew, w)] =
            self.angles(crank).map(unit).map(|[along, across]| (along, across));
        let coupler = -a * u.dot(&ew) / (b * v.dot(&ew));
        let follower = a * u.dot(&ev) / (c * w.dot(&ev));
        let centres = [u * (a / 2.0), u * a + v * (coupler * b / 2.0), w * (follower * c / 2.0)];
        self.joined(centres, [1.0, coupler, follower])
    }

    fn joined(&self, centres: [Vector2<f64>; 3], angles: [f64; 3]) -> [f64; 9] {
        array(|k| match k % 3 {
            2 => angles[k / 3],
            c => centres[k / 3][c],
        })
    }

    /// The pins at both hooks and at both ends of the coupler.
    ///
    /// # Errors
    /// [`RigidError::Joint`] for a length that is not finite.
    pub fn joints(&self) -> Result<Vec<PlanarJoint>, RigidError> {
        let [a, b, c, d] = self.lengths.map(|length| Vector2::x() * length);
        let body = |bar, point: Vector2<f64>| PlanarEnd::on(bar, point / 2.0);
        let pairs = [
            [PlanarEnd::world(Vector2::zeros()), body(0, -a)],
            [body(0, a), body(1, -b)],
            [body(1, b), body(2, c)],
            [body(2, -c), PlanarEnd::world(d)],
        ];
        pairs.into_iter().map(|ends| PlanarJoint::new(3, PlanarJointKind::Pin, ends)).collect()
    }

    /// The metric of the bars' freedoms.
    ///
    /// # Errors
    /// [`MetricError::NotAMass`](stationary_calculus::MetricError::NotAMass) for a mass or a moment
    /// that is not positive and finite.
    pub fn metric(&self) -> Result<DiagonalMetric<Vec<f64>>, stationary_calculus::MetricError> {
        let bars = self.masses().into_iter().zip(self.moments());
        DiagonalMetric::new(bars.flat_map(|(mass, moment)| [mass, mass, moment]).collect())
    }

    /// The bars' weight.
    pub fn weight(&self) -> PlanarWeight {
        PlanarWeight { gravity: self.gravity, masses: self.masses().to_vec() }
    }

    /// The inertia M of the crank's rate at an angle, kg m^2, and the potential energy, joules.
    fn inertia_and_energy(&self, crank: f64) -> (f64, f64) {
        let (q, slope) = (self.configuration(crank), self.slope(crank));
        let (masses, moments) = (self.masses(), self.moments());
        (0..3).fold((0.0, 0.0), |(inertia, energy), bar| {
            let of = |numbers: &[f64; 9]| Vector2::new(numbers[3 * bar], numbers[3 * bar + 1]);
            let turned = slope[3 * bar + 2];
            let moved = masses[bar] * of(&slope).norm_squared() + moments[bar] * turned * turned;
            (inertia + moved, energy - masses[bar] * self.gravity.dot(&of(&q)))
        })
    }

    /// The time of a revolution, seconds, of a crank that turns at `rate` rad/s at the angle
    /// `crank`; not a number where it does not get round, or so narrowly that its energy says too little.
    pub fn revolution(&self, crank: f64, rate: f64) -> f64 {
        // Where the crank lies along the ground coupler and follower may be nearly in line, and turn fast.
        let in_line = [0.0, PI];
        let time = time_of_revolution(crank, rate, &in_line, |u| self.inertia_and_energy(u));
        time.unwrap_or(f64::NAN)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_crank_that_barely_gets_round_is_told_from_one_that_does_not() {
        let gravity = Vector2::new(0.0, -9.81);
        let linkage = FourBar { lengths: [1.0, 2.0, 2.0, 2.0], density: 1.0, gravity };
        // Times by quadrature in 30 digits, split at the top.
        let rates_and_times = [
            (2.785_464_569_443_263_4, 2.132_347_254_581_527),
            (2.657_822_564_596_260_3, 4.468_289_405_059_855),
            (2.657_693_031_970_101_8, 6.025_020_428_314_905),
            (2.657_691_854_371_815, 6.803_463_354_700_946),
        ];
        for (rate, time) in rates_and_times {
            let found = linkage.revolution(0.3, rate);
            assert!((found / time - 1.0).abs() < 1e-9, "{rate}: {found} {time}");
        }
        for short in [2.657_691_710_443_099_7, 2.657_691_592_683_236_5, 2.657_690_415_084_312] {
            assert!(linkage.revolution(0.3, short).is_nan());
        }
    }

    #[test]
    fn a_linkage_that_is_nearly_in_line_on_its_way_goes_round_in_its_time() {
        // Times by quadrature in 30 digits, split beside both ends.
        let cases = [
            ([0.25, 1.0, 1.5, 2.25 - 1e-6], [1.0, -3.0], 1.0, 20.0, 0.473_764_744_156_324_3),
            ([0.25, 1.0, 1.5, 2.25 - 1e-9], [1.0, -3.0], 1.0, -20.0, 0.474_055_860_791_642_7),
            ([0.5, 2.0, 1.0, 1.5 + 1e-8], [0.0, -9.81], 0.3, 9.0, 0.669_715_726_925_827_2),
        ];
        for (lengths, gravity, crank, rate, time) in cases {
            let linkage = FourBar { lengths, density: 1.0, gravity: gravity.into() };
            let found = linkage.revolution(crank, rate);
            assert!((found / time - 1.0).abs() < 1e-9, "{lengths:?}: {found} {time}");
        }
    }
}
