//! What can be wrong with a tree: the joint is named, with its kind and its bodies.

use std::fmt;

use stationary_calculus::{Readable, SizeError, first_non_finite};

use crate::{JointFault, JointName};

/// A joint as a message names it: its kind, the body that hangs from it, and what that hangs from.
///
/// A joint has the number of the body that hangs from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Joining {
    /// The kind of the joint.
    pub kind: &'static str,
    /// The body that hangs from it, counted from 0.
    pub body: usize,
    /// What it hangs from; `None` is the world.
    pub parent: Option<usize>,
}

impl fmt::Display for Joining {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.parent {
            Some(parent) => {
                write!(f, "joint {} ({}, body {0} to body {parent})", self.body, self.kind)
            }
            None => write!(f, "joint {} ({}, body {0} to the world)", self.body, self.kind),
        }
    }
}

/// What is no tree, or does not fit one.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TreeError {
    /// A joint names a body that is not there.
    #[error("{joining}: there is no such parent among {bodies} bodies, counted from 0")]
    NoSuchParent {
        /// The joint.
        joining: Joining,
        /// How many bodies there are.
        bodies: usize,
    },
    /// A body hangs, over its parents, from itself.
    #[error("{joining}: the parent comes no earlier than the body; a tree is built from its root")]
    Circle {
        /// The joint.
        joining: Joining,
    },
    /// A joint that cannot be.
    #[error("{joining}: {fault}")]
    Joint {
        /// The joint.
        joining: Joining,
        /// What is wrong with it.
        fault: JointFault,
    },
    /// A joint moves what has no mass.
    #[error("{joining}: it moves bodies without mass only; one of them must have a mass")]
    Massless {
        /// The joint.
        joining: Joining,
    },
    /// A freedom meets no inertia at this configuration.
    #[error(
        "{joining}: freedom {freedom} moves without inertia here ({inertia:e}): no force has a motion"
    )]
    Singular {
        /// The joint.
        joining: Joining,
        /// The freedom of the joint, counted from 0.
        freedom: usize,
        /// The inertia that it meets, kg or kg m^2.
        inertia: f64,
    },
    /// A joint that cannot close a loop.
    #[error("{joint}: {fault}")]
    Loop {
        /// The joint.
        joint: JointName,
        /// What is wrong with it.
        fault: JointFault,
    },
    /// Rows of loops that ask the same of the tree.
    #[error("the {rows} rows of the loops depend on each other here; leave out what others hold")]
    DependentLoops {
        /// How many rows there are.
        rows: usize,
    },
    /// Loops that do not close near where they were.
    #[error("no closed configuration was found near: a gap of {gap:e} of the mechanism is left")]
    NotClosed {
        /// The largest gap, as a part of the distance of its points from their bodies' centres and
        /// from the origin, or as the cosine of an angle.
        gap: f64,
    },
    /// A quaternion without a direction.
    #[error(
        "{joining}: a quaternion of length {length}; it must have a direction",
        length = Readable(length)
    )]
    Quaternion {
        /// The joint.
        joining: Joining,
        /// Its length.
        length: f64,
    },
    /// A number that is not finite.
    #[error("{what}: number {index} is {value}; it must be finite")]
    NonFinite {
        /// What holds it.
        what: &'static str,
        /// Its place.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// Two schedules for one speed.
    #[error("speed {speed} is driven twice; a coordinate follows one schedule")]
    DrivenTwice {
        /// The speed, counted from 0.
        speed: usize,
    },
    /// A body that is not there.
    #[error("there is no body {body}: the tree has {bodies}, counted from 0")]
    NoSuchBody {
        /// The body.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// Something has the wrong size.
    #[error(transparent)]
    Size(#[from] SizeError),
}

/// An error unless there are as many numbers as there should be, all of them finite.
pub(super) fn check_numbers(
    what: &'static str,
    expected: usize,
    numbers: &[f64],
) -> Result<(), TreeError> {
    SizeError::check(what, expected, numbers.len())?;
    match first_non_finite(numbers) {
        Some(index) => Err(TreeError::NonFinite { what, index, value: numbers[index] }),
        None => Ok(()),
    }
}
