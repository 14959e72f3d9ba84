//! What holds of `stationary-modal`, in one binary: what is generic is compiled once.

mod clusters;
mod elastic;
mod larger_motion;
mod modes;
mod rigid_motions;
