//! Six masses between walls, on springs that are stiff and soft in turn: the chain of Fermi, Pasta,
//! Ulam and Tsingou in the form of Hairer, Lubich and Wanner.
//!
//! ```text
//! wall ~ q_1 = q_2 ~ q_3 = q_4 ~ q_5 = q_6 ~ wall         ~ soft and cubic, = stiff and linear
//! V(q) = omega^2/4 sum_{i=1..3} (q_2i - q_2i-1)^2 + sum_{i=0..3} (q_2i+1 - q_2i)^4
//! I_i = 1/4 (p_2i - p_2i-1)^2 + omega^2/4 (q_2i - q_2i-1)^2
//! ```
//! `q_i` displacements from rest, unit masses, `q_0 = q_7 = 0`. The stiff springs vibrate with
//! frequency omega and hand their energies `I_i` on to each other within a time of order omega,
//! while their sum stays near its value: an adiabatic invariant, and the test of methods whose
//! steps do not resolve omega. It has no closed solution. Source: Hairer, Lubich, Wanner, Geometric
//! Numerical Integration, I.5.1, with its initial data.

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2, TAU};

use stationary_calculus::{Covector, DiagonalMetric, Potential, Sink, System, array};

use super::{Problem, ProblemError, SmallProblem, within};
use crate::State;

/// The springs of the chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AlternatingSprings {
    /// The frequency omega of the stiff springs.
    pub frequency: f64,
}

impl AlternatingSprings {
    /// The energies `I_i` of the three stiff springs.
    pub fn oscillatory_energies(&self, state: &State<[f64; 6]>) -> [f64; 3] {
        let pairs = |x: &[f64; 6]| [x[1] - x[0], x[3] - x[2], x[5] - x[4]];
        let (stretch, rate) = (pairs(&state.q), pairs(&state.p.0));
        let stiffness = self.frequency * self.frequency;
        array(|i| 0.25 * (rate[i] * rate[i] + stiffness * stretch[i] * stretch[i]))
    }

    /// How far each of the four soft springs is stretched.
    #[inline]
    fn soft(q: &[f64]) -> [f64; 4] {
        [q[0], q[2] - q[1], q[4] - q[3], -q[5]]
    }
}

impl Potential for AlternatingSprings {
    fn dim(&self) -> usize {
        6
    }

    #[inline]
    fn energy(&self, q: &[f64]) -> f64 {
        let stiff = [q[1] - q[0], q[3] - q[2], q[5] - q[4]].map(|d| d * d).iter().sum::<f64>();
        let soft = Self::soft(q).map(|d| (d * d) * (d * d)).iter().sum::<f64>();
        0.25 * self.frequency * self.frequency * stiff + soft
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let stiffness = 0.5 * self.frequency * self.frequency;
        let soft = Self::soft(q).map(|d| 4.0 * d * d * d);
        for i in 0..3 {
            let stiff = stiffness * (q[2 * i + 1] - q[2 * i]);
            dv.0[2 * i] += soft[i] - stiff;
            dv.0[2 * i + 1] += stiff - soft[i + 1];
        }
    }

    #[inline]
    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        let spring = |k: f64| [k, -k, -k, k];
        let soft = Self::soft(q).map(|d| 12.0 * d * d);
        for i in [0, 2, 4] {
            let stiff = spring(0.5 * self.frequency * self.frequency);
            hessian.add_symmetric(&[i, i + 1], &stiff);
        }
        hessian.add_symmetric(&[0], &[soft[0]]);
        hessian.add_symmetric(&[1, 2], &spring(soft[1]));
        hessian.add_symmetric(&[3, 4], &spring(soft[2]));
        hessian.add_symmetric(&[5], &[soft[3]]);
    }
}

/// The chain whose stiff springs have this frequency (positive), until they have shared energy.
///
/// # Errors
/// [`ProblemError::Parameter`] for a frequency outside of (1e-50, 1e50).
pub fn fermi_pasta_ulam(
    frequency: f64,
) -> Result<SmallProblem<AlternatingSprings, 6>, ProblemError> {
    within("the frequency", frequency, "(1e-50, 1e50)", 1e-50..1e50)?;
    let (near, far) = (1.0 - frequency.recip(), 1.0 + frequency.recip());
    Ok(Problem {
        name: "fermi-pasta-ulam",
        system: System::new(DiagonalMetric::new([1.0; 6])?, AlternatingSprings { frequency })?,
        initial: State::new(
            [near * FRAC_1_SQRT_2, far * FRAC_1_SQRT_2, 0.0, 0.0, 0.0, 0.0],
            Covector([0.0, SQRT_2, 0.0, 0.0, 0.0, 0.0]),
        ),
        horizon: 200.0,
        period: TAU / frequency,
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
        let springs = AlternatingSprings { frequency: 3.0 };
        assert_derivatives(&springs, &[0.3, -0.2, 0.5, 0.1, -0.4, 0.7]);
    }

    #[test]
    fn the_first_stiff_spring_hands_its_energy_on_and_the_sum_stays() {
        let problem = fermi_pasta_ulam(50.0).unwrap();
        let springs = problem.system.potential();
        let [first, second, third] = springs.oscillatory_energies(&problem.initial);
        assert!((first - 1.0).abs() < 1e-12 && second == 0.0 && third == 0.0);
        let tolerance = Tolerance::new(1e-10, 1e-10).unwrap();
        let mut nystrom = Nystrom12::new(&problem.system, tolerance.into()).unwrap();
        let mut state = problem.initial.clone();
        let (mut most, mut least_first) = ([0.0_f64; 3], 1.0_f64);
        let seen = nystrom.run(&mut state, problem.horizon, |step| {
            let now = springs.oscillatory_energies(step.after);
            assert!((now.iter().sum::<f64>() - 1.0).abs() < 0.1, "{now:?}");
            most = std::array::from_fn(|i| most[i].max(now[i]));
            least_first = least_first.min(now[0]);
            ControlFlow::Continue(())
        });
        assert!(seen.is_ok());
        assert!(most[1] > 0.5 && most[2] > 0.5 && least_first < 0.1, "{most:?} {least_first}");
    }
}
