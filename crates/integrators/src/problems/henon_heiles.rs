//! A star in the plane of a galaxy that is not quite round: regular at low energy, chaotic above.
//!
//! ```text
//! V(x, y) = 1/2 (x^2 + y^2) + x^2 y - 1/3 y^3,      bound for E < 1/6
//! ```
//! It starts at the centre, along (4, 3). It has no closed solution. Up to E = 1/12 or so almost
//! every orbit is regular; near 1/6 almost every one is chaotic. Source: Henon, Heiles, The
//! applicability of the third integral of motion, The Astronomical Journal 69 (1964) 73-79.

use std::f64::consts::TAU;

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};

use super::{Problem, ProblemError, SmallProblem, within};
use crate::State;

/// The potential of Henon and Heiles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HenonHeilesPotential;

impl Potential for HenonHeilesPotential {
    fn dim(&self) -> usize {
        2
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let (x, y) = (q[0], q[1]);
        0.5 * (x * x + y * y) + y * (x * x - y * y / 3.0)
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let (x, y) = (q[0], q[1]);
        dv.0[0] += x + 2.0 * x * y;
        dv.0[1] += y + x * x - y * y;
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let (x, y) = (2.0 * q[0], 2.0 * q[1]);
        hessian.add_symmetric(&[0, 1], &[1.0 + y, x, x, 1.0 - y]);
    }
}

/// The star of this energy in (0, 1/6), over about thirty turns.
///
/// # Errors
/// [`ProblemError::Parameter`] for another energy.
pub fn henon_heiles(energy: f64) -> Result<SmallProblem<HenonHeilesPotential, 2>, ProblemError> {
    within("the energy", energy, "(0, 1/6)", 0.0..1.0 / 6.0)?;
    let speed = (2.0 * energy).sqrt();
    Ok(Problem {
        name: "henon-heiles",
        system: System::new(DiagonalMetric::new([1.0; 2])?, HenonHeilesPotential)?,
        initial: State::new([0.0, 0.0], Covector([0.8 * speed, 0.6 * speed])),
        horizon: 200.0,
        period: TAU,
        scale: 1.0,
        solution: Box::new(|_| None),
        solution_error: f64::INFINITY,
    })
}

#[cfg(test)]
mod tests {
    use std::ops::ControlFlow;

    use stationary_calculus::assert_derivatives;

    use super::*;
    use crate::{Nystrom12, Tolerance};

    #[test]
    fn the_derivatives_are_those_of_the_energy() {
        assert_derivatives(&HenonHeilesPotential, &[0.3, -0.2]);
    }

    #[test]
    fn the_star_stays_in_its_triangle_and_keeps_its_energy() {
        for energy in [1.0 / 12.0, 1.0 / 8.0, 0.166] {
            let problem = henon_heiles(energy).unwrap();
            assert!((problem.energy(&problem.initial) - energy).abs() < 1e-16);
            let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
            let mut nystrom = Nystrom12::new(&problem.system, tolerance.into()).unwrap();
            let mut state = problem.initial.clone();
            let seen = nystrom.run(&mut state, problem.horizon, |step| {
                let [x, y] = step.after.q;
                // The equipotential of 1/6 is a triangle: (0, 1) and (+-sqrt 3/2, -1/2).
                assert!(y > -0.5 && 3.0_f64.sqrt() * x.abs() + y < 1.0);
                assert!((problem.energy(step.after) - energy).abs() < 1e-11);
                ControlFlow::Continue(())
            });
            assert!(seen.unwrap().steps > 50);
        }
    }

    #[test]
    fn neighbours_part_exponentially_at_high_energy_and_linearly_at_low() {
        let apart = |energy: f64| {
            let problem = henon_heiles(energy).unwrap();
            let end = |shift: f64| {
                let tolerance = Tolerance::new(1e-13, 1e-13).unwrap();
                let mut nystrom = Nystrom12::new(&problem.system, tolerance.into()).unwrap();
                let mut state = problem.initial.clone();
                state.q[0] += shift;
                nystrom.run(&mut state, 1000.0, |_| ControlFlow::Continue(())).unwrap();
                state.q
            };
            let (a, b) = (end(0.0), end(1e-9));
            (a[0] - b[0]).hypot(a[1] - b[1]) / 1e-9
        };
        let (regular, chaotic) = (apart(0.02), apart(0.16));
        assert!(regular < 1e3 && chaotic > 1e6, "{regular:e} {chaotic:e}");
    }
}
