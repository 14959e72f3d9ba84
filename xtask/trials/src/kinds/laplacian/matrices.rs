//! The referee's own matrices: gradients of hats from a QR factorization of a simplex's edges.
//!
//! ```text
//! E = Q R   (D x K-1),   |s| = |det R| / (K-1)!,   grad_i . grad_j = (R^-1 R^-T)_ij,   W = |s| grad . grad
//! ```

use nalgebra::{DMatrix, DVector};

use super::shapes::Shape;

/// The Dirichlet energy's matrix and the two masses, on all vertices.
pub struct Matrices {
    pub stiffness: DMatrix<f64>,
    pub lumped: DMatrix<f64>,
    pub galerkin: DMatrix<f64>,
    /// The size of the smallest simplex against that of a regular one with its longest edge.
    pub shape: f64,
}

impl Matrices {
    pub fn of<const K: usize>(shape: &Shape<K>) -> Self {
        let n = shape.vertices.len();
        let zero = || DMatrix::zeros(n, n);
        let mut sums =
            Matrices { stiffness: zero(), lumped: zero(), galerkin: zero(), shape: f64::INFINITY };
        for simplex in &shape.simplices {
            let corner = |k: usize| shape.vertices[simplex[k]];
            let edges = DMatrix::from_fn(3, K - 1, |c, k| (corner(k + 1) - corner(0))[c]);
            let longest = edges.column_iter().map(|e| e.norm()).fold(0.0, f64::max);
            let r = edges.qr().r();
            let product: f64 = r.diagonal().iter().product();
            let size = product.abs() / [1.0, 1.0, 2.0, 6.0][K - 1];
            let flat = longest == 0.0;
            let part = if flat { 0.0 } else { product.abs() / longest.powi(K as i32 - 1) };
            sums.shape = sums.shape.min(part);
            let inverse =
                r.try_inverse().unwrap_or_else(|| DMatrix::from_element(K - 1, K - 1, f64::NAN));
            let dots = &inverse * inverse.transpose();
            let dot = |i: usize, j: usize| match (i, j) {
                (0, 0) => dots.sum(),
                (0, k) | (k, 0) => -dots.row(k - 1).sum(),
                (i, j) => dots[(i - 1, j - 1)],
            };
            for i in 0..K {
                sums.lumped[(simplex[i], simplex[i])] += size / K as f64;
                for j in 0..K {
                    let place = (simplex[i], simplex[j]);
                    sums.stiffness[place] += size * dot(i, j);
                    let share = if i == j { 2.0 } else { 1.0 };
                    sums.galerkin[place] += share * size / (K * (K + 1)) as f64;
                }
            }
        }
        sums
    }
}

/// The rows and columns of a matrix that are named.
pub fn part(matrix: &DMatrix<f64>, rows: &[usize], columns: &[usize]) -> DMatrix<f64> {
    DMatrix::from_fn(rows.len(), columns.len(), |i, j| matrix[(rows[i], columns[j])])
}

/// The solution of a positive definite system, and the condition number of the matrix once its
/// diagonal is scaled to one.
pub fn solve(matrix: &DMatrix<f64>, right: &DVector<f64>) -> (DVector<f64>, f64) {
    let scale = matrix.diagonal().map(|d| d.sqrt().recip());
    let scaled = DMatrix::from_fn(right.len(), right.len(), |i, j| {
        0.5 * (matrix[(i, j)] + matrix[(j, i)]) * scale[i] * scale[j]
    });
    let eigen = scaled.symmetric_eigen();
    let values = eigen.eigenvalues.iter().copied();
    let (low, high) = values.fold((f64::INFINITY, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
    let coefficients = eigen.eigenvectors.transpose() * right.component_mul(&scale);
    let solved = &eigen.eigenvectors * coefficients.component_div(&eigen.eigenvalues);
    (solved.component_mul(&scale), if low > 0.0 { high / low } else { f64::INFINITY })
}
