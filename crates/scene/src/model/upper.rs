//! The types of the crates above the integrators that a scene, its methods and its errors are made of.
//!
//! Where such a crate is not compiled, a type without values stands for its own: whoever matches on an
//! error or a method has the same variants to think of, of which nobody ever meets that one.

#[cfg(any(feature = "constraints", feature = "elasticity", feature = "modal"))]
pub use stationary_calculus::SparseError;
#[cfg(feature = "constraints")]
pub use stationary_constraints::ConstraintError;
#[cfg(feature = "contact")]
pub use stationary_contact::{ContactError, ImpactLaw, When};
#[cfg(feature = "elasticity")]
pub use stationary_elasticity::{ElasticityError, Lame, SpringError, Strain};
#[cfg(feature = "laplacian")]
pub use stationary_laplacian::{HeatMethod, LaplacianError};
#[cfg(feature = "modal")]
pub use stationary_modal::ModalError;
#[cfg(feature = "rigid")]
pub use stationary_rigid::{BodyMethod, RigidError};

#[cfg(not(feature = "default"))]
#[allow(unused_imports)]
pub use crate::absent::types::*;
