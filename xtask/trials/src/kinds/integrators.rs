//! What integrators promises, on random problems.

use crate::Kind;

/// The kinds of trials of integrators.
pub const KINDS: &[Kind] = &[];
