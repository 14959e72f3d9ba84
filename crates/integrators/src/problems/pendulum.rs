//! A pendulum: a unit mass on a unit rod, its angle counted from hanging.
//!
//! ```text
//! V(theta) = -cos theta          (m = L = g = 1)
//! sin(theta/2) = k sn(K(k) - t, k) = k cn(t, k)/dn(t, k),   k = sin(theta_0/2)
//! ```
//! It starts at rest at the angle theta_0; the period is 4 K(k). Source: notes 0.1, 6.1; errata 0.1
//! (from hanging, counterclockwise). Jacobi's functions by the descending Landen transformation
//! (Abramowitz and Stegun 16.4).

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
    let k = (0.5 * theta).sin();
    let scale = AgmScale::new(k);
    let period = 4.0 * scale.quarter_period();
    within("theta", theta, "(0, pi)", 0.0..std::f64::consts::PI)?;
    Ok(Problem {
        name: "pendulum",
        system: System::new(DiagonalMetric::new([1.0; 1])?, PendulumPotential)?,
        initial: State::new([theta], Covector([0.0])),
        horizon: 10.0 * period,
        period,
        scale: theta,
        solution: Box::new(move |t| {
            let quarter = scale.quarter_period();
            let u = t - period * (t / period).round();
            Some([2.0 * (k * scale.sn(quarter - u.abs())).asin()])
        }),
        solution_error: 1e-14,
    })
}

/// Halvings of the arithmetic-geometric mean: it doubles its digits each time.
const HALVINGS: usize = 9;

/// The scale of arithmetic-geometric means that belongs to a modulus k.
#[derive(Clone, Copy)]
struct AgmScale {
    a: [f64; HALVINGS],
    c: [f64; HALVINGS],
}

impl AgmScale {
    fn new(k: f64) -> Self {
        let (mut a, mut c) = ([1.0; HALVINGS], [k; HALVINGS]);
        let mut b = ((1.0 - k) * (1.0 + k)).sqrt();
        for i in 1..HALVINGS {
            a[i] = 0.5 * (a[i - 1] + b);
            c[i] = 0.5 * (a[i - 1] - b);
            b = (a[i - 1] * b).sqrt();
        }
        AgmScale { a, c }
    }

    /// K(k) = pi / (2 AGM).
    fn quarter_period(&self) -> f64 {
        std::f64::consts::FRAC_PI_2 / self.a[HALVINGS - 1]
    }

    /// sn(u, k).
    fn sn(&self, u: f64) -> f64 {
        let last = HALVINGS - 1;
        let mut phi = f64::from(1_u32 << last) * self.a[last] * u;
        for i in (1..HALVINGS).rev() {
            phi = 0.5 * (phi + (self.c[i] / self.a[i] * phi.sin()).asin());
        }
        phi.sin()
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
