//! A scene's method, bound to what it moves.

use std::time::Instant;

use stationary_integrators::{Saved, State, StepReport};

use crate::assemble::error::AssemblyError;
use crate::model::built::Built;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::StepFailure;
use crate::run::samples::{BrokenRod, ChosenSteps, Impacts};

/// A scene's method, bound to its system.
pub(crate) trait Stepper {
    /// Makes the state one that the method can be in.
    fn start(&mut self, _: &mut State<Vec<f64>>) -> Result<(), AssemblyError> {
        Ok(())
    }

    /// Moves the state by the scene's step `h`, to the time `to`.
    fn step(
        &mut self,
        state: &mut State<Vec<f64>>,
        h: f64,
        to: f64,
    ) -> Result<Stepped, StepFailure>;

    /// Whether it goes to a time whatever the step, so that it need not go back.
    fn reads_off(&self) -> bool {
        false
    }

    /// Whether it can take a part of a step and go back.
    fn takes_parts(&self) -> bool {
        true
    }

    /// The ends of the steps that the method itself chose within the last one.
    fn own_ends(&self) -> &[f64] {
        &[]
    }

    /// Keeps the states at these parts of such steps, and at their ends.
    fn keep_own(&mut self, _parts: &[f64]) {}

    /// Ends in an error where its own steps go on beyond that moment.
    fn break_off_at(&mut self, _deadline: Option<Instant>) {}

    /// Those within the last step of the scene, in the order of time.
    fn own_states(&self) -> &[State<Vec<f64>>] {
        &[]
    }

    /// The multipliers of the rods that are left, none where rods are not held by forces.
    fn multipliers(&self) -> &[f64] {
        &[]
    }

    /// Shows the contact impulses of the last step, which ended at `time`.
    fn pushes(&self, _time: f64, _see: &mut dyn FnMut(Push)) {}

    /// The works of what acted in the last step, as [`Acting`](crate::assemble::acting::Acting) names them.
    fn works(&self) -> &[f64] {
        &[]
    }

    /// The work of motors with a speed in the last step.
    fn driven_work(&self) -> f64 {
        0.0
    }

    /// What the next steps depend on beside the state.
    fn save(&mut self) -> Saved {
        Saved::default()
    }

    /// Goes on from another state with what was saved there.
    fn load(&mut self, _: &Before) -> Result<(), CheckpointError> {
        Ok(())
    }

    /// What making it took.
    fn prepared(&self) -> StepReport {
        StepReport::default()
    }

    /// What was built for it.
    fn built(&self) -> Built {
        Built::default()
    }
}

/// What a step did beside moving the state.
pub(crate) struct Stepped {
    pub(crate) report: StepReport,
    /// The rod that broke; its place is that among the rods that were left.
    pub(crate) broken: Option<BrokenRod>,
    pub(crate) impacts: Option<Impacts>,
    /// How far the contact conditions were missed where the step is not settled.
    pub(crate) unsettled: Option<f64>,
    /// For how long contact lasted, of a method that steps it otherwise than flight.
    pub(crate) lasting: f64,
    /// The steps that contact chose by their error.
    pub(crate) chosen: ChosenSteps,
}

impl Stepped {
    pub(crate) fn done(report: StepReport) -> Self {
        Stepped {
            report,
            broken: None,
            impacts: None,
            unsettled: None,
            lasting: 0.0,
            chosen: ChosenSteps::default(),
        }
    }

    /// A step in which the law of impact was applied so often, the last time at this one. To apply
    /// it counts as a differential.
    pub(crate) fn met(count: usize, time: f64) -> Self {
        let report = StepReport { differentials: 1 + count as u32, ..StepReport::default() };
        let impacts = (count > 0).then_some(Impacts { time, count });
        Stepped { impacts, ..Stepped::done(report) }
    }
}
