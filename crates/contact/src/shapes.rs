//! The plane and space: what they are to contact, shapes, and what carries them.

pub(crate) mod dimension;
#[cfg(feature = "2d")]
pub(crate) mod planar;
#[cfg(feature = "3d")]
pub(crate) mod spatial;
#[cfg(feature = "2d")]
pub(crate) mod planar_convert;
#[cfg(feature = "3d")]
pub(crate) mod convert;
#[cfg(feature = "2d")]
pub(crate) mod outline;
#[cfg(feature = "2d")]
pub(crate) mod planar_shape;
#[cfg(feature = "3d")]
pub(crate) mod polytope;
#[cfg(feature = "3d")]
pub(crate) mod solid;
#[cfg(feature = "3d")]
pub(crate) mod shape;
pub(crate) mod collider;
