//! What can go wrong on the way to modes.

use stationary_calculus::{EigenError, SizeError, SparseError};

/// Modes that cannot be had.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ModalError {
    /// The configuration is no equilibrium.
    #[error(
        "no equilibrium: |M^-1 dV| is {residual:e} kg^1/2 m/s^2, largest at freedom {freedom}; \
         {tolerance:e} was allowed"
    )]
    NoEquilibrium {
        /// The size of dV in the metric, kg^1/2 m/s^2.
        residual: f64,
        /// The freedom that contributes most.
        freedom: usize,
        /// What the caller allowed.
        tolerance: f64,
    },
    /// More modes than freedoms, or none.
    #[error("{asked} modes were asked for, and there are {there} besides the rigid ones")]
    Count {
        /// How many were asked for.
        asked: usize,
        /// How many there are.
        there: usize,
    },
    /// The mass must be positive definite.
    #[error("the mass is not positive definite: {0}")]
    Mass(SparseError),
    /// No multiple of the mass makes the stiffness positive definite.
    #[error("the stiffness cannot be shifted: {0}")]
    Stiffness(SparseError),
    /// The iteration did not find all modes within its bound.
    #[error("{converged} of {asked} modes converged in {restarts} restarts")]
    NotConverged {
        /// How many did.
        converged: usize,
        /// How many were asked for.
        asked: usize,
        /// The bound.
        restarts: usize,
    },
    /// A number that must be positive, or at least not negative, and finite.
    #[error("{what} is {value}")]
    Parameter {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Vectors of another size than the system.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// The sparse matrices.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// The small dense eigenproblem.
    #[error(transparent)]
    Eigen(#[from] EigenError),
}
