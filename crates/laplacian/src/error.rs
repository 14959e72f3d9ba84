//! What can go wrong between a mesh and the flow of heat on it.

use stationary_calculus::{MetricError, Readable, SizeError, SparseError};
use stationary_mesh::MeshError;
use stationary_modal::ModalError;

/// A problem that has no answer, or none that can be trusted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LaplacianError {
    /// The mesh is no domain for functions.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A held vertex, or a source, that does not exist.
    #[error("vertex {vertex} is named; there are {vertices}")]
    NoSuchVertex {
        /// The vertex.
        vertex: usize,
        /// How many there are.
        vertices: usize,
    },
    /// A vertex is held twice.
    #[error("vertex {0} is held twice")]
    HeldTwice(usize),
    /// Every vertex is held, so that nothing is left to find.
    #[error("all vertices are held")]
    NothingFree,
    /// A number that must be finite, and of which more may be asked.
    #[error("{what} is {value}", value = Readable(value))]
    Parameter {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A piece without held vertices has no steady state while heat flows in.
    #[error(
        "the piece of vertex {vertex} is held nowhere, and its source adds up to {total:e}: \
         no steady state"
    )]
    Incompatible {
        /// The first vertex of the piece.
        vertex: usize,
        /// The integral of the source over it.
        total: f64,
    },
    /// A piece where a value is wanted is held nowhere.
    #[error("the piece of vertex {0} is held nowhere")]
    NothingHeld(usize),
    /// Heat that has not arrived: no distance can be read from it.
    #[error(
        "in a heat time of {time:e} no heat arrives at {count} vertices, first at {vertex}; \
         a heat time of {enough:e} arrives everywhere"
    )]
    Underflow {
        /// The first vertex.
        vertex: usize,
        /// How many there are.
        count: usize,
        /// The heat time, m^2.
        time: f64,
        /// A heat time that suffices, m^2.
        enough: f64,
    },
    /// Heat that is not positive: some edges' weights are negative, and no edges were found on the
    /// same surface that have none.
    #[error(
        "heat takes both signs at {count} vertices, first at {vertex}: the triangles are too thin \
         for distances from heat; shortest paths do not need it"
    )]
    LostSign {
        /// The first vertex.
        vertex: usize,
        /// How many there are.
        count: usize,
    },
    /// No sources to measure distances from.
    #[error("there are no sources")]
    NoSources,
    /// Modes of an energy that is not one of heat, which grow instead of decaying.
    #[error("a mode has the eigenvalue {lambda:e}; heat has none below zero")]
    Growing {
        /// The eigenvalue.
        lambda: f64,
    },
    /// A value that is infinite or not a number, given or found; what it was to replace is as it was.
    #[error("the value at vertex or freedom {freedom} is {value}; values must be finite")]
    NonFinite {
        /// Where.
        freedom: usize,
        /// What.
        value: f64,
    },
    /// Something has the wrong size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A mass that is none.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// The sparse matrices.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// The modes.
    #[error(transparent)]
    Modal(#[from] ModalError),
}

/// The value, if it is positive and finite.
pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, LaplacianError> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(LaplacianError::Parameter { what, value })
    }
}

/// An error at the first value that is not finite.
pub(crate) fn check_finite(values: &[f64]) -> Result<(), LaplacianError> {
    match stationary_calculus::first_non_finite(values) {
        Some(freedom) => Err(LaplacianError::NonFinite { freedom, value: values[freedom] }),
        None => Ok(()),
    }
}
