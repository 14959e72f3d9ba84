//! What a first-order problem with a known end is made of.

use std::fmt;

use crate::{Moment, VectorField};

/// A first-order system with initial data and the right answer at the end.
pub struct StiffProblem<F, const N: usize> {
    /// Its name, with lower-case letters and hyphens.
    pub name: &'static str,
    /// Its right-hand side.
    pub field: F,
    /// Where it starts.
    pub initial: Moment<[f64; N]>,
    /// When it ends, seconds.
    pub end: f64,
    /// The size below which each component counts as zero.
    pub scale: [f64; N],
    /// The state at the end, where it is known.
    pub solution: Option<[f64; N]>,
    /// How far the solution may itself be off, relative to each component.
    pub solution_error: f64,
}

impl<F: VectorField, const N: usize> StiffProblem<F, N> {
    /// The largest error of a component at the end relative to that component, or `None` where the
    /// solution is not known.
    pub fn error(&self, y: &[f64; N]) -> Option<f64> {
        let pairs = self.solution.as_ref()?.iter().zip(y);
        Some(pairs.map(|(a, b)| ((b - a) / a).abs()).fold(0.0, f64::max))
    }
}

impl<F, const N: usize> fmt::Debug for StiffProblem<F, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("StiffProblem").field("name", &self.name).finish_non_exhaustive()
    }
}
