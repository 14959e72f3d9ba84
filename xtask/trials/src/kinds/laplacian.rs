//! What laplacian promises, on random problems.

use crate::Kind;

/// The kinds of trials of laplacian.
pub const KINDS: &[Kind] = &[];
