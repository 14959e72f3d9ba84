//! The entries of a sparse differential, stored once in the order in which a constraint brings
//! them.
//!
//! ```text
//! J = (row, freedom, value), ...        row after row
//! ```
//! The places are found once; later visits write values only, and a visit that brings other places
//! is an error. Products read the list from front to back.

use stationary_calculus::{Covector, SizeError, Vector, first_non_finite};

use crate::{Constraint, ConstraintError, Rows};

/// A sparse differential.
#[derive(Clone, Debug)]
pub(crate) struct Entries {
    pub(crate) places: Vec<(u32, u32)>,
    pub(crate) values: Vec<f64>,
}

/// The first visit.
struct Find<'a>(&'a mut Vec<(u32, u32)>);

impl Rows for Find<'_> {
    fn add(&mut self, row: usize, freedom: usize, _: f64) {
        self.0.push((row as u32, freedom as u32));
    }
}

/// A later visit.
struct Write<'a> {
    places: &'a [(u32, u32)],
    values: &'a mut [f64],
    at: usize,
    changed: Option<usize>,
}

impl Rows for Write<'_> {
    #[inline]
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        match self.places.get(self.at) {
            Some(&(i, f)) if i as usize == row && f as usize == freedom => {
                self.values[self.at] = value;
            }
            _ => {
                self.changed.get_or_insert(self.at);
            }
        }
        self.at += 1;
    }
}

impl Entries {
    /// The places of a constraint's entries, their values still zero.
    pub(crate) fn find(constraint: &impl Constraint, t: f64, q: &[f64]) -> Result<Self, SizeError> {
        let mut places = Vec::new();
        constraint.differential(t, q, &mut Find(&mut places))?;
        Ok(Entries { values: vec![0.0; places.len()], places })
    }

    /// The values at `(t, q)`.
    #[inline]
    pub(crate) fn write(
        &mut self,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        let Entries { places, values } = self;
        let mut write = Write { places, values, at: 0, changed: None };
        constraint.differential(t, q, &mut write)?;
        match (write.changed, write.at) {
            (Some(entry), _) => return Err(ConstraintError::PatternChanged { entry }),
            (None, at) if at != write.places.len() => {
                return Err(ConstraintError::PatternChanged { entry: at });
            }
            _ => {}
        }
        match first_non_finite(&self.values) {
            Some(index) => {
                Err(ConstraintError::NonFinite { what: "constraint's differential", index })
            }
            None => Ok(()),
        }
    }

    /// Adds `scale J^T lambda`.
    #[inline]
    pub(crate) fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>) {
        for (&(row, freedom), value) in self.places.iter().zip(&self.values) {
            p.0[freedom as usize] += scale * lambda[row as usize] * value;
        }
    }

    /// Adds `J v`.
    #[inline]
    pub(crate) fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        for (&(row, freedom), value) in self.places.iter().zip(&self.values) {
            rates[row as usize] += value * v.0[freedom as usize];
        }
    }
}
