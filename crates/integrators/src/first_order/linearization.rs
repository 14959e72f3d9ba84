//! What implicit methods know of a field near a moment: its Jacobian, and the mass matrix.
//!
//! ```text
//! J_ij = (f_i(y + d e_j) - f_i(y)) / d,      d = sqrt(eps) max(|y_j|, absolute_j / relative)
//! ```
//! Differences are taken where the field does not know its Jacobian: in proportion to the
//! component, or to the size below which the tolerance calls it zero, and to the side to which it
//! is moving, so that a component that must not become negative does not.
//!
//! An implicit step solves with `M - c J`, `c` in proportion to the step. As c grows from zero, the
//! determinant changes its sign where `c lambda = 1` for a real rate of growth lambda, det(lambda M -
//! J) = 0: beyond that the step lets the motion decay that grows. Where that motion begins below the
//! tolerance no error estimate sees it. Source: Lindberg, BIT 14 (1974) 430-436.

use stationary_calculus::{SizeError, Storage};

use super::error_scale::ErrorScale;
use super::lu::Lu;
use super::{AdaptiveError, Jacobian, Moment, VectorField, Work};
use crate::integrator::zeros;

/// A Jacobian and the moment at which it was taken.
#[derive(Clone, Debug)]
pub(crate) struct Linearization<C> {
    pub(crate) at: Moment<C>,
    pub(crate) matrix: Vec<f64>,
    /// Rates of growth below this may be rounding of the matrix.
    rounding: f64,
    /// Whether det(M - c J) is negative for small c, where it has a sign.
    negative: Option<bool>,
    /// For a mass matrix, whose determinant has a sign, or is zero.
    small: Option<Lu<f64>>,
    moved: C,
    f: C,
}

impl<C: Storage> Linearization<C> {
    pub(crate) fn new<F: VectorField>(field: &F) -> Result<Self, SizeError> {
        let n = field.dim();
        let zero: C = zeros(n)?;
        Ok(Linearization {
            at: Moment::new(0.0, zero.clone()),
            matrix: vec![0.0; n * n],
            rounding: 0.0,
            negative: Some(false),
            small: field.mass().map(|_| Lu::new(n)),
            moved: zero.clone(),
            f: zero,
        })
    }

    /// The Jacobian at (t, y).
    pub(crate) fn take<F: VectorField>(
        &mut self,
        field: &F,
        scale: &ErrorScale<C>,
        (t, y): (f64, &C),
        work: &mut Work,
    ) {
        self.at.t = t;
        self.at.y.clone_from(y);
        self.renew(field, scale, work);
    }

    /// The Jacobian at the moment that is there.
    pub(crate) fn renew<F: VectorField>(
        &mut self,
        field: &F,
        scale: &ErrorScale<C>,
        work: &mut Work,
    ) {
        let Moment { t, y } = &self.at;
        work.jacobians += 1;
        let mut relative = f64::EPSILON;
        if field.jacobian(*t, y.as_ref(), &mut self.matrix) == Jacobian::Unknown {
            work.evaluations += 1 + y.as_ref().len() as u64;
            self.take_differences(field, scale);
            relative = f64::EPSILON.sqrt();
        }
        self.rounding = relative * size(&self.matrix);
        if let (Some(mass), Some(lu)) = (field.mass(), &mut self.small) {
            let matrix = &self.matrix;
            let (absolute, y) = (scale.absolute.as_ref(), self.at.y.as_ref());
            let unit = |j: usize| absolute[j] + scale.relative * y[j].abs();
            let fastest = fastest(mass, matrix, (y.len(), unit));
            self.rounding = relative * fastest;
            let c = if fastest > 0.0 { SMALL / fastest } else { 1.0 };
            pencil(field, matrix, lu.matrix(), |m, j| m - c * j);
            work.factorizations += 1;
            self.negative = lu.factor().is_ok().then(|| lu.is_negative());
        }
    }

    /// Whether an odd number of motions grow faster than 1/c, by the factors of `M - c J` or of a
    /// positive multiple of it. An implicit step of such a `c` lets them decay, or change sign.
    pub(crate) fn is_outgrown(&self, c: f64, factors: &Lu<f64>) -> bool {
        c * self.rounding < 1.0 && self.negative.is_some_and(|sign| sign != factors.is_negative())
    }

    /// Turns f into y', `(M - c J)^-1 f` with a small c: of what has no mass the rate that keeps its equations, as if
    /// they held, because c divides their rounding. Without a mass matrix, and where there are no factors, f stays.
    pub(crate) fn solve_for_rate<F: VectorField>(&self, field: &F, f: &mut [f64]) {
        if let (Some(mass), Some(lu), Some(_)) = (field.mass(), &self.small, self.negative) {
            let n = f.len();
            let massless = |i: usize| mass.iter().skip(i).step_by(n).all(|entry| *entry == 0.0);
            f.iter_mut().enumerate().filter(|(i, _)| massless(*i)).for_each(|(_, f)| *f = 0.0);
            lu.solve(f);
        }
    }

    fn take_differences<F: VectorField>(&mut self, field: &F, scale: &ErrorScale<C>) {
        let Linearization { at: Moment { t, y }, matrix, moved, f, .. } = self;
        let n = y.as_ref().len();
        field.evaluate(*t, y.as_ref(), f.as_mut());
        moved.clone_from(y);
        for (j, column) in matrix.chunks_exact_mut(n.max(1)).enumerate() {
            let (y, moved) = (y.as_ref()[j], moved.as_mut());
            let size = y.abs().max(scale.absolute.as_ref()[j] / scale.relative);
            moved[j] = y + (f64::EPSILON.sqrt() * size).copysign(f.as_ref()[j]);
            // What was added after rounding, which is not what was meant to be.
            let d = moved[j] - y;
            field.evaluate(*t, moved, column);
            moved[j] = y;
            for (entry, f) in column.iter_mut().zip(f.as_ref()) {
                *entry = (*entry - f) / d;
            }
        }
    }
}

/// c in parts of the shortest `|M_i| / |J_i|` where `M - c J` stands for all smaller ones.
const SMALL: f64 = 1e-10;

/// The largest `|J_i| / |M_i|` of the rows i that have a mass: each has a unit of its own, and each of the n
/// unknowns that of what is tolerated of it.
fn fastest(mass: &[f64], jacobian: &[f64], (n, unit): (usize, impl Fn(usize) -> f64)) -> f64 {
    let row = |matrix: &[f64], i: usize| {
        let entries = matrix.iter().skip(i).step_by(n).enumerate();
        entries.map(|(j, entry)| (entry * unit(j)).abs()).sum::<f64>()
    };
    let rates = (0..n).map(|i| (row(mass, i), row(jacobian, i))).filter(|(m, _)| *m > 0.0);
    rates.map(|(m, j)| j / m).fold(0.0, f64::max)
}

/// The root of the sum of squares.
fn size(matrix: &[f64]) -> f64 {
    matrix.iter().map(|entry| entry * entry).sum::<f64>().sqrt()
}

/// An error unless the mass matrix has n x n finite entries.
pub(crate) fn check_mass<F: VectorField>(field: &F) -> Result<(), AdaptiveError> {
    let Some(mass) = field.mass() else { return Ok(()) };
    SizeError::check("the mass matrix's entries", field.dim() * field.dim(), mass.len())?;
    super::method::check_finite("the mass matrix", 0.0, mass)
}

/// Writes M x.
pub(crate) fn mass_times<F: VectorField>(field: &F, x: &[f64], product: &mut [f64]) {
    let Some(mass) = field.mass() else { return product.copy_from_slice(x) };
    product.fill(0.0);
    for (column, x) in mass.chunks_exact(x.len().max(1)).zip(x) {
        for (product, entry) in product.iter_mut().zip(column) {
            *product += entry * x;
        }
    }
}

/// Writes a M + b J, entry by entry, as `write(entry of M, entry of J)`.
pub(crate) fn pencil<F: VectorField, T>(
    field: &F,
    jacobian: &[f64],
    matrix: &mut [T],
    write: impl Fn(f64, f64) -> T,
) {
    let diagonal = field.dim() + 1;
    match field.mass() {
        Some(mass) => {
            for ((entry, m), j) in matrix.iter_mut().zip(mass).zip(jacobian) {
                *entry = write(*m, *j);
            }
        }
        None => {
            for (i, (entry, j)) in matrix.iter_mut().zip(jacobian).enumerate() {
                *entry = write(if i % diagonal == 0 { 1.0 } else { 0.0 }, *j);
            }
        }
    }
}
