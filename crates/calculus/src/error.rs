//! What can go wrong in this crate, one enum or struct for each kind of input.

use crate::Readable;

/// Two things that must have the same size do not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{what}: expected {expected}, got {got}")]
pub struct SizeError {
    /// What has the wrong size.
    pub what: &'static str,
    /// The size it must have.
    pub expected: usize,
    /// The size it has.
    pub got: usize,
}

impl SizeError {
    /// An error unless the two sizes agree.
    ///
    /// # Errors
    /// Sizes that differ.
    pub fn check(what: &'static str, expected: usize, got: usize) -> Result<(), SizeError> {
        if expected == got { Ok(()) } else { Err(SizeError { what, expected, got }) }
    }
}

/// A mass that is no metric.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MetricError {
    /// A mass must be positive and finite, and so must be its inverse.
    #[error(
        "the mass of freedom {freedom} is {mass:?}; it must be positive and finite, and at least \
         5.6e-309, below which its inverse overflows"
    )]
    NotAMass {
        /// The freedom.
        freedom: usize,
        /// Its mass, kg.
        mass: f64,
    },
    /// A mass matrix must be square.
    #[error("the mass matrix is {rows} x {columns}, not square")]
    NotSquare {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// A mass matrix must be finite and symmetric.
    #[error(
        "the mass matrix is not symmetric: entry ({row}, {column}) is {entry}, its mirror image {mirror}",
        entry = Readable(entry), mirror = Readable(mirror)
    )]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        entry: f64,
        /// The entry at (column, row).
        mirror: f64,
    },
    /// Kinetic energy must be positive for every velocity but zero.
    #[error("the mass matrix is not positive definite")]
    NotPositiveDefinite,
}
