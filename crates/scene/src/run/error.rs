//! What can go wrong: with a file, with what it says, while it runs, and when the answer is written.
//!
//! ```text
//! SceneError    no scene: the file cannot be read, or says something that cannot be ([`Diagnostic`],
//!               whose [`Fault`](crate::Fault) stands in a file of its own)
//! RunError      no complete run; what was computed before the failure is in it
//! WriteError    the folder or a file in it cannot be written
//! ```

use std::io;
use std::path::PathBuf;

use stationary_calculus::{MetricError, NewtonError, NewtonFailure, SizeError, UnknownVertex};
use stationary_integrators::{AdaptiveError, ControlError, ForceError, StepError};

use crate::assemble::stable_step::UnstableStep;
use crate::model::upper::{
    ConstraintError, ContactError, ElasticityError, LaplacianError, ModalError, RigidError,
    SparseError, SpringError,
};
use crate::run::checkpoint::CheckpointError;
use crate::run::samples::Run;
use crate::text::diagnostic::Diagnostic;
use crate::text::limits;

/// A scene that cannot be had from a file or a text.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SceneError {
    /// The file is missing, or may not be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A folder, a pipe or a device.
    #[error("{}: is not a file", path.display())]
    NotAFile {
        /// What was named.
        path: PathBuf,
    },
    /// More bytes than a scene may have.
    #[error("{name}: has {bytes} bytes; a scene has at most {}", limits::FILE_BYTES)]
    TooLarge {
        /// The file or the text.
        name: String,
        /// Its size, or what was seen of it before giving up.
        bytes: u64,
    },
    /// Bytes that are no text.
    #[error("{}:{line}:{column}: the bytes here are not UTF-8 text", path.display())]
    NotUtf8 {
        /// The file.
        path: PathBuf,
        /// The line of the first such byte, counted from 1.
        line: usize,
        /// The column of the first such byte, in characters from 1.
        column: usize,
    },
    /// A text that says something which cannot be.
    #[error("{0}")]
    Invalid(Box<Diagnostic>),
}

/// A scene that cannot be made into a system: its own checks leave little of this.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum AssemblyError {
    /// The caller asked for another dimension.
    #[error("the scene has dimension {scene}, not {asked}")]
    Dimension {
        /// The scene's.
        scene: usize,
        /// The caller's.
        asked: usize,
    },
    /// A mass that is none.
    #[error(transparent)]
    Metric(#[from] MetricError),
    /// Parts of different size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A spring that cannot be.
    #[error(transparent)]
    Spring(#[from] SpringError),
    /// An elastic body that cannot be.
    #[error(transparent)]
    Elasticity(#[from] ElasticityError),
    /// Nothing at rest was found from which what is hung could be let go.
    #[error("static equilibrium did not converge: {source}")]
    Equilibrium {
        /// The freedom of the largest acceleration where the search ended.
        freedom: usize,
        /// Of so many that were free in the search: what is hung is not.
        freedoms: usize,
        /// Why not.
        source: NewtonError,
    },
    /// Modes that cannot be had.
    #[error(transparent)]
    Modal(#[from] ModalError),
    /// A spring to a vertex that is not there.
    #[error(transparent)]
    Vertex(#[from] UnknownVertex),
    /// Rods or joints that cannot be, or a start that moves against them.
    #[error(transparent)]
    Constraint(#[from] ConstraintError),
    /// A start that no method can leave.
    #[error(transparent)]
    Adaptive(#[from] AdaptiveError),
    /// A tolerance or a force that is none.
    #[error(transparent)]
    Control(#[from] ControlError),
    /// A drag that is none.
    #[error(transparent)]
    Force(#[from] ForceError),
    /// The sparse matrix of an implicit step.
    #[error(transparent)]
    Sparse(#[from] SparseError),
    /// A scene of bodies makes no problem of particles.
    #[error("Scene::problem supports particle scenes only; this scene has rigid bodies")]
    Bodies,
    /// Contact that cannot be.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// A scene of heat makes no problem of particles.
    #[error("Scene::problem supports particle scenes only; this is a heat scene")]
    Heat,
    /// Heat that cannot flow.
    #[error(transparent)]
    Laplacian(#[from] LaplacianError),
    /// A body or a joint that cannot be.
    #[error(transparent)]
    Rigid(#[from] RigidError),
    /// A method or a word whose cargo feature is not on.
    #[error("built without support for `{0}`")]
    NotCompiled(&'static str),
    /// One of the others, in the names of the scene.
    #[error("{words}")]
    Named {
        /// What is wrong.
        words: String,
        /// The error of the crate below, which counts rows and freedoms.
        source: Box<AssemblyError>,
    },
}

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
#[error("step {step}, from t = {time} {unit}: {reason}{}", advice(self.unstable.as_ref()))]
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
pub enum StepFailure {
    /// A method of equal steps.
    #[error(transparent)]
    Step(#[from] StepError),
    /// A method that chooses its steps.
    #[error(transparent)]
    Adaptive(#[from] AdaptiveError),
    /// Rods that cannot be held.
    #[error(transparent)]
    Constraint(ConstraintError),
    /// Modes of another system.
    #[error(transparent)]
    Modal(#[from] ModalError),
    /// Impacts that have no end, or no solution.
    #[error(transparent)]
    Contact(#[from] ContactError),
    /// Temperatures that grow without bound.
    #[error(transparent)]
    Laplacian(#[from] LaplacianError),
    /// What is sampled exceeds the range of a double, though the state does not.
    #[error(
        "{quantity} is not finite (got {value}); where the motion grows without bound take a smaller \
         step, else units in which it is smaller than 1e308"
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
    advice(self.unstable.as_ref())
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

/// The names of the coordinates.
pub(crate) const COORDINATES: [&str; 3] = ["x", "y", "z"];

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

/// A folder or a file that cannot be written.
#[derive(Debug, thiserror::Error)]
#[error("{}: cannot be written: {source}", path.display())]
pub struct WriteError {
    /// The folder or the file.
    pub path: PathBuf,
    /// What the system says.
    pub source: io::Error,
}
