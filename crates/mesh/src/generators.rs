//! Shapes that everyone needs: lines, rectangles, discs, boxes, cylinders, balls and their
//! surfaces.

mod benchmarks;
mod flat;
mod round;
mod solid;

pub use benchmarks::{curved_elliptic_membrane, elliptic_membrane, tapered_membrane};
pub(crate) use flat::check_rectangle;
pub use flat::{Diagonals, bar, circle, curved_disc, disc, rectangle, segment};
pub use round::{ball, curved_ball, curved_sphere, curved_torus, icosphere, torus};
pub use solid::{cuboid, curved_cylinder, cylinder, extruded};

use crate::MeshError;
use crate::mesh::FARTHEST;

/// An error unless a size is positive, finite and within what coordinates may be.
fn check_size(what: &'static str, value: f64) -> Result<(), MeshError> {
    if value > 0.0 && value <= FARTHEST { Ok(()) } else { Err(MeshError::Size { what, value }) }
}

/// An error if there are fewer than that.
fn check_cells(what: &'static str, given: usize, least: usize) -> Result<(), MeshError> {
    if given >= least { Ok(()) } else { Err(MeshError::TooFew { what, given, least }) }
}
