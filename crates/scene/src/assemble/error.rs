//! A scene that cannot be made into a system.

#[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
use stationary_calculus::SparseError;
use stationary_calculus::{MetricError, NewtonError, SizeError, UnknownVertex};
#[cfg(feature = "constraints")]
use stationary_constraints::ConstraintError;
#[cfg(feature = "contact")]
use stationary_contact::ContactError;
#[cfg(feature = "elasticity")]
use stationary_elasticity::{ElasticityError, SpringError};
use stationary_integrators::{AdaptiveError, ControlError, ForceError};
#[cfg(feature = "laplacian")]
use stationary_laplacian::LaplacianError;
#[cfg(feature = "modal")]
use stationary_modal::ModalError;
#[cfg(feature = "rigid")]
use stationary_rigid::{RigidError, tree::TreeError};

/// A scene that cannot be made into a system: its own checks leave little of this.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// The caller asked for another dimension.
    #[error("the scene has dimension {scene}, not {asked}")]
    Dimension {
        /// The scene's.
        scene: usize,
        /// The caller's.
        asked: usize,
    },
    /// A mass that is none.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// Parts of different size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A spring that cannot be.
    #[cfg(feature = "elasticity")]
    #[error(transparent)]
    Spring(#[from] SpringError),
    /// An elastic body that cannot be.
    #[cfg(feature = "elasticity")]
    #[error(transparent)]
    Elasticity(#[from] ElasticityError),
    /// Nothing at rest was found from which what is hung could be let go.
    #[error("static equilibrium did not converge: {source}")]
    Equilibrium {
        /// The freedom of the largest acceleration where the search ended.
        freedom: usize,
        /// Of so many that were free in the search: what is hung is not.
        freedoms: usize,
        /// Why not.
        source: NewtonError,
    },
    /// Modes that cannot be had.
    #[cfg(feature = "modal")]
    #[error(transparent)]
    Modal(#[from] ModalError),
    /// A spring to a vertex that is not there.
    #[error(transparent)]
    Vertex(#[from] UnknownVertex),
    /// Rods or joints that cannot be, or a start that moves against them.
    #[cfg(feature = "constraints")]
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    /// A start that no method can leave.
    #[error(transparent)]
    Adaptive(#[from] AdaptiveError),
    /// A tolerance or a force that is none.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// A drag that is none.
    #[error(transparent)]
    Force(#[from] ForceError),
    /// The sparse matrix of an implicit step.
    #[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// A scene of bodies makes no problem of particles.
    #[error("Scene::problem supports particle scenes only; this scene has rigid bodies")]
    Bodies,
    /// Contact that cannot be.
    #[cfg(feature = "contact")]
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A scene of heat makes no problem of particles.
    #[error("Scene::problem supports particle scenes only; this is a heat scene")]
    Heat,
    /// Heat that cannot flow.
    #[cfg(feature = "laplacian")]
    #[error(transparent)]
    Laplacian(#[from] LaplacianError),
    /// A body or a joint that cannot be.
    #[cfg(feature = "rigid")]
    #[error(transparent)]
    Rigid(#[from] RigidError),
    /// Bodies that make no tree.
    #[cfg(feature = "rigid")]
    #[error(transparent)]
    Tree(#[from] TreeError),
    /// The speed of a joint follows from the others of its loop.
    #[error(
        "the joint between `{first}` and `{second}` closes a loop of joints that all have motors with a speed"
    )]
    ClosesLoop {
        /// What it joins.
        first: String,
        /// To this.
        second: String,
    },
    /// A method or a word whose cargo feature is not on.
    #[error("built without support for `{0}`")]
    NotCompiled(&'static str),
    /// One of the others, in the names of the scene.
    #[error("{words}")]
    Named {
        /// What is wrong.
        words: String,
        /// The error of the crate below, which counts rows and freedoms.
        source: Box<AssemblyError>,
    },
}
