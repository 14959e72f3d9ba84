//! What contact promises, on random problems.

mod bad_input;
mod case;
mod engine;
mod exact;
mod gaps;
mod hull;
mod hulls;
mod jointed;
mod judged;
mod mesh_points;
mod planar;
mod planar_points;
mod points;
mod refined;
mod scenes;
mod solids;
mod spatial;
mod step;
mod swung;

use crate::Kind;

pub use judged::{JudgedPair, judged_pairs};
pub use points::SolidKind;
pub use solids::Form;

/// The kinds of trials of contact.
pub const KINDS: &[Kind] = &[
    scenes::PLANAR,
    scenes::SPATIAL,
    scenes::ROLLING,
    scenes::LANDING,
    jointed::KIND,
    jointed::LIMITED,
    jointed::OF_ANY_SIZE,
    swung::KIND,
    points::KIND,
    planar_points::KIND,
    mesh_points::KIND,
    gaps::SPATIAL,
    gaps::PLANAR,
    bad_input::KIND,
];
