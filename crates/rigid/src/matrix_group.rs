//! The exponential and the logarithm of matrices: every matrix group's, given by its equations.
//!
//! ```text
//! exp(A) = sum_k A^k/k!                                                         (8.2.2)
//! log(M) = 2^k log(M^(1/2^k)),    log(Y) = 2 artanh((Y - I)(Y + I)^-1)           (8.2.3)
//! algebra = { A : dg(I) A = 0 }        of the group { M : g(M) = 0 }            (8.2.1)
//! ```
//! `A M Y` n x n. The logarithm takes square roots, by the product form of Denman and Beavers'
//! iteration, until the matrix is close to I, where the series of artanh converges fast; it is the
//! principal one, whose eigenvalues have imaginary parts within (-pi, pi). A matrix with an
//! eigenvalue on the negative axis (zero included) has none, and is refused: a reflection, half a
//! turn. What a logarithm claims is checked: its exponential gives M back, or there is an error.
//! The notes' power series is not used: it diverges for rotations beyond 60 degrees (errata 8.2.3).
//! Source: Higham, Functions of Matrices, 6.3 and 11.5.

use nalgebra::{DMatrix, SVD};
use stationary_calculus::SizeError;

use crate::RigidError;
use crate::error::check_finite;

/// The exponential of a square matrix.
///
/// # Errors
/// A matrix that is not square or not finite, one so large that no digit would be known, and an
/// exponential that is not finite.
pub fn matrix_exponential(a: &DMatrix<f64>) -> Result<DMatrix<f64>, RigidError> {
    checked(a)?;
    if a.is_empty() {
        return Ok(a.clone());
    }
    let norm = a.lp_norm(1).max(a.amax());
    if norm > LARGEST {
        return Err(RigidError::TooLarge { norm });
    }
    // Halved until its terms fall, and squared as often.
    let halvings = norm.log2().ceil().max(0.0) as i32;
    let mut result = (a * 0.5_f64.powi(halvings)).exp();
    for _ in 0..halvings {
        result = &result * &result;
    }
    check_finite("the exponential", result.as_slice())?;
    Ok(result)
}

/// Beyond this no digit of an exponential is known.
const LARGEST: f64 = 1e15;

/// Most square roots: each halves the logarithm, and no finite matrix needs more.
const ROOTS: i32 = 64;
/// Most iterations for one square root: each takes a factor of four off what is far from 1, the range of numbers has a
/// thousand factors of two to either side, and then they converge quadratically.
const ITERATIONS: usize = 540;
/// Close enough to I, in the Frobenius norm, for the series of artanh.
const CLOSE: f64 = 0.25;
/// Terms of the series: `(1/7)^(2*12)` is below rounding.
const TERMS: i32 = 12;
/// How far the exponential of the logarithm may miss the matrix, relative to it.
const ACCURACY: f64 = 1e-9;

/// The principal logarithm of a square matrix.
///
/// # Errors
/// A matrix that is not square or not finite, and [`RigidError::NoLogarithm`].
pub fn matrix_logarithm(m: &DMatrix<f64>) -> Result<DMatrix<f64>, RigidError> {
    checked(m)?;
    if m.is_empty() {
        return Ok(m.clone());
    }
    let identity = DMatrix::identity(m.nrows(), m.nrows());
    let mut root = m.clone();
    let mut roots = 0;
    while (&root - &identity).norm() > CLOSE {
        if roots == ROOTS {
            return Err(RigidError::NoLogarithm { reason: "its roots do not approach I" });
        }
        root = square_root(&root)?;
        roots += 1;
    }
    let sum = (&root + &identity).lu();
    let z = sum.solve(&(&root - &identity)).ok_or(SINGULAR)?;
    let log = artanh(&z) * 2.0_f64.powi(roots + 1);
    let back = matrix_exponential(&log)?;
    if (back - m).amax() > ACCURACY * m.amax() {
        return Err(RigidError::NoLogarithm { reason: "what was found is not accurate" });
    }
    Ok(log)
}

const SINGULAR: RigidError = RigidError::NoLogarithm { reason: "it is singular" };

/// `z + z^3/3 + z^5/5 + ...`
fn artanh(z: &DMatrix<f64>) -> DMatrix<f64> {
    let square = z * z;
    let identity = DMatrix::identity(z.nrows(), z.nrows());
    let series = (0..TERMS).rev().fold(DMatrix::zeros(z.nrows(), z.nrows()), |sum, k| {
        sum * &square + &identity / f64::from(2 * k + 1)
    });
    series * z
}

/// The inverse by elimination: a determinant, which small matrices have by default, may leave the range of numbers.
fn inverted(m: &DMatrix<f64>) -> Result<DMatrix<f64>, RigidError> {
    m.clone().lu().try_inverse().ok_or(SINGULAR)
}

/// The principal square root: `M <- (I + (M + M^-1)/2)/2`, `X <- X (I + M^-1)/2` from `X = M`.
fn square_root(m: &DMatrix<f64>) -> Result<DMatrix<f64>, RigidError> {
    let identity = DMatrix::identity(m.nrows(), m.nrows());
    let (mut x, mut product) = (m.clone(), m.clone());
    for _ in 0..ITERATIONS {
        let inverse = inverted(&product)?;
        x = &x * (&identity + &inverse) * 0.5;
        product = (&identity + (&product + &inverse) * 0.5) * 0.5;
        if product.iter().any(|entry| !entry.is_finite()) {
            break;
        }
        if (&product - &identity).amax() < 1e-8 {
            // One more step than this squares it below rounding.
            let inverse = inverted(&product)?;
            return Ok(&x * (&identity + &inverse) * 0.5);
        }
    }
    Err(RigidError::NoLogarithm { reason: "an eigenvalue lies on the negative axis" })
}

/// Entries below this part of the largest.
const NEGLIGIBLE: f64 = 1e-100;

/// A basis of the vectors that the m x n matrix `a` maps to zero: the null space's dimension in
/// columns. Singular values below `1e-12` of the largest count as zero.
///
/// # Errors
/// A matrix that is not finite, or whose singular values or vectors were not found.
///
/// Of `dg(I)`, the differential at the identity of a group's equations, it is the Lie algebra.
pub fn null_space(a: &DMatrix<f64>) -> Result<DMatrix<f64>, RigidError> {
    check_finite("the matrix", a.as_slice())?;
    let n = a.ncols();
    let size = a.amax();
    if a.is_empty() || size == 0.0 {
        return Ok(DMatrix::identity(n, n));
    }
    // Entries whose squares are no normal numbers change nothing, and spoil the decomposition.
    let entries = (a / size).map(|x| if x.abs() < NEGLIGIBLE { 0.0 } else { x });
    // Rows of zeros, so that the decomposition is square and shows all n directions.
    let square = entries.resize_vertically(n.max(a.nrows()), 0.0);
    let found = SVD::try_new(square, false, true, f64::EPSILON, 100 * n);
    let svd = found.ok_or(RigidError::NotDecomposed { rows: a.nrows(), columns: n })?;
    let largest = svd.singular_values.max();
    let v = svd.v_t.unwrap_or_else(|| DMatrix::identity(n, n)).transpose();
    let null: Vec<usize> = (0..n).filter(|&i| svd.singular_values[i] <= 1e-12 * largest).collect();
    let basis = v.select_columns(&null);
    check_finite("the basis", basis.as_slice())?;
    Ok(basis)
}

fn checked(m: &DMatrix<f64>) -> Result<(), RigidError> {
    SizeError::check("the matrix's columns", m.nrows(), m.ncols())?;
    check_finite("the matrix", m.as_slice())
}
