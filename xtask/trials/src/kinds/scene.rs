//! What scene promises, on random problems.

mod changed_files;
mod moved_scenes;

use crate::Kind;

/// The kinds of trials of scene.
pub const KINDS: &[Kind] = &[changed_files::KIND, moved_scenes::KIND];
