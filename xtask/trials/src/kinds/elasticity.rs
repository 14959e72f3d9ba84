//! What elasticity promises, on random problems.

use crate::Kind;

/// The kinds of trials of elasticity.
pub const KINDS: &[Kind] = &[];
