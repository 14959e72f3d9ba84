//! A point that is held in place.
//!
//! ```text
//! g = x_i - a        D equations
//! F = -lambda        the force of the hold on the point, newtons
//! ```
//! `x_i` a free point in D dimensions, `a` the place, metres. A hold that moves is a
//! [`FunctionConstraint`](crate::FunctionConstraint).

use stationary_calculus::{Flat, Sink, SizeError};

use crate::{
    Constraint, ConstraintError, ConstraintOn, Rows, check_multipliers, check_read, check_values,
};

/// A free point held at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixedPoint<const D: usize> {
    vertex: usize,
    place: [f64; D],
}

impl<const D: usize> FixedPoint<D> {
    /// Holds a vertex at a place, metres.
    ///
    /// # Errors
    /// Where the place is not finite.
    pub fn new(vertex: usize, place: [f64; D]) -> Result<Self, ConstraintError> {
        if place.iter().any(|x| !x.is_finite()) {
            return Err(ConstraintError::Hook { vertex });
        }
        Ok(FixedPoint { vertex, place })
    }
}

impl<const D: usize> ConstraintOn<Flat> for FixedPoint<D> {}

impl<const D: usize> Constraint for FixedPoint<D> {
    fn dim(&self) -> usize {
        D.saturating_mul(self.vertex.saturating_add(1))
    }

    fn count(&self) -> usize {
        D
    }

    fn value(&self, _: f64, q: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        check_values(D, g)?;
        check_read(self.dim(), q)?;
        let point = &q[D * self.vertex..];
        for (g, (x, place)) in g.iter_mut().zip(point.iter().zip(&self.place)) {
            *g = x - place;
        }
        Ok(())
    }

    fn differential(&self, _: f64, q: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        check_read(self.dim(), q)?;
        (0..D).for_each(|c| rows.add(c, D * self.vertex + c, 1.0));
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        q: &[f64],
        lambda: &[f64],
        _: &mut impl Sink,
    ) -> Result<(), SizeError> {
        check_multipliers(D, lambda)?;
        check_read(self.dim(), q)
    }
}
