//! The differential: what a function does to an infinitesimal change of its argument, exactly.
//!
//! ```text
//! D_w f(q)           = d/ds f(q + s w) at s = 0        directional derivative, shaped like f
//! {df(q)}(w)         = D_w f(q) = [df(q)] [w]          linear in w
//! {d2f(q)}(v, w)     = D_w (D_v f)(q)                  bilinear, symmetric
//! grad f(q)          = df(q)^sharp = [g]^-1 [df(q)]^T  needs a metric g; the differential does not
//! ```
//! `q` in R^N, `v w` vectors, `f` a number, a column of M numbers or a matrix. `[df]` is a covector
//! for a number and M x N for a column. A matrix is an array of its columns, and where it must be one
//! long column it is unrolled column by column: everywhere in this project, the notes unroll by rows.
//!
//! A function is written once over any [`Number`] and evaluated at dual numbers, whose infinitesimal
//! parts are the derivatives, exact to rounding: there is no step.
//! Source: notes 2.1, 2.2, 2.4. Differences with a step, to check what was written by hand, are in
//! [`check_jacobian`](crate::check_jacobian).
//!
//! ```
//! use stationary_calculus::{Number, differential, jacobian};
//! fn polar<R: Number>([r, theta]: [R; 2]) -> [R; 2] {
//!     [r * theta.cos(), r * theta.sin()]
//! }
//! let q = [2.0, 0.5];
//! assert_eq!(jacobian(polar, q)[(1, 0)], 0.5_f64.sin());
//! assert_eq!(differential(|[x, y]| x * x * y, q).0, [2.0, 4.0]);
//! ```

use nalgebra::{DMatrix, SMatrix};
use num_dual::{Dual2SVec64, Dual64, DualNum, DualSVec64, HyperDual64, Mappable};

use crate::{Covector, Metric, SizeError, Vector, array};

/// A real number or a dual number: what a function is written over to be differentiated.
///
/// It has the arithmetic of `f64`, mixed arithmetic with an `f64` on the right, and `sqrt`, `sin`,
/// `powi` and the like; `R::from(2.0)` is a constant. Numbers compare by their real parts. Of an angle
/// take [`atan2`]: their own has no derivatives where its second number is zero.
pub trait Number: DualNum<Primitive = f64> + Copy {}

impl<R: DualNum<Primitive = f64> + Copy> Number for R {}

/// The angle of `(x, y)` from the first axis, in [-pi, pi], with derivatives that are right on the second axis and
/// beside it as well: the dual numbers' own `atan2` divides by `x`. At the origin there are none.
pub fn atan2<R: Number>(y: R, x: R) -> R {
    let [up, along] = [y.re(), x.re()];
    if up == 0.0 && along == 0.0 {
        return y.atan2(x);
    }
    let part = if up.abs() <= along.abs() { (y / x).atan() } else { -(x / y).atan() };
    // What is left are quarter turns, a constant.
    part + (up.atan2(along) - part.re())
}

/// The directional derivative `D_w f(q)`, shaped like the value of f: a number, an array, an array of
/// columns.
pub fn directional_derivative<const N: usize, F: Mappable<Dual64>>(
    f: impl Fn([Dual64; N]) -> F,
    q: [f64; N],
    w: Vector<[f64; N]>,
) -> F::Output<f64> {
    f(array(|i| Dual64::new(q[i], w.0[i]))).map_dual(|f| f.eps)
}

/// The differential of a function with one number as its value: a covector.
pub fn differential<const N: usize>(
    f: impl Fn([DualSVec64<N>; N]) -> DualSVec64<N>,
    q: [f64; N],
) -> Covector<[f64; N]> {
    Covector(row(f(dual(q))))
}

/// The M x N matrix of the differential of a function with M numbers as its value.
pub fn jacobian<const N: usize, const M: usize>(
    f: impl Fn([DualSVec64<N>; N]) -> [DualSVec64<N>; M],
    q: [f64; N],
) -> SMatrix<f64, M, N> {
    let rows = f(dual(q)).map(row);
    SMatrix::from_fn(|i, j| rows[i][j])
}

/// The matrix of the differential of a function with a matrix as its value, given by columns and
/// unrolled column by column: (rows x columns) x N.
pub fn jacobian_of_matrix<const N: usize, const ROWS: usize, const COLUMNS: usize>(
    f: impl Fn([DualSVec64<N>; N]) -> [[DualSVec64<N>; ROWS]; COLUMNS],
    q: [f64; N],
) -> DMatrix<f64> {
    let rows = f(dual(q)).map(|column| column.map(row));
    DMatrix::from_fn(ROWS * COLUMNS, N, |k, j| rows.as_flattened()[k][j])
}

/// The second differential `{d2f(q)}(v, w)`, shaped like the value of f.
pub fn second_differential<const N: usize, F: Mappable<HyperDual64>>(
    f: impl Fn([HyperDual64; N]) -> F,
    q: [f64; N],
    v: Vector<[f64; N]>,
    w: Vector<[f64; N]>,
) -> F::Output<f64> {
    let q = array(|i| HyperDual64::new(q[i], v.0[i], w.0[i], 0.0));
    f(q).map_dual(|f| f.eps1eps2)
}

/// The Hessian: the matrix of the second differential of a function with one number as its value.
pub fn hessian<const N: usize>(
    f: impl Fn([Dual2SVec64<N>; N]) -> Dual2SVec64<N>,
    q: [f64; N],
) -> SMatrix<f64, N, N> {
    let q = array(|i| Dual2SVec64::from_re(q[i]).derivative(i));
    f(q).v2.0.unwrap_or_else(SMatrix::zeros)
}

/// The gradient: the vector whose inner product with any `w` is `{df(q)}(w)`.
///
/// # Errors
/// [`SizeError`] unless the metric has N freedoms.
pub fn gradient<const N: usize>(
    metric: &impl Metric,
    f: impl Fn([DualSVec64<N>; N]) -> DualSVec64<N>,
    q: [f64; N],
) -> Result<Vector<[f64; N]>, SizeError> {
    SizeError::check("the metric's freedoms", N, metric.dim())?;
    let mut gradient = Vector([0.0; N]);
    metric.sharp(differential(f, q).view(), gradient.view_mut());
    Ok(gradient)
}

/// The coordinates as dual numbers, each with an infinitesimal part of its own.
fn dual<const N: usize>(q: [f64; N]) -> [DualSVec64<N>; N] {
    array(|i| DualSVec64::from_re(q[i]).derivative(i))
}

/// The infinitesimal parts of a number.
fn row<const N: usize>(number: DualSVec64<N>) -> [f64; N] {
    number.eps.0.map_or([0.0; N], |parts| parts.data.0[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DenseMetric, DiagonalMetric};
    use nalgebra::{dmatrix, matrix};
    use proptest::prelude::*;

    fn f<R: Number>([x, y]: [R; 2]) -> R {
        (x * y).sin() + x * x * 3.0
    }

    fn g<R: Number>([x, y]: [R; 2]) -> [R; 2] {
        [x * x - y, (x + y * 2.0).exp()]
    }

    fn sum(v: [f64; 2], alpha: f64, w: [f64; 2]) -> [f64; 2] {
        [v[0] + alpha * w[0], v[1] + alpha * w[1]]
    }

    fn close(a: &[f64], b: &[f64]) -> bool {
        a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-12 * (1.0 + b.abs()))
    }

    fn pair() -> impl Strategy<Value = [f64; 2]> {
        prop::array::uniform2(-1.0..1.0)
    }

    #[test]
    fn an_angle_has_its_derivatives_on_both_axes_and_beside_them() {
        let angle = |[x, y]: [Dual2SVec64<2>; 2]| atan2(y, x);
        for small in [0.0, 1e-300, 1e-17, 1e-12, 1e-6, 0.3] {
            for (x, y) in [(small, 0.7), (small, -0.7), (-small, 0.7), (0.7, small), (-0.7, small)]
            {
                let square: f64 = x * x + y * y;
                let slope = differential(|[x, y]| atan2(y, x), [x, y]).0;
                let expected = [-y / square, x / square];
                assert!(
                    (0..2).all(|k| (slope[k] - expected[k]).abs() < 1e-15),
                    "{x} {y} {slope:?}"
                );
                let (twice, cross) = (2.0 * x * y, y * y - x * x);
                let bend = matrix![twice, cross; cross, -twice] / (square * square);
                assert!((hessian(angle, [x, y]) - bend).amax() < 1e-14, "{x} {y}");
                assert!((atan2(y, x) - y.atan2(x)).abs() <= 4.5e-16);
            }
        }
        assert_eq!(atan2(0.0, 0.0), 0.0);
    }

    proptest! {
        #[test]
        fn the_differential_is_linear_in_its_direction(
            q in pair(), v in pair(), w in pair(), alpha in -2.0..2.0,
        ) {
            let d = |w| directional_derivative(g, q, Vector(w));
            prop_assert!(close(&d(sum(v, alpha, w)), &sum(d(v), alpha, d(w))));
            prop_assert_eq!(d(w.map(|x| -x)), d(w).map(|x| -x));
        }

        #[test]
        fn the_differential_of_a_sum_is_the_sum_of_the_differentials(q in pair()) {
            let total = differential(|q| f(q) + g(q)[1], q);
            let [a, b] = [differential(f, q), differential(|q| g(q)[1], q)];
            prop_assert!(close(&total.0, &sum(a.0, 1.0, b.0)));
        }

        #[test]
        fn the_differential_of_a_composition_is_the_composition(q in pair()) {
            let inner = jacobian(g, q);
            let value = g(q);
            let chain = jacobian(g, value) * inner;
            prop_assert!(close(jacobian(|q| g(g(q)), q).as_slice(), chain.as_slice()));
        }

        #[test]
        fn the_differential_of_a_product_has_two_terms(q in pair(), w in pair()) {
            let d = directional_derivative(|q| f(q) * g(q)[1], q, Vector(w));
            let df = directional_derivative(f, q, Vector(w));
            let dg = directional_derivative(g, q, Vector(w))[1];
            prop_assert!(close(&[d], &[df * g(q)[1] + f(q) * dg]));
        }

        #[test]
        fn the_directional_derivative_is_the_matrix_times_the_direction(q in pair(), w in pair()) {
            let product = jacobian(g, q) * nalgebra::Vector2::from(w);
            prop_assert!(close(&directional_derivative(g, q, Vector(w)), product.as_slice()));
            let d = directional_derivative(f, q, Vector(w));
            prop_assert!(close(&[d], &[differential(f, q).apply(&Vector(w))]));
        }

        #[test]
        fn the_second_differential_is_symmetric_and_given_by_the_hessian(
            q in pair(), v in pair(), w in pair(),
        ) {
            let d2 = second_differential(f, q, Vector(v), Vector(w));
            prop_assert!(close(&[d2], &[second_differential(f, q, Vector(w), Vector(v))]));
            let h = hessian(f, q);
            let product = nalgebra::Vector2::from(v).dot(&(h * nalgebra::Vector2::from(w)));
            prop_assert!(close(&[d2], &[product]));
            prop_assert_eq!(h, h.transpose());
        }

        #[test]
        fn the_gradient_is_the_vector_whose_inner_products_are_the_differential(
            q in pair(), w in pair(),
        ) {
            let metric = DenseMetric::new(dmatrix![4.0, 1.0; 1.0, 2.0]).unwrap();
            let gradient = gradient(&metric, f, q).unwrap();
            let product = metric.inner(gradient.view(), Vector(w).view());
            prop_assert!(close(&[product], &[differential(f, q).apply(&Vector(w))]));
        }
    }

    #[test]
    fn the_gradient_is_the_transposed_differential_for_the_euclidean_metric_only() {
        let q = [0.3, -0.8];
        let euclidean = DiagonalMetric::new([1.0, 1.0]).unwrap();
        assert_eq!(gradient(&euclidean, f, q).unwrap().0, differential(f, q).0);
        let masses = DiagonalMetric::new([2.0, 4.0]).unwrap();
        let [x, y] = differential(f, q).0;
        assert_eq!(gradient(&masses, f, q).unwrap().0, [x / 2.0, y / 4.0]);
        assert!(gradient(&DiagonalMetric::new([1.0]).unwrap(), f, q).is_err());
    }

    #[test]
    fn matrices_are_unrolled_column_by_column() {
        // The turn by theta, by columns: (cos, sin), (-sin, cos).
        fn turn<R: Number>([theta]: [R; 1]) -> [[R; 2]; 2] {
            [[theta.cos(), theta.sin()], [-theta.sin(), theta.cos()]]
        }
        let (s, c) = 0.3_f64.sin_cos();
        assert_eq!(jacobian_of_matrix(turn, [0.3]), dmatrix![-s; c; -c; -s]);
        let d = directional_derivative(turn, [0.3], Vector([2.0]));
        assert_eq!(d, [[-2.0 * s, 2.0 * c], [-2.0 * c, -2.0 * s]]);
    }

    #[test]
    fn a_constant_has_no_differential() {
        fn constant<R: Number>(_: [R; 2]) -> R {
            R::from(7.0)
        }
        assert_eq!(differential(constant, [1.0, 2.0]).0, [0.0; 2]);
        assert_eq!(hessian(constant, [1.0, 2.0]), matrix![0.0, 0.0; 0.0, 0.0]);
        assert_eq!(directional_derivative(constant, [1.0, 2.0], Vector([1.0, 1.0])), 0.0);
    }

    #[test]
    fn a_function_of_two_arguments_that_coincide_has_the_sum_of_its_partial_differentials() {
        // g(q) = f(q, q) with f(v, w) = v w^2 (notes 2.2): d1f + d2f = q^2 + 2 q^2.
        let product = |v: DualSVec64<1>, w: DualSVec64<1>| v * w * w;
        assert_eq!(differential(|[q]| product(q, q), [3.0]).0, [27.0]);
        let hessian = hessian(|[v, w]| v * w * w, [2.0, 3.0]);
        assert_eq!(hessian, matrix![0.0, 6.0; 6.0, 4.0]);
    }
}
