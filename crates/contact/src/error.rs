//! What can go wrong in this crate.

use stationary_calculus::{MetricError, Readable, SizeError};
use stationary_constraints::ConstraintError;
use stationary_integrators::StepError;
use stationary_rigid::RigidError;

/// Input that is no contact problem, or a problem that could not be solved.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ContactError {
    /// A coefficient of restitution lies between 0 and 1.
    #[error(
        "the restitution of contact {contact} is {value}; it lies between 0 and 1",
        value = Readable(value)
    )]
    Restitution {
        /// The contact, counted from 0.
        contact: usize,
        /// Its coefficient.
        value: f64,
    },
    /// A coefficient of friction is not negative.
    #[error(
        "the friction of contact {contact} is {value}; it is a finite number of at least 0",
        value = Readable(value)
    )]
    Friction {
        /// The contact, counted from 0.
        contact: usize,
        /// Its coefficient.
        value: f64,
    },
    /// A length of rolling or torsional friction.
    #[error(
        "the rolling friction of colliders {colliders:?} is {length} m; it is finite and at least 0",
        length = Readable(length)
    )]
    Rolling {
        /// The pair.
        colliders: [usize; 2],
        /// The length, m.
        length: f64,
    },
    /// No impulse moves what is immovable on both sides.
    #[error("contact {contact} is between two things that no impulse moves")]
    Immovable {
        /// The contact, counted from 0.
        contact: usize,
    },
    /// A differential has an entry for a freedom that the system does not have.
    #[error("the differential of contact {contact} names freedom {freedom} of {freedoms}")]
    NoSuchFreedom {
        /// The contact, counted from 0.
        contact: usize,
        /// The freedom that it names.
        freedom: usize,
        /// The freedoms that there are.
        freedoms: usize,
    },
    /// A number that is not finite.
    #[error("{what}: number {index} is {value}")]
    NonFinite {
        /// What holds it.
        what: &'static str,
        /// Its place.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A mass matrix that is not positive definite.
    #[error("the mass of freedom {freedom} and those coupled to it is not positive definite")]
    Mass {
        /// The first freedom of the block.
        freedom: usize,
    },
    /// A body turns too far in one step.
    #[error("body {body} turns by up to {angle:.1e} rad in a step; take shorter steps")]
    Turn {
        /// The body, counted from 0.
        body: usize,
        /// The largest angle that its energy allows, rad.
        angle: f64,
    },
    /// Contacts still approach when the bound on the iterations is reached.
    #[error(
        "{what}: after {iterations} iterations contacts are off by {residual} m/s",
        residual = Readable(residual)
    )]
    NotConverged {
        /// Which iteration.
        what: &'static str,
        /// How many there were.
        iterations: usize,
        /// How far the conditions are from being met, m/s.
        residual: f64,
        /// The velocity that it had reached.
        velocity: Vec<f64>,
    },
    /// A size of a shape that must be positive and finite.
    #[error(
        "the {what} of a {shape} is {value} m; it must be positive and finite",
        value = Readable(value)
    )]
    Length {
        /// The shape.
        shape: &'static str,
        /// Which of its sizes.
        what: &'static str,
        /// The size.
        value: f64,
    },
    /// A shape of no thickness, or with a hole.
    #[error("the points of a {shape} enclose nothing")]
    Flat {
        /// The shape.
        shape: &'static str,
    },
    /// A part of a mesh starts on another part, on neither side of it.
    #[error("parts of the mesh with the vertices {vertices:?} start at distance 0 and meet")]
    Touching {
        /// A vertex and those of a triangle, or those of two edges.
        vertices: [usize; 4],
    },
    /// A triangle names a vertex that the mesh does not have.
    #[error("triangle {triangle} names vertex {vertex} of {vertices}")]
    NoSuchVertex {
        /// The triangle.
        triangle: usize,
        /// What it names.
        vertex: usize,
        /// The vertices that there are.
        vertices: usize,
    },
    /// Bodies overlap where they must not.
    #[error(
        "{count} pairs overlap, colliders {first} and {second} by {depth} m",
        depth = Readable(depth)
    )]
    Overlap {
        /// How many pairs.
        count: usize,
        /// One collider of the deepest pair.
        first: usize,
        /// The other.
        second: usize,
        /// How deep, m.
        depth: f64,
    },
    /// Two shapes between which there is no query.
    #[error("there is no contact between {first} and {second}")]
    NoQuery {
        /// One shape.
        first: &'static str,
        /// The other.
        second: &'static str,
    },
    /// A stiffness that must be positive and finite.
    #[error("the stiffness is {} N/m; it must be positive and finite", Readable(.0))]
    Stiffness(f64),
    /// A depth of overlaps that may be left.
    #[error(
        "the depth to which bodies may overlap is {} m; it must be finite and not negative",
        Readable(.0)
    )]
    Depth(f64),
    /// A distance at which to look for contacts.
    #[error("the margin is {} m; it must be finite and not negative", Readable(.0))]
    Margin(f64),
    /// How far contact conditions are to be met.
    #[error(
        "the tolerance of contact conditions is {} m/s; it must be finite and not negative",
        Readable(.0)
    )]
    Settling(f64),
    /// A distance up to which things count as touching.
    #[error("the thickness is {} m; it must be finite and not negative", Readable(.0))]
    Thickness(f64),
    /// A tolerance below rounding.
    #[error(
        "the tolerance is {} m; it must be finite and above the rounding of the coordinates",
        Readable(.0)
    )]
    Tolerance(f64),
    /// More impacts in a step than the bound allows.
    #[error("more than {bound} impacts in the step that starts at {time} s", time = Readable(time))]
    TooManyImpacts {
        /// The bound.
        bound: usize,
        /// When the step starts.
        time: f64,
    },
    /// An accuracy to which steps are chosen.
    #[error("the accuracy must be positive and finite (got {} m)", Readable(.0))]
    Accuracy(f64),
    /// A step that may not get any shorter is off by more than its share of the accuracy.
    #[error(
        "at {time} s a step of {step} s is off by {off} m, more than {share} m, and cannot be shorter",
        time = Readable(time), step = Readable(step), off = Readable(off), share = Readable(share)
    )]
    StepTooShort {
        /// When the step starts.
        time: f64,
        /// Its length, s.
        step: f64,
        /// By how much it is off, m.
        off: f64,
        /// By how much it may be off, m.
        share: f64,
    },
    /// More steps than the bound allows.
    #[error("more than {bound} steps of chosen length, at {time} s", time = Readable(time))]
    TooManySteps {
        /// The bound.
        bound: usize,
        /// How far they led, s.
        time: f64,
    },
    /// A step of an integrator failed.
    #[error(transparent)]
    Step(#[from] StepError),
    /// Two sizes that must agree.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// A body or a pose that is none.
    #[error(transparent)]
    Rigid(#[from] RigidError),
    /// Rows that are none, or name a freedom that does not answer.
    #[error(transparent)]
    Rows(#[from] ConstraintError),
    /// An outline that bounds no polygon.
    #[cfg(feature = "2d")]
    #[error(transparent)]
    Outline(#[from] stationary_mesh::MeshError),
}

impl From<MetricError> for ContactError {
    /// Of masses that stand alone; of a matrix the first freedom is named.
    fn from(error: MetricError) -> Self {
        let freedom = if let MetricError::NotAMass { freedom, .. } = error { freedom } else { 0 };
        ContactError::Mass { freedom }
    }
}

/// An error unless a step ends at a time.
pub(crate) fn check_time(t: f64) -> Result<(), StepError> {
    if t.is_finite() { Ok(()) } else { Err(StepError::Time(t)) }
}

/// An error unless every number is finite.
#[inline]
pub(crate) fn check_finite(what: &'static str, numbers: &[f64]) -> Result<(), ContactError> {
    match stationary_calculus::first_non_finite(numbers) {
        Some(index) => Err(ContactError::NonFinite { what, index, value: numbers[index] }),
        None => Ok(()),
    }
}

/// An error unless a size of a shape is positive and finite.
#[cfg(any(feature = "2d", feature = "3d"))]
pub(crate) fn check_length(
    shape: &'static str,
    what: &'static str,
    value: f64,
) -> Result<(), ContactError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ContactError::Length { shape, what, value })
}
