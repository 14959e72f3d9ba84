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
/// at the time zero. Residuals are told in the size of df at the guess and in that of the equations.
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
    let curvatures = on_tangent_space(f, constraint, &x, &multipliers)?;
    let size = curvature(f, constraint, &x, &multipliers)?.amax();
    let kind = kind(&curvatures, FLAT * size);
    Ok(CriticalPoint { q: x, multipliers, kind, curvatures, newton: report })
}

/// Units in which forces and equations are numbers of one size, so that neither hides the other: powers
/// of two.
struct Units {
    force: f64,
    rows: Vec<f64>,
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
        let scales = (0..constraint.count()).map(|row| constraint.scale(row));
        let rows = scales.map(|scale| power_of_two(scale.slope * scale.length)).collect();
        Ok(Units { force: power_of_two(size), rows })
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

    /// f = y w + 0.3 w x on the unit circle, whatever the unit w of energy.
    struct Tilted(f64);

    impl Energy<2> for Tilted {
        fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
            (y + x * 0.3) * self.0
        }
    }

    #[derive(Clone, Debug)]
    struct Circle;

    impl Level<2> for Circle {
        fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
            x * x + y * y - 1.0
        }
    }

    #[test]
    fn the_unit_of_energy_changes_neither_the_point_nor_the_steps_there() {
        let circle = LevelSet::new(0, Circle);
        let find = |w: f64| {
            let tilted = Automatic(Tilted(w));
            critical_point(&tilted, &circle, &[0.6, -0.8], Newton::default()).unwrap()
        };
        let expected = find(1.0);
        assert_eq!(expected.kind, Kind::Minimum);
        for w in [1e-30, 1e-6, 1e6, 1e13, 1e30] {
            let found = find(w);
            assert!(found.q.iter().zip(&expected.q).all(|(a, b)| (a - b).abs() < 1e-14), "{w}");
            assert!((found.multipliers[0] / w / expected.multipliers[0] - 1.0).abs() < 1e-13);
            assert!(found.newton.iterations.abs_diff(expected.newton.iterations) <= 2, "{w}");
        }
    }

    /// f = 1e9 (x^2 + y^2)/2 + 1e6 y z + z^2/2, turned.
    struct Turned;

    impl Energy<3> for Turned {
        fn energy<R: Number>(&self, [x, y, z]: [R; 3]) -> R {
            let turned = |a: [f64; 3]| x * a[0] + y * a[1] + z * a[2];
            let [x, y, z] = TURN.map(turned);
            x * x * 5e8 + y * y * 5e8 + y * z * 1e6 + z * z * 0.5
        }
    }

    /// The rows of a rotation.
    const TURN: [[f64; 3]; 3] = [
        [2.0 / 3.0, 2.0 / 3.0, -1.0 / 3.0],
        [-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0],
        [2.0 / 3.0, -1.0 / 3.0, 2.0 / 3.0],
    ];

    #[test]
    fn rows_that_are_nearly_parallel_do_not_spoil_the_curvatures() {
        for apart in [1e-2, 1e-4, 3e-5] {
            let row = |a: [f64; 3]| {
                (
                    (0..3)
                        .map(|k| (k, (0..3).map(|i| a[i] * TURN[i][k]).sum()))
                        .collect::<Vec<_>>(),
                    1.0,
                )
            };
            let held = Linear::new(vec![row([1.0, 0.0, 0.0]), row([1.0, apart, 0.0])]).unwrap();
            let found =
                critical_point(&Automatic(Turned), &held, &[0.1, 0.2, 0.3], Newton::default());
            let curvature = found.unwrap().curvatures[0];
            // The rows themselves are rounded: 1e-16/apart of the form's 1e6 beside the curvature 1.
            assert!((curvature - 1.0).abs() < 1e-9 / apart, "{apart}: {curvature}");
        }
    }

    #[test]
    fn a_second_differential_that_is_not_finite_is_an_error() {
        /// Slopes of roots, which are vertical at zero.
        struct Roots;
        impl Potential for Roots {
            fn dim(&self) -> usize {
                2
            }
            fn energy(&self, q: &[f64]) -> f64 {
                q.iter().map(|q| q.abs().powf(1.5) / 1.5).sum()
            }
            fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
                dv.0.iter_mut().zip(q).for_each(|(dv, q)| *dv += q.abs().sqrt().copysign(*q));
            }
            fn add_hessian(&self, q: &[f64], hessian: &mut impl stationary_calculus::Sink) {
                for (k, q) in q.iter().enumerate() {
                    hessian.add_symmetric(&[k], &[0.5 / q.abs().sqrt()]);
                }
            }
        }
        let held = Linear::new(vec![(vec![(0, 1.0), (1, 1.0)], 0.0)]).unwrap();
        let error = critical_point(&Roots, &held, &[0.0, 0.0], Newton::default()).unwrap_err();
        assert!(matches!(error, ConstraintError::NonFinite { .. }), "{error}");
        let error = critical_point(&Roots, &held, &[0.3, f64::NAN], Newton::default()).unwrap_err();
        let what = "differential of the function";
        assert_eq!(error, ConstraintError::NonFinite { what, index: 1 });
    }

    #[test]
    fn a_freedom_far_away_does_not_end_the_search_at_the_guess() {
        /// A coordinate of its own beside two on a circle.
        struct Beside(f64);
        impl Energy<3> for Beside {
            fn energy<R: Number>(&self, [y, z, x]: [R; 3]) -> R {
                let off = x - R::from(self.0);
                off * off * 0.5 + z * 3.0 + y * 0.9 + y * z
            }
        }
        let find = |far: f64| {
            let circle = LevelSet::new(0, Circle);
            let found = critical_point(
                &Automatic(Beside(far)),
                &circle,
                &[-0.3, -1.0, far],
                Newton::default(),
            );
            found.map(|found| [found.q[0], found.q[1]])
        };
        let expected = find(1.0).unwrap();
        for far in [1e6, 1e10, 1e12] {
            let found = find(far).unwrap();
            assert!(
                found.iter().zip(&expected).all(|(a, b)| (a - b).abs() < 1e-12),
                "{far}: {found:?}"
            );
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
