//! What can go wrong: with a file, with what it says, while it runs, and when the answer is written.
//!
//! ```text
//! SceneError    no scene: the file cannot be read, or says something that cannot be ([`Diagnostic`])
//! Fault         what it says that cannot be, without its place
//! RunError      no complete run; what was computed before the failure is in it
//! WriteError    the folder or a file in it cannot be written
//! ```

use std::io;
use std::path::PathBuf;

use stationary_calculus::{
    MetricError, NewtonError, NewtonFailure, SizeError, SparseError, UnknownVertex,
};
use stationary_elasticity::SpringError;
use stationary_integrators::{HorizonError, StepError};

use crate::{Diagnostic, Run, limits};

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

/// What is wrong with a scene.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Fault {
    /// Not TOML, or a value of the wrong kind.
    #[error("{message}")]
    Syntax {
        /// What was found and what was expected.
        message: String,
    },
    /// A word outside the vocabulary, or a particle that is not there.
    #[error("unknown {kind} `{word}`")]
    UnknownWord {
        /// What the word should have been.
        kind: &'static str,
        /// The word.
        word: String,
        /// The word that may have been meant.
        nearest: Option<String>,
        /// Every word that could stand here, where there are few.
        allowed: Vec<String>,
    },
    /// A number that must be finite.
    #[error("{what} is {value}; it must be finite")]
    NotFinite {
        /// What the number is.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A number that must be positive, finite, and so large that one over it is finite.
    #[error("{what} is {value}; it must be positive and finite")]
    NotPositive {
        /// What the number is.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// Space has one, two or three dimensions here.
    #[error("the dimension is {0}; it must be 1, 2 or 3")]
    Dimension(u64),
    /// A vector of another length than the dimension.
    #[error("{what} has {got} components in a scene of dimension {expected}")]
    VectorLength {
        /// What the vector is.
        what: &'static str,
        /// The dimension.
        expected: usize,
        /// Its length.
        got: usize,
    },
    /// A name that could not stand in a table's heading.
    #[error(
        "a name is 1 to {} letters, digits, spaces, `-` and `_`, and starts with a letter or a digit",
        limits::NAME
    )]
    Name,
    /// A title or a unit that could not stand in a heading.
    #[error("{what} is 1 to {} characters, none of them a control character", limits::TITLE)]
    Title {
        /// The title or the unit.
        what: &'static str,
    },
    /// Two particles of one name.
    #[error("there is already a particle called `{0}`")]
    DuplicateName(String),
    /// Two nets, or a net and a particle, of one name.
    #[error("there is already a net called `{0}`")]
    DuplicateNet(String),
    /// A particle that can move has a mass.
    #[error("`{0}` has no mass; only a pinned particle may go without")]
    NoMass(String),
    /// One of the two determines the other.
    #[error("`{0}` has a velocity and a momentum; give one of them")]
    VelocityAndMomentum(String),
    /// A pinned particle stays where it is.
    #[error("`{0}` is pinned and cannot move")]
    PinnedMoves(String),
    /// The attraction of a particle that is held in place would not keep momentum.
    #[error("`{0}` is pinned; where particles attract each other, all of them must be free")]
    PinnedAttraction(String),
    /// Newtonian attraction has no value where particles meet.
    #[error("`{second}` is in the same place as `{first}`, where their attraction is infinite")]
    SamePlace {
        /// The particle that was named first.
        first: String,
        /// The other one.
        second: String,
    },
    /// The ends of a spring are one particle.
    #[error("both ends of the spring are `{0}`")]
    Loop(String),
    /// A spring whose energy has a spike where it starts.
    #[error("the spring starts with length zero, where its force has no direction")]
    Spike,
    /// A rest length outside its range.
    #[error("the rest length is {0}; it must be positive, or zero with Cauchy strain")]
    RestLength(f64),
    /// A rest length that is not given and not determined by the start either.
    #[error("the ends start in the same place, so that the spring needs a rest length")]
    NoRestLength,
    /// A spring joins two particles, a distance is between two.
    #[error("{what} is between two particles, not {got}")]
    NotAPair {
        /// What needs two particles.
        what: &'static str,
        /// How many there are.
        got: usize,
    },
    /// An observable such as `{ position = "a", velocity = "a" }`.
    #[error("an observable has one word, such as `{{ position = \"a name\" }}`, not {0}")]
    NotOneObservable(usize),
    /// A net is at least two by two.
    #[error("{what} is {got}; a net has at least two rows and two columns")]
    NetSize {
        /// Rows or columns.
        what: &'static str,
        /// How many.
        got: u64,
    },
    /// A net has two directions.
    #[error("a net needs a scene of dimension 2 or 3")]
    NetDimension,
    /// The cells of a net are squares.
    #[error("the two sides of the net are not at a right angle")]
    NotPerpendicular,
    /// A direction has a length.
    #[error("{what} is zero; a direction is not")]
    NoDirection {
        /// The direction.
        what: &'static str,
    },
    /// Only a scene in space can be seen from several sides.
    #[error("a view needs a scene of dimension 3")]
    ViewDimension,
    /// The horizon is a whole number of steps.
    #[error("the horizon is {steps} steps of {step}; it must be a whole number of steps")]
    NotWhole {
        /// The step.
        step: f64,
        /// The horizon over the step.
        steps: f64,
    },
    /// Too many of something.
    #[error("{count} {what}; there may be at most {limit}")]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many.
        count: u64,
        /// How many there may be.
        limit: u64,
    },
    /// More samples than fit into memory.
    #[error(
        "the samples would be {numbers} numbers, of which at most {} are kept; sample every {enough} steps or more",
        limits::SAMPLED_NUMBERS
    )]
    TooManySamples {
        /// Numbers that would be kept.
        numbers: u64,
        /// A distance between samples that is large enough.
        enough: u64,
    },
    /// Nothing there.
    #[error("the scene has no particles: it needs [[particles]] or [[nets]]")]
    Empty,
    /// Nothing that can move.
    #[error("every particle is pinned, so that nothing can move")]
    AllPinned,
}

impl Fault {
    pub(crate) fn too_many_steps(count: u64) -> Self {
        Fault::TooMany { what: "steps", count, limit: limits::STEPS }
    }
}

impl From<HorizonError> for Fault {
    fn from(error: HorizonError) -> Self {
        match error {
            HorizonError::Step(value) => Fault::NotPositive { what: "the step", value },
            HorizonError::Duration(value) => Fault::NotPositive { what: "the horizon", value },
            HorizonError::NotWhole { step, steps, .. } => Fault::NotWhole { step, steps },
            HorizonError::TooMany { steps, .. } => Fault::too_many_steps(steps as u64),
        }
    }
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
    /// A spring to a vertex that is not there.
    #[error(transparent)]
    Vertex(#[from] UnknownVertex),
    /// The sparse matrix of an implicit step.
    #[error(transparent)]
    Sparse(#[from] SparseError),
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
}

/// A step that failed, where, and what was computed before.
#[derive(Debug, thiserror::Error)]
#[error("step {step}, from t = {time} {unit}: {}", self.reason())]
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
    /// Why it failed.
    #[source]
    pub source: StepError,
    /// The run up to there; its last sample is the state from which the step failed.
    pub run: Box<Run>,
}

/// The names of the coordinates.
pub(crate) const COORDINATES: [&str; 3] = ["x", "y", "z"];

/// The error, with the first and the last residual where it has a list of them.
fn brief(error: &StepError) -> String {
    let text = error.to_string();
    let StepError::Newton(NewtonError { history, .. }) = error else {
        return text;
    };
    let before = text.split("; residuals").next().unwrap_or_default();
    match (history.first(), history.last()) {
        (Some(first), Some(last)) => {
            format!("{before}, its residual first {first:.1e}, last {last:.1e}")
        }
        _ => before.to_owned(),
    }
}

/// The unknown at which Newton's method met a number that is not finite.
pub(crate) fn unknown(error: &StepError) -> Option<usize> {
    match error {
        StepError::Newton(NewtonError { failure: NewtonFailure::NonFinite(unknown), .. }) => {
            Some(*unknown)
        }
        _ => None,
    }
}

impl Interruption {
    fn reason(&self) -> String {
        let (particle, coordinate) = (&self.particle, COORDINATES[self.coordinate.min(2)]);
        match &self.source {
            StepError::NonFiniteConfiguration { .. } => {
                format!("the position of `{particle}` is not finite, first in {coordinate}")
            }
            StepError::NonFiniteMomentum { .. } => {
                format!("the momentum of `{particle}` is not finite, first in {coordinate}")
            }
            other if unknown(other).is_some() => {
                format!("{}; that is `{particle}` in {coordinate}", brief(other))
            }
            other => format!(
                "{}; the largest acceleration is that of `{particle}` in {coordinate}",
                brief(other)
            ),
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
