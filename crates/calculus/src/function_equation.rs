//! An equation from two functions: the residual, and its Jacobian as a full matrix.
//!
//! ```
//! use stationary_calculus::{FunctionEquation, Newton, NewtonMemory};
//!
//! let mut equation = FunctionEquation::new(
//!     1,
//!     |x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0] - 2.0,
//!     |x: &[f64], df: &mut [f64]| df[0] = 2.0 * x[0],
//! );
//! let mut memory = NewtonMemory::<[f64; 1]>::new(1, 50).unwrap();
//! let mut x = [1.0];
//! let report = Newton::default().solve(&mut equation, &mut x, &mut memory)?;
//! assert!((x[0] - 2.0_f64.sqrt()).abs() < 1e-15);
//! assert!(report.iterations <= 6);
//! # Ok::<(), stationary_calculus::NewtonError>(())
//! ```
//! `df` (n x n by columns, row i and column j the derivative of f_i by x_j) may be an approximation:
//! Newton's method then converges linearly (notes 4.4, "very robust to errors in df"), which is
//! a blessing for quasi-Newton methods and a curse for debugging: see
//! [`newton_against_wrong_derivatives`](crate::newton_against_wrong_derivatives).
//! Not for large sparse Jacobians; those have `SparseEquation` (feature `sparse`).

use crate::dense_lu::DenseLu;
use crate::equation::length;
use crate::{Equation, Unsolvable};

/// The equation f(x) = 0 with the Jacobian df, solved by elimination with row exchanges.
#[derive(Clone, Debug)]
pub struct FunctionEquation<F, D> {
    f: F,
    df: D,
    lu: DenseLu,
}

impl<F: FnMut(&[f64], &mut [f64]), D: FnMut(&[f64], &mut [f64])> FunctionEquation<F, D> {
    /// An equation in `n` unknowns. `f` writes n numbers, `df` n x n by columns, initially zero.
    pub fn new(n: usize, f: F, df: D) -> Self {
        FunctionEquation { f, df, lu: DenseLu::new(n) }
    }
}

impl<F: FnMut(&[f64], &mut [f64]), D: FnMut(&[f64], &mut [f64])> Equation
    for FunctionEquation<F, D>
{
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        (self.f)(x, f);
    }

    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        self.lu.matrix().fill(0.0);
        (self.df)(x, self.lu.matrix());
        self.lu.factor()?;
        self.lu.solve(f);
        Ok(())
    }

    /// The Euclidean length, in the units of f.
    fn norm(&mut self, f: &[f64]) -> f64 {
        length(f)
    }

    fn energy(&mut self, _: &[f64]) -> Option<f64> {
        None
    }

    fn unknowns(&self) -> Option<usize> {
        Some(self.lu.dim())
    }
}
