//! Constrained optimization: where a function stands still on a surface, and what it does there.
//!
//! ```text
//! df(q) = lambda^T dg(q),    g(q) = 0                                             (6.1, 6.2)
//!
//! [ d2(f - lambda g)  -J^T ] [ dq      ]     [ df - J^T lambda ]
//! [ -J                  0  ] [ dlambda ] = - [ -g              ]        Newton's method
//! ```
//! `f` a potential and `g` a constraint (m) on a flat space, `q` a configuration (n). The lower
//! block is -g, or the matrix would not be symmetric. A solution is a critical point of f on the
//! surface; the second differential of `f - lambda g` on the tangent space, `J w = 0`, says of
//! which kind. Source: notes 6.4; errata 6.2. For a few dozen freedoms: the matrix is full.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use stationary_calculus::{
    Covector, DenseSink, FunctionEquation, Newton, NewtonMemory, NewtonReport, Potential,
    SizeError, complement, first_non_finite, independent_rows, least_norm,
};

use crate::multipliers::DEPENDENT;
use crate::rows::{add_pulled_back, check_entries};
use crate::{Constraint, ConstraintError, Rows};

/// What an error calls the rows of the constraint.
const DIFFERENTIAL: &str = "differential";

/// What a function does on the surface about a critical point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// It grows in every direction.
    Minimum,
    /// It falls in every direction.
    Maximum,
    /// It grows in some and falls in others.
    Saddle,
    /// In some direction its second differential vanishes, to rounding: it decides nothing.
    /// Newton's method finds such a point only where it starts there; else its matrix is singular.
    Degenerate,
}

/// A critical point of a function on a surface.
#[derive(Clone, Debug, PartialEq)]
pub struct CriticalPoint {
    /// Where it is.
    pub q: Vec<f64>,
    /// Its multipliers, in the units of f over those of g.
    pub multipliers: Vec<f64>,
    /// What kind it is.
    pub kind: Kind,
    /// The eigenvalues of the second differential on the tangent space, ascending.
    pub curvatures: Vec<f64>,
    /// What Newton's method did.
    pub newton: NewtonReport,
}

/// Curvatures below this part of the Hessian's size are zero.
const FLAT: f64 = 1e-10;

/// Finds the critical point near `guess` of a function on the surface where a constraint vanishes,
/// at the time zero. Residuals are told in the size of df at the guess and in that of the equations' terms there.
///
/// # Errors
/// Sizes that differ, no critical point found, a constraint without full rank there.
pub fn critical_point(
    f: &impl Potential,
    constraint: &impl Constraint,
    guess: &[f64],
    newton: Newton,
) -> Result<CriticalPoint, ConstraintError> {
    let (n, m) = (f.dim(), constraint.count());
    SizeError::check("the guess's numbers", n, guess.len())?;
    check_entries(constraint, n, 0.0, guess)?;
    let mut x = guess.to_vec();
    let units = Units::new(f, constraint, guess)?;
    x.extend(units.scaled(multipliers(f, constraint, guess)?.as_slice()));
    let residual = |x: &[f64], r: &mut [f64]| {
        let (q, scaled) = x.split_at(n);
        let lambda = units.multipliers(scaled);
        let (above, below) = r.split_at_mut(n);
        above.fill(0.0);
        f.add_differential(q, Covector(&mut *above));
        let pulled = add_pulled_back(constraint, 0.0, q, -1.0, &lambda, Covector(&mut *above));
        above.iter_mut().for_each(|df| *df /= units.force);
        match pulled.and_then(|()| constraint.value(0.0, q, below)) {
            Ok(()) => below.iter_mut().zip(&units.rows).for_each(|(g, unit)| *g = -*g / unit),
            // Newton's method ends where it meets such numbers.
            Err(_) => below.fill(f64::NAN),
        }
    };
    let matrix = |x: &[f64], matrix: &mut [f64]| {
        let (q, scaled) = x.split_at(n);
        let curvature = curvature(f, constraint, q, &units.multipliers(scaled));
        let (Ok(curvature), Ok(mut j)) = (curvature, differential(constraint, q, n)) else {
            return matrix.fill(f64::NAN);
        };
        j.row_iter_mut().zip(&units.rows).for_each(|(mut row, unit)| row /= *unit);
        let mut matrix = nalgebra::DMatrixViewMut::from_slice(matrix, n + m, n + m);
        matrix.view_mut((0, 0), (n, n)).copy_from(&(curvature / units.force));
        matrix.view_mut((n, 0), (m, n)).copy_from(&-&j);
        matrix.view_mut((0, n), (n, m)).copy_from(&-j.transpose());
    };
    let mut equation = FunctionEquation::new(n + m, residual, matrix);
    let got = 0;
    let what = "the unknowns";
    let mut memory = NewtonMemory::<Vec<f64>>::new(n + m, newton.iterations).ok_or(SizeError {
        what,
        expected: n + m,
        got,
    })?;
    let report = newton.solve(&mut equation, &mut x, &mut memory)?;
    let multipliers = units.multipliers(&x.split_off(n));
    let curvatures = on_tangent_space(f, constraint, &x, &multipliers, &units.slopes)?;
    let size = curvature(f, constraint, &x, &multipliers)?.amax();
    let kind = kind(&curvatures, FLAT * size);
    Ok(CriticalPoint { q: x, multipliers, kind, curvatures, newton: report })
}

/// Units in which forces and equations are numbers of one size, so that neither hides the other: powers of two,
/// of what they are at the guess. Only of an equation that says nothing there they are those of its scale.
struct Units {
    force: f64,
    /// Of each equation, and of its differential.
    rows: Vec<f64>,
    slopes: Vec<f64>,
}

impl Units {
    fn new(
        f: &impl Potential,
        constraint: &impl Constraint,
        q: &[f64],
    ) -> Result<Self, ConstraintError> {
        let n = q.len();
        let mut df = vec![0.0; n];
        f.add_differential(q, Covector(&mut df));
        let mut size = largest(&df);
        if size == 0.0 {
            size = curvature(f, constraint, q, &vec![0.0; constraint.count()])?.amax();
        }
        let j = differential(constraint, q, n)?;
        let (mut rows, mut slopes) = (Vec::new(), Vec::new());
        for (row, entries) in j.row_iter().enumerate() {
            let scale = constraint.scale(row);
            let slope = [entries.norm(), scale.slope].into_iter().find(|x| x.is_normal());
            let slope = slope.unwrap_or(1.0);
            let terms: f64 = entries.iter().zip(q).map(|(dg, q)| (dg * q).abs()).sum();
            rows.push(power_of_two(if terms.is_normal() { terms } else { slope * scale.length }));
            slopes.push(power_of_two(slope));
        }
        Ok(Units { force: power_of_two(size), rows, slopes })
    }

    fn scaled(&self, lambda: &[f64]) -> Vec<f64> {
        lambda.iter().zip(&self.rows).map(|(lambda, unit)| lambda * unit / self.force).collect()
    }

    fn multipliers(&self, scaled: &[f64]) -> Vec<f64> {
        scaled.iter().zip(&self.rows).map(|(lambda, unit)| lambda * self.force / unit).collect()
    }
}

fn largest(numbers: &[f64]) -> f64 {
    numbers.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

pub(crate) fn power_of_two(size: f64) -> f64 {
    if size.is_normal() { 2.0_f64.powi(size.log2().round() as i32) } else { 1.0 }
}

/// The multipliers that come closest to `df = lambda^T dg`.
fn multipliers(
    f: &impl Potential,
    constraint: &impl Constraint,
    q: &[f64],
) -> Result<DVector<f64>, ConstraintError> {
    let n = q.len();
    let mut df = DVector::zeros(n);
    f.add_differential(q, Covector(df.as_mut_slice()));
    let j = differential(constraint, q, n)?;
    if let Some(index) = first_non_finite(df.as_slice()) {
        return Err(ConstraintError::NonFinite { what: "differential of the function", index });
    }
    let index = freedom_not_finite(&j);
    let closest = least_norm(&j.transpose(), &df, DEPENDENT);
    Ok(closest.map_err(|_| ConstraintError::NonFinite { what: DIFFERENTIAL, index })?.x)
}

/// The freedom of the first entry that is no number; the first where all are, and what is made of them overflows.
fn freedom_not_finite(j: &DMatrix<f64>) -> usize {
    first_non_finite(j.as_slice()).map_or(0, |entry| entry / j.nrows().max(1))
}

fn differential(
    constraint: &impl Constraint,
    q: &[f64],
    n: usize,
) -> Result<DMatrix<f64>, SizeError> {
    struct Full(DMatrix<f64>);
    impl Rows for Full {
        fn add(&mut self, row: usize, freedom: usize, value: f64) {
            self.0[(row, freedom)] += value;
        }
    }
    let mut full = Full(DMatrix::zeros(constraint.count(), n));
    constraint.differential(0.0, q, &mut full)?;
    Ok(full.0)
}

/// The second differential of `f - lambda g`.
fn curvature(
    f: &impl Potential,
    constraint: &impl Constraint,
    q: &[f64],
    lambda: &[f64],
) -> Result<DMatrix<f64>, SizeError> {
    let n = q.len();
    let mut matrix = DMatrix::zeros(n, n);
    if let Some(mut sink) = DenseSink::new(1.0, n, matrix.as_mut_slice()) {
        f.add_hessian(q, &mut sink);
    }
    if let Some(mut sink) = DenseSink::new(-1.0, n, matrix.as_mut_slice()) {
        constraint.add_hessian(0.0, q, lambda, &mut sink)?;
    }
    Ok(matrix)
}

/// The eigenvalues of the second differential on the tangent space, ascending. An equation whose differential has
/// all but vanished beside `slopes`, what it was at the guess, or that depends on others, is an error.
fn on_tangent_space(
    f: &impl Potential,
    constraint: &impl Constraint,
    q: &[f64],
    lambda: &[f64],
    slopes: &[f64],
) -> Result<Vec<f64>, ConstraintError> {
    let (n, m) = (q.len(), constraint.count());
    let mut j = differential(constraint, q, n)?;
    j.row_iter_mut().zip(slopes).for_each(|(mut entries, slope)| entries /= *slope);
    let spectrum = least_norm(&j, &DVector::zeros(m), 0.0).map(|solution| solution.singular_values);
    let index = freedom_not_finite(&j);
    let sigma = spectrum.map_err(|_| ConstraintError::NonFinite { what: DIFFERENTIAL, index })?;
    let ratio =
        if m > n { 0.0 } else { sigma.iter().next_back().map_or(1.0, |s| s / sigma[0].max(1.0)) };
    if ratio < DEPENDENT || ratio.is_nan() {
        let shortest = |a: &usize, b: &usize| j.row(*a).norm().total_cmp(&j.row(*b).norm());
        return Err(ConstraintError::Singular { ratio, row: (0..m).min_by(shortest).unwrap_or(0) });
    }
    if m == n {
        // A point by itself.
        return Ok(Vec::new());
    }
    let (_, normal) = independent_rows(&j, 0.0);
    let tangent = complement(normal, n);
    let curvature = curvature(f, constraint, q, lambda)?;
    if let Some(index) = first_non_finite(curvature.as_slice()) {
        return Err(ConstraintError::NonFinite { what: "second differential", index });
    }
    let form = tangent.transpose() * curvature * &tangent;
    let mut curvatures: Vec<f64> = SymmetricEigen::new(form).eigenvalues.iter().copied().collect();
    curvatures.sort_by(f64::total_cmp);
    Ok(curvatures)
}

fn kind(curvatures: &[f64], flat: f64) -> Kind {
    let up = curvatures.iter().filter(|&&c| c > flat).count();
    let down = curvatures.iter().filter(|&&c| c < -flat).count();
    match (up, down) {
        _ if up + down < curvatures.len() => Kind::Degenerate,
        (_, 0) => Kind::Minimum,
        (0, _) => Kind::Maximum,
        _ => Kind::Saddle,
    }
}

#[cfg(test)]
mod tests;
