//! What laplacian promises, on random problems.

use crate::Kind;

mod bad_input;
mod distance;
mod edge_graph;
mod heat;
mod matrices;
mod poisson;
mod shapes;
mod surfaces;
mod unrolled;

/// The kinds of trials of laplacian.
pub const KINDS: &[Kind] =
    &[heat::KIND, poisson::KIND, distance::KIND, surfaces::KIND, bad_input::KIND];
