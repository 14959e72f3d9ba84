//! Moments of rolling and of torsional friction.
//!
//! ```text
//! |tau x n| <= a lambda,   |tau.n| <= b lambda                     N s m, to r_t
//! |tau - disc(tau - w/c)| c |arm| <= r_t                           each part of them, m/s
//! ```
//! `a b` the lengths of a pair, `c` what a unit moment gives of the spin `w` of one body against the other.

use nalgebra::Vector3;

use super::{ROUNDING, Referee, Seen, Step};
use crate::Verdict;

impl Referee<'_> {
    /// Moments are within what their lengths times the normal impulse are.
    pub(super) fn moments_within(&self, step: &Step, touch: &Seen) -> Verdict {
        let [rolls, twists] = self.case.rolling;
        // In the plane all of a moment is across the normal.
        let twist = touch.moment.dot(&touch.normal);
        let roll = (touch.moment - touch.normal * twist).norm();
        let gives: f64 = touch.sides().map(|(k, _, arm)| self.turned_least(k, &arm)).sum();
        let within = |(moment, length): (f64, f64)| {
            let over = (moment - length * touch.rest).max(0.0) * gives;
            let rounding = ROUNDING * gives * touch.moment.norm();
            let promised = 1.01 * step.report.coulomb + rounding;
            Verdict::of(over, promised, "a moment beyond its length")
        };
        within((roll, rolls)).and(within((twist.abs(), twists)))
    }

    /// What a unit moment about any axis moves at least at the end of an arm, 1/(kg m).
    fn turned_least(&self, k: usize, arm: &Vector3<f64>) -> f64 {
        let body = &self.bodies[k];
        let most = body.moments.iter().flatten().fold(0.0, |m: f64, i| m.max(*i));
        if body.pushed { 0.0 } else { arm.norm() / most }
    }

    /// How far moments are off what stops turning, or opposes it at their bounds, as a velocity of the contact
    /// point, m/s.
    pub(super) fn moment_off(&self, step: &Step, touch: &Seen) -> f64 {
        let sides = || touch.sides().filter(|side| !self.bodies[side.0].pushed);
        let spin: Vector3<f64> = touch.sides().map(|(k, s, _)| self.spin(step, k) * s).sum();
        let n = &touch.normal;
        let [twist, twisted] = [spin, touch.moment].map(|v| n * v.dot(n));
        let parts = [(spin - twist, touch.moment - twisted), (twist, twisted)];
        let mut most = 0.0_f64;
        for ((spin, moment), length) in parts.into_iter().zip(self.case.rolling) {
            let Some(axis) = spin.try_normalize(0.0) else { continue };
            let gives = |(k, _, arm): (usize, f64, Vector3<f64>)| {
                let own = self.bodies[k].spin(&step.before[k].pose.r, &axis).dot(&axis);
                [own, own * arm.norm()]
            };
            let [turns, moves] = sides().map(gives).fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d]);
            if turns == 0.0 {
                continue;
            }
            let (wanted, bound) = (moment - spin / turns, length * touch.rest);
            let nearest = if wanted.norm() > bound { wanted.normalize() * bound } else { wanted };
            most = most.max((moment - nearest).norm() * moves);
        }
        most
    }
}
