//! Where a step starts, kept so that the step can be looked into without those before it.

use crate::run::checkpoint::Before;

/// Where a step starts.
#[doc(hidden)]
#[derive(Clone, Debug)]
pub struct Start {
    pub(crate) before: Before,
    /// What the rods felt there.
    pub(crate) multipliers: Vec<f64>,
}

impl Start {
    /// How many numbers it holds.
    #[cfg(feature = "choose")]
    pub(crate) fn numbers(&self) -> usize {
        let Before { state, memory, .. } = &self.before;
        state.q.len() + state.p.0.len() + memory.numbers.len() + self.multipliers.len()
    }
}
