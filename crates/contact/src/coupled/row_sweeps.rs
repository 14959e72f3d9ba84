//! Sweeps over rows of all laws: each block is relaxed in turn, by its own compliance.
//!
//! ```text
//! x <- nearest(x - u/d),    u <- u + W dx              normals first, then friction within what they allow
//! ```
//! Symbols and laws as in `row_laws.rs`. Source: Kaufman, Sueda, James and Pai 2008.

use std::ops::Range;

use crate::coupled::row_laws::{BlockLaw, RowLaws, size};

impl RowLaws {
    /// Relaxes each block in turn, so many times: normals first, then friction within what they allow.
    pub(crate) fn sweep(&mut self, x: &mut [f64], sweeps: usize) {
        self.find_rates(x);
        for _ in 0..sweeps {
            for block in 0..self.laws.len() {
                let rows = self.starts[block]..self.starts[block + 1];
                let law = self.laws[block];
                let first = rows.start;
                if law.normals() > 0 && self.own[first] > 0.0 {
                    let wanted = x[first] - self.rates[first] / self.own[first];
                    let wanted = match law {
                        BlockLaw::Equality | BlockLaw::Disc { .. } => wanted,
                        BlockLaw::Limit | BlockLaw::Cone(_) => wanted.max(0.0),
                        BlockLaw::Bounded(bound) => wanted.clamp(-bound, bound),
                    };
                    self.change(x, first, wanted);
                }
                if matches!(law, BlockLaw::Cone(_) | BlockLaw::Disc { .. }) {
                    self.rub(x, first + law.normals()..rows.end, law.radius(x, first));
                }
            }
        }
    }

    /// The nearest friction to what would stop sliding.
    fn rub(&mut self, x: &mut [f64], rows: Range<usize>, radius: f64) {
        let mut wanted = [0.0; 2];
        for (wanted, row) in wanted.iter_mut().zip(rows.clone()) {
            *wanted = x[row];
            if self.own[row] > 0.0 {
                *wanted -= self.rates[row] / self.own[row];
            }
        }
        let length = size(wanted);
        let part = if length > radius { radius / length } else { 1.0 };
        for (row, wanted) in rows.zip(wanted) {
            self.change(x, row, part * wanted);
        }
    }

    fn change(&mut self, x: &mut [f64], row: usize, to: f64) {
        let change = to - x[row];
        x[row] = to;
        let n = self.rows();
        let column = &self.compliance[n * row..n * (row + 1)];
        self.rates.iter_mut().zip(column).for_each(|(rate, w)| *rate += change * w);
    }
}
