//! What constraints promises, on random problems.

use crate::Kind;

/// The kinds of trials of constraints.
pub const KINDS: &[Kind] = &[];
