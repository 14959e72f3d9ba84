//! A later visit of the blocks of a matrix: adds their entries through the stored slots.
//!
//! A block that is not the one that was recorded there is an error and never a wrong matrix: a block
//! of freedoms is compared with them, a block between vertices with where its vertices' columns begin.
//! Blocks in parts are computed side by side: each part adds to its own columns only, which are its
//! own piece of the values, and every sum runs in the order of the visit.

use std::sync::atomic::{AtomicUsize, Ordering};

use crate::parts::in_parts;
use crate::sink::from_lower;
use crate::sparse::pattern::{Pattern, Visit};
use crate::sparse::visit::{Corner, MIXED, NOWHERE, Run, Shape, stored};
use crate::{FIXED, Parts, Sink, StencilHessian, array};

/// Adds blocks to the values of a matrix.
#[derive(Debug)]
pub struct RefillSink<'a> {
    weight: f64,
    pattern: &'a Pattern,
    shape: Shape,
    /// Blocks of that shape that are still to come, and the runs after it.
    left: usize,
    runs: &'a [Run],
    stream: &'a [u32],
    slots: &'a [u32],
    values: &'a mut [f64],
    /// The slot of the first of the values.
    first: usize,
    block: usize,
    changed: Option<usize>,
}

impl<'a> RefillSink<'a> {
    pub(crate) fn new(pattern: &'a Pattern, values: &'a mut [f64]) -> Self {
        RefillSink::of_visit(pattern, &pattern.visits[0], (0, values))
    }

    fn of_visit(
        pattern: &'a Pattern,
        visit: &'a Visit,
        (first, values): (usize, &'a mut [f64]),
    ) -> Self {
        RefillSink {
            weight: 1.0,
            pattern,
            shape: Shape::Freedoms,
            left: 0,
            runs: &visit.runs,
            stream: &visit.stream,
            slots: &visit.slots,
            values,
            first,
            block: 0,
            changed: None,
        }
    }

    /// The same sink, which from now on multiplies what it is given by `weight`.
    pub fn weighted(&mut self, weight: f64) -> &mut Self {
        self.weight = weight;
        self
    }

    /// The first block that was not the recorded one, also where one is missing.
    pub(crate) fn changed(&self) -> Option<usize> {
        let complete = self.left == 0 && self.runs.is_empty();
        self.changed.or(if complete { None } else { Some(self.block) })
    }

    /// The shape of the next block.
    #[inline]
    fn next_shape(&mut self) -> Option<Shape> {
        if self.left == 0 {
            let (run, rest) = self.runs.split_first()?;
            (self.shape, self.left, self.runs) = (run.shape, run.blocks, rest);
        }
        Some(self.shape)
    }

    #[inline]
    fn next_slots(&mut self, count: usize) -> Option<&'a [u32]> {
        let (slots, rest) = self.slots.split_at_checked(count)?;
        self.slots = rest;
        Some(slots)
    }

    #[inline]
    fn done(&mut self) {
        self.left -= 1;
        self.block += 1;
    }

    /// No block after one that has changed is taken.
    #[cold]
    fn refuse(&mut self) {
        self.changed.get_or_insert(self.block);
        (self.left, self.runs) = (0, &[]);
    }

    #[inline]
    fn add_at(values: &mut [f64], first: usize, slot: usize, entry: f64) {
        // What is fixed, or another part's, has no place here.
        if let Some(value) = values.get_mut(slot.wrapping_sub(first)) {
            *value += entry;
        }
    }

    /// A block of freedoms; false where it is not the recorded one.
    #[inline]
    fn add_freedoms(&mut self, freedoms: &[usize], block: &[f64]) -> bool {
        let k = freedoms.len();
        let Some((recorded, stream)) = self.stream.split_at_checked(k + 1) else { return false };
        let same = recorded[1..].iter().zip(freedoms).all(|(&r, &freedom)| r == stored(freedom));
        if recorded[0] as usize != k || block.len() != k * k || !same {
            return false;
        }
        let Some(slots) = self.next_slots(k * (k + 1) / 2) else { return false };
        self.stream = stream;
        let mut slots = slots.iter();
        for (b, column) in block.chunks_exact(k).enumerate() {
            for (entry, &slot) in column[b..].iter().zip(slots.by_ref()) {
                Self::add_at(self.values, self.first, slot as usize, self.weight * entry);
            }
        }
        true
    }

    /// A block between vertices that are all wholly free, by its lower triangle; false where they are
    /// not, or not the recorded ones, and then nothing has been added.
    #[inline(always)]
    fn add_whole<const V: usize, const D: usize>(
        &mut self,
        slots: &[u32],
        freedoms: &[[usize; D]; V],
        column: &impl Fn(usize, usize, usize) -> [f64; D],
    ) -> bool {
        let starts = self.pattern.columns.col_ptr();
        let mut lengths = [0; V];
        let mut place = 0;
        for (a, freedoms) in freedoms.iter().enumerate() {
            let first = freedoms[0];
            let whole = (1..D).all(|c| freedoms[c] == first.wrapping_add(c));
            let (Some(&start), Some(&end)) = (starts.get(first), starts.get(first.wrapping_add(1)))
            else {
                return false;
            };
            if !whole || start != slots[place] {
                return false;
            }
            lengths[a] = (end - start) as usize;
            place += V - a;
        }
        let (weight, first, values) = (self.weight, self.first, &mut *self.values);
        let mut slots = slots.iter().map(|&slot| (slot as usize).wrapping_sub(first));
        for b in 0..V {
            for a in b..V {
                let Some(at) = slots.next() else { return false };
                if a == b {
                    add_corner(values, at, lengths[b], weight, |d| column(b, d, b));
                } else if freedoms[a][0] > freedoms[b][0] {
                    add_block(values, at, lengths[b], weight, |d| column(b, d, a));
                } else {
                    let columns: [[f64; D]; D] = array(|d| column(b, d, a));
                    let row = |d: usize| array::<_, D>(|c| columns[c][d]);
                    add_block(values, at, lengths[a], weight, row);
                }
            }
        }
        true
    }

    /// A block between vertices of which some are held, or that was recorded by its freedoms.
    #[cold]
    #[inline(never)]
    fn add_written_out<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        column: impl Fn(usize, usize, usize) -> [f64; D],
    ) {
        let block: StencilHessian<V, D> = from_lower(column);
        let block = block.as_flattened().as_flattened().as_flattened();
        self.add_symmetric(freedoms.as_flattened(), block);
    }

    /// A block between vertices of `D` coordinates, some of them held; false where they are not the
    /// recorded ones.
    #[cold]
    fn add_held(
        &mut self,
        slots: &[u32],
        dimension: usize,
        freedoms: &[usize],
        entry: impl Fn(usize, usize) -> f64,
    ) -> bool {
        let mut slots = slots.iter();
        for (b, of_b) in freedoms.chunks_exact(dimension).enumerate() {
            for (a, of_a) in freedoms.chunks_exact(dimension).enumerate().skip(b) {
                let Some(&slot) = slots.next() else { return false };
                if a == b && !self.is_recorded(slot, of_a) {
                    return false;
                }
                let (a, b) = (a * dimension, b * dimension);
                let (i, j) = (first_free(of_a), first_free(of_b));
                if i == FIXED || j == FIXED {
                    continue;
                }
                let slot = (slot & !MIXED) as usize;
                let added = if i >= j {
                    self.add_rows(slot, of_a, of_b, |c, d| entry(a + c, b + d))
                } else {
                    self.add_rows(slot, of_b, of_a, |c, d| entry(a + d, b + c))
                };
                if !added {
                    return false;
                }
            }
        }
        true
    }

    /// Whether the slot of a diagonal block is that of this vertex.
    fn is_recorded(&self, slot: u32, freedoms: &[usize]) -> bool {
        let Some(corner) = Corner::of(freedoms) else { return false };
        let Some(&start) = self.pattern.columns.col_ptr().get(corner.first as usize) else {
            return corner.count == 0 && slot == NOWHERE;
        };
        let mixed = if (corner.count as usize) < freedoms.len() { MIXED } else { 0 };
        corner.count > 0 && slot == start | mixed
    }

    /// Adds what is free of a block, from its slot on; false where its rows are not there.
    fn add_rows(
        &mut self,
        slot: usize,
        rows: &[usize],
        columns: &[usize],
        entry: impl Fn(usize, usize) -> f64,
    ) -> bool {
        let (starts, indices) = (self.pattern.columns.col_ptr(), self.pattern.columns.row_idx());
        let mut start = slot;
        for (d, &column) in columns.iter().enumerate().filter(|(_, column)| **column != FIXED) {
            let Some(&[begin, end]) = starts.get(column..column + 2) else { return false };
            let free = rows.iter().enumerate().filter(|(_, row)| **row != FIXED);
            for (at, (c, &row)) in (start..).zip(free) {
                if row >= column {
                    let here = (begin as usize..end as usize).contains(&at);
                    if !here || indices[at] as usize != row {
                        return false;
                    }
                    Self::add_at(self.values, self.first, at, self.weight * entry(c, d));
                }
            }
            start = (start + (end - begin) as usize).wrapping_sub(1);
        }
        true
    }
}

/// Adds a D x D block below the diagonal by its columns, of which the first starts at `at` in a column
/// of this length. What is another part's has no place among the values.
#[inline(always)]
fn add_block<const D: usize>(
    values: &mut [f64],
    mut at: usize,
    length: usize,
    weight: f64,
    column: impl Fn(usize) -> [f64; D],
) {
    for d in 0..D {
        let place = values.get_mut(at..at.wrapping_add(D));
        let Some(sums) = place.and_then(|place| place.first_chunk_mut::<D>()) else { return };
        let column = column(d);
        for c in 0..D {
            sums[c] += weight * column[c];
        }
        at = at.wrapping_add(length - d - 1);
    }
}

/// Adds the lower triangle of a D x D block on the diagonal.
#[inline(always)]
fn add_corner<const D: usize>(
    values: &mut [f64],
    mut at: usize,
    length: usize,
    weight: f64,
    column: impl Fn(usize) -> [f64; D],
) {
    for d in 0..D {
        let Some(sums) = values.get_mut(at..at.wrapping_add(D - d)) else { return };
        for (sum, entry) in sums.iter_mut().zip(&column(d)[d..]) {
            *sum += weight * entry;
        }
        at = at.wrapping_add(length - d);
    }
}

fn first_free(freedoms: &[usize]) -> usize {
    freedoms.iter().copied().find(|&freedom| freedom != FIXED).unwrap_or(FIXED)
}

impl Sink for RefillSink<'_> {
    #[inline]
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        let k = freedoms.len();
        let added = match self.next_shape() {
            Some(Shape::Freedoms) => self.add_freedoms(freedoms, block),
            Some(Shape::Vertices { count, dimension })
                if count * dimension == k && block.len() == k * k =>
            {
                let slots = self.next_slots(count * (count + 1) / 2);
                slots.is_some_and(|slots| {
                    self.add_held(slots, dimension, freedoms, |i, j| block[i + k * j])
                })
            }
            _ => false,
        };
        if added { self.done() } else { self.refuse() }
    }

    #[inline(always)]
    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        block: &StencilHessian<V, D>,
    ) {
        self.add_lower(freedoms, |b, d, a| block[b][d][a]);
    }

    #[inline(always)]
    fn add_lower<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        column: impl Fn(usize, usize, usize) -> [f64; D],
    ) {
        let shape = self.next_shape();
        if shape == Some(Shape::Vertices { count: V, dimension: D })
            && let Some((slots, rest)) = self.slots.split_at_checked(V * (V + 1) / 2)
            && self.add_whole(slots, freedoms, &column)
        {
            self.slots = rest;
            return self.done();
        }
        self.add_written_out(freedoms, column);
    }

    fn add_parts(&mut self, parts: &impl Parts) {
        let bounds = parts.bounds();
        let count = bounds.len().saturating_sub(1);
        if count < 2 {
            return parts.visit_all(self);
        }
        let starts = self.pattern.columns.col_ptr();
        let known = bounds.last().is_some_and(|&last| last < starts.len());
        let Some(Shape::Parts { first, count: recorded }) = self.next_shape() else {
            return parts.visit_all(self);
        };
        if recorded != count || !known {
            return self.refuse();
        }
        let (pattern, weight) = (self.pattern, self.weight);
        let changed = AtomicUsize::new(usize::MAX);
        let cut = |bound: usize| starts[bound] as usize;
        in_parts(bounds, self.values, &cut, &|part, place, values: &mut [f64]| {
            let visit = &pattern.visits[first + part];
            let mut sink = RefillSink::of_visit(pattern, visit, (place, values));
            parts.visit(part, sink.weighted(weight));
            if let Some(block) = sink.changed() {
                changed.fetch_min(block, Ordering::Relaxed);
            }
        });
        match changed.into_inner() {
            usize::MAX => self.done(),
            block => {
                self.block += block;
                self.refuse();
            }
        }
    }
}
