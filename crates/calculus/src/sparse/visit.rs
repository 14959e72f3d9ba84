//! The first visit of the blocks of a matrix: what each block names, so that later visits find it.
//!
//! ```text
//! block between vertices    ->   one slot for each pair of vertices         where a vertex is a row
//! any other block           ->   one slot for each entry                    of freedoms, one after
//! ```                                                                       another
//! [`PatternSink`] takes the freedoms and forgets the entries. Blocks of one shape that follow one
//! another are a run, of which only the length is kept; a block between vertices keeps no freedoms
//! either: the slots of its diagonal blocks, where its vertices' columns begin, tell them.
//! Blocks that come in parts make a visit for each part. Knows nothing of values.

use crate::sparse::SparseError;
use crate::sparse::pattern::Pattern;
use crate::{FIXED, Parts, Sink, StencilHessian, array};

/// A slot that is none: a fixed freedom has no place.
pub(crate) const NOWHERE: u32 = u32::MAX;

/// Marks the diagonal slot of a vertex of which some coordinates are fixed. No slot has this bit.
pub(crate) const MIXED: u32 = 1 << 31;

/// What blocks of one run are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Freedoms in any order.
    Freedoms,
    /// `count` vertices of `dimension` coordinates.
    Vertices { count: usize, dimension: usize },
    /// No block: `count` visits of their own, from `first` on.
    Parts { first: usize, count: usize },
}

/// Blocks of one shape, one after another.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Run {
    pub(crate) shape: Shape,
    pub(crate) blocks: usize,
}

/// What a visit brought.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    pub(crate) runs: Vec<Run>,
    /// Of each block of freedoms their number, then the freedoms.
    pub(crate) stream: Vec<u32>,
    /// Of each block of vertices their free coordinates.
    pub(crate) corners: Vec<Corner>,
}

/// The free coordinates of a vertex: so many freedoms, one after another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Corner {
    pub(crate) first: u32,
    pub(crate) count: u32,
}

impl Corner {
    /// `None` where the freedoms do not follow one another.
    pub(crate) fn of(freedoms: &[usize]) -> Option<Self> {
        let mut free = freedoms.iter().filter(|&&freedom| freedom != FIXED);
        let Some(&first) = free.next() else { return Some(Corner { first: NOWHERE, count: 0 }) };
        let mut count = 1;
        for &freedom in free {
            if freedom != first + count {
                return None;
            }
            count += 1;
        }
        Some(Corner { first: first as u32, count: count as u32 })
    }
}

/// Takes the freedoms of blocks and forgets their entries.
#[derive(Clone, Debug)]
pub struct PatternSink {
    n: usize,
    blocks: usize,
    /// The visit itself, and after it those of parts.
    records: Vec<Record>,
    /// Which of them is written.
    current: usize,
    /// Whether a freedom and the next one belong to one vertex.
    joined: Vec<bool>,
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
        Ok(PatternSink {
            n,
            blocks: 0,
            records: vec![Record::default()],
            current: 0,
            joined: vec![false; n],
            error: None,
        })
    }

    fn check(&mut self, freedoms: &[usize], entries: usize) {
        if let Err(error) = self.checked(freedoms, entries) {
            self.error.get_or_insert(error);
        }
        self.blocks += 1;
    }

    fn checked(&self, freedoms: &[usize], entries: usize) -> Result<(), SparseError> {
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

    /// The record, in which a run of this shape has one block more.
    fn record(&mut self, shape: Shape) -> &mut Record {
        let record = &mut self.records[self.current];
        match record.runs.last_mut() {
            Some(run) if run.shape == shape => run.blocks += 1,
            _ => record.runs.push(Run { shape, blocks: 1 }),
        }
        record
    }

    fn add_freedoms(&mut self, freedoms: &[usize]) {
        let record = self.record(Shape::Freedoms);
        record.stream.push(freedoms.len() as u32);
        record.stream.extend(freedoms.iter().map(|&freedom| stored(freedom)));
    }

    fn add_corners<const V: usize, const D: usize>(&mut self, freedoms: &[[usize; D]; V]) {
        let all = freedoms.as_flattened();
        self.check(all, all.len() * all.len());
        let corners: [_; V] = array(|a| Corner::of(&freedoms[a]));
        if self.error.is_some() || corners.contains(&None) {
            return self.add_freedoms(all);
        }
        for corner in corners.iter().flatten().filter(|corner| corner.count > 1) {
            let first = corner.first as usize;
            self.joined[first..first + corner.count as usize - 1].fill(true);
        }
        let record = self.record(Shape::Vertices { count: V, dimension: D });
        record.corners.extend(corners.iter().flatten());
    }

    pub(crate) fn pattern(self) -> Result<Pattern, SparseError> {
        match self.error {
            Some(error) => Err(error),
            None => Pattern::new(&self.joined, self.records),
        }
    }
}

impl Sink for PatternSink {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        self.check(freedoms, block.len());
        self.add_freedoms(freedoms);
    }

    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        _block: &StencilHessian<V, D>,
    ) {
        self.add_corners(freedoms);
    }

    fn add_lower<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        _column: impl Fn(usize, usize, usize) -> [f64; D],
    ) {
        self.add_corners(freedoms);
    }

    fn add_parts(&mut self, parts: &impl Parts) {
        let count = parts.bounds().len().saturating_sub(1);
        if count < 2 || self.current > 0 {
            return parts.visit_all(self);
        }
        let first = self.records.len();
        for part in 0..count {
            self.current = self.records.len();
            self.records.push(Record::default());
            parts.visit(part, self);
        }
        self.current = 0;
        self.record(Shape::Parts { first, count });
    }
}
