//! Where a Hessian goes: a sink takes small dense blocks and adds them up.
//!
//! ```text
//! A += S^T B S        S selects the block's freedoms (notes 3.2-3.3), B is k x k
//! ```
//! A potential knows its blocks, a sink what becomes of them: a dense matrix ([`DenseSink`]), a
//! product with a vector without any matrix ([`ProductSink`]), a sparsity pattern or stored values
//! (feature `sparse`). No sink ever sees the selection matrices. Blocks between whole vertices
//! ([`Sink::add_vertices`]) are stored with less, those of which the lower triangle lies somewhere
//! ([`Sink::add_lower`]) need not be written out, and blocks that come in [`Parts`] are computed
//! side by side.

use crate::StencilHessian;
use crate::parts::{Parts, in_parts};

/// In a block's list of freedoms: this one is held fixed, its row and column are dropped.
pub const FIXED: usize = usize::MAX;

/// Takes dense blocks and adds them into a symmetric whole.
pub trait Sink {
    /// Adds the symmetric `block`, k x k by columns, at `freedoms` (k of them, [`FIXED`] or below
    /// the dimension).
    ///
    /// Both triangles must be filled: each sink reads the one that it needs, and the checks of
    /// this crate compare the two.
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]);

    /// Adds a symmetric block between `V` vertices of `D` freedoms each, [`FIXED`] where they are
    /// held.
    ///
    /// The same as [`Sink::add_symmetric`], which it falls back to; but a sink that stores places
    /// needs one for each pair of vertices instead of one for each entry.
    #[inline]
    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        block: &StencilHessian<V, D>,
    ) where
        Self: Sized,
    {
        let block = block.as_flattened().as_flattened().as_flattened();
        self.add_symmetric(freedoms.as_flattened(), block);
    }

    /// Adds a symmetric block between vertices out of its lower triangle: `column(b, d, a)` is what
    /// column d of vertex b has in the rows of vertex a, asked for where a >= b.
    ///
    /// The same as [`Sink::add_vertices`], which it falls back to; but a sink that reads each entry
    /// once reads it where it lies.
    #[inline]
    fn add_lower<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        column: impl Fn(usize, usize, usize) -> [f64; D],
    ) where
        Self: Sized,
    {
        self.add_vertices(freedoms, &from_lower(column));
    }

    /// Adds the blocks of all parts: one part after the other, or side by side where the sink can
    /// be divided. Either way the sums are the same to the last bit.
    ///
    /// What computes the blocks of elements is long, and is compiled for each type of sink. Sinks that
    /// only need [`Sink::add_symmetric`] share one, called by address.
    fn add_parts(&mut self, parts: &impl Parts)
    where
        Self: Sized,
    {
        parts.visit_all(&mut (self as &mut dyn Sink));
    }
}

impl Sink for &mut dyn Sink {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        (**self).add_symmetric(freedoms, block);
    }
}

/// The block whose lower triangle is known: symmetric to the last bit.
#[inline]
#[expect(clippy::needless_range_loop, reason = "blocks are written by their indices")]
pub(crate) fn from_lower<const V: usize, const D: usize>(
    column: impl Fn(usize, usize, usize) -> [f64; D],
) -> StencilHessian<V, D> {
    let mut block = [[[[0.0; D]; V]; D]; V];
    for b in 0..V {
        for d in 0..D {
            for a in b..V {
                block[b][d][a] = column(b, d, a);
            }
        }
    }
    for b in 0..V {
        for d in 0..D {
            for a in 0..=b {
                for c in 0..if a == b { d } else { D } {
                    block[b][d][a][c] = block[a][c][b][d];
                }
            }
        }
    }
    block
}

/// Adds `scale` times what it is given into a dense n x n matrix by columns, both triangles.
#[derive(Debug)]
pub struct DenseSink<'a> {
    scale: f64,
    n: usize,
    values: &'a mut [f64],
}

impl<'a> DenseSink<'a> {
    /// `values` holds n x n numbers by columns, or there is no sink.
    pub fn new(scale: f64, n: usize, values: &'a mut [f64]) -> Option<Self> {
        (values.len() == n * n).then_some(DenseSink { scale, n, values })
    }
}

impl Sink for DenseSink<'_> {
    #[inline]
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            for (&i, entry) in freedoms.iter().zip(column) {
                if i != FIXED && j != FIXED {
                    self.values[i + self.n * j] += self.scale * entry;
                }
            }
        }
    }
}

/// Adds the product with a vector, `y += scale A x`, and stores no matrix.
#[derive(Debug)]
pub struct ProductSink<'a> {
    scale: f64,
    x: &'a [f64],
    y: &'a mut [f64],
    /// The freedom of y's first entry: a part of the product knows no others.
    first: usize,
}

impl<'a> ProductSink<'a> {
    /// `x` and `y` of the same length, or there is no sink.
    pub fn new(scale: f64, x: &'a [f64], y: &'a mut [f64]) -> Option<Self> {
        (x.len() == y.len()).then_some(ProductSink { scale, x, y, first: 0 })
    }
}

impl Sink for ProductSink<'_> {
    #[inline]
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            if j == FIXED {
                continue;
            }
            let x = self.scale * self.x[j];
            for (&i, entry) in freedoms.iter().zip(column) {
                // Neither a fixed freedom nor one of another part has a place here.
                if let Some(y) = self.y.get_mut(i.wrapping_sub(self.first)) {
                    *y += entry * x;
                }
            }
        }
    }

    fn add_parts(&mut self, parts: &impl Parts) {
        let (scale, x, bounds) = (self.scale, self.x, parts.bounds());
        let known = bounds.last().is_some_and(|&last| last <= self.y.len());
        if !known || self.y.len() < x.len() || bounds.len() < 3 {
            return parts.visit_all(self);
        }
        let cut = |bound: usize| bound;
        in_parts(bounds, self.y, &cut, &|part, first, y: &mut [f64]| {
            parts.visit(part, &mut ProductSink { scale, x, y, first });
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fixed_freedoms_leave_no_trace() {
        let mut values = [0.0; 4];
        let mut sink = DenseSink::new(1.0, 2, &mut values).unwrap();
        sink.add_symmetric(&[1, FIXED, 0], &[4.0, 9.0, 2.0, 9.0, 9.0, 9.0, 2.0, 9.0, 3.0]);
        assert_eq!(values, [3.0, 2.0, 2.0, 4.0]);
    }

    #[test]
    fn a_lower_triangle_is_half_of_a_whole_block() {
        let entry = |i: usize, j: usize| (1 + i.min(j) + 10 * i.max(j)) as f64;
        let column = |b: usize, d: usize, a: usize| {
            assert!(a >= b, "only the lower triangle is asked for");
            std::array::from_fn(|c| {
                if a == b && c < d { f64::NAN } else { entry(2 * a + c, 2 * b + d) }
            })
        };
        let mut values = [0.0; 36];
        let mut sink = DenseSink::new(1.0, 6, &mut values).unwrap();
        sink.add_lower(&[[4, 5], [0, 1], [2, 3]], column);
        let place = |freedom: usize| (freedom + 2) % 6;
        for (k, value) in values.iter().enumerate() {
            assert_eq!(*value, entry(place(k % 6), place(k / 6)));
        }
    }

    #[test]
    fn a_product_needs_no_matrix() {
        let (mut matrix, mut y) = ([0.0; 9], [0.0; 3]);
        let x = [1.0, -2.0, 0.5];
        let blocks = [([0, 1], [2.0, -1.0, -1.0, 3.0]), ([2, 1], [5.0, 4.0, 4.0, 1.0])];
        for (freedoms, block) in &blocks {
            DenseSink::new(-2.0, 3, &mut matrix).unwrap().add_symmetric(freedoms, block);
            ProductSink::new(-2.0, &x, &mut y).unwrap().add_symmetric(freedoms, block);
        }
        for i in 0..3 {
            let row: f64 = (0..3).map(|j| matrix[i + 3 * j] * x[j]).sum();
            assert_eq!(row, y[i]);
        }
    }
}
