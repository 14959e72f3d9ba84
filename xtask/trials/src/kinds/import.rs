//! What import promises, on random robots.

mod element;
mod judged;
mod mjcf;
mod numbers;
mod robot;
mod urdf;

use crate::Kind;

/// The kinds of trials of import.
pub const KINDS: &[Kind] = &[urdf::KIND, mjcf::KIND];
