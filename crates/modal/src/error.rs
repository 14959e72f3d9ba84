//! What can go wrong on the way to modes.

use stationary_calculus::{EigenError, Readable, SizeError, SparseError};

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
    /// A mode whose residual is too large.
    #[error("mode {mode} has a residual of {residual:e} 1/s^2; {allowed:e} is allowed")]
    Inaccurate {
        /// Which mode, lowest first.
        mode: usize,
        /// `|H v - lambda M v|` measured by `M^-1`, 1/s^2.
        residual: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// Vectors that ought to be orthonormal in the mass.
    #[error(
        "{what} are not orthonormal in the mass: a product is off by {off:e}; {allowed:e} is allowed"
    )]
    NotOrthonormal {
        /// Which vectors.
        what: &'static str,
        /// How far a product is from one or zero.
        off: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// A rigid motion that costs energy here: one of another system.
    #[error(
        "rigid motion {motion} costs energy in this system: lambda is {lambda:e} 1/s^2; {allowed:e} is \
         allowed"
    )]
    NotRigid {
        /// Which of them.
        motion: usize,
        /// Its lambda, 1/s^2.
        lambda: f64,
        /// What is allowed.
        allowed: f64,
    },
    /// Rigid motions put beside modes that were found beside others.
    #[error("the modes were found beside {found} rigid motions, not beside these {given}")]
    OtherMotions {
        /// How many those were.
        found: usize,
        /// How many these are.
        given: usize,
    },
    /// A time after which rounding has taken the phase of an oscillation.
    #[error("mode {mode} turns by {radians:e} radians in this time: no digit of its phase is left")]
    PhaseLost {
        /// Which mode, lowest first.
        mode: usize,
        /// How far it turns.
        radians: f64,
    },
    /// A number that must be positive, or at least not negative, and finite.
    #[error("{what} is {value}", value = Readable(value))]
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
