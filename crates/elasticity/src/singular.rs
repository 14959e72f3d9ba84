//! Singular values with signs, and eigenvalues, of matrices of at most three columns.
//!
//! ```text
//! F = U diag(s) V^T         U D x R, V R x R a rotation, s_k >= 0, orthonormal columns
//! D = R                     U a rotation too: the smallest s carries the sign of det F
//! S = Q diag(l) Q^T         S symmetric R x R
//! ```
//! By Jacobi's rotations of pairs of columns, which find small singular values to full relative
//! accuracy. The number of sweeps is bounded; four or five are the rule. What is not finite comes out
//! as NaN. Source: Hestenes (1958); Demmel and Veselic (1992).

use crate::tensor::{determinant, dot};

/// More sweeps than any finite matrix of three columns needs.
const SWEEPS: usize = 30;

/// A matrix as two frames and the stretches between them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Singular<const D: usize, const R: usize> {
    /// The columns `u_k`.
    pub(crate) left: [[f64; D]; R],
    /// The stretches `s_k`.
    pub(crate) values: [f64; R],
    /// The columns `v_k`.
    pub(crate) right: [[f64; R]; R],
}

/// Cosine and sine of the rotation that makes a 2 x 2 symmetric matrix `[a b; b c]` diagonal.
#[inline]
fn rotation(a: f64, b: f64, c: f64) -> (f64, f64) {
    let ratio = (c - a) / (2.0 * b);
    let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
    let cosine = tangent.hypot(1.0).recip();
    (cosine, cosine * tangent)
}

#[inline]
fn rotate<const D: usize, const R: usize>(
    columns: &mut [[f64; D]; R],
    (p, q): (usize, usize),
    (cosine, sine): (f64, f64),
) {
    for i in 0..D {
        let (x, y) = (columns[p][i], columns[q][i]);
        columns[p][i] = cosine * x - sine * y;
        columns[q][i] = sine * x + cosine * y;
    }
}

fn identity<const R: usize>() -> [[f64; R]; R] {
    std::array::from_fn(|k| std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }))
}

/// The singular values of `f` and their frames.
pub(crate) fn singular<const D: usize, const R: usize>(f: &[[f64; D]; R]) -> Singular<D, R> {
    let (mut columns, mut right) = (*f, identity::<R>());
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..R {
            for q in p + 1..R {
                let (a, c) = (dot(&columns[p], &columns[p]), dot(&columns[q], &columns[q]));
                let b = dot(&columns[p], &columns[q]);
                if b.abs() > f64::EPSILON * (a * c).sqrt() {
                    rotated = true;
                    let turn = rotation(a, b, c);
                    rotate(&mut columns, (p, q), turn);
                    rotate(&mut right, (p, q), turn);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    let values = columns.map(|column| dot(&column, &column).sqrt());
    let mut result = Singular { left: columns, values, right };
    result.normalize();
    result
}

impl<const D: usize, const R: usize> Singular<D, R> {
    fn normalize(&mut self) {
        for k in 0..R {
            let length = self.values[k];
            if length > f64::MIN_POSITIVE {
                self.left[k] = self.left[k].map(|x| x / length);
            }
        }
        for k in 0..R {
            if self.values[k] <= f64::MIN_POSITIVE {
                self.left[k] = self.completed(k);
            }
        }
        let mut least = 0;
        for k in 1..R {
            if self.values[k] < self.values[least] {
                least = k;
            }
        }
        // V is a product of rotations: only U may be a reflection.
        if D == R && square_determinant(&self.left) < 0.0 {
            self.left[least] = self.left[least].map(|x| -x);
            self.values[least] = -self.values[least];
        }
    }

    /// A unit vector at right angles to the columns that are known: those before k, and those of
    /// positive stretch.
    fn completed(&self, k: usize) -> [f64; D] {
        let known =
            |other: &usize| *other != k && (*other < k || self.values[*other] > f64::MIN_POSITIVE);
        let mut best = ([0.0; D], 0.0);
        for axis in 0..D {
            let mut candidate = [0.0; D];
            candidate[axis] = 1.0;
            for other in (0..R).filter(known) {
                let along = dot(&candidate, &self.left[other]);
                for i in 0..D {
                    candidate[i] -= along * self.left[other][i];
                }
            }
            let length = dot(&candidate, &candidate).sqrt();
            if length > best.1 {
                best = (candidate.map(|x| x / length), length);
            }
        }
        best.0
    }

    /// The rotation nearest to F, `U V^T`, by columns.
    pub(crate) fn rotation(&self) -> [[f64; D]; R] {
        std::array::from_fn(|k| {
            std::array::from_fn(|i| (0..R).map(|m| self.left[m][i] * self.right[m][k]).sum())
        })
    }

    /// `V diag(g(s)) V^T`, by columns: the strain of a measure of stretch.
    pub(crate) fn spectral(&self, g: impl Fn(f64) -> f64) -> [[f64; R]; R] {
        spectral(&self.right, &self.values.map(g))
    }
}

/// The determinant where the matrix is square, else zero.
fn square_determinant<const D: usize, const R: usize>(f: &[[f64; D]; R]) -> f64 {
    let at = |i: usize, k: usize| f[k][i];
    match (D, R) {
        (1, 1) => at(0, 0),
        (2, 2) => at(0, 0) * at(1, 1) - at(1, 0) * at(0, 1),
        (3, 3) => {
            determinant::<f64, 3>(&std::array::from_fn(|k| std::array::from_fn(|i| at(i, k))))
        }
        _ => 0.0,
    }
}

/// `Q diag(l) Q^T` of columns q_k.
pub(crate) fn spectral<const R: usize>(q: &[[f64; R]; R], l: &[f64; R]) -> [[f64; R]; R] {
    std::array::from_fn(|j| {
        std::array::from_fn(|i| (0..R).map(|m| l[m] * (q[m][i] * q[m][j])).sum())
    })
}

/// The eigenvalues of a symmetric matrix and its eigenvectors by columns.
pub(crate) fn symmetric_eigen<const R: usize>(s: &[[f64; R]; R]) -> ([f64; R], [[f64; R]; R]) {
    let (mut s, mut q) = (*s, identity::<R>());
    for _ in 0..SWEEPS {
        let mut rotated = false;
        for p in 0..R {
            for r in p + 1..R {
                let off = s[p][r];
                if off.abs() > f64::EPSILON * 0.25 * (s[p][p].abs() + s[r][r].abs()) {
                    rotated = true;
                    let turn = rotation(s[p][p], off, s[r][r]);
                    rotate(&mut s, (p, r), turn);
                    rotate_rows(&mut s, (p, r), turn);
                    rotate(&mut q, (p, r), turn);
                }
            }
        }
        if !rotated {
            break;
        }
    }
    (std::array::from_fn(|k| s[k][k]), q)
}

fn rotate_rows<const R: usize>(
    s: &mut [[f64; R]; R],
    (p, q): (usize, usize),
    (cosine, sine): (f64, f64),
) {
    for column in s {
        let (x, y) = (column[p], column[q]);
        column[p] = cosine * x - sine * y;
        column[q] = sine * x + cosine * y;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn assert_decomposes<const D: usize, const R: usize>(f: &[[f64; D]; R], size: f64) {
        let Singular { left, values, right } = singular(f);
        for k in 0..R {
            for l in 0..R {
                let unit = if k == l { 1.0 } else { 0.0 };
                assert!((dot(&left[k], &left[l]) - unit).abs() < 1e-14, "{f:?}: {left:?}");
                assert!((dot(&right[k], &right[l]) - unit).abs() < 1e-14, "{right:?}");
            }
            for i in 0..D {
                let sum: f64 = (0..R).map(|m| values[m] * left[m][i] * right[m][k]).sum();
                assert!((sum - f[k][i]).abs() < 1e-14 * size, "{f:?}");
            }
        }
        if D == R {
            let sign = square_determinant(&left) * square_determinant(&right);
            assert!((sign - 1.0).abs() < 1e-14, "{f:?}");
        }
    }

    fn matrix() -> impl Strategy<Value = [[f64; 3]; 3]> {
        prop::array::uniform3(prop::array::uniform3(-2.0..2.0))
    }

    proptest! {
        #[test]
        fn every_matrix_is_two_rotations_and_stretches(f in matrix()) {
            assert_decomposes(&f, 6.0);
            assert_decomposes(&[[f[0][0], f[0][1]], [f[1][0], f[1][1]]], 6.0);
            let membrane: [[f64; 3]; 2] = [f[0], f[1]];
            assert_decomposes(&membrane, 6.0);
            assert_decomposes(&[f[2]], 6.0);
        }

        #[test]
        fn symmetric_matrices_have_their_eigenvalues(f in matrix()) {
            let s = crate::tensor::gram(&f);
            let shifted = crate::tensor::shifted(s, -3.0);
            let (values, vectors) = symmetric_eigen(&shifted);
            let again = spectral(&vectors, &values);
            for k in 0..3 {
                for i in 0..3 {
                    prop_assert!((again[k][i] - shifted[k][i]).abs() < 1e-13);
                }
            }
        }
    }

    #[test]
    fn degenerate_matrices_have_frames_too() {
        assert_decomposes(&[[0.0; 3]; 3], 1.0);
        assert_decomposes(&[[1.0, 0.0, 0.0], [0.0; 3], [0.0; 3]], 1.0);
        assert_decomposes(&[[1.0, 2.0, 3.0], [2.0, 4.0, 6.0], [0.5, 0.0, 1.0]], 10.0);
        assert_decomposes(&[[0.0; 3]; 2], 1.0);
        let inside_out = singular(&[[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -0.5]]);
        assert_eq!(inside_out.values, [2.0, 1.0, -0.5]);
        assert_eq!(inside_out.rotation(), identity());
        assert!(singular(&[[f64::NAN, 0.0], [0.0, 1.0]]).values[0].is_nan());
    }
}
