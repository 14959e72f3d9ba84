//! Corners that move on straight lines, and what it means that they meet.
//!
//! ```text
//! a(t) = a0 + t (a1 - a0),   0 <= t <= 1
//! ```

use nalgebra::Vector3;

use crate::ContactError;

/// A corner that moves on a straight line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moving {
    /// Where it starts, m.
    pub start: Vector3<f64>,
    /// Where it ends.
    pub end: Vector3<f64>,
}

impl Moving {
    /// Where it is at a fraction of the time.
    #[inline]
    pub fn at(&self, t: f64) -> Vector3<f64> {
        self.start + (self.end - self.start) * t
    }
}

/// When and where two things meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// The fraction of the motion before which they are proved apart.
    pub time: f64,
    /// The coordinates u and v of the place.
    pub place: [f64; 2],
    /// Boxes looked at.
    pub boxes: usize,
    /// Whether the distance at [`Hit::time`] is as promised. Where the search hit its bound it is
    /// not known; that they are apart before still is.
    pub settled: bool,
}

/// How close is a hit, and how exactly it is to be found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closeness {
    /// A distance up to which things count as touching, m.
    pub thickness: f64,
    /// The excess over it that may be taken for a hit, m.
    pub tolerance: f64,
}

impl Closeness {
    /// An error unless both are finite, the thickness is not negative and the tolerance exceeds what
    /// is rounding.
    pub(crate) fn check(self, rounding: f64) -> Result<(), ContactError> {
        if !(self.tolerance > rounding && self.tolerance.is_finite()) {
            return Err(ContactError::Tolerance(self.tolerance));
        }
        if !(self.thickness >= 0.0 && self.thickness.is_finite()) {
            return Err(ContactError::Thickness(self.thickness));
        }
        Ok(())
    }
}
