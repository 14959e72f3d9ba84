//! Looks on while a run is made, and stops it where its trial is lost or the time is over.

use std::ops::ControlFlow;
use std::time::Instant;

use crate::ladder::MOMENTS;
use crate::measured::{End, Failure, StopRule};

/// Steps between two looks at the clock.
const LOOK: u64 = 256;

/// What a run tells, step after step.
#[derive(Debug)]
pub struct Watch<'t> {
    trial: Option<&'t StopRule<'t>>,
    deadline: Instant,
    steps: u64,
    pub(crate) works: Vec<u64>,
    pub(crate) end: End,
}

impl<'t> Watch<'t> {
    /// A watch to the deadline.
    pub(crate) fn new(trial: Option<&'t StopRule<'t>>, deadline: Instant) -> Self {
        Watch { trial, deadline, steps: 0, works: vec![0], end: End::Whole }
    }

    /// When the time is over.
    pub fn deadline(&self) -> Instant {
        self.deadline
    }

    /// A step was taken. Breaks off where the time is over.
    pub fn stepped(&mut self) -> ControlFlow<()> {
        self.steps += 1;
        if self.steps.is_multiple_of(LOOK) && Instant::now() >= self.deadline {
            self.end = End::Failed(Failure::OutOfBudget);
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }

    /// The next of the moments was reached, with so much counted work. Breaks off where the run is
    /// known to be of no use.
    pub fn moment(&mut self, observed: &[f64], work: u64) -> ControlFlow<()> {
        self.works.push(work);
        let moment = self.works.len() - 1;
        let lost = |trial: &StopRule<'_>| trial.is_lost(moment, observed, work);
        let is_number = observed.iter().all(|x| x.is_finite());
        if (moment as u64) < MOMENTS && (!is_number || self.trial.is_some_and(lost)) {
            self.end = End::Stopped;
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(())
    }
}
