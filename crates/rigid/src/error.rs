//! What can go wrong in this crate.

use stationary_calculus::{Readable, SizeError};

use crate::{JointFault, JointName};

/// Input that is no rotation, no body or no pose.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RigidError {
    /// A mass is positive.
    #[error("the mass is {} kg; it must be positive and finite", Readable(.0))]
    Mass(f64),
    /// A solid body resists every turn.
    #[error(
        "the moment of inertia about axis {axis} is {moment} kg m^2; it must be positive and finite",
        moment = Readable(moment)
    )]
    Moment {
        /// The axis, 0 to 2.
        axis: usize,
        /// Its moment.
        moment: f64,
    },
    /// No distribution of mass has these moments.
    #[error(
        "moment {axis} of {moments:?} exceeds the sum of the others: no mass is distributed like that"
    )]
    TriangleInequality {
        /// The axis of the largest moment.
        axis: usize,
        /// The principal moments, kg m^2.
        moments: [f64; 3],
    },
    /// An inertia tensor is symmetric.
    #[error(
        "the inertia tensor is not symmetric: ({row}, {column}) is {entry}, its mirror image {mirror}",
        entry = Readable(entry), mirror = Readable(mirror)
    )]
    NotSymmetric {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        entry: f64,
        /// The entry at (column, row).
        mirror: f64,
    },
    /// A quaternion that stands for a rotation has length 1.
    #[error("the quaternion has length {length}; a rotation's is 1", length = Readable(length))]
    NotUnit {
        /// Its length.
        length: f64,
    },
    /// A rotation matrix is orthogonal.
    #[error(
        "R^T R is off from the identity by {defect}; a rotation's matrix is orthogonal",
        defect = Readable(defect)
    )]
    NotOrthogonal {
        /// The largest entry of `R^T R - I`.
        defect: f64,
    },
    /// A rotation does not turn right hands into left ones.
    #[error(
        "the matrix has determinant {determinant}: it reflects",
        determinant = Readable(determinant)
    )]
    Reflection {
        /// Its determinant.
        determinant: f64,
    },
    /// An axis has a direction.
    #[error("the axis {0:?} has no direction")]
    NoAxis([f64; 3]),
    /// A turn so long that rounding has taken its phase.
    #[error("a turn by {radians:e} radians: no digit of its phase is left")]
    PhaseLost {
        /// The turn.
        radians: f64,
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
    /// The body of this number is wrong.
    #[error(
        "a quaternion of length {length} at body {body}; a rotation's is 1",
        length = Readable(length)
    )]
    Pose {
        /// The body, counted from 0.
        body: usize,
        /// The length of its quaternion.
        length: f64,
    },
    /// Euler angles are lost where the middle one lines up the other two axes.
    #[error(
        "gimbal lock: the pitch is {pitch} rad, where yaw and roll turn about the same axis",
        pitch = Readable(pitch)
    )]
    GimbalLock {
        /// The middle angle, radians.
        pitch: f64,
        /// The sum (pitch up) or difference (pitch down) of roll and yaw that is left, radians.
        turn: f64,
    },
    /// A matrix without a real logarithm, or too ill-conditioned to find one.
    #[error("the matrix has no real logarithm that square roots reach: {reason}")]
    NoLogarithm {
        /// What was met on the way.
        reason: &'static str,
    },
    /// A matrix whose exponential would have no right digit.
    #[error("the matrix has norm {norm:e}: no digit of its exponential would be right beyond 1e15")]
    TooLarge {
        /// Its norm.
        norm: f64,
    },
    /// The singular values of a matrix were not found.
    #[error("the singular values of a {rows} x {columns} matrix did not converge")]
    NotDecomposed {
        /// Its rows.
        rows: usize,
        /// Its columns.
        columns: usize,
    },
    /// Something names a body that is not there.
    #[error("there is no body {body}: there are {bodies}, counted from 0")]
    NoSuchBody {
        /// The body that it names.
        body: usize,
        /// How many there are.
        bodies: usize,
    },
    /// A joint that holds nothing, or cannot be.
    #[error("{joint}: {fault}")]
    Joint {
        /// The joint.
        joint: JointName,
        /// What is wrong with it.
        fault: JointFault,
    },
    /// A box has sizes.
    #[error(
        "half the box's size along axis {axis} is {half} m; it must be finite and not negative",
        half = Readable(half)
    )]
    HalfSize {
        /// The axis, 0 to 2.
        axis: usize,
        /// Half its size.
        half: f64,
    },
    /// A round body has a size.
    #[error("the {what} is {value} m; it must be positive and finite", value = Readable(value))]
    Length {
        /// Which length.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// A density is positive.
    #[error("the density is {}; it must be positive and finite", Readable(.0))]
    Density(f64),
    /// A shape whose area or volume is not positive, or whose moments are not numbers.
    #[error(
        "the shape has measure {measure}; a body needs a positive and finite one",
        measure = Readable(measure)
    )]
    NoMeasure {
        /// Its area (m^2) or volume (m^3).
        measure: f64,
    },
    /// A number that is not negative.
    #[error("{what} is {value}; it must be finite and not negative", value = Readable(value))]
    Negative {
        /// What it is.
        what: &'static str,
        /// Its value.
        value: f64,
    },
    /// Something has the wrong size.
    #[error(transparent)]
    Size(#[from] SizeError),
}

/// The first of these numbers that is not finite, as an error.
pub(crate) fn check_finite(what: &'static str, numbers: &[f64]) -> Result<(), RigidError> {
    match stationary_calculus::first_non_finite(numbers) {
        Some(index) => Err(RigidError::NonFinite { what, index, value: numbers[index] }),
        None => Ok(()),
    }
}

/// An error where a number is negative or not finite.
pub(crate) fn check_not_negative(what: &'static str, value: f64) -> Result<(), RigidError> {
    let fits = value >= 0.0 && value.is_finite();
    if fits { Ok(()) } else { Err(RigidError::Negative { what, value }) }
}
