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
    SizeError, least_norm,
};

use crate::multipliers::DEPENDENT;
use crate::rows::{add_pulled_back, check_entries};
use crate::{Constraint, ConstraintError, Rows};

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
    /// Newton.s method finds such a point only where it starts there; else its matrix is singular.
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
/// at the time zero.
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
    x.extend(multipliers(f, constraint, guess)?.iter());
    let residual = |x: &[f64], r: &mut [f64]| {
        let (q, lambda) = x.split_at(n);
        let (above, below) = r.split_at_mut(n);
        above.fill(0.0);
        f.add_differential(q, Covector(&mut *above));
        let pulled = add_pulled_back(constraint, 0.0, q, -1.0, lambda, Covector(above));
        match pulled.and_then(|()| constraint.value(0.0, q, below)) {
            Ok(()) => below.iter_mut().for_each(|g| *g = -*g),
            // Newton's method ends where it meets such numbers.
            Err(_) => below.fill(f64::NAN),
        }
    };
    let matrix = |x: &[f64], matrix: &mut [f64]| {
        let (q, lambda) = x.split_at(n);
        let curvature = curvature(f, constraint, q, lambda);
        let (Ok(curvature), Ok(j)) = (curvature, differential(constraint, q, n)) else {
            return matrix.fill(f64::NAN);
        };
        let mut matrix = nalgebra::DMatrixViewMut::from_slice(matrix, n + m, n + m);
        matrix.view_mut((0, 0), (n, n)).copy_from(&curvature);
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
    let multipliers = x.split_off(n);
    let curvatures = on_tangent_space(f, constraint, &x, &multipliers)?;
    let size = curvature(f, constraint, &x, &multipliers)?.amax();
    let kind = kind(&curvatures, FLAT * size);
    Ok(CriticalPoint { q: x, multipliers, kind, curvatures, newton: report })
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
    let closest = least_norm(&j.transpose(), &df, DEPENDENT);
    let what = "differential";
    Ok(closest.map_err(|_| ConstraintError::NonFinite { what, index: 0 })?.x)
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

/// The eigenvalues of the second differential on the tangent space, ascending.
fn on_tangent_space(
    f: &impl Potential,
    constraint: &impl Constraint,
    q: &[f64],
    lambda: &[f64],
) -> Result<Vec<f64>, ConstraintError> {
    let (n, m) = (q.len(), constraint.count());
    let mut j = differential(constraint, q, n)?;
    for (row, mut entries) in j.row_iter_mut().enumerate() {
        entries /= constraint.scale(row).slope;
    }
    let spectrum = least_norm(&j, &DVector::zeros(m), 0.0).map(|solution| solution.singular_values);
    let what = "differential";
    let sigma = spectrum.map_err(|_| ConstraintError::NonFinite { what, index: 0 })?;
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
    // The n - m smallest eigenvalues of J^T J are zero, and their vectors span the tangent space.
    let normal = SymmetricEigen::new(j.transpose() * &j);
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&a, &b| normal.eigenvalues[a].total_cmp(&normal.eigenvalues[b]));
    let tangent = normal.eigenvectors.select_columns(&order[..n - m]);
    let form = tangent.transpose() * curvature(f, constraint, q, lambda)? * &tangent;
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
mod tests {
    use super::*;
    use crate::{Level, LevelSet, Linear};
    use stationary_calculus::{Automatic, Energy, Number};

    /// f = x^2 + 2 y^2 + 3 z^2, whose critical points on the unit sphere are the six poles.
    struct Ellipsoid;

    impl Energy<3> for Ellipsoid {
        fn energy<R: Number>(&self, [x, y, z]: [R; 3]) -> R {
            x * x + y * y * 2.0 + z * z * 3.0
        }
    }

    #[derive(Clone, Debug)]
    struct Sphere;

    impl Level<3> for Sphere {
        fn value<R: Number>(&self, _: R, [x, y, z]: [R; 3]) -> R {
            x * x + y * y + z * z - 1.0
        }
    }

    #[test]
    fn the_poles_of_a_sphere_are_a_minimum_a_saddle_and_a_maximum() {
        let sphere = LevelSet::new(0, Sphere);
        let kinds = [Kind::Minimum, Kind::Saddle, Kind::Maximum];
        for (axis, kind) in kinds.into_iter().enumerate() {
            let mut guess = [0.1, -0.15, 0.12];
            guess[axis] = 1.1;
            let point =
                critical_point(&Automatic(Ellipsoid), &sphere, &guess, Newton::default()).unwrap();
            assert_eq!(point.kind, kind, "{point:?}");
            // df = lambda dg: the multiplier is the coefficient of the axis.
            assert!((point.multipliers[0] - (axis + 1) as f64).abs() < 1e-13);
            assert!((point.q[axis] - 1.0).abs() < 1e-13);
            // On the tangent space d2f - lambda d2g is 2 (c_j - c_axis).
            let mut expected: Vec<f64> =
                (0..3).filter(|&j| j != axis).map(|j| 2.0 * (j as f64 - axis as f64)).collect();
            expected.sort_by(f64::total_cmp);
            assert!(point.curvatures.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12));
        }
    }

    /// f = x^4 + y.
    struct Flat;

    impl Energy<2> for Flat {
        fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
            x.powi(4) + y
        }
    }

    #[test]
    fn a_flat_direction_is_called_degenerate() {
        let line = Linear::new(vec![(vec![(1, 1.0)], 0.0)]).unwrap();
        let point =
            critical_point(&Automatic(Flat), &line, &[0.0, 0.0], Newton::default()).unwrap();
        assert_eq!(point.kind, Kind::Degenerate);
        assert!((point.multipliers[0] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn a_point_that_equations_leave_alone_is_a_minimum_without_curvatures() {
        let corner = Linear::new(vec![(vec![(0, 1.0)], -2.0), (vec![(1, 3.0)], 1.0)]).unwrap();
        let point = critical_point(&Automatic(Flat), &corner, &[0.4, 0.1], Newton::default());
        let point = point.unwrap();
        assert_eq!((point.kind, point.curvatures.len()), (Kind::Minimum, 0));
    }

    #[test]
    fn equations_that_depend_on_each_other_are_an_error() {
        let twice = Linear::new(vec![(vec![(1, 1.0)], 0.0), (vec![(1, 2.0)], 0.0)]).unwrap();
        let error = critical_point(&Automatic(Flat), &twice, &[0.0, 0.0], Newton::default());
        let error = error.unwrap_err();
        let named = matches!(error, ConstraintError::Singular { .. })
            || matches!(error, ConstraintError::CriticalPoint(_));
        assert!(named, "{error}");
    }

    /// The line x (1 + t) + y = 1, which turns.
    #[derive(Clone, Debug)]
    struct Turning;

    impl Level<2> for Turning {
        fn value<R: Number>(&self, t: R, [x, y]: [R; 2]) -> R {
            x * (t + 1.0) + y - 1.0
        }
    }

    /// f = x^2 + y^2.
    struct Square;

    impl Energy<2> for Square {
        fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
            x * x + y * y
        }
    }

    #[test]
    fn a_constraint_that_moves_is_taken_at_the_time_zero() {
        let line = LevelSet::new(0, Turning);
        let found = critical_point(&Automatic(Square), &line, &[0.3, 2.0], Newton::default());
        let point = found.unwrap();
        assert!(point.q.iter().all(|x| (x - 0.5).abs() < 1e-14), "{point:?}");
        assert_eq!((point.kind, point.curvatures.len()), (Kind::Minimum, 1));
        // The equations are linear: one step, and one for its rounding.
        assert!(point.newton.iterations <= 2, "{point:?}");
    }

    #[test]
    fn a_guess_of_another_size_is_refused() {
        let line = LevelSet::new(0, Turning);
        for guess in [&[0.0][..], &[0.0; 3]] {
            let error = critical_point(&Automatic(Square), &line, guess, Newton::default());
            let what = "the guess's numbers";
            let expected = SizeError { what, expected: 2, got: guess.len() };
            assert_eq!(error.unwrap_err(), ConstraintError::Size(expected));
        }
    }
}
