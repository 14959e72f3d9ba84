//! Tall matrices of a few columns, and inner products in the mass.
//!
//! ```text
//! <x, y>_M = x^T M y
//! ```
//! Columns of n numbers one after the other. Sums run in a fixed order.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use stationary_calculus::SymmetricMatrix;

pub(crate) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

pub(crate) fn add_scaled(y: &mut [f64], scale: f64, x: &[f64]) {
    y.iter_mut().zip(x).for_each(|(y, x)| *y += scale * x);
}

/// `A^T B` of an n x k and an n x m matrix: k x m, by columns.
pub(crate) fn transpose_times(n: usize, a: &[f64], b: &[f64]) -> Vec<f64> {
    let (k, m) = (a.len() / n, b.len() / n);
    let mut product = vec![0.0; k * m];
    matmul(
        MatMut::from_column_major_slice_mut(&mut product, k, m),
        Accum::Replace,
        MatRef::from_column_major_slice(a, n, k).transpose(),
        MatRef::from_column_major_slice(b, n, m),
        1.0,
        Par::Seq,
    );
    product
}

/// `C += scale A B` for A n x k and B k x m.
pub(crate) fn add_product(n: usize, c: &mut [f64], scale: f64, a: &[f64], b: &[f64]) {
    let (k, m) = (a.len() / n, c.len() / n);
    matmul(
        MatMut::from_column_major_slice_mut(c, n, m),
        Accum::Add,
        MatRef::from_column_major_slice(a, n, k),
        MatRef::from_column_major_slice(b, k, m),
        scale,
        Par::Seq,
    );
}

/// `M X`, column by column.
pub(crate) fn mass_times(mass: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
    let n = mass.dim();
    let mut y = vec![0.0; x.len()];
    for (x, y) in x.chunks_exact(n).zip(y.chunks_exact_mut(n)) {
        // Both have the matrix's size: there is no error to come.
        let _ = mass.add_product(1.0, x, y);
    }
    y
}

/// Takes out of the columns of `x` what they have of those of `v`, which are orthonormal in the
/// mass, and returns how much that was: k x m.
pub(crate) fn project_out(mass: &SymmetricMatrix, v: &[f64], x: &mut [f64]) -> Vec<f64> {
    let n = mass.dim();
    let mut total = vec![0.0; v.len() / n * (x.len() / n)];
    if v.is_empty() {
        return total;
    }
    // Twice is enough: the second time takes what rounding left.
    for _ in 0..2 {
        let share = transpose_times(n, v, &mass_times(mass, x));
        add_product(n, x, -1.0, v, &share);
        add_scaled(&mut total, 1.0, &share);
    }
    total
}

/// The columns made orthonormal in the mass, without those that are combinations of others up to a
/// share of their length.
pub(crate) fn orthonormal(mass: &SymmetricMatrix, columns: &[f64], independent: f64) -> Vec<f64> {
    let n = mass.dim();
    let length = |x: &[f64]| dot(x, &mass_times(mass, x)).max(0.0).sqrt();
    let mut basis = Vec::new();
    for column in columns.chunks_exact(n.max(1)) {
        let mut x = column.to_vec();
        let before = length(&x);
        project_out(mass, &basis, &mut x);
        let after = length(&x);
        if after > independent * before {
            basis.extend(x.iter().map(|x| x / after));
        }
    }
    basis
}
