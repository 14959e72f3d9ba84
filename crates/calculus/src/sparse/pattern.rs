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

/// Row and column, in the lower triangle, of each entry of a block's lower triangle; `None` where
/// either is fixed.
fn entries(block: &[u32]) -> impl Iterator<Item = Option<(u32, u32)>> {
    block.iter().enumerate().flat_map(move |(b, &j)| {
        block[b..]
            .iter()
            .map(move |&i| (i != u32::MAX && j != u32::MAX).then(|| (i.max(j), i.min(j))))
    })
}

impl Pattern {
    fn new(n: usize, stream: Vec<u32>) -> Result<Self, SparseError> {
        let mut starts = vec![1_usize; n];
        for (_, column) in blocks(&stream).flat_map(entries).flatten() {
            starts[column as usize] += 1;
        }
        let mut sum = 0;
        for start in &mut starts {
            (*start, sum) = (sum, sum + *start);
        }
        let mut rows = vec![0_u32; sum];
        let mut ends = starts.clone();
        let diagonal = (0..n as u32).map(|i| (i, i));
        for (row, column) in diagonal.chain(blocks(&stream).flat_map(entries).flatten()) {
            let end = &mut ends[column as usize];
            rows[*end] = row;
            *end += 1;
        }
        let mut column_starts = vec![0_u32; n + 1];
        let mut nonzeros = 0;
        for column in 0..n {
            let range = starts[column]..ends[column];
            rows[range.clone()].sort_unstable();
            let start = nonzeros;
            for k in range {
                if nonzeros == start || rows[nonzeros - 1] != rows[k] {
                    rows[nonzeros] = rows[k];
                    nonzeros += 1;
                }
            }
            column_starts[column + 1] = nonzeros as u32;
        }
        if nonzeros >= i32::MAX as usize {
            return Err(SparseError::TooLarge { what: "the number of entries", size: nonzeros });
        }
        rows.truncate(nonzeros);
        rows.shrink_to_fit();
        let slot = |(row, column): (u32, u32)| {
            let start = column_starts[column as usize];
            let end = column_starts[column as usize + 1];
            let place = rows[start as usize..end as usize].partition_point(|&r| r < row);
            start + place as u32
        };
        let slots = blocks(&stream)
            .flat_map(entries)
            .map(|entry| entry.map_or(nonzeros as u32, slot))
            .collect();
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
