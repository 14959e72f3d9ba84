//! What steps a scene, whatever makes the steps; and the ways in which particles are stepped.

use stationary_integrators::{Saved, State, StepReport};

use crate::assemble::system::SceneProblem;
use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::AssemblyError;
use crate::run::error::StepFailure;
use crate::run::samples::{BrokenRod, Impacts};

/// A scene's method, bound to its system.
pub(crate) trait Steps {
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

    /// Whether it goes to a time whatever the step.
    fn reads_off(&self) -> bool {
        false
    }

    /// The ends of the steps that the method itself chose within the last one.
    fn own_ends(&self) -> &[f64] {
        &[]
    }

    /// The multipliers of the rods that are left, none where rods are not held by forces.
    fn multipliers(&self) -> &[f64] {
        &[]
    }

    /// Shows the contact impulses of the last step, which ended at `time`.
    fn pushes(&self, _time: f64, _see: &mut dyn FnMut(Push)) {}

    /// What the next steps depend on beside the state.
    fn save(&mut self) -> Saved {
        Saved::default()
    }

    /// Goes on from another state with what was saved there.
    fn load(&mut self, _: &Before) -> Result<(), CheckpointError> {
        Ok(())
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
}

impl Stepped {
    pub(crate) fn done(report: StepReport) -> Self {
        Stepped { report, broken: None, impacts: None }
    }

    /// A step in which the law of impact was applied so often, the last time at this one. To apply
    /// it counts as a differential.
    pub(crate) fn met(count: usize, time: f64) -> Self {
        let report = StepReport { differentials: 1 + count as u32, ..StepReport::default() };
        let impacts = (count > 0).then_some(Impacts { time, count });
        Stepped { impacts, ..Stepped::done(report) }
    }
}

/// A way of stepping particles, which keeps what its steps borrow besides the system.
pub(crate) trait Way<const D: usize> {
    /// What making it took.
    fn prepared(&self) -> StepReport {
        StepReport::default()
    }

    /// The steps of the scene from its start.
    fn steps<'s>(
        &'s self,
        scene: &'s Scene,
        problem: &'s SceneProblem<D>,
    ) -> Result<Box<dyn Steps + 's>, AssemblyError>;
}

/// A way, where it is the scene's.
pub(crate) type Chosen<const D: usize> = Result<Option<Box<dyn Way<D>>>, AssemblyError>;

/// The way in which the scene's particles are stepped: the first that is the scene's.
pub(crate) fn way<const D: usize>(
    scene: &Scene,
    problem: &SceneProblem<D>,
) -> Result<Box<dyn Way<D>>, AssemblyError> {
    let all: &[fn(&Scene, &SceneProblem<D>) -> Chosen<D>] = &[
        #[cfg(feature = "modal")]
        crate::run::linear_modes::way,
        #[cfg(feature = "contact")]
        crate::run::impact_steps::way,
        #[cfg(feature = "constraints")]
        crate::run::rod_steps::way,
        crate::run::adaptive_steps::way,
        crate::run::equal_steps::way,
    ];
    for way in all {
        if let Some(way) = way(scene, problem)? {
            return Ok(way);
        }
    }
    Err(AssemblyError::NotCompiled(scene.stepping().name()))
}
