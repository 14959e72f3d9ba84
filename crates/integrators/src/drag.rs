//! Linear drag: each freedom is held back in proportion to its velocity.
//!
//! ```text
//! F = -C v,    C = diag(c_1, ..., c_n)
//! ```
//! `v` velocity (n), `c` coefficients (n, N s/m, or N m s for angles), not negative. Its power is
//! `-<C v, v>`, so it never adds energy. Source: notes 10.1.1.

use stationary_calculus::{Covector, Force, Sink, Storage, Vector};

use crate::ForceError;

/// Linear drag on each freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct Drag<C>(C);

impl<C: Storage> Drag<C> {
    /// A coefficient for each freedom.
    ///
    /// # Errors
    /// Where a coefficient is negative or not finite.
    pub fn new(coefficients: C) -> Result<Self, ForceError> {
        for (freedom, &coefficient) in coefficients.as_ref().iter().enumerate() {
            if !(coefficient >= 0.0 && coefficient.is_finite()) {
                return Err(ForceError::Drag { freedom, coefficient });
            }
        }
        Ok(Drag(coefficients))
    }
}

impl<C: Storage> Force for Drag<C> {
    fn dim(&self) -> usize {
        self.0.as_ref().len()
    }

    #[inline]
    fn add_force(&self, _t: f64, _q: &[f64], v: Vector<&[f64]>, f: Covector<&mut [f64]>) {
        for ((f, v), c) in f.0.iter_mut().zip(v.0).zip(self.0.as_ref()) {
            *f -= c * v;
        }
    }

    #[inline]
    fn add_damping(&self, _t: f64, _q: &[f64], _v: Vector<&[f64]>, damping: &mut impl Sink) {
        for (freedom, &c) in self.0.as_ref().iter().enumerate() {
            damping.add_symmetric(&[freedom], &[c]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use stationary_calculus::ProductSink;

    proptest! {
        #[test]
        fn the_damping_is_the_derivative_of_the_force_and_takes_energy_away(
            v in prop::array::uniform3(-10.0..10.0), c in prop::array::uniform3(0.0..10.0),
        ) {
            let drag = Drag::new(c).unwrap();
            let (mut f, mut cv) = (Covector([0.0; 3]), [0.0; 3]);
            drag.add_force(1.0, &[0.0; 3], Vector(v).view(), f.view_mut());
            let mut product = ProductSink::new(-1.0, &v, &mut cv).unwrap();
            drag.add_damping(1.0, &[0.0; 3], Vector(v).view(), &mut product);
            prop_assert_eq!(f.0, cv);
            prop_assert!(f.apply(&Vector(v)) <= 0.0);
        }
    }

    #[test]
    fn a_coefficient_that_drives_is_refused_by_name() {
        for c in [-1.0, f64::NAN, f64::INFINITY] {
            let error = Drag::new([1.0, c]).unwrap_err();
            assert!(matches!(error, ForceError::Drag { freedom: 1, .. }), "{error}");
        }
    }
}
