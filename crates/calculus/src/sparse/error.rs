//! What can go wrong with sparse matrices and their factors.

use crate::{Readable, SizeError, Unsolvable};

/// A solution of a system that is not definite is trusted up to this residual, relative to the
/// right-hand side.
pub(crate) const TRUSTED: f64 = 1e-8;

/// A sparse matrix that cannot be assembled, factored or solved.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SparseError {
    /// A vector, a potential or a matrix has another size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A block names a freedom, a row or a column that does not exist.
    #[error("block {block} names freedom {freedom}, but there are only {freedoms}")]
    UnknownFreedom {
        /// The block, counted from 0 in visiting order.
        block: usize,
        /// The freedom.
        freedom: usize,
        /// How many freedoms there are.
        freedoms: usize,
    },
    /// A block names a freedom twice, so that its entries cannot be told apart.
    #[error("block {block} names freedom {freedom} twice")]
    RepeatedFreedom {
        /// The block, counted from 0 in visiting order.
        block: usize,
        /// The freedom.
        freedom: usize,
    },
    /// A block of k freedoms, at least one, has k x k entries.
    #[error("block {block} has {entries} entries for {freedoms} freedoms")]
    BlockSize {
        /// The block, counted from 0 in visiting order.
        block: usize,
        /// Its entries.
        entries: usize,
        /// Its freedoms.
        freedoms: usize,
    },
    /// The blocks, or entries, are not those that were analysed, in the same order.
    #[error("block {block} is not where it was when the pattern was analysed")]
    PatternChanged {
        /// The first block that differs, counted from 0 in visiting order.
        block: usize,
    },
    /// A matrix was given to a factorization that was analysed for another one.
    #[error("the matrix does not have the pattern that was analysed")]
    OtherPattern,
    /// Indices are 32 bits wide.
    #[error("{what}: {size} is more than 32-bit indices can tell apart")]
    TooLarge {
        /// What is too large.
        what: &'static str,
        /// Its size.
        size: usize,
    },
    /// The factor would not fit into memory.
    #[error("the factor of a matrix of size {size} does not fit into memory")]
    OutOfMemory {
        /// The matrix's size.
        size: usize,
    },
    /// Cholesky's method met a pivot that is not positive.
    #[error("the matrix is not positive definite: its pivot at freedom {freedom} is not positive")]
    NotPositiveDefinite {
        /// The freedom whose elimination failed.
        freedom: usize,
    },
    /// A factorization solves only after it has succeeded.
    #[error("no matrix was factored")]
    NotFactored,
    /// Conjugate gradients need a positive definite matrix.
    #[error("after {iterations} iterations, a direction in which the matrix is not positive")]
    NegativeCurvature {
        /// The iterations before it was met.
        iterations: usize,
    },
    /// A pivot vanished, or no row was left to pivot on.
    #[error("the matrix is singular to working precision")]
    Singular,
    /// The matrix or its factor has a number that is not finite.
    #[error("the matrix or its factor is not finite")]
    NonFinite,
    /// The factorization was finished, but what it gives does not solve the equation.
    #[error(
        "no solution can be trusted: the best has a relative residual of {relative_residual:e}"
    )]
    Untrusted {
        /// The residual relative to the right-hand side, after refinement.
        relative_residual: f64,
    },
    /// The tolerance of an iteration is no number that a residual can reach.
    #[error("the tolerance is {}; it must be zero or positive", Readable(.0))]
    Tolerance(f64),
    /// An iteration was ended by its bound.
    #[error("{iterations} iterations left a relative residual of {relative_residual:e}")]
    NotConverged {
        /// The bound.
        iterations: usize,
        /// The residual relative to the right-hand side.
        relative_residual: f64,
    },
}

impl SparseError {
    /// What Newton's method is told.
    pub(crate) fn unsolvable(self) -> Unsolvable {
        match self {
            SparseError::PatternChanged { block } => Unsolvable::PatternChanged { block },
            SparseError::NonFinite => Unsolvable::NonFinite,
            SparseError::Untrusted { relative_residual } => {
                Unsolvable::Untrusted { relative_residual }
            }
            SparseError::NotConverged { iterations, relative_residual } => {
                Unsolvable::NotConverged { iterations, relative_residual }
            }
            SparseError::NegativeCurvature { iterations } => Unsolvable::NotPositive { iterations },
            SparseError::Size(error) => Unsolvable::Size(error),
            _ => Unsolvable::Singular,
        }
    }
}
