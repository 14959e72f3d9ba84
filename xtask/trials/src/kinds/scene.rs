//! What scene promises, on random problems.

mod changed_files;

use crate::Kind;

/// The kinds of trials of scene.
pub const KINDS: &[Kind] = &[changed_files::KIND];
