//! What becomes of a differential's entries: a covector, without a matrix, and a look at their
//! places.
//!
//! ```text
//! p += s J^T lambda       a force or an impulse
//! ```
//! `J` m x n, given entry by entry. Nothing is stored and nothing is allocated.

use stationary_calculus::{Covector, SizeError};

use crate::{Constraint, ConstraintError, Rows, check_multipliers};

/// Adds s J^T lambda to a covector.
struct Pulled<'a> {
    scale: f64,
    lambda: &'a [f64],
    p: &'a mut [f64],
}

impl Rows for Pulled<'_> {
    #[inline]
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        if let (Some(p), Some(lambda)) = (self.p.get_mut(freedom), self.lambda.get(row)) {
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
) -> Result<(), SizeError> {
    check_multipliers(constraint.count(), lambda)?;
    constraint.differential(t, q, &mut Pulled { scale, lambda, p: p.0 })
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
fn outside(
    constraint: &impl Constraint,
    t: f64,
    q: &[f64],
    dim: usize,
) -> Result<Option<(usize, usize)>, SizeError> {
    let mut outside = Outside { count: constraint.count(), dim, found: None };
    constraint.differential(t, q, &mut outside)?;
    Ok(outside.found)
}

/// An error where a constraint needs more than the `n` freedoms there are, or brings an entry that lies
/// outside of its matrix.
pub(crate) fn check_entries(
    constraint: &impl Constraint,
    n: usize,
    t: f64,
    q: &[f64],
) -> Result<(), ConstraintError> {
    let rows = constraint.count();
    if constraint.dim() > n {
        return Err(ConstraintError::Freedoms { needed: constraint.dim(), freedoms: n });
    }
    match outside(constraint, t, q, n)? {
        Some((row, freedom)) => {
            Err(ConstraintError::UnknownFreedom { row, freedom, rows, freedoms: n })
        }
        None => Ok(()),
    }
}
