//! Multipliers of many equations under any metric: the saddle system, never the inverse of the
//! mass.
//!
//! ```text
//! [ M  J^T ] [  x ]   [ 0 ]
//! [ J   0  ] [ -l ] = [ b ]        l = (J M^-1 J^T)^-1 b
//! ```
//! `M` the metric's matrix (n x n), sparse with entries off its diagonal; `J` m x n. The matrix is
//! symmetric and indefinite; its pattern is analysed once, and each solution is refined and refused
//! if its residual is too large. A matrix that is singular to working precision is the error for
//! equations that depend on each other; redundant equations are refused.
//! Source: errata conventions; `SparseIndefinite` of calculus, with the traps that it avoids.

use stationary_calculus::{
    Covector, Metric, Sink, SparseError, SparseIndefinite, SymmetricMatrix, Vector,
};

use crate::entries::Entries;
use crate::{Constraint, ConstraintError, Multipliers, Solver};

/// The choice of [`SaddleMultipliers`]: many equations, a metric that couples freedoms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Coupled;

/// Multipliers of many equations, from the saddle system.
#[derive(Clone, Debug)]
pub struct SaddleMultipliers {
    freedoms: usize,
    count: usize,
    entries: Entries,
    matrix: SymmetricMatrix,
    solver: SparseIndefinite,
    right: Vec<f64>,
}

/// Brings the blocks of the saddle matrix.
fn visit(metric: &impl Metric, entries: &Entries, n: usize, sink: &mut impl Sink) {
    metric.add_matrix(sink);
    for (&(row, freedom), &value) in entries.places.iter().zip(&entries.values) {
        sink.add_symmetric(&[freedom as usize, n + row as usize], &[0.0, value, value, 0.0]);
    }
}

impl<C> Solver<C> for Coupled {
    type Multipliers = SaddleMultipliers;

    fn analyse<M: Metric, K: Constraint>(
        &self,
        metric: &M,
        constraint: &K,
        t: f64,
        q: &[f64],
    ) -> Result<SaddleMultipliers, ConstraintError> {
        let (n, count) = (metric.dim(), constraint.count());
        let entries = Entries::find(constraint, t, q)?;
        let matrix = SymmetricMatrix::analyse(n + count, |sink| visit(metric, &entries, n, sink))?;
        Ok(SaddleMultipliers {
            freedoms: n,
            count,
            entries,
            solver: SparseIndefinite::analyse(&matrix)?,
            matrix,
            right: vec![0.0; n + count],
        })
    }
}

impl Multipliers for SaddleMultipliers {
    type Numbers = Vec<f64>;

    fn numbers(&self) -> Vec<f64> {
        vec![0.0; self.count]
    }

    fn prepare(
        &mut self,
        metric: &impl Metric,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.entries.write(constraint, t, q)?;
        let SaddleMultipliers { entries, matrix, freedoms, .. } = self;
        matrix.refill(|sink| visit(metric, entries, *freedoms, sink))?;
        match self.solver.factor(&self.matrix) {
            Ok(_) => Ok(()),
            Err(SparseError::Singular) => Err(ConstraintError::Dependent { row: None }),
            Err(other) => Err(other.into()),
        }
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), ConstraintError> {
        let (above, below) = self.right.split_at_mut(self.freedoms);
        above.fill(0.0);
        below.copy_from_slice(b);
        self.solver.solve(&self.matrix, &mut self.right)?;
        for (b, l) in b.iter_mut().zip(&self.right[self.freedoms..]) {
            *b = -l;
        }
        Ok(())
    }

    fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>) {
        self.entries.add_pulled_back(scale, lambda, p);
    }

    fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        self.entries.add_along(v, rates);
    }
}
