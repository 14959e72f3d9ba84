//! Detection: which features of which shapes face each other, and across which gaps.

pub(crate) mod contact_point;
pub(crate) mod broad_phase;
#[cfg(feature = "2d")]
pub(crate) mod planar_narrow_phase;
#[cfg(feature = "3d")]
pub(crate) mod box_axes;
#[cfg(feature = "3d")]
pub(crate) mod polytope_axes;
#[cfg(feature = "3d")]
pub(crate) mod polytope_corners;
#[cfg(feature = "3d")]
pub(crate) mod polytopes;
#[cfg(feature = "3d")]
pub(crate) mod separation;
#[cfg(feature = "3d")]
pub(crate) mod facing_points;
#[cfg(feature = "3d")]
pub(crate) mod round_contacts;
#[cfg(feature = "3d")]
pub(crate) mod narrow_phase;
pub(crate) mod seams;
pub(crate) mod detection;
pub(crate) mod ray;
pub(crate) mod queries;
