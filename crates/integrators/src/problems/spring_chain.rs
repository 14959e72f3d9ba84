//! A row of unit masses between walls, on equal linear springs.
//!
//! ```text
//! V(q) = k/2 sum_{i=0..N} (q_i+1 - q_i)^2,      q_0 = q_N+1 = 0
//! modes   u_j(i) = sin(pi i j / (N+1)),   omega_j = 2 sqrt(k) sin(pi j / (2 (N+1))),   j = 1..N
//! q_i(t) = u_1(i) cos(omega_1 t) + RIPPLE u_N(i) cos(omega_N t)
//! ```
//! `q_i` displacements from rest along the row, `k` the stiffness. It starts at rest in the slowest
//! mode, with a ripple of the fastest on it, which vibrates some 2N/pi times as fast: an explicit
//! method must resolve that ripple, `h omega_N < 2` for Stormer-Verlet, an implicit one need not.
//! For any number of masses, sparse and solvable in closed form. Source: notes chapter 6 (modes).

use std::f64::consts::{PI, TAU};

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System};

use super::{LargeProblem, Problem, ProblemError, within};
use crate::State;

/// Amplitude of the fastest mode, relative to the slowest.
const RIPPLE: f64 = 0.01;

/// Equal springs between neighbours in a row and between its ends and walls.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringChain {
    /// The number N of masses.
    pub masses: usize,
    /// The stiffness k of each spring, N/m.
    pub stiffness: f64,
}

impl SpringChain {
    /// The angular frequency of a mode, counted from 1.
    pub fn frequency(&self, mode: usize) -> f64 {
        let angle = 0.5 * PI * mode as f64 / (self.masses + 1) as f64;
        2.0 * self.stiffness.sqrt() * angle.sin()
    }

    /// The displacement of a mass, counted from 0, in a mode, counted from 1.
    fn shape(&self, mode: usize, mass: usize) -> f64 {
        // Whole turns are taken off while they are whole numbers.
        let turn = 2 * (self.masses + 1);
        (PI * ((mode * (mass + 1)) % turn) as f64 / (self.masses + 1) as f64).sin()
    }
}

impl Potential for SpringChain {
    fn dim(&self) -> usize {
        self.masses
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let mut before = 0.0;
        let mut sum = 0.0;
        for &q in q {
            sum += (q - before) * (q - before);
            before = q;
        }
        0.5 * self.stiffness * (sum + before * before)
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let mut tension = self.stiffness * q.first().copied().unwrap_or(0.0);
        for (row, pair) in dv.0.iter_mut().zip(q.windows(2)) {
            let next = self.stiffness * (pair[1] - pair[0]);
            *row += tension - next;
            tension = next;
        }
        if let (Some(row), Some(last)) = (dv.0.last_mut(), q.last()) {
            *row += tension + self.stiffness * last;
        }
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let k = self.stiffness;
        let Some(last) = q.len().checked_sub(1) else { return };
        hessian.add_symmetric(&[0], &[k]);
        for i in 0..last {
            hessian.add_symmetric(&[i, i + 1], &[k, -k, -k, k]);
        }
        hessian.add_symmetric(&[last], &[k]);
    }
}

/// The row of this many masses, at least two, with springs of stiffness `k` (positive), over one
/// turn of the slowest mode.
///
/// # Errors
/// [`ProblemError::Parameter`] for fewer than two masses, or 2^31 and more, and for a stiffness
/// outside of (1e-100, 1e100).
pub fn spring_chain(masses: usize, k: f64) -> Result<LargeProblem<SpringChain>, ProblemError> {
    within("the number of masses", masses as f64, "[2, 2^31)", 1.0..2_f64.powi(31))?;
    within("k", k, "(1e-100, 1e100)", 1e-100..1e100)?;
    let chain = SpringChain { masses, stiffness: k };
    let at = move |t: f64| -> Vec<f64> {
        let mode = |j: usize| (chain.frequency(j) * t).cos();
        let (slow, fast) = (mode(1), RIPPLE * mode(masses));
        (0..masses).map(|i| slow * chain.shape(1, i) + fast * chain.shape(masses, i)).collect()
    };
    let period = TAU / chain.frequency(1);
    Ok(Problem {
        name: "spring-chain",
        system: System::new(DiagonalMetric::new(vec![1.0; masses])?, chain)?,
        initial: State::new(at(0.0), Covector(vec![0.0; masses])),
        horizon: period,
        period,
        scale: (0.5 * (masses + 1) as f64).sqrt(),
        solution: Box::new(move |t| Some(at(t))),
        // The ripple's phase omega_N t is rounded before its cosine is taken.
        solution_error: 1e-15 * masses as f64,
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
        let chain = SpringChain { masses: 4, stiffness: 2.5 };
        assert_derivatives(&chain, &[0.3, -0.2, 0.5, 0.1]);
    }

    #[test]
    fn a_chain_of_no_masses_has_no_second_differential() {
        let chain = SpringChain { masses: 0, stiffness: 2.5 };
        let mut no_room = stationary_calculus::DenseSink::new(1.0, 0, &mut []).unwrap();
        chain.add_hessian(&[], &mut no_room);
    }

    #[test]
    fn each_mode_is_an_eigenvector_of_the_force() {
        for masses in [2, 5, 40] {
            let chain = SpringChain { masses, stiffness: 3.0 };
            for mode in 1..=masses {
                let u: Vec<f64> = (0..masses).map(|i| chain.shape(mode, i)).collect();
                let mut dv = Covector(vec![0.0; masses]);
                chain.add_differential(&u, dv.view_mut());
                let square = chain.frequency(mode).powi(2);
                for (u, dv) in u.iter().zip(&dv.0) {
                    assert!((square * u - dv).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn an_accurate_run_follows_the_closed_form() {
        let problem = spring_chain(30, 100.0).unwrap();
        let tolerance = Tolerance::new(1e-12, 1e-12).unwrap();
        let mut nystrom = Nystrom12::new(&problem.system, tolerance.into()).unwrap();
        let mut state = problem.initial.clone();
        let run = nystrom.run(&mut state, problem.horizon, |step| {
            assert!(problem.error(step.after.t, &step.after.q).unwrap() < 1e-10);
            ControlFlow::Continue(())
        });
        assert!(run.unwrap().steps > 10);
    }
}
