//! What holds of `stationary-constraints`, in one binary: what is generic is compiled once.

mod adaptive;
mod bad_input;
mod curved;
mod facts;
mod halving;
#[cfg(feature = "sparse")]
mod many;
mod multipliers;
mod no_allocation;
mod reduced;
mod singular;
mod warm_start;
mod ways;
