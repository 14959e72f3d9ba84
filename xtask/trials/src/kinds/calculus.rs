//! What calculus promises, on random problems.

use crate::Kind;

/// The kinds of trials of calculus.
pub const KINDS: &[Kind] = &[];
