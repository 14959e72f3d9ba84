//! Elimination of a symmetric matrix as if it were none, with exchanges of any rows.
//!
//! ```text
//! P A Q = L U
//! ```
//! Breaks down on singular matrices only, but fills more and knows nothing of the symmetry.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};

use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::lu::SparseLu;

/// Both triangles of a symmetric matrix, and their factors.
#[derive(Clone, Debug)]
pub(super) struct RowPivoting {
    columns: SymbolicSparseColMat<u32>,
    values: Vec<f64>,
    /// Where each entry comes from in the lower triangle.
    sources: Vec<u32>,
    lu: SparseLu,
}

impl RowPivoting {
    pub(super) fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        let (n, lower_starts) = (matrix.dim(), matrix.column_starts());
        let mut entries = Vec::with_capacity(2 * matrix.rows().len());
        for j in 0..n as u32 {
            let column = lower_starts[j as usize]..lower_starts[j as usize + 1];
            for source in column {
                let i = matrix.rows()[source as usize];
                entries.push((j, i, source));
                if i != j {
                    entries.push((i, j, source));
                }
            }
        }
        entries.sort_unstable();
        let mut starts = vec![0_u32; n + 1];
        for &(column, ..) in &entries {
            starts[column as usize + 1] += 1;
        }
        for j in 0..n {
            starts[j + 1] += starts[j];
        }
        let rows = entries.iter().map(|&(_, row, _)| row).collect();
        let columns = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        Ok(RowPivoting {
            lu: SparseLu::analyse(columns.as_ref())?,
            columns,
            values: vec![0.0; entries.len()],
            sources: entries.iter().map(|&(.., source)| source).collect(),
        })
    }

    pub(super) fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SparseError> {
        for (value, &source) in self.values.iter_mut().zip(&self.sources) {
            *value = matrix.values()[source as usize];
        }
        self.lu.factor(SparseColMatRef::new(self.columns.as_ref(), &self.values))
    }

    pub(super) fn solve(&mut self, b: &mut [f64]) {
        self.lu.solve(b);
    }
}
