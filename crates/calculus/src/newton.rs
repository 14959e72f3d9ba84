//! Newton's method, bounded, with a line search and a record of what happened.
//!
//! ```text
//! solve  df(x) delta = -f(x),    x <- x + t delta,    t = 1, 1/2, 1/4, ...  (notes 4.4)
//! ```
//! `x` the unknowns (n), `f` the residual (n), `df` its differential (n x n) or what the caller takes
//! for it. The notes' loop has no bound and no line search (errata 4.4); this one has both, so that
//! it always ends: with a solution, or with a [`NewtonError`] that holds the residual of every iterate.
//!
//! A full step that halves the residual is taken as it is. Otherwise the step is shortened until the
//! equation's energy falls enough (Armijo's condition), or the residual where there is no energy; an
//! equation that is a minimization asks for the energy to fall at every step ([`Merit`]).
//! The iteration ends at the caller's tolerance, or where rounding lets the residual fall no
//! further; with a tolerance of zero every solve runs to rounding.
//!
//! Convergence is quadratic near a simple root; at a double root g(x)^2 = 0 each step only halves
//! the error; where there is no root, the bound on the iterations or the line search ends the search.
//! It knows nothing of matrices: solving the linearized equation is the equation's own business.

use std::fmt;

use crate::{Storage, first_non_finite};

/// An equation f(x) = 0 in n unknowns that can be linearized.
pub trait Equation {
    /// Writes f(x).
    fn residual(&mut self, x: &[f64], f: &mut [f64]);

    /// Replaces `f` by `df(x)^-1 f`.
    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable>;

    /// The size of a residual, in the units of the tolerance.
    fn norm(&mut self, f: &[f64]) -> f64;

    /// The energy whose differential is f, where there is one.
    fn energy(&mut self, x: &[f64]) -> Option<f64>;

    /// What a step must lower.
    fn merit(&self) -> Merit {
        Merit::Residual
    }
}

/// What a step must lower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Merit {
    /// The residual by half; or, where a step does not, the energy, or the residual by a little.
    /// Finds any root, at the price of no energies where all goes well.
    #[default]
    Residual,
    /// The energy, at every step that descends. Finds a minimum, not a maximum or a saddle.
    Energy,
}

/// The linearized equation has no solution that can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Unsolvable {
    /// A pivot vanished.
    #[error("the linearized equation is singular to working precision")]
    Singular,
    /// The linearization overflowed, or was evaluated outside its domain.
    #[error("the linearized equation has numbers that are not finite")]
    NonFinite,
    /// A Hessian or Jacobian must visit the same blocks in the same order as when it was analysed.
    #[error("block {block} of the linearization is not where it was when its pattern was analysed")]
    PatternChanged {
        /// The first block that differs, counted from 0.
        block: usize,
    },
    /// The factorization was finished, but what it gives does not solve the equation.
    #[error("the linearized equation was solved with a relative residual of {relative_residual:e}")]
    Untrusted {
        /// The best residual that refinement reached, relative to the right-hand side.
        relative_residual: f64,
    },
}

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Newton {
    /// Residuals up to this size are small enough, in the units of [`Equation::norm`].
    pub tolerance: f64,
    /// No more steps than this.
    pub iterations: usize,
}

impl Default for Newton {
    /// To rounding, within 50 iterations.
    fn default() -> Self {
        Newton { tolerance: 0.0, iterations: 50 }
    }
}

/// What a solve did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct NewtonReport {
    /// Newton steps taken, each one linear solve.
    pub iterations: u32,
    /// Residuals evaluated.
    pub residuals: u32,
    /// Energies evaluated by the line search.
    pub energies: u32,
    /// Size of the residual at the solution.
    pub residual: f64,
    /// What ended the search.
    pub end: NewtonEnd,
}

/// What ended a successful search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NewtonEnd {
    /// The residual is within the tolerance.
    #[default]
    Tolerance,
    /// The steps are rounding: no residual can be told from a smaller one.
    Rounding,
}

/// Why a solve failed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NewtonFailure {
    /// The bound on the iterations was reached.
    NotConverged,
    /// No step length lets the energy or the residual fall.
    Stalled,
    /// The linearized equation was not solved.
    Unsolvable(Unsolvable),
    /// The residual at the initial guess, or a Newton step, is not finite at this unknown.
    NonFinite(usize),
}

impl fmt::Display for NewtonFailure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            NewtonFailure::NotConverged => f.write_str("reached its bound on the iterations"),
            NewtonFailure::Stalled => f.write_str("found no step that makes progress"),
            NewtonFailure::Unsolvable(why) => write!(f, "stopped: {why}"),
            NewtonFailure::NonFinite(i) => write!(f, "met a non-finite number at unknown {i}"),
        }
    }
}

/// A failed solve, with the size of the residual at each iterate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("Newton's method {failure}; residuals {history:?}")]
pub struct NewtonError {
    /// What failed.
    pub failure: NewtonFailure,
    /// The residual's size at the initial guess and after each step.
    pub history: Vec<f64>,
}

/// The memory of a solve, so that solving again allocates nothing.
#[derive(Clone, Debug)]
pub struct NewtonMemory<C> {
    residual: C,
    step: C,
    trial: C,
    history: Vec<f64>,
}

impl<C: Storage> NewtonMemory<C> {
    /// Memory for `n` unknowns and a bound of `iterations`; `None` where C holds another number.
    pub fn new(n: usize, iterations: usize) -> Option<Self> {
        let zeros = C::zeros(n)?;
        Some(NewtonMemory {
            residual: zeros.clone(),
            step: zeros.clone(),
            trial: zeros,
            history: Vec::with_capacity(iterations + 1),
        })
    }

    /// The residual's size at the initial guess and after each step of the last solve.
    pub fn history(&self) -> &[f64] {
        &self.history
    }

    fn error(&self, failure: NewtonFailure) -> NewtonError {
        NewtonError { failure, history: self.history.clone() }
    }
}

/// Armijo's constant: the part of the predicted fall that a step must reach.
const SUFFICIENT: f64 = 1e-4;
/// Step lengths tried: down to 2^-30, below which progress could not be told from rounding.
const HALVINGS: i32 = 30;
/// Steps of this size relative to x are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Steps of this size relative to x are so small that a residual which no longer falls is rounding.
const NEARLY: f64 = 1e-9;
/// So are steps of this size relative to the guess, where the solution itself is close to zero.
const NEARLY_OF_GUESS: f64 = 1e-12;
/// A residual that stays the same over this many such steps is rounding as well.
const STANDSTILL: usize = 3;
/// Energies that differ by this much, relatively, cannot be told apart.
const SAME_ENERGY: f64 = 16.0 * f64::EPSILON;

impl Newton {
    /// Solves f(x) = 0 from the guess in `x`, where the solution is left. On failure `x` holds the
    /// last iterate.
    pub fn solve<C: Storage>(
        &self,
        equation: &mut impl Equation,
        x: &mut [f64],
        memory: &mut NewtonMemory<C>,
    ) -> Result<NewtonReport, NewtonError> {
        let mut report = NewtonReport { residuals: 1, ..NewtonReport::default() };
        let guess = largest(x);
        memory.history.clear();
        equation.residual(x, memory.residual.as_mut());
        let mut size = equation.norm(memory.residual.as_ref());
        memory.history.push(size);
        if !size.is_finite() {
            let unknown = first_non_finite(memory.residual.as_ref()).unwrap_or(0);
            return Err(memory.error(NewtonFailure::NonFinite(unknown)));
        }
        while size > self.tolerance {
            if report.iterations as usize >= self.iterations {
                return Err(memory.error(NewtonFailure::NotConverged));
            }
            memory.step.clone_from(&memory.residual);
            if let Err(why) = equation.solve(x, memory.step.as_mut()) {
                return Err(memory.error(NewtonFailure::Unsolvable(why)));
            }
            if let Some(unknown) = first_non_finite(memory.step.as_ref()) {
                return Err(memory.error(NewtonFailure::NonFinite(unknown)));
            }
            report.iterations += 1;
            let longest = largest(memory.step.as_ref());
            let nearly = longest <= (NEARLY * largest(x)).max(NEARLY_OF_GUESS * guess);
            let found = search(equation, x, size, nearly, memory, &mut report);
            match found {
                Some(new_size) => {
                    x.copy_from_slice(memory.trial.as_ref());
                    size = new_size;
                    memory.history.push(size);
                }
                None if nearly => {}
                None => return Err(memory.error(NewtonFailure::Stalled)),
            }
            let stands = nearly && stands_still(&memory.history);
            let rounding = found.is_none() || stands || longest <= ROUNDING * largest(x);
            if rounding && size > self.tolerance {
                // A residual larger than at the guess is no rounding, but the end of a fall.
                if size > memory.history[0] {
                    return Err(memory.error(NewtonFailure::Stalled));
                }
                report.end = NewtonEnd::Rounding;
                break;
            }
        }
        report.residual = size;
        Ok(report)
    }
}

/// Leaves an acceptable next iterate in `memory.trial`, its residual in `memory.residual`, and
/// returns the residual's size. Where there is none, `memory.residual` is that of a rejected trial.
fn search<C: Storage>(
    equation: &mut impl Equation,
    x: &[f64],
    size: f64,
    nearly: bool,
    memory: &mut NewtonMemory<C>,
    report: &mut NewtonReport,
) -> Option<f64> {
    // The energy changes at this rate along the step, if f is its differential.
    let slope = -dot(memory.residual.as_ref(), memory.step.as_ref());
    let must_lower_energy = equation.merit() == Merit::Energy && slope < 0.0;
    let mut start_energy = None;
    for halving in 0..=if nearly { 0 } else { HALVINGS } {
        let t = 0.5_f64.powi(halving);
        for ((trial, x), step) in memory.trial.as_mut().iter_mut().zip(x).zip(memory.step.as_ref())
        {
            *trial = x - t * step;
        }
        equation.residual(memory.trial.as_ref(), memory.residual.as_mut());
        report.residuals += 1;
        let new_size = equation.norm(memory.residual.as_ref());
        if !new_size.is_finite() {
            continue;
        }
        let halved = new_size <= 0.5 * size && !must_lower_energy;
        if halved || (nearly && new_size <= size) {
            return Some(new_size);
        }
        if start_energy.is_none() && slope < 0.0 {
            start_energy = equation.energy(x);
            report.energies += u32::from(start_energy.is_some());
        }
        let less = new_size <= (1.0 - SUFFICIENT * t) * size;
        let enough = match start_energy {
            Some(start) => {
                report.energies += 1;
                equation.energy(memory.trial.as_ref()).is_some_and(|energy| {
                    energy <= start + SUFFICIENT * t * slope
                        || (less && energy <= start + SAME_ENERGY * start.abs())
                })
            }
            None => less,
        };
        if enough {
            return Some(new_size);
        }
    }
    None
}

/// Whether the last residuals are all of one size: around a solution at zero no step is small
/// relative to it.
fn stands_still(history: &[f64]) -> bool {
    let last = history.len().saturating_sub(STANDSTILL + 1);
    history.len() > STANDSTILL && history[last..].windows(2).all(|pair| pair[0] == pair[1])
}

#[inline]
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// The Euclidean length, not a number if any component is none.
pub(crate) fn length(x: &[f64]) -> f64 {
    dot(x, x).sqrt()
}

#[inline]
fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::FunctionEquation;

    /// The root, the report and the residuals' history of one equation in one unknown.
    fn root(
        newton: Newton,
        guess: f64,
        f: impl FnMut(f64) -> f64,
        df: impl FnMut(f64) -> f64,
    ) -> (f64, Result<NewtonReport, NewtonError>, Vec<f64>) {
        let (mut f, mut df) = (f, df);
        let mut equation = FunctionEquation::new(
            1,
            |x: &[f64], value: &mut [f64]| value[0] = f(x[0]),
            |x: &[f64], value: &mut [f64]| value[0] = df(x[0]),
        );
        let mut memory = NewtonMemory::<[f64; 1]>::new(1, newton.iterations).unwrap();
        let mut x = [guess];
        let report = newton.solve(&mut equation, &mut x, &mut memory);
        (x[0], report, memory.history().to_vec())
    }

    #[test]
    fn convergence_to_a_simple_root_is_quadratic() {
        // x^2 + y^2 = 4, x y = 1, with x > y > 0.
        let exact = [(2.0 + 3.0_f64.sqrt()).sqrt(), (2.0 - 3.0_f64.sqrt()).sqrt()];
        let mut errors = Vec::new();
        let mut equation = FunctionEquation::new(
            2,
            |x: &[f64], f: &mut [f64]| {
                f.copy_from_slice(&[x[0] * x[0] + x[1] * x[1] - 4.0, x[0] * x[1] - 1.0]);
            },
            |x: &[f64], df: &mut [f64]| {
                errors.push((x[0] - exact[0]).hypot(x[1] - exact[1]));
                df.copy_from_slice(&[2.0 * x[0], x[1], 2.0 * x[1], x[0]]);
            },
        );
        let mut memory = NewtonMemory::<[f64; 2]>::new(2, 20).unwrap();
        let mut x = [2.5, 0.2];
        let report = Newton::default().solve(&mut equation, &mut x, &mut memory).unwrap();
        assert!((x[0] - exact[0]).hypot(x[1] - exact[1]) < 1e-15);
        assert!(report.iterations <= 7, "{report:?}");
        let orders: Vec<f64> = errors
            .windows(3)
            .filter(|e| e[0] < 0.3 && e[2] > 1e-14)
            .map(|e| (e[2] / e[1]).ln() / (e[1] / e[0]).ln())
            .collect();
        let order = orders.last().unwrap();
        assert!((order - 2.0).abs() < 0.1, "order {order}, errors {errors:?}");
    }

    #[test]
    fn each_step_towards_a_double_root_halves_the_error() {
        let mut errors = Vec::new();
        let newton = Newton { tolerance: 1e-16, iterations: 50 };
        // g(x)^2 with g = x^2 - 2.
        let g = |x: f64| x * x - 2.0;
        let (x, report, history) = root(
            newton,
            2.0,
            |x| g(x).powi(2),
            |x| {
                errors.push(x - 2.0_f64.sqrt());
                4.0 * x * g(x)
            },
        );
        let iterations = report.unwrap().iterations;
        assert!((20..=30).contains(&iterations), "{iterations}");
        assert!((x - 2.0_f64.sqrt()).abs() < 1e-8);
        let last = &errors[errors.len() - 5..];
        for pair in last.windows(2) {
            assert!((pair[1] / pair[0] - 0.5).abs() < 1e-3, "{errors:?}");
        }
        for pair in history[history.len() - 5..].windows(2) {
            assert!((pair[1] / pair[0] - 0.25).abs() < 1e-3, "{history:?}");
        }
    }

    #[test]
    fn an_equation_without_a_root_ends_with_a_typed_failure_and_its_history() {
        for guess in [-3.0, -0.1, 1e-3, 0.7, 1e6] {
            let newton = Newton { tolerance: 1e-12, iterations: 40 };
            let (_, result, _) = root(newton, guess, |x| x * x + 1.0, |x| 2.0 * x);
            let error = result.unwrap_err();
            assert!(
                matches!(error.failure, NewtonFailure::Stalled | NewtonFailure::NotConverged),
                "{error}"
            );
            assert!(error.history.len() <= 41);
            assert_eq!(error.history[0], guess * guess + 1.0);
            assert!(error.history.windows(2).all(|pair| pair[1] < pair[0]));
        }
    }

    #[test]
    fn a_vanishing_derivative_is_singular() {
        let (_, result, _) = root(Newton::default(), 0.0, |x| x * x + 1.0, |x| 2.0 * x);
        let error = result.unwrap_err();
        assert_eq!(error.failure, NewtonFailure::Unsolvable(Unsolvable::Singular));
        assert_eq!(error.history, [1.0]);
    }

    #[test]
    fn a_guess_outside_of_the_domain_is_refused() {
        for guess in [-1.0, f64::NAN, f64::INFINITY] {
            let (_, result, _) = root(Newton::default(), guess, f64::ln, f64::recip);
            assert_eq!(result.unwrap_err().failure, NewtonFailure::NonFinite(0));
        }
    }

    #[test]
    fn steps_out_of_the_domain_are_shortened() {
        // The full step from 3 leads to 3 - 3 ln 3 < 0, where the logarithm is not defined.
        let (x, report, _) = root(Newton::default(), 3.0, f64::ln, f64::recip);
        let report = report.unwrap();
        assert!((x - 1.0).abs() < 1e-15);
        assert!(report.residuals > report.iterations + 1);
        assert_eq!(report.energies, 0, "there is no energy to evaluate");
    }

    #[test]
    fn the_line_search_rescues_the_arc_tangent_from_a_far_guess() {
        // Without it the iteration diverges from |x| > 1.3917.
        for guess in [1.4, -10.0, 1e4] {
            let (mut f, mut x) = (f64::atan(guess), guess);
            for _ in 0..4 {
                x -= f * (1.0 + x * x);
                f = x.atan();
            }
            assert!(x.abs() > guess.abs(), "plain Newton should diverge from {guess}");
            let (x, report, _) =
                root(Newton::default(), guess, f64::atan, |x| (1.0 + x * x).recip());
            assert!(x.abs() < 1e-15, "{x}");
            assert!(report.unwrap().iterations < 20);
        }
    }

    #[test]
    fn a_derivative_of_the_wrong_sign_stalls() {
        let (_, result, _) = root(Newton::default(), 1.0, |x| x.powi(3) - 8.0, |x| -3.0 * x * x);
        assert_eq!(result.unwrap_err().failure, NewtonFailure::Stalled);
    }

    #[test]
    fn the_bound_on_the_iterations_is_kept() {
        let newton = Newton { tolerance: 0.0, iterations: 3 };
        let (_, result, history) = root(newton, 100.0, |x| x * x - 2.0, |x| 2.0 * x);
        assert_eq!(result.unwrap_err().failure, NewtonFailure::NotConverged);
        assert_eq!(history.len(), 4);
    }

    #[test]
    fn a_residual_within_the_tolerance_costs_no_step() {
        let newton = Newton { tolerance: 0.5, iterations: 0 };
        let (x, report, _) = root(newton, 1.5, |x| x * x - 2.0, |x| 2.0 * x);
        assert_eq!((x, report.unwrap().iterations), (1.5, 0));
    }

    /// A step towards a point mass, `x - y + a/x^2 = 0`, with the energy `1/2 (x - y)^2 - a/x`, which has
    /// no lower bound: where it is not convex, the step is shifted to descend.
    struct Fall {
        y: f64,
        a: f64,
    }

    impl Equation for Fall {
        fn residual(&mut self, x: &[f64], f: &mut [f64]) {
            f[0] = x[0] - self.y + self.a / x[0].powi(2);
        }

        fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
            let curvature = 1.0 - 2.0 * self.a / x[0].powi(3);
            f[0] /= curvature.abs();
            Ok(())
        }

        fn norm(&mut self, f: &[f64]) -> f64 {
            f[0].abs()
        }

        fn energy(&mut self, x: &[f64]) -> Option<f64> {
            Some(0.5 * (x[0] - self.y).powi(2) - self.a / x[0])
        }
    }

    #[test]
    fn falling_into_an_abyss_of_the_energy_is_a_failure() {
        // The equation has a root as long as y >= 3 (a/4)^(1/3).
        let a = 1e-4;
        let fold = 3.0 * (a / 4.0_f64).cbrt();
        for (factor, solvable) in [(2.0, true), (1.01, true), (0.99, false), (0.5, false)] {
            let mut x = [factor * fold];
            let mut memory = NewtonMemory::<[f64; 1]>::new(1, 200).unwrap();
            let newton = Newton { tolerance: 0.0, iterations: 200 };
            let mut fall = Fall { y: x[0], a };
            let result = newton.solve(&mut fall, &mut x, &mut memory);
            assert_eq!(result.is_ok(), solvable, "{factor}: {result:?} at {x:?}");
        }
    }

    #[test]
    fn a_residual_that_stands_still_at_a_root_near_zero_is_rounding() {
        // What is left of p = (x - q)/h is too small to move x - q, but not too small to move x.
        let h = 0.01;
        for k in 1..100 {
            let q = 0.01 + 1e-4 * f64::from(k);
            let p = -q / h * (1.0 + 2.0 * f64::EPSILON);
            let (x, report, _) = root(Newton::default(), q, |x| (x - q) / h - p, |_| 1.0 / h);
            assert!(x.abs() < 1e-15, "{x}");
            assert!(report.unwrap().iterations < 12);
        }
    }

    #[test]
    fn a_root_at_zero_among_rounding_noise_is_found() {
        // Near x = 0 the residual is the rounding noise of two forces of size 1e3.
        let f = |x: f64| (1e3 + x) * (1.0 + x / 3e3) - (1e3 - x) * (1.0 - x / 7e3);
        let df = |x: f64| 2.0 + 1e3 / 3e3 + 1e3 / 7e3 + x * (2.0 / 3e3 - 2.0 / 7e3);
        for k in 1..100 {
            let guess = 0.1 * k as f64;
            let (x, report, _) = root(Newton::default(), guess, f, df);
            assert!(x.abs() < 1e-13, "{x}");
            report.unwrap();
        }
    }
}
