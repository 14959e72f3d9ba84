//! Who looks on while a scene runs, and controls it.

use std::rc::Rc;
use std::time::Instant;

use stationary_integrators::Cost;

use crate::run::checkpoint::Checkpoint;
#[cfg(doc)]
use crate::run::error::StepFailure;
use crate::run::samples::Run;
use crate::run::start::Start;

/// What an observer asks for after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Control {
    /// The run goes on.
    Continue,
    /// The run goes on, and after its next step makes a checkpoint.
    Checkpoint,
    /// The run ends here, which is no error.
    Stop,
}

/// Looks on while a scene runs.
pub trait Observer {
    /// Sees every step, and says what is to be done.
    fn stepped(&mut self, now: Progress<'_>) -> Control;

    /// Takes a checkpoint for which it has asked.
    fn keep(&mut self, checkpoint: &Checkpoint);

    /// The parts of a step, between 0 and 1, at which it is to see the observables too.
    fn parts(&mut self, _step: u64) -> &[f64] {
        &[]
    }

    /// Sees the observables at a part of a step before it sees the step: what the method gives by a
    /// step of that part, which is then taken back. No cost is counted for it but that of adaptive
    /// steps, which are read off.
    fn inside(&mut self, _time: f64, _observed: &[f64]) {}

    /// When the run is to be broken off although a step of the scene has not ended: an adaptive method may take any
    /// number of its own in one. It is then an error, [`StepFailure::TimeIsOver`].
    fn deadline(&self) -> Option<Instant> {
        None
    }

    /// Sees where the steps ended that an adaptive method chose itself.
    fn own_ends(&mut self, _ends: &[f64]) {}

    /// The parts of these steps, between 0 and 1, at which they are sampled beside the scene's own samples.
    #[doc(hidden)]
    fn own_parts(&self) -> &[f64] {
        &[]
    }

    /// Takes what was sampled there and at the ends of these steps, after the last one; nothing where that was
    /// too much.
    #[doc(hidden)]
    fn own(&mut self, _sampled: Run) {}

    /// Whether it keeps where each step starts.
    #[doc(hidden)]
    fn keeps_starts(&self) -> bool {
        false
    }

    /// Takes where a step starts, and after the last one where that ends.
    #[doc(hidden)]
    fn start(&mut self, _: Start) {}

    /// Where the steps of this run start, kept before: then none is taken again, only parts of them.
    #[doc(hidden)]
    fn kept(&self) -> Option<Rc<[Start]>> {
        None
    }
}

/// How far a run has come, shown after every step.
#[derive(Clone, Copy, Debug)]
pub struct Progress<'a> {
    /// Steps taken.
    pub step: u64,
    /// Steps to the horizon.
    pub steps: u64,
    /// The time.
    pub time: f64,
    /// The configuration: D numbers for each particle that is free; of a body in the plane place
    /// and angle, in space place and quaternion.
    pub q: &'a [f64],
    /// What was computed so far.
    pub cost: Cost,
    /// The observables at the last sample, a number for each heading.
    pub observed: &'a [f64],
}
