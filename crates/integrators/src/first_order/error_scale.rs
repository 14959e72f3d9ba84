//! The size of an error, measured against the tolerance.
//!
//! ```text
//! |e| = sqrt( 1/n sum_i (e_i / s_i)^2 ),      s_i = absolute_i + relative |y_i|
//! ```
//! `e` an error (n), `y` the state it belongs to; 1 is what may just be tolerated.

use stationary_calculus::{SizeError, Storage};

use super::Tolerance;
use crate::integrator::zeros;

/// The tolerance in the storage of the state.
#[derive(Clone, Debug)]
pub(crate) struct ErrorScale<C> {
    pub(crate) relative: f64,
    pub(crate) absolute: C,
}

impl<C: Storage> ErrorScale<C> {
    pub(crate) fn new(tolerance: &Tolerance, n: usize) -> Result<Self, SizeError> {
        let mut absolute: C = zeros(n)?;
        match tolerance.absolute.as_slice() {
            [same] => absolute.as_mut().fill(*same),
            each => {
                SizeError::check("the tolerances", n, each.len())?;
                absolute.as_mut().copy_from_slice(each);
            }
        }
        Ok(ErrorScale { relative: tolerance.relative, absolute })
    }

    /// Writes s for the state `y`.
    pub(crate) fn write(&self, y: &[f64], s: &mut [f64]) {
        for ((s, y), absolute) in s.iter_mut().zip(y).zip(self.absolute.as_ref()) {
            *s = absolute + self.relative * y.abs();
        }
    }
}

/// The sum of (e_i / s_i)^2.
#[inline]
pub(crate) fn sum_of_squares(e: &[f64], s: &[f64]) -> f64 {
    e.iter().zip(s).map(|(e, s)| (e / s) * (e / s)).sum()
}

/// The root mean square of e_i / s_i.
#[inline]
pub(crate) fn norm(e: &[f64], s: &[f64]) -> f64 {
    (sum_of_squares(e, s) / e.len().max(1) as f64).sqrt()
}
