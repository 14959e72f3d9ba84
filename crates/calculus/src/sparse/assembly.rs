//! A sparse symmetric matrix whose values are summed up again and again in the same places.
//!
//! ```text
//! A = w_1 A_1 + w_2 A_2 + ...        A_i given block by block
//! ```
//! The lower triangle of A (n x n) is stored by columns. The pattern is found once, from a first visit
//! of all blocks ([`SymmetricMatrix::analyse`]); a later visit ([`SymmetricMatrix::refill`]) must bring
//! the same blocks in the same order and only adds: no search, no triplets, no allocation. Each block
//! is compared with the recorded one, so that a changed order is an error and never a wrong matrix.
//! Sums run in visiting order, hence have the same bits in every run, and for blocks that come in parts
//! ([`Parts`](crate::Parts)) on any number of threads.

use std::sync::Arc;

use faer::sparse::SparseColMatRef;

use crate::sparse::SparseError;
use crate::sparse::pattern::Pattern;
use crate::sparse::refill::RefillSink;
use crate::sparse::visit::PatternSink;
use crate::{Metric, Potential, Sink, SizeError};

/// A symmetric matrix in compressed columns of its lower triangle.
#[derive(Clone, Debug)]
pub struct SymmetricMatrix {
    pattern: Arc<Pattern>,
    values: Vec<f64>,
}

impl SymmetricMatrix {
    /// The zero matrix of size n with the pattern of the blocks that `visit` brings.
    ///
    /// # Errors
    /// [`SparseError::UnknownFreedom`], [`SparseError::RepeatedFreedom`] and
    /// [`SparseError::BlockSize`] for the first such block; [`SparseError::TooLarge`] for more
    /// freedoms or entries than 32-bit indices can tell apart.
    pub fn analyse(n: usize, visit: impl FnOnce(&mut PatternSink)) -> Result<Self, SparseError> {
        let mut sink = PatternSink::new(n)?;
        visit(&mut sink);
        let pattern = sink.pattern()?;
        let values = vec![0.0; pattern.columns.row_idx().len()];
        Ok(SymmetricMatrix { pattern: Arc::new(pattern), values })
    }

    /// The sum of blocks: of each its freedoms and its symmetric entries by columns.
    ///
    /// # Errors
    /// Those of [`SymmetricMatrix::analyse`].
    pub fn from_blocks<F: AsRef<[usize]>, B: AsRef<[f64]>>(
        n: usize,
        blocks: &[(F, B)],
    ) -> Result<Self, SparseError> {
        let mut matrix = SymmetricMatrix::analyse(n, |sink| visit(blocks, sink))?;
        matrix.refill(|sink| visit(blocks, sink))?;
        Ok(matrix)
    }

    /// The Hessian of a potential at `q`, on flat space.
    ///
    /// # Errors
    /// [`SparseError::Size`] where q has another size; blocks that name what is not there, or are not the
    /// same when they are visited again.
    pub fn hessian(potential: &impl Potential, q: &[f64]) -> Result<Self, SparseError> {
        let n = potential.dim();
        SizeError::check("the configuration's numbers", n, q.len())?;
        let mut matrix = SymmetricMatrix::analyse(n, |sink| potential.add_hessian(q, sink))?;
        matrix.refill(|sink| potential.add_hessian(q, sink))?;
        Ok(matrix)
    }

    /// The mass matrix of a metric.
    ///
    /// # Errors
    /// Those of [`SymmetricMatrix::analyse`]; [`SparseError::PatternChanged`] where the metric
    /// brings other blocks when it is visited again.
    pub fn mass(metric: &impl Metric) -> Result<Self, SparseError> {
        let mut matrix = SymmetricMatrix::analyse(metric.dim(), |sink| metric.add_matrix(sink))?;
        matrix.refill(|sink| metric.add_matrix(sink))?;
        Ok(matrix)
    }

    /// Sets the values to the sum of the blocks that `visit` brings: those that were analysed, in
    /// the same order. After an error the values are not to be used.
    ///
    /// # Errors
    /// [`SparseError::PatternChanged`] for the first block that differs, is missing or is too many.
    #[inline]
    pub fn refill(&mut self, visit: impl FnOnce(&mut RefillSink)) -> Result<(), SparseError> {
        self.values.fill(0.0);
        let mut sink = RefillSink::new(&self.pattern, &mut self.values);
        visit(&mut sink);
        match sink.changed() {
            None => Ok(()),
            Some(block) => Err(SparseError::PatternChanged { block }),
        }
    }

    /// The size n.
    pub fn dim(&self) -> usize {
        self.pattern.dim()
    }

    /// Where each column starts in [`SymmetricMatrix::rows`], and after the last one the end.
    pub fn column_starts(&self) -> &[u32] {
        self.pattern.columns.col_ptr()
    }

    /// The rows of the entries, ascending in each column from its diagonal.
    pub fn rows(&self) -> &[u32] {
        self.pattern.columns.row_idx()
    }

    /// The entries.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// What it takes in memory, bytes: entries, their places, and the slots of the blocks. The last
    /// two are shared with its clones and its factors.
    pub fn bytes(&self) -> usize {
        size_of_val(self.values()) + self.pattern.bytes()
    }

    /// The same matrix in another unit.
    pub(crate) fn divided_by(&self, unit: f64) -> SymmetricMatrix {
        let values = self.values.iter().map(|value| value / unit).collect();
        SymmetricMatrix { pattern: Arc::clone(&self.pattern), values }
    }

    /// The diagonal entry of a column.
    pub(crate) fn diagonal(&self, column: usize) -> f64 {
        self.values[self.column_starts()[column] as usize]
    }

    /// Adds the product with a vector: `y += scale A x`.
    ///
    /// # Errors
    /// [`SizeError`] unless both vectors have n components; y is then as it was.
    pub fn add_product(&self, scale: f64, x: &[f64], y: &mut [f64]) -> Result<(), SizeError> {
        self.pattern.check_vector(x)?;
        self.pattern.check_vector(y)?;
        self.add_product_unchecked(scale, x, y);
        Ok(())
    }

    /// The same for vectors whose lengths are known to be n.
    pub(crate) fn add_product_unchecked(&self, scale: f64, x: &[f64], y: &mut [f64]) {
        add_product(self.column_starts(), self.rows(), self.values(), scale, x, y);
    }

    /// What the terms of a product are together, without their signs: `sizes = |A| x`, x positive.
    pub(crate) fn sizes_of_product(&self, x: &[f64], sizes: &mut [f64]) {
        sizes.fill(0.0);
        for (j, ends) in self.column_starts().windows(2).enumerate() {
            for entry in ends[0] as usize..ends[1] as usize {
                let (i, size) = (self.rows()[entry] as usize, self.values[entry].abs());
                sizes[i] += size * x[j];
                if i != j {
                    sizes[j] += size * x[i];
                }
            }
        }
    }

    pub(crate) fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// The lower triangle as faer sees it.
    pub(crate) fn lower(&self) -> SparseColMatRef<'_, u32, f64> {
        SparseColMatRef::new(self.pattern.columns.as_ref(), self.values())
    }
}

fn visit<F: AsRef<[usize]>, B: AsRef<[f64]>>(blocks: &[(F, B)], sink: &mut impl Sink) {
    for (freedoms, entries) in blocks {
        sink.add_symmetric(freedoms.as_ref(), entries.as_ref());
    }
}

/// `y += scale A x` for a symmetric A given by its lower triangle, diagonal first in each column.
/// Every symmetric product and every residual of this crate is summed here.
pub(crate) fn add_product(
    column_starts: &[u32],
    rows: &[u32],
    values: &[f64],
    scale: f64,
    x: &[f64],
    y: &mut [f64],
) {
    let y = &mut y[..x.len()];
    for (j, ends) in column_starts.windows(2).enumerate() {
        let column = ends[0] as usize..ends[1] as usize;
        let (rows, values) = (&rows[column.clone()], &values[column]);
        let Some((diagonal, below)) = values.split_first() else { continue };
        let scaled = scale * x[j];
        let mut above = 0.0;
        for (&i, value) in rows[1..].iter().zip(below) {
            y[i as usize] += value * scaled;
            above += value * x[i as usize];
        }
        y[j] += diagonal * scaled + scale * above;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DenseSink, FIXED, ProductSink, Scaled, StencilHessian};
    use proptest::prelude::*;

    /// Blocks as a list of freedoms and symmetric entries.
    type Blocks = Vec<(Vec<usize>, Vec<f64>)>;

    /// Up to 20 blocks of one to four freedoms among six, some of them fixed.
    fn any_blocks() -> impl Strategy<Value = Blocks> {
        let block = (1..5_usize, prop::collection::vec(-1.0..1.0, 16), any::<u64>()).prop_map(
            |(k, mut entries, seed)| {
                let mut freedoms: Vec<usize> = (0..6).chain([FIXED, FIXED]).collect();
                let len = freedoms.len();
                for i in 0..len {
                    freedoms.swap(i, (seed >> (3 * i)) as usize % len);
                }
                freedoms.truncate(k);
                entries.truncate(k * k);
                for b in 0..k {
                    for a in 0..b {
                        entries[a + k * b] = entries[b + k * a];
                    }
                }
                (freedoms, entries)
            },
        );
        prop::collection::vec(block, 0..20)
    }

    proptest! {
        #[test]
        fn the_sparse_matrix_is_the_dense_one(
            blocks in any_blocks(),
            weight in -2.0..2.0,
            x in prop::array::uniform6(-1.0..1.0),
        ) {
            let mut matrix = SymmetricMatrix::from_blocks(6, &blocks).unwrap();
            matrix.refill(|sink| visit(&blocks, sink.weighted(weight))).unwrap();
            let (mut dense, mut product, mut sparse) = ([0.0; 36], [0.0; 6], [0.0; 6]);
            visit(&blocks, &mut DenseSink::new(weight, 6, &mut dense).unwrap());
            visit(&blocks, &mut ProductSink::new(weight, &x, &mut product).unwrap());
            matrix.add_product(1.0, &x, &mut sparse).unwrap();
            let starts = matrix.column_starts();
            for j in 0..6 {
                for k in starts[j] as usize..starts[j + 1] as usize {
                    let i = matrix.rows()[k] as usize;
                    prop_assert!((dense[i + 6 * j] - matrix.values()[k]).abs() < 1e-13);
                    dense[i + 6 * j] = 0.0;
                    dense[j + 6 * i] = 0.0;
                }
                prop_assert!((product[j] - sparse[j]).abs() < 1e-13);
            }
            prop_assert!(dense.iter().all(|&entry| entry == 0.0));
        }
    }

    #[test]
    fn a_change_of_the_visit_is_an_error_that_names_the_block() {
        let blocks: Blocks = vec![
            (vec![0, 1], vec![2.0, -1.0, -1.0, 2.0]),
            (vec![2], vec![1.0]),
            (vec![1, 2], vec![2.0, -1.0, -1.0, 2.0]),
        ];
        let mut matrix = SymmetricMatrix::from_blocks(3, &blocks).unwrap();
        let values = matrix.values().to_vec();
        let mut changed = |blocks: Blocks| matrix.refill(|sink| visit(&blocks, sink)).unwrap_err();
        let block = |block| SparseError::PatternChanged { block };
        assert_eq!(changed(vec![blocks[1].clone(), blocks[0].clone()]), block(0));
        assert_eq!(
            changed(vec![blocks[0].clone(), blocks[2].clone(), blocks[1].clone()]),
            block(1)
        );
        assert_eq!(changed(blocks[..2].to_vec()), block(2));
        assert_eq!(changed([blocks.clone(), blocks[..1].to_vec()].concat()), block(3));
        assert_eq!(changed(vec![]), block(0));
        assert_eq!(changed(vec![blocks[0].clone(), (vec![], vec![])]), block(1));
        assert_eq!(changed(vec![(vec![0, 1], vec![2.0])]), block(0));
        matrix.refill(|sink| visit(&blocks, sink)).unwrap();
        assert_eq!(matrix.values(), values);
    }

    #[test]
    fn vertices_that_begin_at_the_recorded_places_and_go_on_elsewhere_are_a_change() {
        let block: StencilHessian<2, 2> = [[[[1.0; 2]; 2]; 2]; 2];
        let recorded = [[0, 1], [2, 3]];
        let mut matrix =
            SymmetricMatrix::analyse(4, |sink| sink.add_vertices(&recorded, &block)).unwrap();
        let mut refill = |freedoms| matrix.refill(|sink| sink.add_vertices(&freedoms, &block));
        assert_eq!(refill([[0, 3], [2, 1]]), Err(SparseError::PatternChanged { block: 0 }));
        assert_eq!(refill([[0, 1], [2, 1]]), Err(SparseError::PatternChanged { block: 0 }));
        assert_eq!(refill(recorded), Ok(()));
    }

    #[test]
    fn a_lower_triangle_is_added_where_its_whole_block_is() {
        // Vertices out of order; one held in part, one wholly; one whose freedoms are apart.
        let all =
            [[[4, 5], [0, 1], [2, 3]], [[2, 3], [FIXED, 6], [FIXED; 2]], [[2, 3], [7, 9], [4, 5]]];
        let entry = |i: usize, j: usize| (1 + i.min(j) + 7 * i.max(j)) as f64;
        let block: StencilHessian<3, 2> = std::array::from_fn(|b| {
            std::array::from_fn(|d| {
                std::array::from_fn(|a| std::array::from_fn(|c| entry(2 * a + c, 2 * b + d)))
            })
        });
        let column = |b: usize, d: usize, a: usize| {
            assert!(a >= b, "only the lower triangle is asked for");
            block[b][d][a]
        };
        let lower = |sink: &mut RefillSink| {
            all.iter().for_each(|freedoms| sink.add_lower(freedoms, column));
        };
        let whole = |sink: &mut RefillSink| {
            all.iter().for_each(|freedoms| sink.add_vertices(freedoms, &block));
        };
        let mut matrix = SymmetricMatrix::analyse(10, |sink| {
            all.iter().for_each(|freedoms| sink.add_lower(freedoms, column));
        })
        .unwrap();
        matrix.refill(|sink| whole(sink.weighted(-2.0))).unwrap();
        let expected = matrix.values().to_vec();
        assert!(expected.iter().any(|value| *value != 0.0));
        matrix.refill(|sink| lower(sink.weighted(-2.0))).unwrap();
        assert_eq!(matrix.values(), expected);
        let doubled = matrix.refill(|sink| {
            let mut scaled = Scaled::new(-2.0, sink);
            all.iter().for_each(|freedoms| scaled.add_lower(freedoms, column));
        });
        doubled.unwrap();
        assert_eq!(matrix.values(), expected);
    }

    #[test]
    fn the_diagonal_is_there_even_where_no_block_is() {
        let matrix = SymmetricMatrix::from_blocks(3, &[([1], [5.0])]).unwrap();
        assert_eq!(matrix.rows(), [0, 1, 2]);
        assert_eq!(matrix.values(), [0.0, 5.0, 0.0]);
        assert_eq!(matrix.diagonal(1), 5.0);
    }

    #[test]
    fn a_matrix_may_have_no_freedoms_at_all() {
        let none: [([usize; 1], [f64; 1]); 0] = [];
        let matrix = SymmetricMatrix::from_blocks(0, &none).unwrap();
        let mut cholesky = crate::SparseCholesky::analyse(&matrix).unwrap();
        cholesky.factor(&matrix).unwrap();
        cholesky.solve(&mut []);
        crate::SparseIndefinite::analyse(&matrix).unwrap();
    }

    #[test]
    fn vectors_of_another_length_are_refused() {
        let matrix = SymmetricMatrix::from_blocks(3, &[([0], [1.0])]).unwrap();
        let error = matrix.add_product(1.0, &[0.0; 2], &mut [0.0; 3]).unwrap_err();
        assert_eq!((error.expected, error.got), (3, 2));
    }
}
