//! Where a sparse symmetric matrix has entries, and where each block of a visit goes.
//!
//! ```text
//! block between vertices b and a   ->   one slot: its first entry, in the first column of b
//! column j + 1 of that block       ->   length of column j, less one, further on
//! ```
//! The columns of the lower triangle have ascending rows, the diagonal first and always present. All
//! columns of a vertex have the same rows, each one less than the one before, so that one slot finds a
//! whole block: an entry that no block brings is a zero. Entries of blocks of other shapes have a slot
//! each. Later visits read the slots in a row: no search, no triplets. Indices have 32 bits, which
//! halves what the refill has to read. Knows nothing of values.

use faer::sparse::SymbolicSparseColMat;

use crate::SizeError;
use crate::sparse::SparseError;
use crate::sparse::visit::{Corner, MIXED, NOWHERE, Record, Run, Shape};

/// The lower triangle's columns, and the slots of the blocks.
#[derive(Debug)]
pub(crate) struct Pattern {
    pub(crate) columns: SymbolicSparseColMat<u32>,
    /// The visit itself, and after it those of parts.
    pub(crate) visits: Vec<Visit>,
}

/// Where the blocks of a visit go, in its order.
#[derive(Debug)]
pub(crate) struct Visit {
    pub(crate) runs: Vec<Run>,
    pub(crate) stream: Vec<u32>,
    pub(crate) slots: Vec<u32>,
}

impl Pattern {
    /// From what was visited, and whether each freedom belongs to one vertex with the next one.
    pub(crate) fn new(joined: &[bool], records: Vec<Record>) -> Result<Self, SparseError> {
        let vertices = Vertices::new(joined);
        let columns = vertices.columns(&records)?;
        let places = Places { starts: columns.col_ptr(), rows: columns.row_idx() };
        let visits = records.into_iter().map(|record| places.visit(record)).collect();
        Ok(Pattern { columns, visits })
    }

    pub(crate) fn dim(&self) -> usize {
        self.columns.ncols()
    }

    pub(crate) fn check_vector(&self, x: &[f64]) -> Result<(), SizeError> {
        SizeError::check("the vector's components", self.dim(), x.len())
    }

    /// What it takes in memory, bytes.
    pub(crate) fn bytes(&self) -> usize {
        let words = |visit: &Visit| visit.stream.len() + visit.slots.len();
        let slots: usize = self.visits.iter().map(words).sum();
        let runs: usize = self.visits.iter().map(|visit| visit.runs.len()).sum();
        let columns = self.columns.col_ptr().len() + self.columns.row_idx().len();
        size_of::<u32>() * (columns + slots) + size_of::<Run>() * runs
    }
}

/// The blocks of freedoms of a stream.
fn blocks(stream: &[u32]) -> impl Iterator<Item = &[u32]> {
    let mut rest = stream;
    std::iter::from_fn(move || {
        let (&k, tail) = rest.split_first()?;
        let (block, tail) = tail.split_at(k as usize);
        rest = tail;
        Some(block)
    })
}

/// The pairs of a block, each member with itself and those after it.
fn pairs<T: Copy>(members: &[T]) -> impl Iterator<Item = (T, T)> {
    members.iter().enumerate().flat_map(|(b, &j)| members[b..].iter().map(move |&i| (i, j)))
}

/// The blocks of vertices of a record.
fn corners(record: &Record) -> impl Iterator<Item = &[Corner]> {
    let mut rest = &record.corners[..];
    let runs = record.runs.iter().filter_map(|run| match run.shape {
        Shape::Vertices { count, .. } => Some((count, run.blocks)),
        _ => None,
    });
    let counts = runs.flat_map(|(count, blocks)| std::iter::repeat_n(count, blocks));
    counts.map(move |count| {
        let (block, tail) = rest.split_at(count);
        rest = tail;
        block
    })
}

/// Freedoms that share their columns' rows, in a row each.
struct Vertices {
    /// The vertex of each freedom.
    of: Vec<u32>,
    /// The first freedom of each vertex, and after the last one the end.
    starts: Vec<u32>,
}

impl Vertices {
    fn new(joined: &[bool]) -> Self {
        let (mut of, mut starts) = (Vec::with_capacity(joined.len()), Vec::new());
        for freedom in 0..joined.len() {
            if freedom == 0 || !joined[freedom - 1] {
                starts.push(freedom as u32);
            }
            of.push(starts.len() as u32 - 1);
        }
        starts.push(joined.len() as u32);
        Vertices { of, starts }
    }

    /// Calls `see(row, column)` for each two vertices that a block couples, row > column.
    fn coupled(&self, records: &[Record], mut see: impl FnMut(usize, usize)) {
        let mut pair = |(i, j): (u32, u32)| {
            if i != j && i != NOWHERE && j != NOWHERE {
                let (i, j) = (self.of[i as usize] as usize, self.of[j as usize] as usize);
                if i != j {
                    see(i.max(j), i.min(j));
                }
            }
        };
        for record in records {
            blocks(&record.stream).flat_map(pairs).for_each(&mut pair);
            let firsts = corners(record).flat_map(pairs).map(|(a, b)| (a.first, b.first));
            firsts.for_each(&mut pair);
        }
    }

    /// The vertices below each one, ascending: where those of each begin, and all of them.
    fn below(&self, records: &[Record]) -> (Vec<usize>, Vec<u32>) {
        let n = self.starts.len() - 1;
        let mut starts = vec![1_usize; n];
        self.coupled(records, |_, column| starts[column] += 1);
        let mut sum = 0;
        for start in &mut starts {
            (*start, sum) = (sum, sum + *start);
        }
        let (mut rows, mut ends) = (vec![0_u32; sum], starts.clone());
        let mut put = |row: usize, column: usize| {
            rows[ends[column]] = row as u32;
            ends[column] += 1;
        };
        (0..n).for_each(|vertex| put(vertex, vertex));
        self.coupled(records, put);
        let (mut begins, mut kept) = (Vec::with_capacity(n + 1), 0);
        for column in 0..n {
            let range = starts[column]..ends[column];
            rows[range.clone()].sort_unstable();
            begins.push(kept);
            for k in range {
                if begins[column] == kept || rows[kept - 1] != rows[k] {
                    rows[kept] = rows[k];
                    kept += 1;
                }
            }
        }
        begins.push(kept);
        rows.truncate(kept);
        (begins, rows)
    }

    fn freedoms(&self, vertex: u32) -> std::ops::Range<u32> {
        self.starts[vertex as usize]..self.starts[vertex as usize + 1]
    }

    /// The columns of the lower triangle.
    fn columns(&self, records: &[Record]) -> Result<SymbolicSparseColMat<u32>, SparseError> {
        let n = self.of.len();
        let (begins, below) = self.below(records);
        let sizes = |vertex: usize| {
            let rows = &below[begins[vertex]..begins[vertex + 1]];
            let own = self.freedoms(rows[0]).len();
            let under: usize = rows[1..].iter().map(|&row| self.freedoms(row).len()).sum();
            own * (own + 1) / 2 + own * under
        };
        let size: usize = (0..self.starts.len() - 1).map(sizes).sum();
        if size >= i32::MAX as usize {
            return Err(SparseError::TooLarge { what: "the number of entries", size });
        }
        let (mut starts, mut rows) = (Vec::with_capacity(n + 1), Vec::with_capacity(size));
        for column in 0..n as u32 {
            starts.push(rows.len() as u32);
            let vertex = self.of[column as usize] as usize;
            let (own, under) = (vertex as u32, begins[vertex] + 1..begins[vertex + 1]);
            rows.extend(column..self.freedoms(own).end);
            rows.extend(below[under].iter().flat_map(|&row| self.freedoms(row)));
        }
        starts.push(rows.len() as u32);
        Ok(SymbolicSparseColMat::new_checked(n, n, starts, None, rows))
    }
}

/// Finds entries in the columns.
struct Places<'a> {
    starts: &'a [u32],
    rows: &'a [u32],
}

impl Places<'_> {
    /// The place of an entry and of its mirror image, which is the same one.
    fn slot(&self, (i, j): (u32, u32)) -> u32 {
        if i == NOWHERE || j == NOWHERE {
            return NOWHERE;
        }
        let (row, column) = (i.max(j), i.min(j) as usize);
        let (start, end) = (self.starts[column], self.starts[column + 1]);
        if i == j {
            return start;
        }
        let column = &self.rows[start as usize..end as usize];
        start + column.partition_point(|&r| r < row) as u32
    }

    fn visit(&self, record: Record) -> Visit {
        let mut slots = Vec::new();
        let (mut freedoms, mut vertices) = (blocks(&record.stream), corners(&record));
        for run in &record.runs {
            for _ in 0..run.blocks {
                match run.shape {
                    Shape::Freedoms => {
                        let block = freedoms.next().unwrap_or(&[]);
                        slots.extend(pairs(block).map(|pair| self.slot(pair)));
                    }
                    Shape::Vertices { count, dimension } => {
                        let block = vertices.next().unwrap_or(&[]);
                        slots.extend(pairs(block).map(|(a, b)| self.slot((a.first, b.first))));
                        self.mark(
                            block,
                            dimension,
                            slots.len() - count * (count + 1) / 2,
                            &mut slots,
                        );
                    }
                    Shape::Parts { .. } => {}
                }
            }
        }
        slots.shrink_to_fit();
        drop((freedoms, vertices));
        Visit { runs: record.runs, stream: record.stream, slots }
    }

    /// Marks the diagonal slots of vertices that are partly fixed.
    fn mark(&self, block: &[Corner], dimension: usize, first: usize, slots: &mut [u32]) {
        let mut place = first;
        for (b, corner) in block.iter().enumerate() {
            if corner.count > 0 && corner.count < dimension as u32 {
                slots[place] |= MIXED;
            }
            place += block.len() - b;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::visit::PatternSink;
    use crate::{FIXED, Sink};

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
        let none = NOWHERE;
        assert_eq!(
            pattern.visits[0].slots,
            [5, 2, 0, /* block 1 */ 0, 1, none, 4, none, none, /* block 2 */ 5, 2, 0]
        );
    }

    #[test]
    fn a_block_between_vertices_has_a_slot_for_each_pair() {
        let mut sink = PatternSink::new(6).unwrap();
        // The first vertex is 4, 5; the second 1, 2; the third is held in part, the fourth wholly.
        let block = [[[[1.0; 2]; 4]; 2]; 4];
        sink.add_vertices(&[[4, 5], [1, 2], [FIXED, 3], [FIXED; 2]], &block);
        let pattern = sink.pattern().unwrap();
        assert_eq!(pattern.columns.col_ptr(), [0, 1, 6, 10, 13, 15, 16]);
        assert_eq!(pattern.columns.row_idx()[1..10], [1, 2, 3, 4, 5, 2, 3, 4, 5]);
        let [none, held] = [NOWHERE, MIXED | 10];
        assert_eq!(pattern.visits[0].slots, [13, 4, 11, none, 1, 3, none, held, none, none]);
        // Freedom 2 comes along wherever freedom 1 of its vertex is coupled.
        let mut sink = PatternSink::new(3).unwrap();
        sink.add_vertices(&[[1, 2]], &[[[[1.0; 2]]; 2]]);
        sink.add_symmetric(&[0, 1], &[1.0; 4]);
        assert_eq!(sink.pattern().unwrap().columns.row_idx(), [0, 1, 2, 1, 2, 2]);
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
        let mut sink = PatternSink::new(4).unwrap();
        sink.add_vertices(&[[0, 1], [1, 2]], &[[[[1.0; 2]; 2]; 2]; 2]);
        let error = sink.pattern().unwrap_err();
        assert_eq!(error, SparseError::RepeatedFreedom { block: 0, freedom: 1 });
    }
}
