//! The entries of a sparse differential, whose places are found once.
//!
//! ```text
//! J = blocks, one for a group of freedoms:     (equations that touch them) x (freedoms)
//! ```
//! Freedoms one after the other that the same equations touch (the turn of a body) make a group, whose entries are
//! a dense block, equation after equation. A visit writes values only, and one that brings other places than the
//! first is an error. Products go block by block.

use std::sync::Arc;

use stationary_calculus::{Covector, SizeError, Vector, first_non_finite};

use crate::carried_sum::CarriedSum;
use crate::{Constraint, ConstraintError, Rows};

/// A sparse differential. Copies share its places.
#[derive(Clone, Debug)]
pub(crate) struct Entries {
    pub(crate) pattern: Arc<Pattern>,
    /// Block after block.
    pub(crate) values: Vec<f64>,
}

/// Where a sparse differential has entries.
#[derive(Debug)]
pub(crate) struct Pattern {
    /// Row, freedom and where its value is of each entry, as a constraint brings them.
    visits: Vec<(u32, u32, u32)>,
    /// Row and freedom of each value.
    pub(crate) places: Vec<(u32, u32)>,
    groups: Vec<Group>,
    /// The equations of all groups.
    equations: Vec<u32>,
}

/// Freedoms one after the other that the same equations touch.
#[derive(Clone, Copy, Debug)]
struct Group {
    first: u32,
    freedoms: u32,
    equations: u32,
}

/// A group of freedoms with its part of a differential.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Block<'a> {
    /// The first freedom, and how many there are.
    pub(crate) first: usize,
    pub(crate) freedoms: usize,
    pub(crate) equations: &'a [u32],
    /// Of each equation its entries at the freedoms.
    pub(crate) values: &'a [f64],
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
    visits: &'a [(u32, u32, u32)],
    values: &'a mut [f64],
    at: usize,
    changed: Option<usize>,
}

impl Rows for Write<'_> {
    #[inline]
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        match self.visits.get(self.at) {
            Some(&(i, f, to)) if i as usize == row && f as usize == freedom => {
                self.values[to as usize] = value;
            }
            _ => {
                self.changed.get_or_insert(self.at);
            }
        }
        self.at += 1;
    }
}

impl Pattern {
    /// That of entries with these places (row, freedom), as a constraint brings them.
    fn of(brought: &[(u32, u32)]) -> Self {
        // By freedoms, and those of one by equations.
        let mut order: Vec<u32> = (0..brought.len() as u32).collect();
        let place = |visit: &u32| brought[*visit as usize];
        order.sort_by_key(|visit| (place(visit).1, place(visit).0));
        let columns: Vec<&[u32]> = order.chunk_by(|a, b| place(a).1 == place(b).1).collect();
        let rows = |column: &[u32]| column.iter().map(|visit| place(visit).0).collect::<Vec<_>>();
        let together =
            |a: &&[u32], b: &&[u32]| place(&a[0]).1 + 1 == place(&b[0]).1 && rows(a) == rows(b);
        let mut visits: Vec<_> = brought.iter().map(|&(row, freedom)| (row, freedom, 0)).collect();
        let (mut places, mut groups, mut equations) = (Vec::new(), Vec::new(), Vec::new());
        for group in columns.chunk_by(together) {
            let own = rows(group[0]);
            for at in 0..own.len() {
                for column in group {
                    visits[column[at] as usize].2 = places.len() as u32;
                    places.push(place(&column[at]));
                }
            }
            groups.push(Group {
                first: place(&group[0][0]).1,
                freedoms: group.len() as u32,
                equations: own.len() as u32,
            });
            equations.extend(own);
        }
        Pattern { visits, places, groups, equations }
    }
}

/// Adds `scale lambda` times each row of F entries to F numbers.
#[inline]
fn pull_back<const F: usize>(scale: f64, lambda: &[f64], block: &Block<'_>, p: &mut [f64]) {
    let Some(p) = p.first_chunk_mut::<F>() else { return };
    let mut sum = CarriedSum::from(*p);
    for (&equation, row) in block.equations.iter().zip(block.values.as_chunks::<F>().0) {
        let factor = scale * lambda[equation as usize];
        sum.add(row.map(|value| factor * value));
    }
    *p = sum.rounded();
}

/// Adds the product of each row of F entries with F numbers to its rate.
#[inline]
fn along<const F: usize>(v: &[f64], block: &Block<'_>, rates: &mut [f64]) {
    let Some(v) = v.first_chunk::<F>() else { return };
    for (&equation, row) in block.equations.iter().zip(block.values.as_chunks::<F>().0) {
        let mut product = row[0] * v[0];
        (1..F).for_each(|k| product += row[k] * v[k]);
        rates[equation as usize] += product;
    }
}

impl Entries {
    /// The places of a constraint's entries, their values still zero.
    pub(crate) fn find(constraint: &impl Constraint, t: f64, q: &[f64]) -> Result<Self, SizeError> {
        let mut brought = Vec::new();
        constraint.differential(t, q, &mut Find(&mut brought))?;
        let pattern = Arc::new(Pattern::of(&brought));
        Ok(Entries { values: vec![0.0; brought.len()], pattern })
    }

    /// The values at `(t, q)`.
    #[inline]
    pub(crate) fn write(
        &mut self,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        let Entries { pattern, values } = self;
        let mut write = Write { visits: &pattern.visits, values, at: 0, changed: None };
        constraint.differential(t, q, &mut write)?;
        match (write.changed, write.at) {
            (Some(entry), _) => return Err(ConstraintError::PatternChanged { entry }),
            (None, at) if at != write.visits.len() => {
                return Err(ConstraintError::PatternChanged { entry: at });
            }
            _ => {}
        }
        match first_non_finite(&self.values) {
            Some(at) => {
                let visit = |&(_, _, to): &(u32, u32, u32)| to as usize == at;
                let index = self.pattern.visits.iter().position(visit).unwrap_or(at);
                Err(ConstraintError::NonFinite { what: "constraint's differential", index })
            }
            None => Ok(()),
        }
    }

    /// Every group of freedoms, in their order.
    #[inline]
    pub(crate) fn blocks(&self) -> impl Iterator<Item = Block<'_>> {
        let Pattern { groups, equations, .. } = &*self.pattern;
        let (mut equations, mut values) = (&equations[..], &self.values[..]);
        groups.iter().map(move |group| {
            let (first, freedoms) = (group.first as usize, group.freedoms as usize);
            let (own, later) = equations.split_at(group.equations as usize);
            let (block, others) = values.split_at(own.len() * freedoms);
            (equations, values) = (later, others);
            Block { first, freedoms, equations: own, values: block }
        })
    }

    /// Adds `scale J^T lambda`.
    #[inline]
    pub(crate) fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>) {
        for block in self.blocks() {
            let p = &mut p.0[block.first..][..block.freedoms];
            match block.freedoms {
                1 => pull_back::<1>(scale, lambda, &block, p),
                2 => pull_back::<2>(scale, lambda, &block, p),
                3 => pull_back::<3>(scale, lambda, &block, p),
                6 => pull_back::<6>(scale, lambda, &block, p),
                freedoms => {
                    for (f, p) in p.iter_mut().enumerate() {
                        let mut sum = CarriedSum::from([*p]);
                        let column = block.values.iter().skip(f).step_by(freedoms);
                        for (&equation, value) in block.equations.iter().zip(column) {
                            sum.add([scale * lambda[equation as usize] * value]);
                        }
                        [*p] = sum.rounded();
                    }
                }
            }
        }
    }

    /// Adds `J v`.
    #[inline]
    pub(crate) fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        for block in self.blocks() {
            let v = &v.0[block.first..][..block.freedoms];
            match block.freedoms {
                1 => along::<1>(v, &block, rates),
                2 => along::<2>(v, &block, rates),
                3 => along::<3>(v, &block, rates),
                6 => along::<6>(v, &block, rates),
                freedoms => {
                    let rows = block.values.chunks_exact(freedoms);
                    for (&equation, row) in block.equations.iter().zip(rows) {
                        let products = row.iter().zip(v).map(|(value, v)| value * v);
                        rates[equation as usize] += products.sum::<f64>();
                    }
                }
            }
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
        let mut indices: Vec<u32> = (0..entries.pattern.places.len() as u32).collect();
        indices.sort_by_key(|&index| entries.pattern.places[index as usize].0);
        let row = |index: &u32| entries.pattern.places[*index as usize].0 as usize;
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
            (self.entries.pattern.places[entry].1 as usize, self.entries.values[entry])
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
