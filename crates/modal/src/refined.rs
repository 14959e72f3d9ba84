//! Solutions of `H x = b` beyond the condition of H: the residual with twice the digits.
//!
//! ```text
//! r = b - H x        exact products and sums, rounded once
//! x <- x + H^-1 r    until that no longer grows smaller; the last correction tells how far x is off
//! ```
//! Of stiffnesses 1e10 times the softest, a solution by elimination alone has six digits. Source: Higham,
//! Accuracy and Stability of Numerical Algorithms (2002), chapter 12; Dekker 1971; Knuth.

use stationary_calculus::{SparseCholesky, SymmetricMatrix};

use crate::dense;

/// Corrections before the last one stands for what is missing.
const CORRECTIONS: usize = 4;

/// A solution, and the last correction to it.
pub(crate) struct Refined {
    pub(crate) x: Vec<f64>,
    pub(crate) off: Vec<f64>,
}

/// The solution of `H x = b` with the matrix and its factor.
pub(crate) fn solve(matrix: &SymmetricMatrix, factor: &mut SparseCholesky, b: &[f64]) -> Refined {
    let mut x = b.to_vec();
    factor.solve(&mut x);
    let mut off = x.clone();
    for _ in 0..CORRECTIONS {
        let mut correction = residual(matrix, &x, b);
        factor.solve(&mut correction);
        let (size, before) = (dense::dot(&correction, &correction), dense::dot(&off, &off));
        let falls = size < before;
        if !falls {
            break;
        }
        dense::add_scaled(&mut x, 1.0, &correction);
        off = correction;
        // Smaller than the last digit of the whole: nothing is left to correct.
        if size <= f64::EPSILON * f64::EPSILON * dense::dot(&x, &x) {
            break;
        }
    }
    Refined { x, off }
}

/// `b - A x`, rounded once.
fn residual(matrix: &SymmetricMatrix, x: &[f64], b: &[f64]) -> Vec<f64> {
    let mut sums: Vec<[f64; 2]> = b.iter().map(|b| [*b, 0.0]).collect();
    for (j, ends) in matrix.column_starts().windows(2).enumerate() {
        for k in ends[0] as usize..ends[1] as usize {
            let (i, entry) = (matrix.rows()[k] as usize, matrix.values()[k]);
            subtract(&mut sums[i], entry, x[j]);
            if i != j {
                subtract(&mut sums[j], entry, x[i]);
            }
        }
    }
    sums.into_iter().map(|[sum, rest]| sum + rest).collect()
}

/// Subtracts a product; the second number has what rounding took from the first.
fn subtract([sum, rest]: &mut [f64; 2], a: f64, b: f64) {
    let product = -a * b;
    let of_product = (-a).mul_add(b, -product);
    let total = *sum + product;
    let added = total - *sum;
    let of_sum = (*sum - (total - added)) + (product - added);
    *sum = total;
    *rest += of_product + of_sum;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_solution_has_all_digits_where_the_condition_takes_all_but_six() {
        for k in [1.0, 1e5, 1e10, 1e14] {
            let block = ([0, 1], [1.0 + k, -k, -k, k]);
            let matrix = SymmetricMatrix::from_blocks(2, &[block]).unwrap();
            let mut factor = SparseCholesky::analyse(&matrix).unwrap();
            factor.factor(&matrix).unwrap();
            let Refined { x, off } = solve(&matrix, &mut factor, &[0.0, 1.0]);
            assert!((x[0] - 1.0).abs() < 1e-15 && (x[1] - (1.0 + 1.0 / k)).abs() < 1e-15, "{x:?}");
            assert!(off.iter().all(|off| off.abs() < 1e-4), "{off:?}");
        }
    }
}
