//! Tall matrices of a few columns, and inner products in the mass.
//!
//! ```text
//! <x, y>_M = x^T M y
//! ```
//! Columns of n numbers one after the other. Sums run in a fixed order.

use faer::linalg::matmul::matmul;
use faer::{Accum, MatMut, MatRef, Par};
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use stationary_calculus::{EigenError, SymmetricMatrix};

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

/// `A X`, column by column.
pub(crate) fn times(matrix: &SymmetricMatrix, x: &[f64]) -> Vec<f64> {
    let n = matrix.dim();
    let mut y = vec![0.0; x.len()];
    for (x, y) in x.chunks_exact(n.max(1)).zip(y.chunks_exact_mut(n.max(1))) {
        // Both have the matrix's size: there is no error to come.
        let _ = matrix.add_product(1.0, x, y);
    }
    y
}

/// `|x|^T |A| |x|`: the terms of `x^T A x` without their signs.
pub(crate) fn sum_of_sizes(matrix: &SymmetricMatrix, x: &[f64]) -> f64 {
    let mut sum = 0.0;
    for (j, ends) in matrix.column_starts().windows(2).enumerate() {
        for k in ends[0] as usize..ends[1] as usize {
            let i = matrix.rows()[k] as usize;
            let entry = (matrix.values()[k] * x[i] * x[j]).abs();
            sum += if i == j { entry } else { 2.0 * entry };
        }
    }
    sum
}

/// Eigenvalues, ascending, and orthonormal eigenvectors of a small symmetric matrix.
pub(crate) struct Pairs {
    pub(crate) eigenvalues: DVector<f64>,
    pub(crate) eigenvectors: DMatrix<f64>,
}

/// Rotations for an eigenvalue before the iteration is given up.
const ROTATIONS: usize = 100;

/// The eigenpairs of a small symmetric matrix.
///
/// # Errors
/// [`EigenError::NotFinite`] and [`EigenError::NotConverged`]: on what is no number the iteration
/// would not end.
pub(crate) fn eigenpairs(matrix: DMatrix<f64>) -> Result<Pairs, EigenError> {
    let n = matrix.nrows();
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return Err(EigenError::NotFinite { which: "the form" });
    }
    if n == 0 {
        return Ok(Pairs { eigenvalues: DVector::zeros(0), eigenvectors: matrix });
    }
    let pairs = SymmetricEigen::try_new(matrix, f64::EPSILON, ROTATIONS * n)
        .ok_or(EigenError::NotConverged)?;
    let mut order: Vec<usize> = (0..n).collect();
    order.sort_by(|&i, &j| pairs.eigenvalues[i].total_cmp(&pairs.eigenvalues[j]));
    Ok(Pairs {
        eigenvalues: DVector::from_iterator(n, order.iter().map(|&i| pairs.eigenvalues[i])),
        eigenvectors: pairs.eigenvectors.select_columns(&order),
    })
}

/// The largest of some numbers, zero at least; NaN where one is.
pub(crate) fn largest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |largest: f64, x| if largest.is_nan() || x <= largest { largest } else { x })
}

/// Whether a number is above a limit, or none.
pub(crate) fn exceeds(x: f64, limit: f64) -> bool {
    x > limit || x.is_nan()
}

/// How far the products of these columns in the mass are from one and zero; NaN where one is.
pub(crate) fn skewness(mass: &SymmetricMatrix, columns: &[f64]) -> f64 {
    let n = mass.dim().max(1);
    let count = columns.len() / n;
    let products = transpose_times(n, columns, &times(mass, columns));
    let off = products.iter().enumerate().map(|(k, product)| {
        let exact = if k / count == k % count { 1.0 } else { 0.0 };
        (product - exact).abs()
    });
    largest(off)
}

/// Vectors that are orthonormal in the mass, one after the other, and their products with it.
#[derive(Clone, Debug)]
pub(crate) struct Basis {
    n: usize,
    vectors: Vec<f64>,
    moved: Vec<f64>,
}

impl Basis {
    /// None yet, and memory for so many.
    pub(crate) fn with_room(n: usize, room: usize) -> Self {
        Basis { n, vectors: Vec::with_capacity(n * room), moved: Vec::with_capacity(n * room) }
    }

    /// Forgets them and keeps the memory.
    pub(crate) fn clear(&mut self) {
        self.vectors.clear();
        self.moved.clear();
    }

    /// Of vectors that are orthonormal already.
    pub(crate) fn of(mass: &SymmetricMatrix, vectors: &[f64]) -> Self {
        let moved = times(mass, vectors);
        Basis { n: mass.dim(), vectors: vectors.to_vec(), moved }
    }

    pub(crate) fn len(&self) -> usize {
        self.vectors.len().checked_div(self.n).unwrap_or(0)
    }

    pub(crate) fn vectors(&self) -> &[f64] {
        &self.vectors
    }

    pub(crate) fn moved(&self) -> &[f64] {
        &self.moved
    }

    pub(crate) fn append(&mut self, other: &Basis) {
        self.vectors.extend_from_slice(&other.vectors);
        self.moved.extend_from_slice(&other.moved);
    }

    /// Appends `x / length` where `length` is that of x in the mass and `moved` its product with it.
    pub(crate) fn push(&mut self, x: &[f64], moved: &[f64], length: f64) {
        self.vectors.extend(x.iter().map(|x| x / length));
        self.moved.extend(moved.iter().map(|x| x / length));
    }

    /// Appends what a column has beside these vectors, made of length 1, where that is more than this
    /// share of it; the column's parts along them, and the length of what was left.
    pub(crate) fn push_independent(
        &mut self,
        mass: &SymmetricMatrix,
        column: &[f64],
        independent: f64,
    ) -> (Vec<f64>, Option<f64>) {
        let mut x = column.to_vec();
        let shares = self.project_out(0, &mut x);
        let moved = times(mass, &x);
        let after = length(&x, &moved);
        // The column's own length, of which the shares and the rest are orthogonal parts.
        let before = dot(&shares, &shares).sqrt().hypot(after);
        let is_independent = after > independent * before;
        if is_independent {
            self.push(&x, &moved, after);
        }
        (shares, is_independent.then_some(after))
    }

    /// Combinations of the vectors: one for each column of `weights`.
    pub(crate) fn combined(&self, weights: &[f64]) -> Self {
        let mut vectors = vec![0.0; self.n * (weights.len() / self.len().max(1))];
        let mut moved = vectors.clone();
        add_product(self.n, &mut vectors, 1.0, &self.vectors, weights);
        add_product(self.n, &mut moved, 1.0, &self.moved, weights);
        Basis { n: self.n, vectors, moved }
    }

    /// Takes out of the columns of `x` what they have of these vectors, and returns how much that
    /// was: a number for each vector, column by column. Of those before `coupled` they have no more
    /// than rounding.
    pub(crate) fn project_out(&self, coupled: usize, x: &mut [f64]) -> Vec<f64> {
        let mut total = vec![0.0; self.len() * x.len().checked_div(self.n).unwrap_or(0)];
        // Twice is enough: the second time takes what rounding left.
        for from in [coupled, 0] {
            let (vectors, moved) = (&self.vectors[from * self.n..], &self.moved[from * self.n..]);
            if vectors.is_empty() {
                continue;
            }
            let share = transpose_times(self.n, moved, x);
            add_product(self.n, x, -1.0, vectors, &share);
            let columns = total.chunks_exact_mut(self.len());
            for (total, share) in columns.zip(share.chunks_exact(self.len() - from)) {
                add_scaled(&mut total[from..], 1.0, share);
            }
        }
        total
    }
}

/// The length of x in the mass, from x and its product with it.
pub(crate) fn length(x: &[f64], moved: &[f64]) -> f64 {
    dot(x, moved).max(0.0).sqrt()
}

/// The columns made orthonormal in the mass, without those that are combinations of others up to a
/// share of their length.
pub(crate) fn orthonormal(mass: &SymmetricMatrix, columns: &[f64], independent: f64) -> Vec<f64> {
    let n = mass.dim();
    let mut basis = Basis::with_room(n, columns.len().checked_div(n).unwrap_or(0));
    for column in columns.chunks_exact(n.max(1)) {
        basis.push_independent(mass, column, independent);
    }
    basis.vectors
}
