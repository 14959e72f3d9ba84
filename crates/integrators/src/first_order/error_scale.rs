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

/// The larger of two errors. `f64::max` ignores what is not a number, which an error must not.
#[inline]
pub(crate) fn larger(a: f64, b: f64) -> f64 {
    if a.is_nan() || a > b { a } else { b }
}

/// The root mean square of e_i / s_i.
#[inline]
pub(crate) fn norm(e: &[f64], s: &[f64]) -> f64 {
    (sum_of_squares(e, s) / e.len().max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_that_is_not_a_number_is_the_larger_one() {
        assert!(larger(f64::NAN, 1.0).is_nan() && larger(1.0, f64::NAN).is_nan());
        assert_eq!(
            [larger(1.0, 2.0), larger(2.0, 1.0), larger(0.0, f64::INFINITY)],
            [2.0, 2.0, f64::INFINITY]
        );
    }
}
