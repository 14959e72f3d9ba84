//! A pendulum: a unit mass on a unit rod, its angle counted from hanging.
//!
//! ```text
//! V(theta) = -cos theta          (m = L = g = 1)
//! tan(theta/2) = k sn(u, k) / dn(u, k),    u = K(k) - t,    k = sin(theta_0/2),    k' = cos(theta_0/2)
//! dn^2 = k'^2 + k^2 cn^2
//! ```
//! It starts at rest at the angle theta_0; the period is 4 K(k). Near the top k rounds to 1, so that
//! nothing is computed from `1 - k^2`: all is of k', and angles are those of two sides. Source: notes
//! 0.1, 6.1; errata 0.1 (from hanging, counterclockwise). Jacobi's functions by the descending Landen
//! transformation (Abramowitz and Stegun 16.4).

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};

use super::{Problem, ProblemError, SmallProblem, within};
use crate::State;

/// The potential of a unit pendulum, `-cos theta`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PendulumPotential;

impl Potential for PendulumPotential {
    fn dim(&self) -> usize {
        1
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        -q[0].cos()
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        dv.0[0] += q[0].sin();
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        hessian.add_symmetric(&[0], &[q[0].cos()]);
    }
}

/// The pendulum released at rest from the angle `theta` in (0, pi), radians, for ten periods.
///
/// # Errors
/// [`ProblemError::Parameter`] for another angle.
pub fn pendulum(theta: f64) -> Result<SmallProblem<PendulumPotential, 1>, ProblemError> {
    within("theta", theta, "(0, pi)", 0.0..std::f64::consts::PI)?;
    let scale = AgmScale::new(theta);
    let period = 4.0 * scale.quarter_period();
    let horizon = 10.0 * period;
    Ok(Problem {
        name: "pendulum",
        system: System::new(DiagonalMetric::new([1.0; 1])?, PendulumPotential)?,
        initial: State::new([theta], Covector([0.0])),
        horizon,
        period,
        scale: theta,
        solution: Box::new(move |t| {
            let quarter = scale.quarter_period();
            let u = t - period * (t / period).round();
            Some([scale.angle(quarter - u.abs())])
        }),
        // A time is rounded, and so is the period.
        solution_error: 2.0 * f64::EPSILON * horizon,
    })
}

/// Halvings of the arithmetic-geometric mean: it doubles its digits each time, and at the least k'
/// that there is, 1e-16, the means are alike after 9.
const HALVINGS: usize = 11;

/// The scale of arithmetic-geometric means that belongs to an angle at rest: `a^2 = b^2 + c^2` at
/// each halving, and at the first `a = 1`, `b = k'`, `c = k`.
#[derive(Clone, Copy)]
struct AgmScale {
    a: [f64; HALVINGS],
    b: [f64; HALVINGS],
    c: [f64; HALVINGS],
}

impl AgmScale {
    fn new(theta: f64) -> Self {
        let (k, complement) = (0.5 * theta).sin_cos();
        let (mut a, mut b, mut c) = ([1.0; HALVINGS], [complement; HALVINGS], [k; HALVINGS]);
        for i in 1..HALVINGS {
            a[i] = 0.5 * (a[i - 1] + b[i - 1]);
            b[i] = (a[i - 1] * b[i - 1]).sqrt();
            c[i] = 0.5 * (a[i - 1] - b[i - 1]);
        }
        AgmScale { a, b, c }
    }

    /// K(k) = pi / (2 AGM).
    fn quarter_period(&self) -> f64 {
        std::f64::consts::FRAC_PI_2 / self.a[HALVINGS - 1]
    }

    /// `asin(c/a sin(phi))`, where c/a may round to 1.
    fn arcsine(&self, i: usize, phi: f64) -> f64 {
        let (sine, cosine) = phi.sin_cos();
        (self.c[i] * sine).atan2(self.b[i].hypot(self.c[i] * cosine))
    }

    /// The angle u seconds before or after hanging.
    fn angle(&self, u: f64) -> f64 {
        let last = HALVINGS - 1;
        let mut phi = f64::from(1_u32 << last) * self.a[last] * u;
        for i in (1..HALVINGS).rev() {
            phi = 0.5 * (phi + self.arcsine(i, phi));
        }
        2.0 * self.arcsine(0, phi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_starts_at_rest_and_swings_to_the_other_side() {
        for theta in [1e-3, 1.0, 2.0, 3.1] {
            let problem = pendulum(theta).unwrap();
            let at = |t: f64| (problem.solution)(t).unwrap()[0];
            assert!((at(0.0) - theta).abs() < 1e-13 * theta.max(1.0), "{} {theta}", at(0.0));
            assert!((at(0.5 * problem.period) + theta).abs() < 1e-12);
            assert!(at(0.25 * problem.period).abs() < 1e-13);
        }
    }

    /// Angles, period and the angle after 0.2 periods, by the integrals in 50 digits.
    const REFERENCES: [[f64; 3]; 6] = [
        [0.5, 6.382789697677741, 0.15524904522472383],
        [1.0, 6.699975664370453, 0.31526959812265],
        [3.0, 16.155539372393374, 1.4602536066468121],
        [3.141591653589793, 63.57980839753136, 2.9751780922165376],
        [3.141592643589793, 82.00048911785282, 3.0753096407087677],
        [3.1415926535897927, 148.7456040482612, 3.1392371151879144],
    ];

    #[test]
    fn period_and_solution_are_right_up_to_the_top() {
        for [theta, period, angle] in REFERENCES {
            let problem = pendulum(theta).unwrap();
            assert!((problem.period / period - 1.0).abs() < 1e-15, "{theta}: {}", problem.period);
            let error = problem.error(0.2 * problem.period, &[angle]).unwrap();
            assert!(error < problem.solution_error, "{theta}: {error}");
        }
    }

    #[test]
    fn the_solution_satisfies_the_equation_of_motion() {
        let problem = pendulum(2.0).unwrap();
        let at = |t: f64| (problem.solution)(t).unwrap()[0];
        let h = 1e-3;
        for i in 0..50 {
            let t = 0.17 * f64::from(i) + 0.01;
            let acceleration = (at(t + h) - 2.0 * at(t) + at(t - h)) / (h * h);
            assert!((acceleration + at(t).sin()).abs() < 1e-6, "t = {t}");
        }
    }
}
