//! What mesh promises, on random problems.

use crate::Kind;

/// The kinds of trials of mesh.
pub const KINDS: &[Kind] = &[];
