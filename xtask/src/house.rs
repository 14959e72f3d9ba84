//! The checks of the house: what is allowed, what it costs, and what is written from what.

pub mod cargo;
pub mod check_page;
pub mod cost;
pub mod kernels;
pub mod layers;
pub mod licenses;
pub mod mentions;
pub mod readme;
