//! Conjugate gradients: solves with products alone, where a factor would not fit.
//!
//! ```text
//! (m M + a d2V(q)) x = r,      preconditioned by the diagonal
//! ```
//! Only products with the matrix are formed, block by block ([`ProductSink`]). The matrix must be
//! positive definite; a direction in which it is not ends the iteration with an error, as does the
//! bound on the iterations. The residual that is reported is computed at the end, `r - A x`, and not
//! carried along. Takes its memory anew at every call: one call is thousands of products.

use std::fmt;

use faer::dyn_stack::{MemStack, StackReq};
use faer::matrix_free::conjugate_gradient::{
    CgError, CgParams, conjugate_gradient, conjugate_gradient_scratch,
};
use faer::matrix_free::{InitialGuessStatus, LinOp, Precond};
use faer::{ColRef, MatMut, MatRef, Par};

use crate::hessian_solver::Diagonal;
use crate::sparse::SparseError;
use crate::sparse::scratch::Scratch;
use crate::{Metric, Potential, ProductSink, SizeError};

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradient {
    /// Residuals up to this, relative to the right-hand side, are small enough.
    pub tolerance: f64,
    /// No more products than this.
    pub iterations: usize,
}

/// What a solve did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradientReport {
    /// Products with the matrix, but for the one that checks the residual.
    pub iterations: usize,
    /// The length of `r - A x` relative to that of r.
    pub relative_residual: f64,
}

/// The matrix `m M + a d2V(q)`, as what it does to a vector.
struct HessianProduct<'a, M, P> {
    m: f64,
    metric: &'a M,
    a: f64,
    potential: &'a P,
    q: &'a [f64],
}
