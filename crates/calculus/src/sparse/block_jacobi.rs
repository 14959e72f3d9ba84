//! A preconditioner that knows each vertex by itself: the inverses of the diagonal's blocks.
//!
//! ```text
//! B = diag(B_1, B_2, ...),    B_v = L_v L_v^T       the block of A of the freedoms of vertex v
//! ```
//! Freedoms are one vertex where a block between vertices says so ([`Sink::add_vertices`]); any other
//! freedom is a vertex of its own, and the preconditioner the diagonal. Each block is factored by
//! Cholesky's method: one that is not positive definite is an error that names the freedom, and shows
//! that A is not either. Source: notes A.1, where the diagonal alone is taken.

use std::ops::Range;

use faer::dyn_stack::{MemStack, StackReq};
use faer::matrix_free::{LinOp, Precond};
use faer::{MatMut, MatRef, Par};

use crate::equation::power_of_two;
use crate::sparse::conjugate_gradient::{column, column_mut};
use crate::sparse::visit::Corner;
use crate::sparse::{SparseError, SymmetricMatrix};
use crate::{FIXED, Parts, Sink, StencilHessian};

/// The factors of the blocks.
#[derive(Clone, Debug)]
pub(crate) struct BlockJacobi {
    /// The first freedom of each vertex, and after the last one the end.
    starts: Vec<u32>,
    /// Where each freedom's column of its block begins in the entries.
    columns: Vec<u32>,
    entries: Vec<f64>,
    /// A power of two near the largest pivot where squares of it would leave the range of numbers, else
    /// 1. The inverses are multiplied by it: they are those of the blocks over it.
    scale: f64,
}

impl BlockJacobi {
    /// The zero blocks of n freedoms that belong together as the visited blocks say.
    pub(crate) fn analyse(n: usize, visit: impl FnOnce(&mut Joined)) -> Self {
        let mut joined = Joined(vec![false; n]);
        visit(&mut joined);
        let mut starts: Vec<u32> =
            (0..n as u32).filter(|&f| f == 0 || !joined.0[f as usize - 1]).collect();
        starts.push(n as u32);
        let (mut columns, mut size) = (Vec::with_capacity(n), 0);
        for ends in starts.windows(2) {
            for _ in ends[0]..ends[1] {
                columns.push(size);
                size += ends[1] - ends[0];
            }
        }
        BlockJacobi { starts, columns, entries: vec![0.0; size as usize], scale: 1.0 }
    }

    fn blocks(&self) -> impl Iterator<Item = Range<usize>> {
        self.starts.windows(2).map(|ends| ends[0] as usize..ends[1] as usize)
    }

    /// Sums up the blocks that are visited and factors them.
    pub(crate) fn factor(&mut self, visit: impl FnOnce(&mut Blocks)) -> Result<(), SparseError> {
        self.entries.fill(0.0);
        visit(&mut Blocks { weight: 1.0, jacobi: self });
        self.factor_in_place()
    }

    /// Takes the blocks out of a matrix and factors them.
    pub(crate) fn factor_of(&mut self, matrix: &SymmetricMatrix) -> Result<(), SparseError> {
        self.entries.fill(0.0);
        let (starts, rows) = (matrix.column_starts(), matrix.rows());
        for block in self.starts.windows(2) {
            let (first, end) = (block[0] as usize, block[1] as usize);
            for j in first..end {
                let column = starts[j] as usize..starts[j + 1] as usize;
                let own = rows[column.clone()].iter().zip(&matrix.values()[column]);
                for (&i, value) in own.take_while(|(i, _)| (**i as usize) < end) {
                    self.entries[self.columns[j] as usize + i as usize - first] = *value;
                }
            }
        }
        self.factor_in_place()
    }

    /// What the matrix has to be divided by to go with the preconditioner.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    fn factor_in_place(&mut self) -> Result<(), SparseError> {
        let mut smallest = f64::INFINITY;
        for ends in self.starts.windows(2) {
            let (first, k) = (ends[0] as usize, (ends[1] - ends[0]) as usize);
            let Some(&start) = self.columns.get(first) else { continue };
            let block = &mut self.entries[start as usize..start as usize + k * k];
            if let Some(pivot) = cholesky(block, k) {
                let freedom = first + pivot;
                return Err(if block[pivot + k * pivot].is_finite() {
                    SparseError::NotPositiveDefinite { freedom }
                } else {
                    SparseError::NonFinite
                });
            }
            smallest = (0..k).map(|j| block[j + k * j]).fold(smallest, f64::min);
        }
        self.scale = power_of_two(smallest.recip().powi(2));
        Ok(())
    }

    /// The freedoms of a freedom's block: the first, and the end.
    pub(crate) fn block_of(&self, freedom: usize) -> (usize, usize) {
        let block = self.starts.partition_point(|&start| start as usize <= freedom);
        (self.starts[block - 1] as usize, self.starts[block] as usize)
    }

    /// Replaces x by its product with the inverse of the blocks.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        for block in self.blocks() {
            let k = block.len();
            let start = self.columns[block.start] as usize;
            let factor = &self.entries[start..start + k * k];
            let x = &mut x[block];
            for j in 0..k {
                x[j] *= factor[j + k * j];
                for i in j + 1..k {
                    x[i] -= factor[i + k * j] * x[j];
                }
            }
            for j in (0..k).rev() {
                for i in j + 1..k {
                    x[j] -= factor[i + k * j] * x[i];
                }
                x[j] *= factor[j + k * j];
            }
        }
        if self.scale != 1.0 {
            x.iter_mut().for_each(|x| *x *= self.scale);
        }
    }
}

/// Replaces the lower triangle by its factor, the reciprocals of its diagonal on the diagonal; the first
/// pivot that is not positive, left where it is.
fn cholesky(block: &mut [f64], k: usize) -> Option<usize> {
    for j in 0..k {
        for m in 0..j {
            let factor = block[j + k * m];
            for i in j..k {
                block[i + k * j] -= block[i + k * m] * factor;
            }
        }
        let pivot = block[j + k * j];
        if !(pivot > 0.0 && pivot < f64::INFINITY) {
            return Some(j);
        }
        let reciprocal = pivot.sqrt().recip();
        block[j + k * j] = reciprocal;
        for i in j + 1..k {
            block[i + k * j] *= reciprocal;
        }
    }
    None
}

/// Whether each freedom belongs to one vertex with the next one.
pub(crate) struct Joined(Vec<bool>);

impl Sink for Joined {
    fn add_symmetric(&mut self, _freedoms: &[usize], _block: &[f64]) {}

    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        _block: &StencilHessian<V, D>,
    ) {
        for corner in freedoms.iter().filter_map(|freedoms| Corner::of(freedoms)) {
            if corner.count > 1 {
                let first = corner.first as usize;
                self.0[first..first + corner.count as usize - 1].fill(true);
            }
        }
    }

    fn add_parts(&mut self, parts: &impl Parts) {
        parts.visit_all(self);
    }
}

/// Adds what is on the blocks and drops the rest.
pub(crate) struct Blocks<'a> {
    weight: f64,
    jacobi: &'a mut BlockJacobi,
}

impl Blocks<'_> {
    /// The same sink, which from now on multiplies what it is given by `weight`.
    pub(crate) fn weighted(&mut self, weight: f64) -> &mut Self {
        self.weight = weight;
        self
    }

    fn add(&mut self, i: usize, j: usize, entry: f64) {
        if i < j || j == FIXED || i == FIXED {
            return;
        }
        let vertex = self.jacobi.starts.partition_point(|&start| start as usize <= j) - 1;
        let (first, end) = (self.jacobi.starts[vertex], self.jacobi.starts[vertex + 1]);
        if i < end as usize {
            let column = self.jacobi.columns[j] as usize;
            self.jacobi.entries[column + i - first as usize] += self.weight * entry;
        }
    }
}

impl Sink for Blocks<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        let k = freedoms.len();
        for (b, &j) in freedoms.iter().enumerate() {
            for (a, &i) in freedoms.iter().enumerate() {
                self.add(i, j, block[a + k * b]);
            }
        }
    }

    fn add_vertices<const V: usize, const D: usize>(
        &mut self,
        freedoms: &[[usize; D]; V],
        block: &StencilHessian<V, D>,
    ) {
        for (a, freedoms) in freedoms.iter().enumerate() {
            for (d, &j) in freedoms.iter().enumerate() {
                for (c, &i) in freedoms.iter().enumerate() {
                    self.add(i, j, block[a][d][a][c]);
                }
            }
        }
    }

    fn add_parts(&mut self, parts: &impl Parts) {
        parts.visit_all(self);
    }
}

impl LinOp<f64> for BlockJacobi {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.columns.len()
    }

    fn ncols(&self) -> usize {
        self.columns.len()
    }

    fn apply(&self, out: MatMut<'_, f64>, x: MatRef<'_, f64>, _: Par, _: &mut MemStack) {
        let y = column_mut(out);
        y.copy_from_slice(column(x));
        self.solve(y);
    }

    fn conj_apply(&self, y: MatMut<'_, f64>, x: MatRef<'_, f64>, par: Par, stack: &mut MemStack) {
        self.apply(y, x, par, stack);
    }
}

impl Precond<f64> for BlockJacobi {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blocks_of_vertices_are_inverted_and_what_is_between_them_is_not_seen() {
        let own = [[4.0, 1.0], [1.0, 3.0]];
        let block: StencilHessian<2, 2> = std::array::from_fn(|b| {
            own.map(|column| std::array::from_fn(|a| if a == b { column } else { [0.5; 2] }))
        });
        // A vertex of freedoms 1 and 2, one of freedom 3 alone, and freedom 0 by itself.
        let visit = |sink: &mut dyn FnMut(&[[usize; 2]; 2])| sink(&[[1, 2], [FIXED, 3]]);
        let mut jacobi = BlockJacobi::analyse(4, |sink| {
            visit(&mut |freedoms| sink.add_vertices(freedoms, &block));
        });
        jacobi
            .factor(|sink| {
                sink.add_symmetric(&[0, 1], &[2.0, 7.0, 7.0, 0.0]);
                visit(&mut |freedoms| sink.add_vertices(freedoms, &block));
            })
            .unwrap();
        let mut x = [2.0, 5.0, 4.0, 6.0];
        jacobi.solve(&mut x);
        for (x, exact) in x.iter().zip([1.0, 1.0, 1.0, 2.0]) {
            assert!((x - exact).abs() < 1e-15, "{x}");
        }
        let mut matrix = SymmetricMatrix::analyse(4, |sink| {
            visit(&mut |freedoms| sink.add_vertices(freedoms, &block));
            sink.add_symmetric(&[0, 1], &[0.0; 4]);
        })
        .unwrap();
        matrix
            .refill(|sink| {
                visit(&mut |freedoms| sink.add_vertices(freedoms, &block));
                sink.add_symmetric(&[0, 1], &[2.0, 7.0, 7.0, 0.0]);
            })
            .unwrap();
        let mut of_matrix = BlockJacobi::analyse(4, |sink| {
            visit(&mut |freedoms| sink.add_vertices(freedoms, &block));
        });
        of_matrix.factor_of(&matrix).unwrap();
        assert_eq!(of_matrix.entries, jacobi.entries);
    }

    #[test]
    fn a_block_that_is_not_positive_is_refused_by_freedom() {
        let all = |entry: f64| [[[[entry; 2]]; 2]];
        let mut jacobi = BlockJacobi::analyse(2, |sink| sink.add_vertices(&[[0, 1]], &all(1.0)));
        let error = jacobi.factor(|sink| sink.add_vertices(&[[0, 1]], &all(1.0))).unwrap_err();
        assert_eq!(error, SparseError::NotPositiveDefinite { freedom: 1 });
        let error = jacobi.factor(|sink| sink.add_vertices(&[[0, 1]], &all(f64::NAN))).unwrap_err();
        assert_eq!(error, SparseError::NonFinite);
    }
}
