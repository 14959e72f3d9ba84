//! Rows that are no equalities, as they answer where equalities keep what they ask for.
//!
//! ```text
//! W_c = W_cc - W_ce W_ee^-1 W_ec,    o_c = o_c - W_ce W_ee^-1 o_e          e equalities, c the others
//! ```
//! An equality that depends on those before it takes no part. Of each cone of space the tangents may be turned, so
//! that a pyramid in its place has an edge where friction is expected.

use crate::coupled::row_laws::{BlockLaw, RowLaws};

/// What is left of a row's own compliance, relative to it, where it depends on those before it.
const DEPENDENT: f64 = 1e-10;

/// The rows, their compliance (n x n), their rates before any impulse, and the impulse of a unit compliance
/// of each.
#[derive(Debug, Default)]
pub(crate) struct ReducedRows {
    pub(crate) laws: Vec<BlockLaw>,
    pub(crate) starts: Vec<usize>,
    pub(crate) compliance: Vec<f64>,
    pub(crate) free: Vec<f64>,
    pub(crate) scale: Vec<f64>,
    /// The number of each row among all.
    rows: Vec<usize>,
    /// The first tangents of cones that are turned, and by what cosine and sine.
    turns: Vec<(usize, [f64; 2])>,
    /// What is left of the compliance and the rates of all rows, and a row of it.
    left: Vec<f64>,
    rates: Vec<f64>,
    line: Vec<f64>,
    /// Impulses of these rows.
    pub(crate) x: Vec<f64>,
}

impl ReducedRows {
    /// Reduces rows.
    pub(crate) fn find(&mut self, all: &RowLaws) {
        self.turns.clear();
        self.left.clear();
        self.left.extend_from_slice(&all.compliance);
        self.rates.clear();
        self.rates.extend_from_slice(&all.free);
        let n = all.rows();
        for (_, block) in all.blocks().filter(|(law, _)| *law == BlockLaw::Equality) {
            let own = n * block.start + block.start;
            if self.left[own] > DEPENDENT * all.compliance[own] {
                self.eliminate(block.start);
            }
        }
        self.laws.clear();
        self.starts.clear();
        self.starts.push(0);
        self.rows.clear();
        for (law, block) in all.blocks().filter(|(law, _)| *law != BlockLaw::Equality) {
            self.laws.push(match law {
                // A cone is no equality, and comes before its discs.
                BlockLaw::Disc { normal, part } => {
                    BlockLaw::Disc { normal: self.rows.partition_point(|row| *row < normal), part }
                }
                law => law,
            });
            self.rows.extend(block);
            self.starts.push(self.rows.len());
        }
        self.compliance.clear();
        for row in &self.rows {
            self.compliance.extend(self.rows.iter().map(|of| self.left[n * row + of]));
        }
        self.free.clear();
        self.free.extend(self.rows.iter().map(|&row| self.rates[row]));
        self.scale.clear();
        self.scale.extend(self.rows.iter().map(|&row| all.scale[row]));
    }

    /// Gives a row the impulse that stops it, whatever those of the others are.
    fn eliminate(&mut self, row: usize) {
        let n = self.rates.len();
        self.line.clear();
        self.line.extend_from_slice(&self.left[n * row..n * (row + 1)]);
        let (pivot, rate) = (self.line[row], self.rates[row]);
        for (other, line) in self.left.chunks_exact_mut(n).enumerate() {
            let part = line[row] / pivot;
            if other != row && part != 0.0 {
                line.iter_mut().zip(&self.line).for_each(|(to, from)| *to -= part * from);
                self.rates[other] -= part * rate;
            }
        }
    }

    /// Turns the tangents of each cone: the first is along what its impulses and rates (of all rows) want.
    pub(crate) fn turn(&mut self, x: &[f64], rates: &[f64]) {
        let ReducedRows { laws, starts, rows, compliance, free, scale, turns, .. } = self;
        let n = free.len();
        for (law, block) in laws.iter().zip(starts.windows(2)) {
            let [a, b] = [block[0] + law.normals(), block[0] + law.normals() + 1];
            let rubs = matches!(law, BlockLaw::Cone(_) | BlockLaw::Disc { .. });
            if !rubs || b >= block[1] {
                continue;
            }
            let own = scale[a] * scale[a];
            let wanted = [a, b].map(|row| x[rows[row]] - own * rates[rows[row]]);
            let length = wanted[0].hypot(wanted[1]);
            if !(length > 0.0 && length.is_finite()) {
                continue;
            }
            let [c, s] = wanted.map(|along| along / length);
            turns.push((a, [c, s]));
            let turn = |p: &mut f64, q: &mut f64| (*p, *q) = (c * *p + s * *q, c * *q - s * *p);
            let (above, below) = compliance.split_at_mut(n * b);
            above[n * a..].iter_mut().zip(below).for_each(|(p, q)| turn(p, q));
            for list in compliance.chunks_exact_mut(n).chain([&mut free[..]]) {
                let (p, q) = list.split_at_mut(b);
                turn(&mut p[a], &mut q[0]);
            }
        }
    }

    /// Writes the impulses of these rows among those of all.
    pub(crate) fn put_back(&mut self, all: &mut [f64]) {
        for &(a, [c, s]) in &self.turns {
            (self.x[a], self.x[a + 1]) =
                (c * self.x[a] - s * self.x[a + 1], c * self.x[a + 1] + s * self.x[a]);
        }
        self.rows.iter().zip(&self.x).for_each(|(&row, x)| all[row] = *x);
    }
}
