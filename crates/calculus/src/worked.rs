//! The differentials that the notes work out: dot product, norm, hat, inverse, cross product.
//!
//! ```text
//! u . v          [df] = v^T [du] + u^T [dv]
//! |q|            [df] = q^^T
//! q^ = q/|q|     [df] = I/|q| - q q^T/|q|^3           {df}(q) = 0
//! M^-1           {df}(dM) = -M^-1 dM M^-1
//! u x v          [df] = -[v]x [du] + [u]x [dv]
//! ```
//! `q u v` columns; `[du] [dv]` the matrices of their differentials, by whatever they depend on; `[u]x`
//! the matrix with `[u]x v = u x v`. A linear function is its own differential, the transpose among
//! them. Norm and hat have no differential at q = 0: there the closed forms are NaN.
//! Source: notes 2.3, right as printed.

use nalgebra::{Matrix3, RowSVector, SMatrix, SVector, Vector3, matrix};

use crate::Number;
use crate::equation::power_of_two;

/// The differential of `u . v`.
pub fn dot_differential<const M: usize, const N: usize>(
    u: &SVector<f64, M>,
    du: &SMatrix<f64, M, N>,
    v: &SVector<f64, M>,
    dv: &SMatrix<f64, M, N>,
) -> RowSVector<f64, N> {
    v.transpose() * du + u.transpose() * dv
}

/// The norm `|q|`.
pub fn norm<R: Number, const N: usize>(q: [R; N]) -> R {
    q.iter().fold(R::from(0.0), |sum, &x| sum + x * x).sqrt()
}

/// The differential of the norm: the direction of q, as a row.
pub fn norm_differential<const N: usize>(q: &SVector<f64, N>) -> RowSVector<f64, N> {
    direction(q).0.transpose()
}

/// The hat function `q^ = q/|q|`: the direction of q.
pub fn hat<R: Number, const N: usize>(q: [R; N]) -> [R; N] {
    let norm = norm(q);
    q.map(|x| x / norm)
}

/// The differential of the hat function.
pub fn hat_differential<const N: usize>(q: &SVector<f64, N>) -> SMatrix<f64, N, N> {
    let (unit, [factor, norm]) = direction(q);
    (SMatrix::identity() - unit * unit.transpose()) / norm / factor
}

/// The direction of a vector and two numbers whose product is its norm, which may be too large for one.
fn direction<const N: usize>(q: &SVector<f64, N>) -> (SVector<f64, N>, [f64; 2]) {
    let factor = power_of_two(q.amax());
    let scaled = q / factor;
    let norm = scaled.norm();
    (scaled / norm, [factor, norm])
}

/// The differential of the inverse at a matrix M, applied to a change of it.
pub fn inverse_differential<const N: usize>(
    inverse: &SMatrix<f64, N, N>,
    change: &SMatrix<f64, N, N>,
) -> SMatrix<f64, N, N> {
    -(inverse * change * inverse)
}

/// The matrix `[u]x` with `[u]x v = u x v`.
pub fn cross_matrix(u: &Vector3<f64>) -> Matrix3<f64> {
    matrix![0.0, -u.z, u.y; u.z, 0.0, -u.x; -u.y, u.x, 0.0]
}

/// The differential of `u x v`.
pub fn cross_differential<const N: usize>(
    u: &Vector3<f64>,
    du: &SMatrix<f64, 3, N>,
    v: &Vector3<f64>,
    dv: &SMatrix<f64, 3, N>,
) -> SMatrix<f64, 3, N> {
    cross_matrix(u) * dv - cross_matrix(v) * du
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Differences, Vector, differences, differential, directional_derivative, jacobian};
    use nalgebra::{DMatrix, dmatrix, vector};

    const Q: [f64; 3] = [0.6, -1.1, 0.4];
    const W: Vector<[f64; 3]> = Vector([0.3, 0.8, -0.5]);

    /// Two vector fields on R^3.
    fn u<R: Number>([x, y, z]: [R; 3]) -> [R; 3] {
        [x * y, z.sin(), x + z * z]
    }

    fn v<R: Number>([x, y, z]: [R; 3]) -> [R; 3] {
        [y.exp(), x * z, y - x]
    }

    fn dot<R: Number>(u: [R; 3], v: [R; 3]) -> R {
        u[0] * v[0] + u[1] * v[1] + u[2] * v[2]
    }

    fn cross<R: Number>(u: [R; 3], v: [R; 3]) -> [R; 3] {
        [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
    }

    fn inverse<R: Number>([a, c, b, d]: [R; 4]) -> [R; 4] {
        let determinant = a * d - b * c;
        [d / determinant, -c / determinant, -b / determinant, a / determinant]
    }

    /// Steps of half a decade from 0.1 down to rounding.
    fn study<const N: usize, const M: usize>(
        f: impl Fn([f64; N]) -> [f64; M],
        df: DMatrix<f64>,
        q: [f64; N],
        w: [f64; N],
    ) -> Differences {
        let steps: Vec<f64> = (2..30).map(|k| 10_f64.powf(-0.5 * f64::from(k))).collect();
        let f = |q: &[f64]| f(std::array::from_fn(|i| q[i])).to_vec();
        differences(f, &df, &q, Vector(&w), &steps).unwrap()
    }

    /// The slopes of figure 2.1: one for forward and two for centred differences.
    fn converges(differences: &Differences) -> bool {
        let near = |slope: Option<f64>, k: f64| slope.is_some_and(|slope| (slope - k).abs() < 0.05);
        near(differences.forward_slope(), 1.0) && near(differences.centred_slope(), 2.0)
    }

    fn dynamic<const M: usize, const N: usize>(matrix: SMatrix<f64, M, N>) -> DMatrix<f64> {
        DMatrix::from_column_slice(M, N, matrix.as_slice())
    }

    #[test]
    fn differentials_of_norm_and_hat_hold_where_squares_leave_the_range_of_numbers() {
        for size in [1e-200, 1e-90, 1.0, 1e90, 1e200] {
            let q = nalgebra::vector![3.0 * size, 4.0 * size];
            assert!(
                (norm_differential(&q) - nalgebra::vector![0.6, 0.8].transpose()).amax() < 1e-15
            );
            let expected = matrix![0.64, -0.48; -0.48, 0.36] / 5.0;
            assert!((hat_differential(&q) * size - expected).amax() < 1e-16, "{size}");
        }
        assert!(norm_differential(&SVector::<f64, 2>::zeros()).iter().all(|x| x.is_nan()));
    }

    #[test]
    fn the_differential_of_a_dot_product_is_the_printed_one() {
        let [du, dv] = [jacobian(u, Q), jacobian(v, Q)];
        let printed = dot_differential(&SVector::from(u(Q)), &du, &SVector::from(v(Q)), &dv);
        let exact = differential(|q| dot(u(q), v(q)), Q);
        assert!((printed.transpose() - SVector::from(exact.0)).amax() < 1e-14);
        assert!(converges(&study(|q| [dot(u(q), v(q))], dynamic(printed), Q, W.0)));
    }

    #[test]
    fn a_linear_function_is_its_own_differential() {
        fn linear<R: Number>([x, y, z]: [R; 3]) -> [R; 2] {
            [x * 2.0 - y, z * 3.0 + y]
        }
        assert_eq!(directional_derivative(linear, Q, W), linear(W.0));
        assert_eq!(jacobian(|q| q, Q), Matrix3::identity());
        let matrix = dmatrix![2.0, -1.0, 0.0; 0.0, 1.0, 3.0];
        let study = study(linear, matrix, Q, W.0);
        // No truncation: the error is rounding over the step from the first step on.
        assert!(study.rows().iter().all(|row| row.centred <= 1e-15 / row.step));
    }

    #[test]
    fn the_differential_of_the_transpose_is_the_transpose_of_the_change() {
        fn transpose<R: Number>([a, b, c, d, e, f]: [R; 6]) -> [[R; 3]; 2] {
            [[a, c, e], [b, d, f]]
        }
        let change = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];
        let d = directional_derivative(transpose, [1.0; 6], Vector(change));
        assert_eq!(d, transpose(change));
    }

    #[test]
    fn the_differential_of_the_norm_is_the_unit_vector_as_a_row() {
        let printed = norm_differential(&SVector::from(Q));
        assert!((printed.transpose() - SVector::from(differential(norm, Q).0)).amax() < 1e-15);
        assert!(converges(&study(|q| [norm(q)], dynamic(printed), Q, W.0)));
        assert!(norm_differential(&SVector::from([0.0; 3])).x.is_nan());
    }

    #[test]
    fn the_differential_of_the_hat_function_is_the_printed_one() {
        let printed = hat_differential(&SVector::from(Q));
        assert!((printed - jacobian(hat, Q)).amax() < 1e-15);
        assert!((printed * SVector::from(Q)).amax() < 1e-15);
        assert!(converges(&study(hat, dynamic(printed), Q, W.0)));
    }

    #[test]
    fn the_differential_of_the_inverse_is_the_printed_one() {
        let (m, dm) = ([2.0, 0.3, -0.7, 1.1], [0.4, -0.2, 0.9, 0.5]);
        let by_columns = SMatrix::<f64, 2, 2>::from_column_slice;
        let printed = inverse_differential(&by_columns(&inverse(m)), &by_columns(&dm));
        let exact = directional_derivative(inverse, m, Vector(dm));
        assert!((printed - by_columns(&exact)).amax() < 1e-15);
        assert!(converges(&study(inverse, dynamic(jacobian(inverse, m)), m, dm)));
    }

    #[test]
    fn the_differential_of_a_cross_product_is_the_printed_one() {
        let [du, dv] = [jacobian(u, Q), jacobian(v, Q)];
        let printed = cross_differential(&Vector3::from(u(Q)), &du, &Vector3::from(v(Q)), &dv);
        assert!((printed - jacobian(|q| cross(u(q), v(q)), Q)).amax() < 1e-14);
        assert!(converges(&study(|q| cross(u(q), v(q)), dynamic(printed), Q, W.0)));
        let (a, b) = (vector![1.0, 2.0, 3.0], vector![-2.0, 0.5, 1.0]);
        assert_eq!(cross_matrix(&a) * b, a.cross(&b));
    }
}
