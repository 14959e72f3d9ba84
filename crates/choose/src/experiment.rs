//! What can be run in many ways: all that the search knows of it.
//!
//! ```text
//! ladder()             every way to run it, as data
//! run(at)              one of them, watched from moment to moment
//! look(at, moments)    the same at other moments: within its steps
//! ```

use std::time::Instant;

use crate::grid::Moments;
use crate::ladder::{At, Ladder};
use crate::look::Look;
use crate::measured::Failure;
use crate::samples::Samples;
use crate::watch::Watch;

/// What can be run in many ways. Runs are deterministic: the same rung gives the same numbers.
pub trait Experiment {
    /// Every way to run it, and what is asked of it. It does not change.
    fn ladder(&self) -> &Ladder;

    /// Runs a rung, on a finer mesh where one is named ([`Ladder::finer`]). After every step the watch is told
    /// ([`Watch::stepped`]), at every one of the [`MOMENTS`](crate::MOMENTS) too ([`Watch::moment`]), and where
    /// it breaks off, the run ends with what there is.
    fn run(&self, at: At, finer: Option<usize>, watch: &mut Watch<'_>) -> Record;

    /// Runs a rung and looks at it at these moments, within steps by steps of that part or by dense
    /// output; nothing where it fails, or the deadline comes before its end.
    fn look(&self, at: At, moments: &Moments, deadline: Instant) -> Option<Look>;
}

/// What a run left.
#[derive(Clone, Debug, Default)]
pub struct Record {
    /// What it showed at equal distances in time, the start first.
    pub samples: Samples,
    /// Samples from one moment to the next.
    pub each: usize,
    /// The ends of the steps that an adaptive method accepted.
    pub accepted: Vec<f64>,
    /// What it showed at the parts and ends of these steps ([`own_parts`](crate::own_parts)), the start first,
    /// where that was kept: to look there again costs nothing.
    pub own: Option<Samples>,
    /// What happened once and for all, such as rods that broke, in the order of time. Other ones are
    /// another motion.
    pub outcomes: Vec<usize>,
    /// The largest scale that the run tells, where [`Scale::Told`](crate::Scale::Told) asks for it.
    pub told: f64,
    /// What the observable's scale would be where everything moved as far as there is room.
    pub size: f64,
    /// Counted work.
    pub work: u64,
    /// Whether it may be read off between samples: nothing in it is joined by straight lines.
    pub is_smooth: bool,
    /// How it failed.
    pub failure: Option<Failure>,
}
