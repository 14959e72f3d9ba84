//! What modal promises, on random problems.

use crate::Kind;

/// The kinds of trials of modal.
pub const KINDS: &[Kind] = &[];
