//! What a scene's text may say that cannot be, without the place where it says so.

mod bodies;
mod claims;
mod drives;

use stationary_calculus::Readable;
use stationary_integrators::HorizonError;

pub use bodies::BodyFault;
pub use claims::ClaimFault;
pub use drives::DriveFault;

use crate::text::limits;

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
    /// Arithmetic that comes to no number.
    #[error("{0}")]
    Expression(String),
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
    /// A word of the vocabulary whose cargo feature is not on.
    #[error(
        "`{word}` needs the cargo feature `{feature}` of stationary-scene, which is not compiled"
    )]
    NotCompiled {
        /// The word.
        word: &'static str,
        /// The feature.
        feature: &'static str,
    },
    /// A number that must be finite.
    #[error("{what} is {value}; it must be finite", value = Readable(value))]
    NotFinite {
        /// What the number is.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A number that must be positive, finite, and so large that one over it is finite.
    #[error("{what} is {value}; it must be positive and finite", value = Readable(value))]
    NotPositive {
        /// What the number is.
        what: &'static str,
        /// The number.
        value: f64,
    },
    /// A tolerance outside its range.
    #[error("the tolerance is {value:e}; it must be at least {:e} and below 1", limits::TOLERANCE)]
    Tolerance {
        /// The tolerance.
        value: f64,
    },
    /// A method that chooses its steps needs to know how well.
    #[error("this integrator chooses its own steps and needs a `tolerance`")]
    NoTolerance,
    /// A tolerance for a method that could not keep it.
    #[error("only an integrator that chooses its own steps has a tolerance")]
    EqualSteps,
    /// A method that cannot step what the scene has.
    #[error("`{method}` cannot step {what}: {instead}")]
    MethodCannot {
        /// The method.
        method: &'static str,
        /// What it cannot step.
        what: &'static str,
        /// What to do instead.
        instead: &'static str,
    },
    /// Motion by modes needs to know how many.
    #[error("`linear-modes` needs the number of `modes`")]
    NoModes,
    /// No modes, or too many.
    #[error("{modes} modes; there must be at least 1 and at most {}", limits::MODES)]
    NumberOfModes {
        /// How many were asked for.
        modes: u64,
    },
    /// Modes for a method that has none.
    #[error("only the integrator `linear-modes` has a number of modes")]
    Modes,
    /// The ends of a rod are one particle.
    #[error("both ends of the rod are `{0}`")]
    RodLoop(String),
    /// A rod between two places that stay anyway.
    #[error("both ends of the rod are pinned")]
    RodBetweenPins,
    /// Two rods between the same particles.
    #[error("there is already a rod between `{first}` and `{second}`")]
    RepeatedRod {
        /// One end.
        first: String,
        /// The other end.
        second: String,
    },
    /// A rod has a length at the start.
    #[error("the rod starts with length {}; it must be positive and finite", Readable(.0))]
    RodLength(f64),
    /// A tension between particles that no rod joins.
    #[error("no rod joins these particles")]
    NoRod,
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
    #[error("the rest length is {}; it must be positive, or zero with Cauchy strain", Readable(.0))]
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
    /// The cells of a net are squares, and shapes are not sheared.
    #[error("the two sides are not at a right angle")]
    NotPerpendicular,
    /// A shape is made or read.
    #[error("a shape has a `kind` with `size` and `cells`, or a `file`")]
    ShapeOrFile,
    /// A shape that does not fit into the scene.
    #[error("the shape `{kind}` does not fit into a scene of dimension {dimension}")]
    ShapeDimension {
        /// The shape.
        kind: String,
        /// The scene's dimension.
        dimension: usize,
    },
    /// Sizes or cells of another number.
    #[error("`{key}` has {got} numbers here; this shape needs {expected}, for {what}")]
    ShapeNumbers {
        /// The key.
        key: &'static str,
        /// How many numbers the shape needs.
        expected: usize,
        /// How many there are.
        got: usize,
        /// What the sizes are.
        what: &'static str,
    },
    /// A shape that cannot be cut into cells.
    #[error("{0}")]
    Shape(String),
    /// A file that is not in the scene's folder.
    #[error(
        "`{0}` is not in the folder of the scene's file, where meshes and tables are looked for"
    )]
    OutsideFolder(String),
    /// A file beside the scene's that is no mesh or no table.
    #[error("`{file}`: {why}")]
    FileBeside {
        /// The file.
        file: String,
        /// What is wrong with it.
        why: String,
    },
    /// A material that cannot be.
    #[error("{0}")]
    Solid(String),
    /// Bars and sheets in space have one material.
    #[error(
        "material `{0}` is for volumes; bars, and sheets in space, support only `saint-venant-kirchhoff`"
    )]
    MaterialOfBlocks(String),
    /// A block is as thick as it is.
    #[error("a solid that fills space has neither a section nor a thickness")]
    SectionOfBlock,
    /// A bar has a cross-section, a sheet a thickness.
    #[error("this solid needs a `{0}`: a bar has a section, a sheet a thickness")]
    Section(&'static str),
    /// Only a sheet in space is bent.
    #[error("only a sheet in space has a bending stiffness")]
    Bending,
    /// Hinges are between the flat triangles of linear elements.
    #[error(
        "a sheet of quadratic elements has no bending stiffness: its folds are between the flat \
         triangles of `linear` ones"
    )]
    BendingOfQuadratic,
    /// A file of quadratic elements where linear ones are asked for.
    #[error(
        "its elements have nodes in the middle of their edges, which only a solid with \
         `element = \"quadratic\"` has"
    )]
    QuadraticMesh,
    /// A side of an axis that the shape does not have.
    #[error("this shape has no side `{0}`")]
    NoSuchSide(String),
    /// Heat alone.
    #[error(
        "heat cannot be combined with what moves: nothing here couples temperature and motion; make two scenes"
    )]
    MixedWithHeat,
    /// A warm place beside the shape.
    #[error("no vertex of the shape is within this radius")]
    Nowhere,
    /// Nothing through which heat could flow.
    #[error("the temperature of every vertex is held, so that nothing can change")]
    AllHeld,
    /// An observable of another kind of scene.
    #[error("this observable is not available in {0}")]
    ObservableOfAnother(&'static str),
    /// A number below zero.
    #[error("{what} is {value}; it must not be negative", value = Readable(value))]
    Negative {
        /// What has this value.
        what: &'static str,
        /// The value.
        value: f64,
    },
    /// A coefficient of restitution out of its range.
    #[error("the restitution is {}; it must be between 0 and 1", Readable(.0))]
    Restitution(f64),
    /// Particles do not turn, and have no friction here.
    #[error("particles have no friction; only bodies do")]
    FrictionOfParticles,
    /// Particles are all alike where they touch.
    #[error("`{0}` applies to bodies only")]
    OfBodiesOnly(&'static str),
    /// A pair is two things.
    #[error("a pair is two bodies, or a body and a wall or ball that has a name, not {0}")]
    PairEnds(usize),
    /// A pair that never touches.
    #[error("these two never touch: a pair has two different things, and one of them moves")]
    PairNeverMeets,
    /// What does not move cannot be placed.
    #[error("the first of the two is moved until they touch: it must be a body")]
    PlacedFixed,
    /// A body for which no place was found.
    #[error(
        "no place was found at which the two touch; what is left between them is {gap}",
        gap = Readable(gap)
    )]
    NotPlaced {
        /// The gap.
        gap: f64,
    },
    /// Two declarations of one pair.
    #[error("there is already a pair of these two")]
    DuplicatePair,
    /// A pair like all others.
    #[error(
        "a pair has a `restitution`, `friction`, `rolling` or `torsion` of its own, or `meet = false`"
    )]
    PairSaysNothing,
    /// A surface where nothing touches.
    #[error("what passes through each other has no restitution and no friction")]
    SurfaceOfNoContact,
    /// Two things that touch, of one name.
    #[error("there is already a body, a wall or a ball called `{0}`")]
    DuplicateSurface(String),
    /// Bodies are given their impulses before a step.
    #[error("`when` applies to particles only")]
    WhenOfBodies,
    /// Bodies touch by impulses.
    #[error("`stiffness` applies to particles only")]
    StiffnessOfBodies,
    /// Springs know no impulses.
    #[error("`{0}` cannot be combined with `stiffness`")]
    ImpulseOfSprings(&'static str),
    /// Things that overlap before anything has moved.
    #[error("`{name}` overlaps an obstacle by {depth:e} at t = 0")]
    Overlap {
        /// The particle.
        name: String,
        /// How deep.
        depth: f64,
    },
    /// A strike beside the solid.
    #[error("no vertex within the strike radius")]
    StruckNothing,
    /// Two solids of one name.
    #[error("there is already a solid called `{0}`")]
    DuplicateSolid(String),
    /// A direction has a length.
    #[error("{what} has no direction: all its components are zero")]
    NoDirection {
        /// The direction.
        what: &'static str,
    },
    /// Only a scene in space can be seen from several sides.
    #[error("a view needs a scene of dimension 3")]
    ViewDimension,
    /// Nothing turns about the normal of a contact in the plane.
    #[error(
        "`torsion` resists turns about the normal of a contact: it needs a scene of dimension 3"
    )]
    TorsionDimension,
    /// The horizon is a whole number of steps.
    #[error(
        "the horizon is {steps} steps of {step}; it must be a whole number of steps",
        steps = Readable(steps), step = Readable(step)
    )]
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
    /// Elastic bodies are not coupled to rigid ones.
    #[error(
        "elastic and rigid bodies are not coupled yet, and there are rigid bodies already; leave one of \
         them out"
    )]
    ElasticBesideRigid,
    /// Both ends of a spring or a rod are on one body.
    #[error("`{0}` and `{1}` are points of one body, whose distance nothing changes")]
    SameBody(String, String),
    /// The attraction of most bodies is not that of points.
    #[error(
        "`{0}` does not attract as a point: `newtonian_gravity` is between particles and, in space, balls; the \
         attraction of other bodies, such as a disc in the plane, depends on how their mass is distributed"
    )]
    BodyAttraction(String),
    /// A method that does not hold joints.
    #[error("{0} does not hold joints")]
    MethodOfJoints(String),
    /// A method of another kind of scene.
    #[error("{0} does not move what is in this scene")]
    MethodOfAnother(String),
    /// An angular velocity of something that does not turn.
    #[error("`{0}` is no body, and has no angular velocity")]
    NotABody(String),
    /// Nothing there.
    #[error(
        "the scene has no particles: it needs [[particles]], [[nets]], [[solids]] or [[bodies]]"
    )]
    Empty,
    /// Nothing that can move.
    #[error("every particle is pinned, so that nothing can move")]
    AllPinned,
    /// A body or a joint that cannot be.
    #[error(transparent)]
    Bodies(#[from] BodyFault),
    /// A load, a motor, a motion or a strength in time that cannot be.
    #[error(transparent)]
    Drives(#[from] DriveFault),
    /// A claim that cannot be checked.
    #[error(transparent)]
    Claims(#[from] ClaimFault),
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
