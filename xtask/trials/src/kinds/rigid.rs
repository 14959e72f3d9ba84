//! What rigid promises, on random problems.

mod bad_input;
mod closed;
pub(super) mod double_double;
mod driven;
mod free_top;
mod independence;
mod joints;
mod lie_maps;
mod linkage;
mod mass_properties;
mod singular_positions;
mod small_motions;
mod two_ways;
mod variational;

use crate::Kind;

/// The kinds of trials of rigid.
pub const KINDS: &[Kind] = &[
    joints::KIND,
    driven::KIND,
    closed::KIND,
    variational::KIND,
    small_motions::KIND,
    singular_positions::KIND,
    lie_maps::KIND,
    mass_properties::KIND,
    free_top::KIND,
    bad_input::KIND,
];
