//! The kinds of trials, a folder a crate, in the crates' order.

use crate::Kind;

pub mod calculus;
#[cfg(feature = "mesh")]
pub mod mesh;
#[cfg(feature = "integrators")]
pub mod integrators;
#[cfg(feature = "constraints")]
pub mod constraints;
#[cfg(feature = "rigid")]
pub mod rigid;
#[cfg(feature = "contact")]
pub mod contact;
#[cfg(feature = "elasticity")]
pub mod elasticity;
#[cfg(feature = "modal")]
pub mod modal;
#[cfg(feature = "laplacian")]
pub mod laplacian;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "import")]
pub mod import;

/// All kinds, a list a crate.
pub(crate) const ALL: &[&[Kind]] = &[
    calculus::KINDS,
    #[cfg(feature = "mesh")]
    mesh::KINDS,
    #[cfg(feature = "integrators")]
    integrators::KINDS,
    #[cfg(feature = "constraints")]
    constraints::KINDS,
    #[cfg(feature = "rigid")]
    rigid::KINDS,
    #[cfg(feature = "contact")]
    contact::KINDS,
    #[cfg(feature = "elasticity")]
    elasticity::KINDS,
    #[cfg(feature = "modal")]
    modal::KINDS,
    #[cfg(feature = "laplacian")]
    laplacian::KINDS,
    #[cfg(feature = "scene")]
    scene::KINDS,
    #[cfg(feature = "import")]
    import::KINDS,
];
