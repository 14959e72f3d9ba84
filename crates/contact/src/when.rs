//! When things meet, and when an impulse is given: times of impact, penalties, the velocity filter.

pub(crate) mod moving;
pub(crate) mod time_of_impact;
pub(crate) mod swept_boxes;
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) mod rigid_path;
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) mod rigid_time_of_impact;
pub(crate) mod mesh_filter;
pub(crate) mod gaps;
pub(crate) mod penalty;
pub(crate) mod choice;
pub(crate) mod impacting;
pub(crate) mod flight;
pub(crate) mod rest;
pub(crate) mod filter;
