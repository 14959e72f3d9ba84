//! The right-hand side of a first-order system.
//!
//! ```text
//! M y' = f(t, y),      J = df/dy
//! ```
//! `y` the state (n), `t` the time in seconds, `f` n numbers, `J` n x n, `M` a constant n x n
//! matrix, the identity unless said otherwise. Matrices are stored by columns.

use std::fmt;

/// What a field knows of its Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Jacobian {
    /// It was written, all n x n entries of it.
    Written,
    /// It is not known; an implicit method takes differences of f instead.
    Unknown,
}

/// A right-hand side f(t, y), with the matrix in front of y'.
pub trait VectorField {
    /// The number n of unknowns.
    fn dim(&self) -> usize;

    /// Writes f(t, y).
    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]);

    /// Writes df/dy at (t, y) by columns: entry (i, j) at `i + n * j`. What it gets wrong costs an
    /// implicit method iterations, not correctness.
    fn jacobian(&self, _t: f64, _y: &[f64], _df: &mut [f64]) -> Jacobian {
        Jacobian::Unknown
    }

    /// The constant matrix M by columns, or `None` where it is the identity.
    fn mass(&self) -> Option<&[f64]> {
        None
    }
}

impl<F: VectorField> VectorField for &F {
    #[inline]
    fn dim(&self) -> usize {
        F::dim(self)
    }

    #[inline]
    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        F::evaluate(self, t, y, f);
    }

    fn jacobian(&self, t: f64, y: &[f64], df: &mut [f64]) -> Jacobian {
        F::jacobian(self, t, y, df)
    }

    fn mass(&self) -> Option<&[f64]> {
        F::mass(self)
    }
}

/// A closure as a field: y' = f(t, y) with n unknowns.
///
/// ```
/// use stationary_integrators::{DormandPrince853, FunctionField, Moment, Tolerance, integrate};
/// use std::ops::ControlFlow;
///
/// let decay = FunctionField::new(1, |_t, y: &[f64], f: &mut [f64]| f[0] = -2.0 * y[0]);
/// let start = Moment::new(0.0, [1.0]);
/// let mut method = DormandPrince853::new(&decay, Tolerance::new(1e-10, 1e-12)?.into(), start)?;
/// integrate(&mut method, 1.0, |_| ControlFlow::Continue(()))?;
/// # use stationary_integrators::AdaptiveMethod;
/// assert!((method.moment().y[0] - (-2.0_f64).exp()).abs() < 1e-9);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct FunctionField<F> {
    n: usize,
    function: F,
}

impl<F> fmt::Debug for FunctionField<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("FunctionField").field("n", &self.n).finish_non_exhaustive()
    }
}

impl<F: Fn(f64, &[f64], &mut [f64])> FunctionField<F> {
    /// The field of `n` unknowns that `function` writes.
    pub fn new(n: usize, function: F) -> Self {
        FunctionField { n, function }
    }
}

impl<F: Fn(f64, &[f64], &mut [f64])> VectorField for FunctionField<F> {
    #[inline]
    fn dim(&self) -> usize {
        self.n
    }

    #[inline]
    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        (self.function)(t, y, f);
    }
}
