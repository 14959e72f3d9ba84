//! The differential of a mechanism's equations as a full matrix, in scales that make its rank plain.
//!
//! ```text
//! A = D J M^-1/2,     D = 1/slope
//! ```

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use stationary_calculus::{DenseSink, Metric, least_norm};
use stationary_constraints::{Constraint, Rows};

use super::MechanismError;

/// Singular values below this part of the largest are zero.
pub(super) const DEPENDENT: f64 = 1e-9;
/// Between this and [`DEPENDENT`] none may lie.
pub(super) const CLEAR: f64 = 1e-7;

struct Full<'a>(&'a mut DMatrix<f64>);

impl Rows for Full<'_> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.0[(row, freedom)] += value;
    }
}

/// J at a time and a configuration, m x n.
pub(super) fn full(
    constraint: &impl Constraint,
    n: usize,
    t: f64,
    q: &[f64],
) -> Result<DMatrix<f64>, MechanismError> {
    let mut j = DMatrix::zeros(constraint.count(), n);
    constraint.differential(t, q, &mut Full(&mut j))?;
    super::error::check_finite("the differential", j.as_slice())?;
    Ok(j)
}

/// M^-1/2 of a metric.
pub(super) fn inverse_root(metric: &impl Metric) -> DMatrix<f64> {
    let n = metric.dim();
    let mut matrix = vec![0.0; n * n];
    if let Some(mut sink) = DenseSink::new(1.0, n, &mut matrix) {
        metric.add_matrix(&mut sink);
    }
    let eigen = SymmetricEigen::new(DMatrix::from_vec(n, n, matrix));
    let scaled = DMatrix::from_diagonal(&eigen.eigenvalues.map(|mass| mass.powf(-0.5)));
    &eigen.eigenvectors * scaled * eigen.eigenvectors.transpose()
}

/// 1/slope of each equation.
pub(super) fn weights(constraint: &impl Constraint) -> DVector<f64> {
    let count = constraint.count();
    DVector::from_fn(count, |row, _| constraint.scale(row).slope.recip())
}

/// The rank of a matrix, where it is plain.
pub(super) fn rank(a: &DMatrix<f64>) -> Result<usize, MechanismError> {
    if a.is_empty() {
        return Ok(0);
    }
    let solved = least_norm(a, &DVector::zeros(a.nrows()), DEPENDENT)?;
    let values = &solved.singular_values;
    let largest = values.get(0).copied().unwrap_or(0.0);
    let last = solved.rank.checked_sub(1).and_then(|k| values.get(k));
    let (above, below) = (last.copied().unwrap_or(0.0), values.get(solved.rank).copied());
    if largest > 0.0 && above < CLEAR * largest {
        let below = below.unwrap_or(0.0) / largest;
        return Err(MechanismError::RankUnclear { above: above / largest, below });
    }
    Ok(solved.rank)
}
