//! Newton's method, bounded, with a line search and a record of what happened.
//!
//! ```text
//! solve  df(x) delta = -f(x),    x <- x + t delta,    t = 1, 1/2, 1/4, ...  (notes 4.4)
//! ```
//! A full step that halves the residual is taken as it is. Otherwise the step is shortened until the
//! equation's energy falls enough (Armijo's condition), or the residual where there is no energy.
//! The iteration ends at the caller's tolerance, or where rounding lets the residual fall no
//! further; with a tolerance of zero every solve runs to rounding.
//!
//! Convergence is quadratic near a simple root; at a double root g(x)^2 = 0 each step only halves
//! the error; where there is no root, the bound on the iterations or the line search ends the search.

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
}

/// The linearized equation has no solution that can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("the linearized equation is singular to working precision")]
pub struct Unsolvable;

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
    /// Size of the last residual.
    pub residual: f64,
}

/// Why a solve failed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NewtonFailure {
    /// The bound on the iterations was reached.
    NotConverged,
    /// No step length lets the energy or the residual fall.
    Stalled,
    /// The linearized equation is singular.
    Singular,
    /// The residual at the initial guess, or a Newton step, is not finite at this unknown.
    NonFinite(usize),
}

/// A failed solve, with the size of the residual at each iterate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("Newton's method {}; residuals {history:?}", describe(*failure))]
pub struct NewtonError {
    /// What failed.
    pub failure: NewtonFailure,
    /// The residual's size at the initial guess and after each step.
    pub history: Vec<f64>,
}

fn describe(failure: NewtonFailure) -> String {
    match failure {
        NewtonFailure::NotConverged => "did not converge".to_owned(),
        NewtonFailure::Stalled => "found no step that makes progress".to_owned(),
        NewtonFailure::Singular => "met a singular linearization".to_owned(),
        NewtonFailure::NonFinite(i) => format!("met a number that is not finite (unknown {i})"),
    }
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
            if equation.solve(x, memory.step.as_mut()).is_err() {
                return Err(memory.error(NewtonFailure::Singular));
            }
            if let Some(unknown) = first_non_finite(memory.step.as_ref()) {
                return Err(memory.error(NewtonFailure::NonFinite(unknown)));
            }
            report.iterations += 1;
            let relative = largest(memory.step.as_ref()) / largest(x).max(f64::MIN_POSITIVE);
            let accepted = self.search(equation, x, size, relative, memory, &mut report);
            let Some(new_size) = accepted else {
                if relative <= NEARLY {
                    break;
                }
                return Err(memory.error(NewtonFailure::Stalled));
            };
            x.copy_from_slice(memory.trial.as_ref());
            size = new_size;
            memory.history.push(size);
            if relative <= ROUNDING {
                break;
            }
        }
        report.residual = size;
        Ok(report)
    }

    /// Leaves an acceptable next iterate in `memory.trial`, its residual in `memory.residual`.
    fn search<C: Storage>(
        &self,
        equation: &mut impl Equation,
        x: &[f64],
        size: f64,
        relative: f64,
        memory: &mut NewtonMemory<C>,
        report: &mut NewtonReport,
    ) -> Option<f64> {
        // The energy falls at this rate along the step, if f is its differential.
        let slope: f64 = -memory
            .residual
            .as_ref()
            .iter()
            .zip(memory.step.as_ref())
            .map(|(f, s)| f * s)
            .sum::<f64>();
        let mut start_energy = None;
        let halvings = if relative <= NEARLY { 0 } else { HALVINGS };
        for halving in 0..=halvings {
            let t = 0.5_f64.powi(halving);
            for ((trial, x), step) in
                memory.trial.as_mut().iter_mut().zip(x).zip(memory.step.as_ref())
            {
                *trial = x - t * step;
            }
            equation.residual(memory.trial.as_ref(), memory.residual.as_mut());
            report.residuals += 1;
            let new_size = equation.norm(memory.residual.as_ref());
            if !new_size.is_finite() {
                continue;
            }
            if new_size <= 0.5 * size || (relative <= NEARLY && new_size <= size) {
                return Some(new_size);
            }
            if start_energy.is_none() && slope < 0.0 {
                start_energy = equation.energy(x);
                report.energies += 1;
            }
            let enough = match start_energy {
                Some(start) => {
                    report.energies += 1;
                    equation
                        .energy(memory.trial.as_ref())
                        .is_some_and(|energy| energy <= start + SUFFICIENT * t * slope)
                }
                None => new_size <= (1.0 - SUFFICIENT * t) * size,
            };
            if enough {
                return Some(new_size);
            }
        }
        None
    }
}

#[inline]
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}
