//! Groups as level sets: the examples of 8.1, 8.2 and 9.1, by the rank of their equations.

use nalgebra::{DMatrix, Vector3};
use stationary_calculus::{Number, jacobian};
use stationary_rigid::{LieGroup, Rotation, matrix_exponential, null_space};

/// The rank of a matrix whose null space is known.
fn rank(a: &DMatrix<f64>) -> usize {
    a.ncols() - null_space(a).unwrap().ncols()
}

/// The n (n + 1)/2 equations `M^T M = I` of O(n), M by columns.
fn orthogonality(n: usize, m: &DMatrix<f64>) -> DMatrix<f64> {
    let mut rows = DMatrix::zeros(n * (n + 1) / 2, n * n);
    let mut row = 0;
    for i in 0..n {
        for j in i..n {
            for c in 0..n {
                rows[(row, n * i + c)] += m[(c, j)];
                rows[(row, n * j + c)] += m[(c, i)];
            }
            row += 1;
        }
    }
    rows
}

/// The differential of the determinant: the cofactors of M, by columns.
fn determinant(n: usize, m: &DMatrix<f64>) -> DMatrix<f64> {
    DMatrix::from_fn(1, n * n, |_, k| {
        let minor = m.clone().remove_row(k % n).remove_column(k / n);
        if (k % n + k / n).is_multiple_of(2) { minor.determinant() } else { -minor.determinant() }
    })
}

fn wild(n: usize) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| ((i * 7 + j * 3 + i * j) % 5) as f64 * 0.4 - 0.7)
}

#[test]
fn the_pendulum_moves_on_a_sphere_which_is_the_level_set_of_one_equation() {
    fn length<R: Number>([x, y, z]: [R; 3]) -> [R; 1] {
        [x * x + y * y + z * z - R::from(4.0)]
    }
    let bob = [1.2, -1.6, 0.0];
    let dg = jacobian(length, bob);
    let tangents = null_space(&DMatrix::from_row_slice(1, 3, dg.as_slice())).unwrap();
    assert_eq!(tangents.ncols(), 2, "n - m, errata 8.1");
    for tangent in tangents.column_iter() {
        assert!((0..3).map(|c| tangent[c] * bob[c]).sum::<f64>().abs() < 1e-15);
    }
    // At the centre dg is zero, and zero is no regular value of the distance squared.
    let centre = jacobian(length, [0.0; 3]);
    assert_eq!(rank(&DMatrix::from_row_slice(1, 3, centre.as_slice())), 0);
}

#[test]
fn a_rotation_of_space_is_nine_entries_with_six_constraints() {
    let r = Rotation::exp(Vector3::new(0.4, -1.3, 2.0)).matrix();
    let r = DMatrix::from_column_slice(3, 3, r.as_slice());
    let dg = orthogonality(3, &r);
    assert_eq!((dg.nrows(), dg.ncols(), rank(&dg)), (6, 9, 6));
    // The notes' nine equations have three doubles, and the same rank.
    let nine = DMatrix::from_fn(9, 9, |row, k| {
        let (i, j) = (row % 3, row / 3);
        let (c, column) = (k % 3, k / 3);
        let d = |a: bool, x: f64| if a { x } else { 0.0 };
        d(column == i, r[(c, j)]) + d(column == j, r[(c, i)])
    });
    assert_eq!(rank(&nine), 6);
}

#[test]
fn o_n_and_sl_n_are_level_sets_of_regular_values() {
    for n in 2..6 {
        let skew = wild(n) - wild(n).transpose();
        let rotation = matrix_exponential(&skew).unwrap();
        let mut reflection = rotation.clone();
        reflection.column_mut(0).neg_mut();
        for m in [rotation, reflection] {
            assert_eq!(rank(&orthogonality(n, &m)), n * (n + 1) / 2);
        }
        let mut traceless = wild(n);
        let mean = traceless.trace() / n as f64;
        traceless -= DMatrix::identity(n, n) * mean;
        let special = matrix_exponential(&traceless).unwrap();
        assert!((special.determinant() - 1.0).abs() < 1e-12);
        assert_eq!(rank(&determinant(n, &special)), 1);
        // Zero is no regular value of the determinant: its cofactors vanish at the zero matrix.
        assert_eq!(rank(&determinant(n, &DMatrix::zeros(n, n))), 0);
    }
}

#[test]
fn the_lie_algebra_is_the_null_space_of_dg_at_the_identity() {
    for n in 2..6 {
        let identity = DMatrix::identity(n, n);
        let skew = null_space(&orthogonality(n, &identity)).unwrap();
        assert_eq!(skew.ncols(), n * (n - 1) / 2);
        for v in skew.column_iter() {
            let v = DMatrix::from_column_slice(n, n, v.as_slice());
            assert!((&v + v.transpose()).amax() < 1e-14);
            let g = matrix_exponential(&v).unwrap();
            assert!((g.transpose() * &g - &identity).amax() < 1e-14);
        }
        let traceless = null_space(&determinant(n, &identity)).unwrap();
        assert_eq!(traceless.ncols(), n * n - 1);
        for v in traceless.column_iter() {
            let v = DMatrix::from_column_slice(n, n, v.as_slice());
            assert!(v.trace().abs() < 1e-14);
            assert!((matrix_exponential(&v).unwrap().determinant() - 1.0).abs() < 1e-13);
        }
    }
}

#[test]
fn the_tangent_space_at_a_rotation_is_the_rotation_times_the_algebra() {
    let r = Rotation::exp(Vector3::new(0.4, -1.3, 2.0));
    let dg = orthogonality(3, &DMatrix::from_column_slice(3, 3, r.matrix().as_slice()));
    for v in [Vector3::x(), Vector3::y(), Vector3::z()] {
        let tangent = r.tangent(v);
        let column = DMatrix::from_column_slice(9, 1, tangent.as_slice());
        assert!((&dg * column).amax() < 1e-15);
    }
    assert_eq!(null_space(&dg).unwrap().ncols(), 3);
}

#[test]
fn a_null_space_has_numbers_beside_entries_of_any_size() {
    for small in [1.0, 1e-20, 1e-157, 1e-300] {
        let mut a = DMatrix::zeros(4, 4);
        (a[(0, 2)], a[(3, 2)]) = (-small, -1.0);
        let basis = null_space(&a).unwrap();
        assert_eq!(basis.ncols(), 3);
        assert!((&a * &basis).amax() < 1e-15, "{small}: {basis}");
        let gram = basis.transpose() * &basis;
        assert!((gram - DMatrix::identity(3, 3)).amax() < 1e-14, "{small}: {basis}");
    }
}
