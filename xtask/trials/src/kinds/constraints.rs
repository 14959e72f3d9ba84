//! What constraints promises, on random problems.

mod bad_input;
mod equalities;
mod net;
mod reduced_chain;
mod rods;

use crate::Kind;

/// The kinds of trials of constraints.
pub const KINDS: &[Kind] = &[rods::KIND, equalities::KIND, bad_input::KIND];
