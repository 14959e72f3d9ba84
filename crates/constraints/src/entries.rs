//! The entries of a sparse differential, stored once in the order in which a constraint brings
//! them.
//!
//! ```text
//! J = (row, freedom, value), ...        row after row
//! ```
//! The places are found once; later visits write values only, and a visit that brings other places
//! is an error. Products read the list from front to back.

use std::sync::Arc;

use stationary_calculus::{Covector, SizeError, Vector, first_non_finite};

use crate::{Constraint, ConstraintError, Rows};

/// A sparse differential. Copies share its places.
#[derive(Clone, Debug)]
pub(crate) struct Entries {
    pub(crate) places: Arc<[(u32, u32)]>,
    pub(crate) values: Vec<f64>,
    /// Entries of one row that come one after the other: the row, and how many.
    runs: Arc<[(u32, u32)]>,
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
        let runs = places.chunk_by(|a, b| a.0 == b.0).map(|run| (run[0].0, run.len() as u32));
        let runs = runs.collect();
        Ok(Entries { values: vec![0.0; places.len()], places: places.into(), runs })
    }

    /// The values at `(t, q)`.
    #[inline]
    pub(crate) fn write(
        &mut self,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        let Entries { places, values, .. } = self;
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

    /// Every run: its row, the freedoms and the values of its entries.
    fn runs(&self) -> impl Iterator<Item = (usize, &[(u32, u32)], &[f64])> {
        let (mut places, mut values) = (&*self.places, &*self.values);
        self.runs.iter().map(move |&(row, length)| {
            let (own_places, later_places) = places.split_at(length as usize);
            let (own_values, later_values) = values.split_at(length as usize);
            (places, values) = (later_places, later_values);
            (row as usize, own_places, own_values)
        })
    }

    /// Adds `scale J^T lambda`.
    #[inline]
    pub(crate) fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>) {
        for (row, places, values) in self.runs() {
            let factor = scale * lambda[row];
            for (&(_, freedom), value) in places.iter().zip(values) {
                p.0[freedom as usize] += factor * value;
            }
        }
    }

    /// Adds `J v`.
    #[inline]
    pub(crate) fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        for (row, places, values) in self.runs() {
            let mut rate = rates[row];
            for (&(_, freedom), value) in places.iter().zip(values) {
                rate += value * v.0[freedom as usize];
            }
            rates[row] = rate;
        }
    }
}

/// Which entries are those of each row, whatever the order in which they are brought.
#[derive(Clone, Debug)]
pub(crate) struct RowEntries {
    starts: Arc<[usize]>,
    entries: Arc<[u32]>,
}

impl RowEntries {
    pub(crate) fn of(entries: &Entries, count: usize) -> Self {
        let mut indices: Vec<u32> = (0..entries.places.len() as u32).collect();
        indices.sort_by_key(|&index| entries.places[index as usize].0);
        let row = |index: &u32| entries.places[*index as usize].0 as usize;
        let starts = (0..=count).map(|i| indices.partition_point(|index| row(index) < i)).collect();
        RowEntries { starts, entries: indices.into() }
    }
}

/// The rows of J M^-1/2, without the roots: the freedoms of a dense row are those of J, and products
/// are those of covectors, `<a, M^-1 b>`.
pub(crate) struct WeightedRows<'a> {
    pub(crate) entries: &'a Entries,
    pub(crate) rows: &'a RowEntries,
    pub(crate) inverse_mass: &'a [f64],
}

impl WeightedRows<'_> {
    fn row(&self, row: usize) -> impl Iterator<Item = (usize, f64)> {
        let own = &self.rows.entries[self.rows.starts[row]..self.rows.starts[row + 1]];
        own.iter().map(|&entry| {
            let entry = entry as usize;
            (self.entries.places[entry].1 as usize, self.entries.values[entry])
        })
    }

    /// Adds `factor` times a row to a dense one.
    pub(crate) fn add(&self, row: usize, factor: f64, dense: &mut [f64]) {
        self.row(row).for_each(|(freedom, value)| dense[freedom] += factor * value);
    }

    /// The product of a row and a dense one.
    pub(crate) fn product(&self, row: usize, dense: &[f64]) -> f64 {
        self.row(row)
            .map(|(freedom, value)| value * dense[freedom] * self.inverse_mass[freedom])
            .sum()
    }

    /// The part of a dense row's square that lies in the freedoms of a row, where it is cleared.
    pub(crate) fn take_square(&self, row: usize, dense: &mut [f64]) -> f64 {
        let take = |(freedom, _): (usize, f64)| {
            let value = std::mem::take(&mut dense[freedom]);
            value * value * self.inverse_mass[freedom]
        };
        self.row(row).map(take).sum()
    }
}
