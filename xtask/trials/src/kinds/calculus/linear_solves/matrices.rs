//! Definite, indefinite and singular matrices: whole numbers of small rank, or products with prescribed
//! factors.

use nalgebra::{DMatrix, DVector};

use crate::Draw;

/// Q D Q^T with a prescribed condition, or a grid, or a diagonal.
pub(super) fn definite(draw: &mut Draw, n: usize) -> DMatrix<f64> {
    match draw.below(4) {
        0 => {
            let spread = draw.log_uniform(1.0, 1e9);
            let diagonal: Vec<f64> = (0..n).map(|_| draw.log_uniform(1.0, spread)).collect();
            DMatrix::from_diagonal(&DVector::from_vec(diagonal))
        }
        1 => chain(n, 1.0),
        _ => {
            let spread = draw.one_of(&[1.0, 1e3, 1e9]);
            let values: Vec<f64> = (0..n).map(|_| draw.log_uniform(1.0, spread)).collect();
            turned(draw, &values)
        }
    }
}

/// Springs in a row, the first to a wall of stiffness `ground`.
fn chain(n: usize, ground: f64) -> DMatrix<f64> {
    DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
        0 if i + 1 == n => {
            if i == 0 {
                ground
            } else {
                1.0
            }
        }
        0 if i == 0 => 1.0 + ground,
        0 => 2.0,
        1 => -1.0,
        _ => 0.0,
    })
}

/// A symmetric matrix with these eigenvalues: Householder reflections of their diagonal.
fn turned(draw: &mut Draw, values: &[f64]) -> DMatrix<f64> {
    let n = values.len();
    let mut a = DMatrix::from_diagonal(&DVector::from_column_slice(values));
    for _ in 0..3 {
        let mut u = DVector::from_vec(draw.vector(n));
        let length = u.norm();
        if length > 0.0 {
            u /= length;
            let reflection = DMatrix::identity(n, n) - &u * u.transpose() * 2.0;
            a = &reflection * a * &reflection;
        }
    }
    DMatrix::from_fn(n, n, |i, j| a[(i.max(j), i.min(j))])
}

pub(super) fn indefinite(draw: &mut Draw, n: usize) -> DMatrix<f64> {
    match draw.below(4) {
        // [K B^T; B 0] with small whole numbers; B of full rank.
        0 if n >= 2 => {
            let m = draw.between(1, n / 2);
            let mut a = DMatrix::zeros(n, n);
            for i in 0..n - m {
                a[(i, i)] = 1.0 + draw.below(4) as f64;
            }
            for k in 0..m {
                let (row, column) = (n - m + k, k);
                for j in column..n - m {
                    let entry = if j == column { 1.0 } else { draw.between(0, 2) as f64 - 1.0 };
                    a[(row, j)] = entry;
                    a[(j, row)] = entry;
                }
            }
            a
        }
        // Zero diagonal: pairs of freedoms exchanged.
        1 if n >= 2 && n.is_multiple_of(2) => DMatrix::from_fn(n, n, |i, j| {
            if i / 2 == j / 2 && i != j { 1.0 + (i / 2) as f64 } else { 0.0 }
        }),
        _ => {
            let spread = draw.one_of(&[1.0, 1e3, 1e6]);
            let mut values: Vec<f64> = (0..n)
                .map(|_| {
                    let size = draw.log_uniform(1.0, spread);
                    if draw.chance(0.5) { -size } else { size }
                })
                .collect();
            values[0] = -values[0].abs();
            turned(draw, &values)
        }
    }
}

/// Whole numbers of less than full rank: every sum below is exact.
pub(super) fn singular(draw: &mut Draw, n: usize) -> DMatrix<f64> {
    match draw.below(3) {
        0 => chain(n, 0.0),
        1 => {
            // A zero freedom among others.
            let mut a = chain(n, 1.0);
            let k = draw.below(n);
            a.row_mut(k).fill(0.0);
            a.column_mut(k).fill(0.0);
            a
        }
        _ => {
            let rank = draw.below(n);
            let mut a = DMatrix::zeros(n, n);
            for _ in 0..rank {
                let v = DVector::from_fn(n, |_, _| draw.between(0, 6) as f64 - 3.0);
                let sign = if draw.chance(0.3) { -1.0 } else { 1.0 };
                a += &v * v.transpose() * sign;
            }
            a
        }
    }
}
