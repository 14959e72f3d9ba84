//! Newton's method, bounded, with a line search and a record of what happened.
//!
//! ```text
//! solve  df(x) delta = -f(x),    x <- x + t delta,    t = 1, 1/2, 1/4, ...  (notes 4.4)
//! ```
//! `x` the unknowns (n), `f` the residual (n), `df` its differential (n x n) or what the caller takes
//! for it. The notes' loop has no bound and no line search (errata 4.4); this one has both, so that
//! it always ends: with a solution, or with a [`NewtonError`] that holds the residual of every iterate.
//!
//! How far to go along a step is `line_search`'s business: all the way where the residual halves. The
//! iteration ends at the caller's tolerance, or where rounding lets the residual fall no further; with
//! a tolerance of zero every solve runs to rounding.
//!
//! Convergence is quadratic near a simple root; at a double root g(x)^2 = 0 each step only halves
//! the error; where there is no root, the bound on the iterations or the line search ends the search.
//! It knows nothing of matrices: solving the linearized equation is the equation's own business.

mod failure;
mod line_search;
#[cfg(test)]
mod tests;

use crate::{Equation, SizeError, Storage, first_non_finite};
use line_search::{Start, search};

pub use failure::{NewtonError, NewtonFailure};

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

/// The memory of a solve, so that solving again allocates nothing.
#[derive(Clone, Debug)]
pub struct NewtonMemory<C> {
    iterate: Iterate<C>,
    history: Vec<f64>,
}

/// An iterate's residual, the Newton step from there, and the next iterate on trial.
#[derive(Clone, Debug)]
struct Iterate<C> {
    residual: C,
    step: C,
    trial: C,
}

impl<C: Storage> NewtonMemory<C> {
    /// Memory for `n` unknowns and a bound of `iterations`; `None` where C holds another number.
    ///
    /// The history of up to 4,096 iterations is reserved; that of a longer solve grows as it runs.
    pub fn new(n: usize, iterations: usize) -> Option<Self> {
        let zeros = C::zeros(n)?;
        let iterate = Iterate { residual: zeros.clone(), step: zeros.clone(), trial: zeros };
        let reserved = iterations.min(RESERVED) + 1;
        Some(NewtonMemory { iterate, history: Vec::with_capacity(reserved) })
    }

    /// The residual's size at the initial guess and after each step of the last solve.
    pub fn history(&self) -> &[f64] {
        &self.history
    }
}

/// Iterations whose residuals are remembered without taking more memory.
const RESERVED: usize = 4096;
/// Steps of this size relative to x are rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;
/// Steps of this size relative to x are so small that a residual which no longer falls is rounding.
const NEARLY: f64 = 1e-9;
/// So are steps of this size relative to the guess, where the solution itself is close to zero.
const NEARLY_OF_GUESS: f64 = 1e-12;
/// Steps that are small beside the largest unknown, but not each beside its own, are so only where the residual
/// has fallen to this part of the first: unknowns may differ in size, and in what they mean.
const FALLEN: f64 = 1e-8;
/// A residual that stays the same over this many such steps is rounding as well.
const STANDSTILL: usize = 3;
/// And one that changes by less than this part, where an unknown's steps are not small beside itself.
const SLOW: f64 = 1e-2;

impl Newton {
    /// Solves f(x) = 0 from the guess in `x`, where the solution is left. On failure `x` holds the
    /// last iterate.
    ///
    /// Inlined whole into each equation's caller: a few unknowns then never leave the registers.
    ///
    /// # Errors
    /// [`NewtonError`] with what failed and the residuals on the way there: no progress, no solution
    /// of a linearized equation, numbers that are not finite, a tolerance that is negative or none, or
    /// sizes that do not fit.
    #[inline(always)]
    pub fn solve<C: Storage>(
        &self,
        equation: &mut impl Equation,
        x: &mut [f64],
        memory: &mut NewtonMemory<C>,
    ) -> Result<NewtonReport, NewtonError> {
        memory.history.clear();
        if let Err(failure) = self.check(equation, x.len(), memory) {
            return Err(NewtonError { failure, history: Vec::new() });
        }
        let solved = self.iterate(equation, x, &mut memory.iterate, &mut memory.history);
        solved.map_err(|failure| NewtonError { failure, history: memory.history.clone() })
    }

    /// What a solve needs of its settings and sizes.
    #[inline(always)]
    fn check<C: Storage>(
        &self,
        equation: &impl Equation,
        n: usize,
        memory: &NewtonMemory<C>,
    ) -> Result<(), NewtonFailure> {
        self.check_tolerance()?;
        let held = memory.iterate.residual.as_ref().len();
        SizeError::check("the memory's unknowns", n, held).map_err(NewtonFailure::Size)?;
        let unknowns = equation.unknowns().unwrap_or(n);
        SizeError::check("the unknowns", unknowns, n).map_err(NewtonFailure::Size)
    }

    #[inline(always)]
    pub(crate) fn check_tolerance(&self) -> Result<(), NewtonFailure> {
        // So written that NaN is refused.
        if self.tolerance >= 0.0 { Ok(()) } else { Err(NewtonFailure::Tolerance(self.tolerance)) }
    }

    #[inline(always)]
    fn iterate<C: Storage>(
        &self,
        equation: &mut impl Equation,
        x: &mut [f64],
        iterate: &mut Iterate<C>,
        history: &mut Vec<f64>,
    ) -> Result<NewtonReport, NewtonFailure> {
        let mut report = NewtonReport { residuals: 1, ..NewtonReport::default() };
        let guess = largest(x);
        equation.residual(x, iterate.residual.as_mut());
        let first = equation.norm(iterate.residual.as_ref());
        history.push(first);
        if !first.is_finite() {
            let unknown = first_non_finite(iterate.residual.as_ref()).unwrap_or(0);
            return Err(NewtonFailure::NonFinite(unknown));
        }
        let mut size = first;
        while size > self.tolerance {
            if report.iterations as usize >= self.iterations {
                return Err(NewtonFailure::NotConverged);
            }
            iterate.step.clone_from(&iterate.residual);
            equation.solve(x, iterate.step.as_mut()).map_err(NewtonFailure::Unsolvable)?;
            if let Some(unknown) = first_non_finite(iterate.step.as_ref()) {
                return Err(NewtonFailure::NonFinite(unknown));
            }
            report.iterations += 1;
            let longest = largest(iterate.step.as_ref());
            let small = longest <= (NEARLY * largest(x)).max(NEARLY_OF_GUESS * guess);
            let is_of_each =
                |part| size <= FALLEN * first || each_within(part, iterate.step.as_ref(), x);
            let nearly = small && is_of_each(NEARLY);
            let rounds = longest <= ROUNDING * largest(x) && is_of_each(ROUNDING);
            let start = Start { x, size, nearly };
            let found = search(equation, start, iterate, &mut report);
            match found {
                Some(new_size) => {
                    x.copy_from_slice(iterate.trial.as_ref());
                    size = new_size;
                    history.push(size);
                }
                // Not even a part of it lowers the residual.
                None if small => {}
                None => return Err(NewtonFailure::Stalled),
            }
            let stands = small && stands_still(history, if nearly { 0.0 } else { SLOW });
            let rounding = found.is_none() || stands || rounds;
            if rounding && size > self.tolerance {
                // A residual larger than at the guess is no rounding, but the end of a fall.
                if size > first {
                    return Err(NewtonFailure::Stalled);
                }
                report.end = NewtonEnd::Rounding;
                break;
            }
        }
        report.residual = size;
        Ok(report)
    }
}

/// Whether the last residuals are all of one size, but for this part: around a solution at zero no step is
/// small relative to it.
fn stands_still(history: &[f64], part: f64) -> bool {
    let last = history.len().saturating_sub(STANDSTILL + 1);
    let same = |pair: &[f64]| (pair[0] - pair[1]).abs() <= part * pair[0];
    history.len() > STANDSTILL && history[last..].windows(2).all(same)
}

/// Whether each step is at most this part of its own unknown.
#[inline]
fn each_within(part: f64, step: &[f64], x: &[f64]) -> bool {
    step.iter().zip(x).all(|(step, x)| step.abs() <= part * x.abs())
}

#[inline]
fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}
