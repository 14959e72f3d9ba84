//! A Hessian as it arrives at a sink: blocks that must be symmetric, and their sum.
//!
//! ```text
//! B_ij = B_ji              each block, as it was given
//! H = sum of S^T B S       by place, never formed densely
//! ```
//! `B` k x k at k freedoms, of which fixed ones are left out; `H` n x n.
//! Source: notes 2.4, "a common way to spot a bug".

use crate::{FIXED, Sink};

/// Two entries of a block that ought to be equal.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asymmetry {
    pub row: usize,
    pub column: usize,
    pub entry: f64,
    pub mirror: f64,
    /// Their difference over the block's largest entry.
    pub relative: f64,
}

/// The first block at which two visits differ.
pub(super) fn first_change(one: &[usize], other: &[usize]) -> Option<usize> {
    let (mut at, mut block) = (0, 0);
    loop {
        let (a, b) = match (one.get(at), other.get(at)) {
            (None, None) => return None,
            (Some(&a), Some(&b)) => (a, b),
            _ => return Some(block),
        };
        if a != b || one[at + 1..=at + a] != other[at + 1..=at + a] {
            return Some(block);
        }
        at += a + 1;
        block += 1;
    }
}

/// Keeps each block's entries with their places.
#[derive(Debug, Default)]
pub(super) struct Blocks {
    freedoms: usize,
    entries: Vec<(usize, usize, f64)>,
    /// The worst pair of entries that ought to be equal.
    pub asymmetry: Option<Asymmetry>,
    /// A freedom that the potential does not have.
    pub unknown: Option<usize>,
    /// The freedoms of each block, one block after another: its number of them, then them.
    pub visit: Vec<usize>,
    /// Block, freedoms and entries where the two do not go together.
    pub misfit: Option<(usize, usize, usize)>,
    count: usize,
    /// Row and column of an entry that is not finite.
    pub not_finite: Option<(usize, usize)>,
}

impl Blocks {
    pub fn new(freedoms: usize) -> Self {
        Blocks { freedoms, ..Blocks::default() }
    }

    /// The sum of the blocks.
    pub fn sum(mut self) -> Entries {
        self.entries.sort_by_key(|&(row, column, _)| (row, column));
        self.entries.dedup_by(|next, kept| {
            let same = (next.0, next.1) == (kept.0, kept.1);
            if same {
                kept.2 += next.2;
            }
            same
        });
        Entries { freedoms: self.freedoms, entries: self.entries }
    }
}

impl Sink for Blocks {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        let k = freedoms.len();
        self.visit.push(k);
        self.visit.extend_from_slice(freedoms);
        self.count += 1;
        if k == 0 || block.len() != k * k {
            self.misfit.get_or_insert((self.count - 1, k, block.len()));
            return;
        }
        let largest = block.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for (j, &column) in freedoms.iter().enumerate().filter(|&(_, &f)| f != FIXED) {
            if column >= self.freedoms {
                self.unknown = Some(column);
                return;
            }
            for (i, &row) in freedoms.iter().enumerate().filter(|&(_, &f)| f < self.freedoms) {
                let (entry, mirror) = (block[i + k * j], block[j + k * i]);
                if !entry.is_finite() {
                    self.not_finite = Some((row, column));
                }
                let relative = (entry - mirror).abs() / largest;
                if i > j && relative > self.asymmetry.map_or(0.0, |worst| worst.relative) {
                    self.asymmetry = Some(Asymmetry { row, column, entry, mirror, relative });
                }
                self.entries.push((row, column, entry));
            }
        }
    }
}

/// The entries of a matrix that were touched, by rows.
#[derive(Debug)]
pub(super) struct Entries {
    freedoms: usize,
    entries: Vec<(usize, usize, f64)>,
}

impl Entries {
    /// The product with a vector.
    pub fn product(&self, w: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; self.freedoms];
        for &(row, column, entry) in &self.entries {
            y[row] += entry * w[column];
        }
        y
    }

    /// The quadratic form `w^T H w`.
    pub fn quadratic(&self, w: &[f64]) -> f64 {
        self.entries.iter().map(|&(row, column, entry)| w[row] * entry * w[column]).sum()
    }

    /// The largest magnitude in each row.
    pub fn largest(&self) -> Vec<f64> {
        let mut largest = vec![0.0_f64; self.freedoms];
        for &(row, _, entry) in &self.entries {
            largest[row] = largest[row].max(entry.abs());
        }
        largest
    }

    /// The largest sum of magnitudes in a row.
    pub fn norm(&self) -> f64 {
        let mut sums = vec![0.0_f64; self.freedoms];
        for &(row, _, entry) in &self.entries {
            sums[row] += entry.abs();
        }
        sums.into_iter().fold(0.0, f64::max)
    }

    /// The columns of the largest entries of a row beside its diagonal, with them.
    pub fn largest_beside(&self, row: usize, count: usize) -> Vec<(usize, f64)> {
        let beside = |&&(i, j, entry): &&(usize, usize, f64)| i == row && j != row && entry != 0.0;
        let mut largest: Vec<(usize, f64)> =
            self.entries.iter().filter(beside).map(|&(_, j, entry)| (j, entry)).collect();
        largest.sort_by(|a, b| b.1.abs().total_cmp(&a.1.abs()));
        largest.truncate(count);
        largest
    }

    /// Row and column of the largest magnitude.
    pub fn place_of_largest(&self) -> Option<(usize, usize)> {
        let larger = |a: &&(usize, usize, f64), b: &&(usize, usize, f64)| {
            a.2.abs().total_cmp(&b.2.abs()).then((b.0, b.1).cmp(&(a.0, a.1)))
        };
        self.entries.iter().max_by(larger).map(|&(row, column, _)| (row, column))
    }
}
