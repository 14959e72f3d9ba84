//! The Galerkin mass: a sparse metric, which couples the freedoms of neighbours.
//!
//! ```text
//! M_ab = integral of rho phi_a phi_b         kg
//! p = M v,    v = M^-1 p
//! ```
//! `M` a constant [`SymmetricMatrix`] (n x n), factored once by Cholesky's method; `rho` the density,
//! `phi` the shape functions. Lumping its rows gives a diagonal metric, which needs no factor.
//! Source: notes 13.2. Knows nothing of elements: it takes the blocks that they make.

use std::sync::{Mutex, PoisonError};

use crate::sparse::{SparseCholesky, SparseError, SymmetricMatrix};
use crate::{Covector, Metric, Sink, Vector};

/// A constant sparse positive definite mass matrix.
#[derive(Debug)]
pub struct SparseMetric {
    matrix: SymmetricMatrix,
    /// Solving works in the factor's own memory: one solve at a time.
    factor: Mutex<SparseCholesky>,
}

impl SparseMetric {
    /// Factors a mass matrix; an error that names the freedom if it is not positive definite.
    pub fn new(matrix: SymmetricMatrix) -> Result<Self, SparseError> {
        let mut factor = SparseCholesky::analyse(&matrix)?;
        factor.factor(&matrix)?;
        Ok(SparseMetric { matrix, factor: Mutex::new(factor) })
    }

    /// The mass matrix.
    pub fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }
}

impl Clone for SparseMetric {
    fn clone(&self) -> Self {
        let factor = self.factor.lock().unwrap_or_else(PoisonError::into_inner).clone();
        SparseMetric { matrix: self.matrix.clone(), factor: Mutex::new(factor) }
    }
}

impl Metric for SparseMetric {
    fn dim(&self) -> usize {
        self.matrix.dim()
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        p.0.fill(0.0);
        self.matrix.add_product_unchecked(1.0, v.0, p.0);
    }

    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        v.0.copy_from_slice(p.0);
        self.factor.lock().unwrap_or_else(PoisonError::into_inner).solve(v.0);
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        for (j, ends) in self.matrix.column_starts().windows(2).enumerate() {
            for k in ends[0] as usize..ends[1] as usize {
                let (i, entry) = (self.matrix.rows()[k] as usize, self.matrix.values()[k]);
                if i == j {
                    sink.add_symmetric(&[j], &[entry]);
                } else {
                    sink.add_symmetric(&[j, i], &[0.0, entry, entry, 0.0]);
                }
            }
        }
    }
}
