//! Sparse matrices: assembled through stored slots, factored with an order that is found once.
//!
//! ```text
//! blocks -> pattern -> slots -> values -> factor -> solution, with its residual
//! ```
//! The left half is done once, the right half in every step and without allocation. faer does the
//! ordering and the elimination; what is here decides, checks and reports.

mod assembly;
mod block_jacobi;
mod blocked_lu;
mod cholesky;
mod conjugate_gradient;
mod dissection;
mod error;
mod indefinite;
mod inertia;
mod iterative;
mod jacobian;
mod lu;
mod metric;
mod negative_curvature;
mod pattern;
mod refill;
mod scratch;
mod solver;
mod visit;
mod work;

pub use assembly::SymmetricMatrix;
pub(crate) use blocked_lu::BlockedLu;
pub use cholesky::{Ordering, SparseCholesky};
pub use conjugate_gradient::{ConjugateGradient, ConjugateGradientReport};
pub use error::SparseError;
pub use indefinite::{Pivoting, Refined, SparseIndefinite};
pub use inertia::Inertia;
pub use iterative::IterativeSolver;
pub use jacobian::{JacobianEntries, SparseEquation, SparseJacobian};
pub use metric::SparseMetric;
pub use refill::RefillSink;
pub use solver::{Ladder, SparseSolver};
pub use visit::PatternSink;
