//! What becomes of a differential's entries: a covector, without a matrix, and a look at their
//! places.
//!
//! ```text
//! p += s J^T lambda       a force or an impulse
//! ```
//! `J` m x n, given entry by entry. Nothing is stored and nothing is allocated.

use stationary_calculus::Covector;

use crate::{Constraint, Rows};

/// Adds s J^T lambda to a covector.
struct Pulled<'a> {
    scale: f64,
    lambda: &'a [f64],
    p: &'a mut [f64],
}

impl Rows for Pulled<'_> {
    #[inline]
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        // A multiplier that is missing is not a number, and neither is the force.
        let lambda = self.lambda.get(row).copied().unwrap_or(f64::NAN);
        if let Some(p) = self.p.get_mut(freedom) {
            *p += self.scale * lambda * value;
        }
    }
}

/// Adds `scale J^T lambda` to a covector.
pub(crate) fn add_pulled_back(
    constraint: &impl Constraint,
    t: f64,
    q: &[f64],
    scale: f64,
    lambda: &[f64],
    p: Covector<&mut [f64]>,
) {
    constraint.differential(t, q, &mut Pulled { scale, lambda, p: p.0 });
}

/// Counts entries, and finds the first that lies outside of the matrix.
struct Outside {
    count: usize,
    dim: usize,
    found: Option<(usize, usize)>,
}

impl Rows for Outside {
    fn add(&mut self, row: usize, freedom: usize, _: f64) {
        if row >= self.count || freedom >= self.dim {
            self.found.get_or_insert((row, freedom));
        }
    }
}

/// The first entry (row, freedom) that is not in a matrix of `count` rows and `dim` columns.
pub(crate) fn outside(
    constraint: &impl Constraint,
    t: f64,
    q: &[f64],
    dim: usize,
) -> Option<(usize, usize)> {
    let mut outside = Outside { count: constraint.count(), dim, found: None };
    constraint.differential(t, q, &mut outside);
    outside.found
}
