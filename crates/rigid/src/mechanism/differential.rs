//! The differential of a mechanism's equations as a full matrix, in two scales.
//!
//! ```text
//! G = D J L           how many equations are independent, and which: no mass is in it
//! B = R J M^-1/2      what they leave free, and what they push: rows of length 1
//! D = 1/slope,     L = 1 and 1/sqrt(I/m),     R = 1/(length of the row)
//! ```
//! Bodies 1e9 times lighter than others make rows of `J M^-1/2` that are 3e4 times longer; no rank is
//! read off those.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{SizeError, least_norm};
use stationary_constraints::{Constraint, Rows};

use super::MechanismError;
use super::error::check_finite;
use crate::{Body, BodyMetric, BodySpace};

/// Singular values below this part of the largest are zero.
pub(super) const DEPENDENT: f64 = 1e-9;
/// Between this and [`DEPENDENT`] none may lie.
pub(super) const CLEAR: f64 = 1e-7;

/// A matrix of rows, and the freedoms that they ask for.
struct Full {
    matrix: DMatrix<f64>,
    asked: usize,
}

impl Rows for Full {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.asked = self.asked.max(freedom + 1);
        if let Some(entry) = self.matrix.get_mut((row, freedom)) {
            *entry += value;
        }
    }
}

/// J at a time and a configuration, m x n.
pub(super) fn full(
    constraint: &impl Constraint,
    n: usize,
    t: f64,
    q: &[f64],
) -> Result<DMatrix<f64>, MechanismError> {
    check_finite("the configuration", q)?;
    let mut full = Full { matrix: DMatrix::zeros(constraint.count(), n), asked: 0 };
    constraint.differential(t, q, &mut full)?;
    if full.asked > n {
        SizeError::check("the metric's freedoms", full.asked, n)?;
    }
    check_finite("the differential", full.matrix.as_slice())?;
    Ok(full.matrix)
}

/// 1/slope of each equation.
pub(super) fn weights(constraint: &impl Constraint) -> DVector<f64> {
    let count = constraint.count();
    DVector::from_fn(count, |row, _| constraint.scale(row).slope.recip())
}

/// G of a differential.
pub(super) fn geometric<S: BodySpace>(
    metric: &BodyMetric<S>,
    constraint: &impl Constraint,
    mut j: DMatrix<f64>,
) -> Result<DMatrix<f64>, SizeError> {
    scale(&mut j, &weights(constraint), &lengths(metric))?;
    Ok(j)
}

/// L, freedom by freedom: rotations as metres at the radius of gyration.
pub(super) fn lengths<S: BodySpace>(metric: &BodyMetric<S>) -> DVector<f64> {
    per_freedom(metric, |body| {
        let gyration = (body.moments().max() / body.mass()).sqrt();
        (1.0, [gyration.recip(); 3])
    })
}

/// The square roots of 1/m and 1/I, freedom by freedom.
pub(super) fn inverse_roots<S: BodySpace>(metric: &BodyMetric<S>) -> DVector<f64> {
    per_freedom(metric, |body| {
        (body.mass().sqrt().recip(), body.moments().map(|moment| moment.sqrt().recip()).into())
    })
}

fn per_freedom<S: BodySpace>(
    metric: &BodyMetric<S>,
    of: impl Fn(&Body) -> (f64, [f64; 3]),
) -> DVector<f64> {
    let numbers = metric.bodies().iter().flat_map(|body| {
        let (translation, rotation) = of(body);
        [translation; 3].into_iter().take(S::TRANSLATION).chain(rotation)
    });
    DVector::from_vec(numbers.collect())
}

/// Rows and columns times their scales.
pub(super) fn scale(
    a: &mut DMatrix<f64>,
    rows: &DVector<f64>,
    columns: &DVector<f64>,
) -> Result<(), SizeError> {
    SizeError::check("the metric's freedoms", a.ncols(), columns.len())?;
    for (mut column, scale) in a.column_iter_mut().zip(columns) {
        column *= *scale;
        column.component_mul_assign(rows);
    }
    Ok(())
}

/// The rank of G, where it is plain.
pub(super) fn rank(g: &DMatrix<f64>) -> Result<usize, MechanismError> {
    if g.is_empty() {
        return Ok(0);
    }
    let mut g = g.clone();
    // Metres and radians alike.
    g.row_iter_mut().for_each(|mut row| row /= row.norm().max(f64::MIN_POSITIVE));
    let solved = least_norm(&g, &DVector::zeros(g.nrows()), DEPENDENT)?;
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

/// Equations that are independent, in the metric of the masses.
pub(super) struct Held {
    /// Which of all they are.
    pub(super) rows: Vec<usize>,
    /// B, a row each.
    pub(super) b: DMatrix<f64>,
    /// R, a number each.
    pub(super) scales: DVector<f64>,
}

impl Held {
    /// Those rows of J among joined bodies.
    pub(super) fn new(
        j: &DMatrix<f64>,
        rows: Vec<usize>,
        roots: &DVector<f64>,
    ) -> Result<Self, SizeError> {
        let mut b = j.select_rows(&rows);
        scale(&mut b, &DVector::repeat(rows.len(), 1.0), roots)?;
        let scales = DVector::from_iterator(b.nrows(), b.row_iter().map(|row| row.norm().recip()));
        scale(&mut b, &scales, &DVector::repeat(roots.len(), 1.0))?;
        Ok(Held { rows, b, scales })
    }

    /// The multipliers `lambda` of all `count` equations with `B^T R^-1 lambda = z`, zero for those that are implied.
    pub(super) fn multipliers(
        &self,
        z: &DVector<f64>,
        count: usize,
    ) -> Result<DVector<f64>, MechanismError> {
        let mut lambda = DVector::zeros(count);
        if !self.rows.is_empty() {
            let y = least_norm(&self.b.transpose(), z, 0.0)?.x.component_mul(&self.scales);
            self.rows.iter().zip(&y).for_each(|(row, y)| lambda[*row] = *y);
        }
        Ok(lambda)
    }
}
