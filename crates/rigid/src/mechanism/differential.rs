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
use crate::{Body, BodyMetric, BodySpace};

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
    let solved = least_norm(g, &DVector::zeros(g.nrows()), DEPENDENT)?;
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

/// The rows that no rows before them imply, to this part of their lengths, and an orthonormal basis of
/// their span: by Gram and Schmidt, twice.
pub(super) fn independent(a: &DMatrix<f64>, least: f64) -> (Vec<usize>, Vec<DVector<f64>>) {
    let (mut rows, mut basis) = (Vec::new(), Vec::<DVector<f64>>::new());
    for (number, row) in a.row_iter().enumerate() {
        let length = row.norm();
        let rest = beside(&basis, row.transpose());
        if length > 0.0 && rest.norm() > least * length {
            rows.push(number);
            basis.push(rest.normalize());
        }
    }
    (rows, basis)
}

/// An orthonormal basis of all that is normal to an orthonormal one, n numbers each.
pub(super) fn complement(mut basis: Vec<DVector<f64>>, n: usize) -> DMatrix<f64> {
    let span = basis.len();
    let mut left = DVector::repeat(n, 1.0);
    let take = |left: &mut DVector<f64>, unit: &DVector<f64>| {
        left.zip_apply(unit, |left, entry| *left -= entry * entry);
    };
    basis.iter().for_each(|unit| take(&mut left, unit));
    while basis.len() < n {
        let mut axis = DVector::zeros(n);
        axis[left.imax()] = 1.0;
        let unit = beside(&basis, axis).normalize();
        take(&mut left, &unit);
        basis.push(unit);
    }
    DMatrix::from_fn(n, n - span, |row, column| basis[span + column][row])
}

/// What of a vector is normal to an orthonormal basis.
fn beside(basis: &[DVector<f64>], mut rest: DVector<f64>) -> DVector<f64> {
    for _ in 0..2 {
        for unit in basis {
            let part = unit.dot(&rest);
            rest.axpy(-part, unit, 1.0);
        }
    }
    rest
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
