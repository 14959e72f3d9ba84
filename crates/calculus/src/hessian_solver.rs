//! The linear solve inside every implicit step and every search for an equilibrium.
//!
//! ```text
//! (m M + a d2V(q)) x = r
//! ```
//! `M` the metric and `d2V` the potential's Hessian (n x n, symmetric), `m >= 0` and `a >= 0` their
//! weights, `r` a covector (n), `x` a vector (n). An implicit step has m = 1 and a = h^2 (notes
//! 4.4, bonus math), a minimum of the potential m = 0 and a = 1.
//!
//! The matrix is positive definite near a minimum and for small steps only, so that each solver
//! climbs a ladder and says on which [`Rung`] it stopped:
//!
//! ```text
//! 1  L L^T = m M + a d2V
//! 2  L L^T = (m + sigma) M + a d2V,      sigma = s/500, s/50, ..., 20,000 s
//! 3  P L B L^T P^T = m M + a d2V         sparse only: checked for finite numbers and by its residual
//! ```
//! On the second rung x is not the solution, but it descends: `<r, x> > 0`, so that a step along -x
//! lowers any function whose differential is r. The shift is a multiple of the mass and not of the
//! identity, which would mix units (errata A.1); `s` is the largest row sum of `|A_ij| / sqrt(M_ii M_jj)`,
//! which bounds what a diagonal mass has to make up for.
//!
//! [`DenseSolver`] is for a few freedoms, `SparseSolver` (feature `sparse`) for many. Neither knows
//! who asks.

use crate::{FIXED, Metric, Potential, Sink, Unsolvable};

/// How far up its ladder a solver had to climb. Higher rungs compare greater.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rung {
    /// The matrix is positive definite: x is the solution.
    #[default]
    Cholesky,
    /// The matrix shifted by a multiple of the mass is: x is a direction of descent.
    Shifted {
        /// How many multiples were tried, each ten times the one before.
        tries: u32,
    },
    /// The matrix is indefinite, and x solves it: checked by its residual, and refined.
    Indefinite,
}

/// Solves `(m M + a d2V(q)) x = r` for one metric, potential and configuration after another.
pub trait HessianSolver {
    /// The number of freedoms that the solver was made for, where it says so.
    #[inline]
    fn dim(&self) -> Option<usize> {
        None
    }

    /// Factors `m M + a d2V(q)`.
    ///
    /// # Errors
    /// [`Unsolvable`]: the matrix is singular or not finite, or metric and potential are not those, or
    /// of the size, that the solver was made for.
    fn factor_weighted<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable>;

    /// Factors `M + a d2V(q)`: the matrix of an implicit step.
    ///
    /// # Errors
    /// Those of [`HessianSolver::factor_weighted`].
    #[inline]
    fn factor<M: Metric, P: Potential>(
        &mut self,
        metric: &M,
        potential: &P,
        q: &[f64],
        a: f64,
    ) -> Result<Rung, Unsolvable> {
        self.factor_weighted(1.0, metric, a, potential, q)
    }

    /// Replaces r by x, with the matrix factored last. Where none is, where r has another number of components than
    /// that matrix has rows, where it is indefinite and no x passes the check of its residual, and
    /// where x is too large for a number, every component of x is NaN.
    fn solve(&mut self, r: &mut [f64]);

    /// Why the last solve left NaN, where the solver can tell: an iteration that did not converge.
    #[inline]
    fn unsolved(&self) -> Option<Unsolvable> {
        None
    }

    /// A direction in which the matrix given last is not positive, of a solver whose rung is no proof that there
    /// is none: one that iterates. `None` where the matrix is positive definite, or the rung tells.
    ///
    /// # Errors
    /// [`Unsolvable`] where neither can be told: the matrix is singular, or the bound on the iterations is reached.
    #[inline]
    fn negative_curvature(&mut self) -> Result<Option<Vec<f64>>, Unsolvable> {
        Ok(None)
    }
}

impl<S: HessianSolver> HessianSolver for &mut S {
    #[inline]
    fn dim(&self) -> Option<usize> {
        (**self).dim()
    }

    #[inline]
    fn factor_weighted<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable> {
        (**self).factor_weighted(m, metric, a, potential, q)
    }

    #[inline]
    fn solve(&mut self, r: &mut [f64]) {
        (**self).solve(r);
    }

    #[inline]
    fn unsolved(&self) -> Option<Unsolvable> {
        (**self).unsolved()
    }

    #[inline]
    fn negative_curvature(&mut self) -> Result<Option<Vec<f64>>, Unsolvable> {
        (**self).negative_curvature()
    }
}

/// Shifts by the mass that a ladder tries before it gives the rung up.
pub(crate) const SHIFTS: u32 = 8;

/// The multiple of the mass that is added on the given try, counted from 1. Never the scale itself,
/// which on a diagonal matrix leaves a zero.
pub(crate) fn shift(scale: f64, tries: u32) -> f64 {
    scale * 2e-4 * 10.0_f64.powi(tries as i32)
}

/// The largest of some numbers that are not negative; NaN if any is.
pub(crate) fn largest_or_nan(mut numbers: impl Iterator<Item = f64>) -> f64 {
    let largest = numbers.try_fold(0.0, |largest: f64, x| (!x.is_nan()).then(|| largest.max(x)));
    largest.unwrap_or(f64::NAN)
}

/// Adds `weight` times what it is given to a diagonal, and drops the rest.
pub(crate) struct Diagonal<'a> {
    pub(crate) weight: f64,
    pub(crate) values: &'a mut [f64],
}

impl Sink for Diagonal<'_> {
    #[inline]
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&freedom, entry) in freedoms.iter().zip(block.iter().step_by(freedoms.len() + 1)) {
            if freedom != FIXED {
                self.values[freedom] += self.weight * entry;
            }
        }
    }
}
