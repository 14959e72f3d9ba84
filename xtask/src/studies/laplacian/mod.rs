//! Studies of the Laplacian: spectra, heat, the maximum principle, and distances.

pub mod border;
pub mod cost;
pub mod distance;
pub mod maximum;
pub mod spectrum;
