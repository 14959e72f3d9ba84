//! What holds of `stationary-laplacian`, in one binary: what is generic is compiled once.

mod flows;
mod spectrum;
