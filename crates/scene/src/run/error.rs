//! What can go wrong: with a file, with what it says, while it runs, and when the answer is written.
//!
//! ```text
//! SceneError    no scene: the file cannot be read, or says something that cannot be ([`Diagnostic`],
//!               whose [`Fault`](crate::Fault) stands in a file of its own)
//! RunError      no complete run; what was computed before the failure is in it
//! WriteError    the folder or a file in it cannot be written
//! ```

use stationary_calculus::{NewtonError, NewtonFailure, Readable};
use stationary_integrators::{AdaptiveError, StepError};

use crate::assemble::error::AssemblyError;
use crate::assemble::stable_step::UnstableStep;
use crate::model::scene::COORDINATES;
use crate::run::checkpoint::CheckpointError;
use crate::run::samples::Run;
#[cfg(feature = "constraints")]
use stationary_constraints::ConstraintError;
#[cfg(feature = "contact")]
use stationary_contact::ContactError;
#[cfg(feature = "laplacian")]
use stationary_laplacian::LaplacianError;
#[cfg(feature = "modal")]
use stationary_modal::ModalError;
#[cfg(feature = "rigid")]
use stationary_rigid::tree::TreeError;

/// A run that did not begin, or did not reach the horizon.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The system could not be made.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// A step failed.
    #[error(transparent)]
    Interrupted(Box<Interruption>),
    /// A step of bodies or of heat failed, or what is sampled exceeds the range of doubles.
    #[error(transparent)]
    Stopped(Box<Stop>),
    /// The run does not go on from the checkpoint.
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
}

impl RunError {
    /// What was computed before the failure.
    pub fn partial(&self) -> Option<&Run> {
        match self {
            RunError::Assembly(_) | RunError::Checkpoint(_) => None,
            RunError::Interrupted(interruption) => Some(&interruption.run),
            RunError::Stopped(stop) => Some(&stop.run),
        }
    }
}

/// A step of bodies or of heat that failed, or one after which a sample is not finite, and what was
/// computed before.
#[derive(Debug, thiserror::Error)]
#[error(
    "step {step}, from t = {time} {unit}: {reason}{}", advice(self.unstable.as_ref()),
    time = Readable(time)
)]
pub struct Stop {
    /// The step, counted from 1.
    pub step: u64,
    /// The time at which it began, in the scene's unit.
    pub time: f64,
    /// The scene's unit of time.
    pub unit: String,
    /// Why it failed, in the names of the scene.
    pub reason: String,
    /// The step, where its method is not stable at it.
    pub unstable: Option<UnstableStep>,
    /// Why it failed.
    #[source]
    pub source: StepFailure,
    /// The run up to there; its last sample is the state from which the step failed.
    pub run: Box<Run>,
}

/// What to do about a step that is not stable.
fn advice(unstable: Option<&UnstableStep>) -> String {
    unstable.map_or(String::new(), |unstable| format!("; {unstable}"))
}

/// Why a step failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StepFailure {
    /// A method of equal steps.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A method that chooses its steps.
    #[error(transparent)]
    Adaptive(#[from] AdaptiveError),
    /// Rods that cannot be held.
    #[cfg(feature = "constraints")]
    #[error(transparent)]
    Constraint(ConstraintError),
    /// Joints that cannot be held, as a loop where its rows depend on each other.
    #[cfg(feature = "rigid")]
    #[error(transparent)]
    Tree(#[from] TreeError),
    /// Modes of another system.
    #[cfg(feature = "modal")]
    #[error(transparent)]
    Modal(#[from] ModalError),
    /// Impacts that have no end, or no solution.
    #[cfg(feature = "contact")]
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Temperatures that grow without bound.
    #[cfg(feature = "laplacian")]
    #[error(transparent)]
    Laplacian(#[from] LaplacianError),
    /// Balls that attract as points do only outside of each other.
    #[error(
        "`{first}` and `{second}` are {distance:.3e} apart, within the {radii:.3e} of their radii: a ball attracts as \
         a point only what is outside of it; add `[contact]`, so that they touch, or take a smaller step"
    )]
    Inside {
        /// The name of one.
        first: String,
        /// That of the other.
        second: String,
        /// The distance of their centres.
        distance: f64,
        /// The sum of their radii.
        radii: f64,
    },
    /// Dampers that share bodies, whose full matrix would be too large or is singular.
    #[error(
        "dampers that hold back the same bodies were not solved: {unknowns} velocities and impulses (a full matrix, \
         which masses far apart need, takes at most {most}); take a smaller step, or bring the masses nearer to each \
         other"
    )]
    Dampers {
        /// How many unknowns there are.
        unknowns: usize,
        /// How many a full matrix may have.
        most: usize,
    },
    /// A method that chooses its steps had to come further in the time that it was given.
    #[error("the time that the run was given is over")]
    TimeIsOver,
    /// What is sampled exceeds the range of a double, though the state does not.
    #[error(
        "{quantity} is not finite (got {value}); where the motion grows without bound take a smaller \
         step, else units in which it is smaller than 1e308",
        value = Readable(value)
    )]
    Overflow {
        /// The name of the quantity.
        quantity: String,
        /// Its value.
        value: f64,
    },
}

/// A step that failed, where, and what was computed before.
#[derive(Debug, thiserror::Error)]
#[error(
    "step {step}, from t = {time} {unit}: {}{}",
    self.reason(),
    advice(self.unstable.as_ref()),
    time = Readable(time)
)]
pub struct Interruption {
    /// The step, counted from 1.
    pub step: u64,
    /// The time at which it began, in the scene's unit.
    pub time: f64,
    /// The scene's unit of time.
    pub unit: String,
    /// The first particle whose state is not finite; where an equation was not solved for another
    /// reason, the particle of the largest acceleration.
    pub particle: String,
    /// The coordinate of that particle, from 0.
    pub coordinate: usize,
    /// Why it failed in the names of the scene, where the error itself counts equations or freedoms.
    pub named: Option<String>,
    /// The step, where its method is not stable at it.
    pub unstable: Option<UnstableStep>,
    /// Why it failed.
    #[source]
    pub source: StepFailure,
    /// The run up to there; its last sample is the state from which the step failed.
    pub run: Box<Run>,
}

impl StepFailure {
    /// An error where dampers with so many unknowns were not solved.
    pub(crate) fn of_dampers(unsolved: Option<usize>) -> Result<(), StepFailure> {
        let most = crate::text::limits::FULL_MATRIX_FREEDOMS;
        unsolved.map_or(Ok(()), |unknowns| Err(StepFailure::Dampers { unknowns, most }))
    }
}

/// The unknown at which Newton's method met a number that is not finite.
pub(crate) fn unknown(error: &StepFailure) -> Option<usize> {
    let StepFailure::Step(StepError::Newton(NewtonError { failure, .. })) = error else {
        return None;
    };
    match failure {
        NewtonFailure::NonFinite(unknown) => Some(*unknown),
        _ => None,
    }
}

impl Interruption {
    fn reason(&self) -> String {
        let (particle, coordinate) = (&self.particle, COORDINATES[self.coordinate.min(2)]);
        match &self.source {
            StepFailure::Step(StepError::NonFiniteConfiguration { .. }) => {
                format!("the position of `{particle}` is not finite, first in {coordinate}")
            }
            StepFailure::Step(StepError::NonFiniteMomentum { .. }) => {
                format!("the momentum of `{particle}` is not finite, first in {coordinate}")
            }
            other if unknown(other).is_some() => format!(
                "the implicit step was not solved: Newton's method met a number that is not finite, \
                 first of `{particle}` in {coordinate}"
            ),
            other => match &self.named {
                Some(words) => words.clone(),
                None => format!(
                    "{other}; the largest acceleration is that of `{particle}` in {coordinate}"
                ),
            },
        }
    }
}
