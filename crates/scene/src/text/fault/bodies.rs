//! What is wrong with bodies and joints.

use stationary_calculus::Readable;

/// What is wrong with bodies and joints.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BodyFault {
    /// A body turns, which takes two dimensions.
    #[error("a body needs a scene of dimension 2 or 3")]
    BodyDimension,
    /// The name of the frame in which nothing moves.
    #[error("`world` is what joints call the frame that does not move; no body has this name")]
    WorldName,
    /// Two bodies of one name.
    #[error("there is already a body called `{0}`")]
    DuplicateBody(String),
    /// A body has one shape, or moments of its own.
    #[error(
        "`{0}` needs one of `box`, `ball`, `polygon`, `capsule`, `cylinder`, `cone`, `ellipsoid`, `hull`, \
         `parts` and its `moments` of inertia"
    )]
    BodyShape(String),
    /// Two masses of one body.
    #[error("the mass of a body of `parts` is theirs together; leave this one out")]
    MassOfParts,
    /// A body of no parts.
    #[error("a body of `parts` needs one at least")]
    NoParts,
    /// A part has one shape.
    #[error(
        "a part needs one of `box`, `ball`, `polygon`, `capsule`, `cylinder`, `cone`, `ellipsoid` and `hull`"
    )]
    PartShape,
    /// A shape of space.
    #[error("`{0}` needs a scene of dimension 3")]
    SolidInThePlane(&'static str),
    /// Points without a volume.
    #[error("these points enclose no volume: a hull needs four that are not in one plane")]
    FlatHull,
    /// A body is somewhere.
    #[error(
        "`{0}` needs a `position`; only a polygon, a hull and parts may go without, and stay where they \
         are drawn"
    )]
    NoPosition(String),
    /// A polygon is flat.
    #[error("a polygon needs a scene of dimension 2")]
    PolygonDimension,
    /// Corners that bound no area, or edges that cross.
    #[error(
        "not a simple polygon: it needs three corners that bound an area, and edges that do not cross"
    )]
    NoPolygon,
    /// A body that cannot touch.
    #[error("`{0}` has no shape that could touch: give it one instead of its `moments`")]
    Untouchable(String),
    /// Mass and moments that no body has.
    #[error("{0}")]
    Body(String),
    /// A number where a vector belongs, or a vector where a number does.
    #[error("{what} is {} in a scene of dimension {dimension}", turn(*dimension))]
    Turn {
        /// What belongs to turning.
        what: &'static str,
        /// The scene's dimension.
        dimension: usize,
    },
    /// Joints without bodies.
    #[error("joints need [[bodies]] to join")]
    NoBodies,
    /// A joint has two sides.
    #[error("a joint is between two bodies, or a body and `world`, not {0}")]
    JointEnds(usize),
    /// Both sides of a joint are one body.
    #[error("both sides of the joint are `{0}`")]
    JoinedToItself(String),
    /// A hinge turns about something, a slider shifts along something.
    #[error("a hinge or a slider needs an `axis`")]
    HingeAxis,
    /// Only a hinge and a slider have an axis.
    #[error("only a hinge or a slider has an axis")]
    NoHinge,
    /// Two bodies that move apart where they are joined.
    #[error(
        "`{first}` and `{second}` move apart at {apart} a unit of time where they are joined: velocities that are \
         given must fit there, and those that are not must follow from them",
        apart = Readable(apart)
    )]
    JointTorn {
        /// One side.
        first: String,
        /// The other.
        second: String,
        /// The size of the difference of their velocities there.
        apart: f64,
    },
    /// Two bodies that turn against each other as their joint forbids.
    #[error(
        "the two sides turn against each other at {turn} radians a unit of time, as the joint forbids",
        turn = Readable(turn)
    )]
    JointTurns {
        /// The size of what is forbidden of the difference of their angular velocities.
        turn: f64,
    },
    /// A spring or a damper at a joint that does not turn about one axis.
    #[error(
        "`stiffness`, `rest` and `damping` are of a `pin` or a `hinge`; this joint has no one axis to turn about"
    )]
    SpringWithoutAxis,
    /// Limits or friction of a joint without one turn or shift that is measured.
    #[error(
        "`limits` and `friction` are of a `pin`, a `hinge` or a `slider`; this joint has no one turn or shift"
    )]
    BoundsWithoutCoordinate,
    /// Limits that do not hold the start between them.
    #[error(
        "the limits are {low} and {high}; the least comes first, and the start, which is at 0, is between them",
        low = Readable(low), high = Readable(high)
    )]
    LimitsBesideTheStart {
        /// The first.
        low: f64,
        /// The second.
        high: f64,
    },
    /// A turn is known up to whole ones.
    #[error("the turn is {} radians; it must be within half a turn, from -pi to pi", Readable(.0))]
    BeyondHalfATurn(f64),
    /// The rest of no spring.
    #[error("`rest` is of a spring: this joint has no `stiffness`")]
    RestWithoutSpring,
}

/// What turning is told by.
fn turn(dimension: usize) -> &'static str {
    if dimension == 2 { "a number" } else { "a vector" }
}
