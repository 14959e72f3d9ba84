//! What can be wrong with a joint, and how a message names it.

use stationary_calculus::Readable;
use std::fmt;

/// A joint as a message names it: its kind and its bodies, as "hinge between body 3 and the world".
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JointName {
    /// The kind.
    pub kind: &'static str,
    /// The bodies of its ends, counted from 0; `None` is the world.
    pub bodies: [Option<usize>; 2],
}

impl fmt::Display for JointName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} between ", self.kind)?;
        for (body, between) in self.bodies.iter().zip(["", " and "]) {
            match body {
                Some(body) => write!(f, "{between}body {body}")?,
                None => write!(f, "{between}the world")?,
            }
        }
        Ok(())
    }
}

/// What is wrong with the data of a joint.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum JointFault {
    /// An end on a body that is not there.
    #[error("there is no body {body}: there are {bodies}, counted from 0")]
    NoSuchBody {
        /// The body that it names.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// Two ends on one body, or on the world.
    #[error("it holds a body, or the world, to itself; its ends must be on different bodies")]
    ToItself,
    /// An end that moves by itself is one in the world.
    #[error("none of its ends is in the world; an end that moves along a path must be")]
    NoEndInWorld,
    /// An axis has a direction.
    #[error("axis {0:?} has no direction; it must be finite and not zero")]
    NoAxis([f64; 3]),
    /// Two axes along one line.
    #[error("axes {0:?} are parallel; they must span a plane")]
    Parallel([[f64; 3]; 2]),
    /// A number that is not finite.
    #[error("{what} is {value}; it must be finite")]
    NotFinite {
        /// What is not finite.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A length that is not positive.
    #[error("{what} is {value} m; it must be positive", value = Readable(value))]
    NotPositive {
        /// What is not positive.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Limits in the wrong order, not numbers, or of a turn beyond half a turn.
    #[error(
        "the limits are {low} and {high}; the first must be below the second, and those of a turn within \
         half a turn of zero",
        low = Readable(low), high = Readable(high)
    )]
    Limits {
        /// The lower limit.
        low: f64,
        /// The upper limit.
        high: f64,
    },
    /// The rotation of a frame whose quaternion has not length 1.
    #[error("the rotation of its frame has a quaternion of length {}; it must be 1", Readable(.0))]
    NotUnit(f64),
    /// A freedom that a schedule cannot prescribe.
    #[error(
        "freedom {freedom} has no coordinate of its own: {freedoms} of this joint have, counted from 0"
    )]
    NotDriven {
        /// The freedom.
        freedom: usize,
        /// How many freedoms have.
        freedoms: usize,
    },
    /// A kind that is told by its equations alone.
    #[error("nothing hangs by it: it closes a loop between bodies that hang by other joints")]
    RowsOnly,
}

impl JointFault {
    /// The value, unless it is none of a length.
    pub(crate) fn positive(what: &'static str, value: f64) -> Result<f64, JointFault> {
        match value {
            _ if !value.is_finite() => Err(JointFault::NotFinite { what, value }),
            _ if value <= 0.0 => Err(JointFault::NotPositive { what, value }),
            _ => Ok(value),
        }
    }
}
