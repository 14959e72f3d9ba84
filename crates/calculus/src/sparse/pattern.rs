//! Where a sparse symmetric matrix has entries, and where each entry of each block goes.
//!
//! ```text
//! block k, entry (a, b), a >= b   ->   values[slots[...]]        in the order of the visit
//! ```
//! A first visit of the blocks records their freedoms ([`PatternSink`]); from them follow the columns
//! of the lower triangle (rows ascending, the diagonal first and always present) and one slot for
//! each entry of each block's lower triangle. Later visits read the slots in a row: no search, no
//! triplets. Entries in the row or column of a [`FIXED`] freedom go to one slot past the last entry.
//!
//! Indices have 32 bits, which halves what the refill has to read. Knows nothing of values.

use faer::sparse::SymbolicSparseColMat;

use crate::sparse::SparseError;
use crate::{FIXED, Sink, SizeError};

/// The first visit of the blocks of a matrix: takes their freedoms and forgets their entries.
#[derive(Clone, Debug)]
pub struct PatternSink {
    n: usize,
    blocks: usize,
    /// Of each block its number of freedoms, then the freedoms.
    stream: Vec<u32>,
    error: Option<SparseError>,
}

/// A freedom as it is stored; [`FIXED`] becomes `u32::MAX`, which is never a freedom.
#[inline]
pub(crate) fn stored(freedom: usize) -> u32 {
    freedom as u32
}

impl PatternSink {
    pub(crate) fn new(n: usize) -> Result<Self, SparseError> {
        if n >= i32::MAX as usize {
            return Err(SparseError::TooLarge { what: "the number of freedoms", size: n });
        }
        Ok(PatternSink { n, blocks: 0, stream: Vec::new(), error: None })
    }

    fn check(&self, freedoms: &[usize], entries: usize) -> Result<(), SparseError> {
        let block = self.blocks;
        if freedoms.is_empty() || entries != freedoms.len() * freedoms.len() {
            return Err(SparseError::BlockSize { block, entries, freedoms: freedoms.len() });
        }
        for (place, &freedom) in freedoms.iter().enumerate() {
            if freedom == FIXED {
                continue;
            }
            if freedom >= self.n {
                return Err(SparseError::UnknownFreedom { block, freedom, freedoms: self.n });
            }
            if freedoms[..place].contains(&freedom) {
                return Err(SparseError::RepeatedFreedom { block, freedom });
            }
        }
        Ok(())
    }

    pub(crate) fn pattern(self) -> Result<Pattern, SparseError> {
        match self.error {
            Some(error) => Err(error),
            None => Pattern::new(self.n, self.stream),
        }
    }
}

impl Sink for PatternSink {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        if let Err(error) = self.check(freedoms, block.len()) {
            self.error.get_or_insert(error);
        }
        self.blocks += 1;
        self.stream.push(freedoms.len() as u32);
        self.stream.extend(freedoms.iter().map(|&freedom| stored(freedom)));
    }
}

/// The lower triangle's columns, and the slots of the blocks.
#[derive(Debug)]
pub(crate) struct Pattern {
    pub(crate) columns: SymbolicSparseColMat<u32>,
    pub(crate) stream: Vec<u32>,
    pub(crate) slots: Vec<u32>,
}

/// The blocks of a stream, each as its freedoms.
fn blocks(stream: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let (&k, tail) = rest.split_first()?;
        let (block, tail) = tail.split_at(k as usize);
        rest = tail;
        Some(block)
    })
}

/// Hands over the slot number, row and column, in the lower triangle, of each entry off the diagonal.
#[inline(always)]
fn visit_off_diagonal(stream: &[u32], mut visit: impl FnMut(usize, u32, u32)) {
    let mut slot = 0;
    for block in blocks(stream) {
        for (b, &j) in block.iter().enumerate() {
            slot += 1;
            for &i in &block[b + 1..] {
                if i != u32::MAX && j != u32::MAX {
                    visit(slot, i.max(j), i.min(j));
                }
                slot += 1;
            }
        }
    }
}

/// How many entries the lower triangles of the blocks have.
fn count_slots(stream: &[u32]) -> usize {
    blocks(stream).map(|block| block.len() * (block.len() + 1) / 2).sum()
}

impl Pattern {
    /// By columns first, each column's few entries then sorted by row, each with the number of its
    /// slot: whoever comes to a row first makes a place, and the others of that row share it.
    fn new(n: usize, stream: Vec<u32>) -> Result<Self, SparseError> {
        let slot_count = count_slots(&stream);
        if slot_count >= u32::MAX as usize {
            return Err(SparseError::TooLarge { what: "the blocks' entries", size: slot_count });
        }
        let mut ends = vec![0_u32; n + 1];
        visit_off_diagonal(&stream, |_, _, column| ends[column as usize + 1] += 1);
        for column in 0..n {
            ends[column + 1] += ends[column];
        }
        let mut entries = vec![0_u64; ends[n] as usize];
        visit_off_diagonal(&stream, |slot, row, column| {
            let end = &mut ends[column as usize];
            entries[*end as usize] = u64::from(row) << 32 | slot as u64;
            *end += 1;
        });
        let mut slots = vec![0_u32; slot_count];
        let mut column_starts = Vec::with_capacity(n + 1);
        let mut rows = Vec::with_capacity(n + entries.len());
        let mut start = 0;
        for (column, &end) in ends[..n].iter().enumerate() {
            column_starts.push(rows.len() as u32);
            rows.push(column as u32);
            // Each start has become the next one's.
            let own = &mut entries[start..end as usize];
            start = end as usize;
            own.sort_unstable();
            let mut last = column as u32;
            for entry in own {
                let (row, slot) = ((*entry >> 32) as u32, *entry as u32);
                if row != last {
                    rows.push(row);
                    last = row;
                }
                slots[slot as usize] = rows.len() as u32 - 1;
            }
        }
        if rows.len() >= i32::MAX as usize {
            return Err(SparseError::TooLarge { what: "the number of entries", size: rows.len() });
        }
        fill_rest(&stream, &column_starts, rows.len() as u32, &mut slots);
        column_starts.push(rows.len() as u32);
        rows.shrink_to_fit();
        let columns = SymbolicSparseColMat::new_checked(n, n, column_starts, None, rows);
        Ok(Pattern { columns, stream, slots })
    }

    pub(crate) fn dim(&self) -> usize {
        self.columns.ncols()
    }

    pub(crate) fn check_vector(&self, x: &[f64]) -> Result<(), SizeError> {
        SizeError::check("the vector's components", self.dim(), x.len())
    }
}

/// The slots of entries on the diagonal, and of those that are dropped.
fn fill_rest(stream: &[u32], column_starts: &[u32], dropped: u32, slots: &mut [u32]) {
    let mut slot = 0;
    for block in blocks(stream) {
        for (b, &j) in block.iter().enumerate() {
            slots[slot] = column_starts.get(j as usize).map_or(dropped, |&start| start);
            slot += 1;
            for &i in &block[b + 1..] {
                if i == u32::MAX || j == u32::MAX {
                    slots[slot] = dropped;
                }
                slot += 1;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pattern_of(n: usize, freedoms: &[&[usize]]) -> Result<Pattern, SparseError> {
        let mut sink = PatternSink::new(n)?;
        for freedoms in freedoms {
            sink.add_symmetric(freedoms, &vec![1.0; freedoms.len() * freedoms.len()]);
        }
        sink.pattern()
    }

    #[test]
    fn columns_are_sorted_and_start_with_their_diagonal() {
        let pattern = pattern_of(4, &[&[3, 0], &[0, 2, FIXED], &[3, 0]]).unwrap();
        assert_eq!(pattern.columns.col_ptr(), [0, 3, 4, 5, 6]);
        assert_eq!(pattern.columns.row_idx(), [0, 2, 3, 1, 2, 3]);
        let trash = 6;
        assert_eq!(
            pattern.slots,
            [5, 2, 0, /* block 1 */ 0, 1, trash, 4, trash, trash, /* block 2 */ 5, 2, 0]
        );
    }

    #[test]
    fn blocks_that_do_not_fit_are_refused_by_number() {
        let error = pattern_of(2, &[&[0, 1], &[1, 2]]).unwrap_err();
        assert_eq!(error, SparseError::UnknownFreedom { block: 1, freedom: 2, freedoms: 2 });
        let error = pattern_of(2, &[&[0, FIXED, FIXED], &[1, 0, 1]]).unwrap_err();
        assert_eq!(error, SparseError::RepeatedFreedom { block: 1, freedom: 1 });
        let mut sink = PatternSink::new(2).unwrap();
        sink.add_symmetric(&[0, 1], &[1.0; 3]);
        let error = sink.pattern().unwrap_err();
        assert_eq!(error, SparseError::BlockSize { block: 0, entries: 3, freedoms: 2 });
        let error = pattern_of(2, &[&[0], &[]]).unwrap_err();
        assert_eq!(error, SparseError::BlockSize { block: 1, entries: 0, freedoms: 0 });
    }
}
