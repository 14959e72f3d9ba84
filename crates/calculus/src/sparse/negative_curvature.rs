//! A direction in which a matrix is not positive, or the proof that there is none, by products alone.
//!
//! ```text
//! r_k = p_k(A) r_0,    p_k(x) = (1 - x/theta_1) ... (1 - x/theta_k)        conjugate gradients from a random r_0
//! ```
//! `theta` the Ritz values, positive for as long as every direction has `<A p, p> > 0`. The part of r along an
//! eigenvector of an eigenvalue `<= 0` then never shrinks, `p_k >= 1` there: where the residual becomes small there
//! is no such part, but for a random r_0 without it, of a chance of the part that is left times the root of n. The
//! preconditioner changes no sign. Source: Lanczos (1950); Parlett, The symmetric eigenvalue problem, chapter 12.

use nalgebra::DMatrix;
use stationary_measure::SplitMix64;

use crate::sparse::block_jacobi::BlockJacobi;
use crate::sparse::{SparseError, SymmetricMatrix};

/// A residual of this part of the first one proves that the matrix is definite.
const PROVED: f64 = 1e-8;
/// A curvature of less than this part of its terms has no sign.
const ROUNDING: f64 = 1e-13;

/// A direction in which the matrix is negative; `None` where it is positive definite.
pub(crate) fn negative_curvature(
    matrix: &SymmetricMatrix,
    jacobi: &BlockJacobi,
    iterations: usize,
) -> Result<Option<Vec<f64>>, SparseError> {
    let n = matrix.dim();
    let scale = jacobi.scale();
    let mut random = SplitMix64::new(21);
    let mut r: Vec<f64> = (0..n).map(|_| random.symmetric()).collect();
    let (mut z, mut product, mut terms) = (r.clone(), vec![0.0; n], vec![0.0; n]);
    jacobi.solve(&mut z);
    let mut direction = z.clone();
    let first = dot(&r, &z);
    let (mut square, mut iteration) = (first, 0);
    matrix.sizes_of_product(&vec![1.0; n], &mut terms);
    let widest = terms.iter().fold(0.0, |most: f64, sum| most.max(*sum));
    // NaN goes on to the check of the curvature.
    while square > PROVED * PROVED * first || square.is_nan() {
        product.fill(0.0);
        matrix.add_product_unchecked(scale.recip(), &direction, &mut product);
        let curvature = dot(&direction, &product);
        if !curvature.is_finite() {
            return Err(SparseError::NonFinite);
        }
        // Where no term can be so large the terms need not be summed.
        if curvature <= ROUNDING * widest / scale * dot(&direction, &direction) {
            let sizes: Vec<f64> = direction.iter().map(|p| p.abs()).collect();
            matrix.sizes_of_product(&sizes, &mut terms);
            let rounding = ROUNDING * dot(&sizes, &terms) / scale;
            if curvature < -rounding {
                return Ok(Some(direction));
            }
            if curvature <= rounding {
                return Err(SparseError::Singular);
            }
        }
        if iteration == iterations {
            let relative_residual = (square / first).sqrt();
            return Err(SparseError::NotConverged { iterations, relative_residual });
        }
        iteration += 1;
        let length = square / curvature;
        r.iter_mut().zip(&product).for_each(|(r, y)| *r -= length * y);
        z.copy_from_slice(&r);
        jacobi.solve(&mut z);
        let next = dot(&r, &z);
        direction.iter_mut().zip(&z).for_each(|(p, z)| *p = z + next / square * *p);
        square = next;
    }
    Ok(None)
}

/// The same of the diagonal's block of a vertex, whose freedoms go from `first` to before `end`.
pub(crate) fn negative_in_block(
    matrix: &SymmetricMatrix,
    (first, end): (usize, usize),
) -> Result<Option<Vec<f64>>, SparseError> {
    let mut block = DMatrix::zeros(end - first, end - first);
    for j in first..end {
        for k in matrix.column_starts()[j] as usize..matrix.column_starts()[j + 1] as usize {
            let i = matrix.rows()[k] as usize;
            if i < end {
                block[(i - first, j - first)] = matrix.values()[k];
                block[(j - first, i - first)] = matrix.values()[k];
            }
        }
    }
    let pairs = block.symmetric_eigen();
    let least = pairs.eigenvalues.imin();
    if pairs.eigenvalues[least] < -ROUNDING * pairs.eigenvalues.amax() {
        let mut direction = vec![0.0; matrix.dim()];
        direction[first..end].copy_from_slice(pairs.eigenvectors.column(least).as_slice());
        return Ok(Some(direction));
    }
    Err(SparseError::Singular)
}

fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}
