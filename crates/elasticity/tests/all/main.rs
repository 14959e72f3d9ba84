//! What holds of `stationary-elasticity`, in one binary: what is generic is compiled once.

mod bodies;
mod damping;
mod elements;
mod fitted;
mod materials;
mod parts;
mod problems;
mod projected;
mod residuals;
mod statics;
