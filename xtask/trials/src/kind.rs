//! One kind of promise, and the list of all.

use crate::kinds;
use crate::{Draw, Verdict};

/// One kind of promise: what is promised, and how a random case of it is made and judged.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// Name in kebab-case: `derivative-check`.
    pub name: &'static str,
    /// The crate whose promise this is.
    pub krate: &'static str,
    /// What counts as wrong, written before the first run.
    pub rule: &'static str,
    /// How many cases the tests run: at least 50, all kinds together a minute.
    pub in_tests: u64,
    /// Makes a case and judges it.
    pub trial: fn(&mut Draw) -> Verdict,
}

/// All kinds, in the crates' order.
pub const KINDS: &[&[Kind]] = kinds::ALL;

impl Kind {
    /// All kinds, one after the other.
    pub fn all() -> impl Iterator<Item = &'static Kind> {
        KINDS.iter().flat_map(|kinds| kinds.iter())
    }
}
