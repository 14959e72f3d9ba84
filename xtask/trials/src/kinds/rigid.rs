//! What rigid promises, on random problems.

use crate::Kind;

/// The kinds of trials of rigid.
pub const KINDS: &[Kind] = &[];
