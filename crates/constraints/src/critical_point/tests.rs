//! Critical points that are known, in every unit, and what has none.

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

/// The unit circle of a unit of length, in a unit of its equation.
#[derive(Clone, Debug)]
struct InUnits {
    length: f64,
    equation: f64,
}

impl Level<2> for InUnits {
    fn value<R: Number>(&self, _: R, x: [R; 2]) -> R {
        let [x, y] = x.map(|x| x * self.length.recip());
        (x * x + y * y - 1.0) * self.equation
    }
}

#[test]
fn the_units_of_an_equation_and_of_length_change_nothing() {
    let find = |length: f64, equation: f64| {
        let tilted = Automatic(Tilted(length.recip()));
        let circle = LevelSet::new(0, InUnits { length, equation });
        critical_point(&tilted, &circle, &[0.6 * length, -0.8 * length], Newton::default())
    };
    let expected = find(1.0, 1.0).unwrap();
    for powers in [[0, -40], [0, 40], [0, -100], [30, 0], [-30, 0], [30, -70], [-40, 90]] {
        let [length, equation] = powers.map(|power| 2.0_f64.powi(power));
        let found = find(length, equation).unwrap();
        assert_eq!(found.q, [0, 1].map(|k| expected.q[k] * length), "{powers:?}");
        assert_eq!(found.multipliers[0] * equation, expected.multipliers[0], "{powers:?}");
        assert_eq!(found.newton, expected.newton, "{powers:?}");
        assert_eq!(found.kind, Kind::Minimum);
    }
}

#[test]
fn an_equation_whose_differential_vanishes_is_an_error_in_every_unit() {
    /// A double line, `w (y - x^2/2)^2`.
    #[derive(Clone, Debug)]
    struct Double(f64);
    impl Level<2> for Double {
        fn value<R: Number>(&self, _: R, [x, y]: [R; 2]) -> R {
            (y - x * x * 0.5).powi(2) * self.0
        }
    }
    for w in [1e-12, 1.0, 1e12] {
        let guess = [0.3, 0.5];
        let double = LevelSet::new(0, Double(w));
        let found = critical_point(&Automatic(Ellipse), &double, &guess, Newton::default());
        assert!(found.is_err(), "{w}: {found:?}");
    }
}

/// f = (x - 1)^2 + 2 (y + 1)^2.
struct Ellipse;

impl Energy<2> for Ellipse {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        (x - 1.0).powi(2) + (y + 1.0).powi(2) * 2.0
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
            ((0..3).map(|k| (k, (0..3).map(|i| a[i] * TURN[i][k]).sum())).collect::<Vec<_>>(), 1.0)
        };
        let held = Linear::new(vec![row([1.0, 0.0, 0.0]), row([1.0, apart, 0.0])]).unwrap();
        let found = critical_point(&Automatic(Turned), &held, &[0.1, 0.2, 0.3], Newton::default());
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
        let found =
            critical_point(&Automatic(Beside(far)), &circle, &[-0.3, -1.0, far], Newton::default());
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
    let point = critical_point(&Automatic(Flat), &line, &[0.0, 0.0], Newton::default()).unwrap();
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
