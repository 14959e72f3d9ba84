//! Elimination with row exchanges for a full matrix that is not symmetric.
//!
//! ```text
//! P A = L U
//! ```
//! `A` n x n by columns, factored in place; `P` a permutation of the rows. The memory is taken once.
//! From 64 unknowns on, and with the feature `sparse`, the blocked elimination of faer takes over.

use nalgebra::{DMatrix, DVector, DVectorViewMut};

use crate::Unsolvable;
use crate::equation::{nan_where_not_finite, power_of_two};
use crate::pivots::{SUSPICIOUS, zero_pivot};

/// Rows whose largest entries lie further apart than this are brought to one size.
const UNLIKE: f64 = 1e6;
/// Units of rounding of each column that an elimination may leave of zero.
const ROUNDINGS: f64 = 16.0;

/// A matrix, or its factors once [`DenseLu::factor`] was called.
#[derive(Clone, Debug)]
pub struct DenseLu {
    matrix: DMatrix<f64>,
    scales: Vec<f64>,
    /// The power of two by which each column was divided, so that no product leaves the range of numbers.
    units: Vec<f64>,
    /// The power of two by which each row was divided, where rows are of very unlike sizes.
    rows: Vec<f64>,
    exchanges: Vec<usize>,
    #[cfg(feature = "sparse")]
    blocked: Option<crate::sparse::BlockedLu>,
}

impl DenseLu {
    /// Memory for `n` unknowns.
    pub fn new(n: usize) -> Self {
        DenseLu {
            matrix: DMatrix::zeros(n, n),
            scales: vec![0.0; n],
            units: vec![1.0; n],
            rows: vec![1.0; n],
            exchanges: vec![0; n],
            #[cfg(feature = "sparse")]
            blocked: (n >= 64).then(|| crate::sparse::BlockedLu::new(n).ok()).flatten(),
        }
    }

    /// The number of unknowns.
    pub fn dim(&self) -> usize {
        self.scales.len()
    }

    /// The matrix by columns, to be written before it is factored.
    pub fn matrix(&mut self) -> &mut [f64] {
        self.matrix.as_mut_slice()
    }

    /// Replaces the matrix by its factors.
    ///
    /// # Errors
    /// Where a pivot vanishes next to its column, or a number is not finite.
    pub fn factor(&mut self) -> Result<(), Unsolvable> {
        self.balance_rows();
        for (scale, column) in self.scales.iter_mut().zip(self.matrix.column_iter()) {
            *scale = column.amax();
        }
        if !self.matrix.iter().all(|entry| entry.is_finite()) {
            return Err(Unsolvable::NonFinite);
        }
        for (j, (scale, unit)) in self.scales.iter_mut().zip(&mut self.units).enumerate() {
            *unit = power_of_two(*scale);
            if *unit != 1.0 {
                *scale /= *unit;
                self.matrix.column_mut(j).unscale_mut(*unit);
            }
        }
        self.eliminate();
        let zero = zero_pivot(self.scales.len());
        let mut pivots = self.scales.iter().enumerate();
        if !pivots.all(|(j, scale)| self.matrix[(j, j)].abs() > zero * scale) {
            return Err(Unsolvable::Singular);
        }
        let is_suspicious = |&j: &usize| self.matrix[(j, j)].abs() < SUSPICIOUS * self.scales[j];
        let mut suspicious = (0..self.scales.len()).rev().filter(is_suspicious);
        if suspicious.any(|j| self.is_rounding(j)) { Err(Unsolvable::Singular) } else { Ok(()) }
    }

    /// Divides rows by their sizes where these lie far apart: the largest of a column is no good pivot in a row
    /// beside whose other entries it is nothing.
    fn balance_rows(&mut self) {
        self.rows.fill(0.0);
        for column in self.matrix.column_iter() {
            for (largest, entry) in self.rows.iter_mut().zip(&column) {
                *largest = largest.max(entry.abs());
            }
        }
        let sizes = || self.rows.iter().filter(|size| **size > 0.0);
        let (least, most) =
            (sizes().fold(f64::MAX, |a, &b| a.min(b)), sizes().fold(0.0, |a, &b| b.max(a)));
        if !(most > UNLIKE * least && most.is_finite()) {
            return self.rows.fill(1.0);
        }
        for (row, size) in self.rows.iter_mut().enumerate() {
            *size = if *size > 0.0 {
                2.0_f64.powi(size.log2().floor().max(-1022.0) as i32)
            } else {
                1.0
            };
            self.matrix.row_mut(row).unscale_mut(*size);
        }
    }

    /// Whether pivot j, small beside its column, is what rounding leaves of zero: the vector v of the
    /// columns before it with `v_j = 1`, and `U v` but for the pivot zero, has an `A v` of no more than
    /// rounding makes of its terms.
    #[cold]
    fn is_rounding(&self, j: usize) -> bool {
        let mut v = DVector::zeros(j + 1);
        v[j] = 1.0;
        for i in (0..j).rev() {
            let sum: f64 = (i + 1..=j).map(|k| self.matrix[(i, k)] * v[k]).sum();
            v[i] = -sum / self.matrix[(i, i)];
        }
        let term = |(v, scale): (&f64, &f64)| (v * (scale / self.scales[j])).powi(2);
        let terms: f64 = v.iter().zip(&self.scales).map(term).sum();
        let pivot = self.matrix[(j, j)].abs() / self.scales[j];
        let is_regular = pivot > ROUNDINGS * f64::EPSILON * terms.sqrt();
        !is_regular
    }

    fn eliminate(&mut self) {
        #[cfg(feature = "sparse")]
        if let Some(blocked) = &mut self.blocked {
            return blocked.eliminate(self.matrix.as_mut_slice());
        }
        for j in 0..self.exchanges.len() {
            let k = j + self.matrix.view_range(j.., j).icamax();
            let pivot = self.matrix[(k, j)];
            self.exchanges[j] = k;
            if pivot == 0.0 {
                continue;
            }
            if k == j {
                nalgebra::linalg::gauss_step(&mut self.matrix, pivot, j);
            } else {
                self.matrix.columns_range_mut(..j).swap_rows(j, k);
                nalgebra::linalg::gauss_step_swap(&mut self.matrix, pivot, j, k);
            }
        }
    }

    /// Replaces `b` by `A^-1 b`, once the matrix was factored; by NaN where a component of that is too large for a
    /// number, or is none.
    pub fn solve(&mut self, b: &mut [f64]) {
        if b.is_empty() {
            return;
        }
        b.iter_mut().zip(&self.rows).for_each(|(x, row)| *x /= row);
        let load = power_of_two(b.iter().fold(0.0_f64, |largest, x| largest.max(x.abs())));
        if load != 1.0 {
            b.iter_mut().for_each(|x| *x /= load);
        }
        self.substitute(b);
        for (x, &unit) in b.iter_mut().zip(&self.units) {
            // Of two powers that both make it larger or smaller the quotient may leave the range of numbers.
            *x = if (load > 1.0) == (unit > 1.0) { *x * (load / unit) } else { *x * load / unit };
        }
        nan_where_not_finite(b);
    }

    fn substitute(&mut self, b: &mut [f64]) {
        #[cfg(feature = "sparse")]
        if let Some(blocked) = &mut self.blocked {
            return blocked.solve(self.matrix.as_slice(), b);
        }
        for (j, &k) in self.exchanges.iter().enumerate() {
            b.swap(j, k);
        }
        let mut b = DVectorViewMut::from_slice(b, self.exchanges.len());
        self.matrix.solve_lower_triangular_with_diag_mut(&mut b, 1.0);
        self.matrix.solve_upper_triangular_mut(&mut b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pseudo_random(n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |i, j| ((i * 7919 + 1) * (j * 104_729 + 13) % 9973) as f64 / 9973.0)
    }

    #[test]
    fn the_solution_solves_the_system_at_every_size() {
        for n in [1, 2, 3, 10, 63, 64, 200] {
            let a = pseudo_random(n);
            let exact = DVector::from_fn(n, |i, _| (i as f64).cos());
            let mut b = &a * &exact;
            let mut lu = DenseLu::new(n);
            for _ in 0..2 {
                lu.matrix().copy_from_slice(a.as_slice());
                lu.factor().unwrap();
            }
            lu.solve(b.as_mut_slice());
            assert!((&b - &exact).amax() < 1e-9, "{n}: {}", (b - exact).amax());
        }
    }

    #[test]
    fn rows_of_unlike_sizes_are_solved() {
        for far in [1e3, 1e6, 1e12, 1e17, 1e60] {
            let mut lu = DenseLu::new(2);
            lu.matrix().copy_from_slice(&[1.0, 1.0, far, 1.0]);
            lu.factor().unwrap();
            let mut b = [1.0 + far, 2.0];
            lu.solve(&mut b);
            assert!((b[0] - 1.0).abs() < 1e-15 && (b[1] - 1.0).abs() < 1e-15, "{far}: {b:?}");
        }
    }

    #[test]
    fn entries_of_any_size_are_solved() {
        let cases = [
            (3, 1e-290, 1.0),
            (3, 1e290, 1.0),
            (64, 1e-290, 1.0),
            (64, 1e290, 1.0),
            (64, 1e281, 1e25),
            (64, 1e-281, 1e-10),
        ];
        for (n, scale, size) in cases {
            let a = pseudo_random(n) * scale;
            let exact = DVector::from_fn(n, |i, _| size * (i as f64).cos());
            let mut b = &a * &exact;
            let mut lu = DenseLu::new(n);
            lu.matrix().copy_from_slice(a.as_slice());
            lu.factor().unwrap();
            lu.solve(b.as_mut_slice());
            let off = (&b - &exact).amax();
            assert!(off < 1e-9 * size, "{n} {scale} {size}: {off}");
        }
    }

    #[test]
    fn columns_that_differ_by_more_than_the_range_of_numbers_are_solved_or_the_solution_is_nan() {
        let mut lu = DenseLu::new(2);
        lu.matrix().copy_from_slice(&[0.0, 1.5e308, 3e-16, 0.0]);
        lu.factor().unwrap();
        let mut b = [1.0, 1.0];
        lu.solve(&mut b);
        assert_eq!(b, [1.0 / 1.5e308, 1.0 / 3e-16]);
        let mut too_large = [1e300, 1.0];
        lu.solve(&mut too_large);
        assert!(too_large.iter().all(|x| x.is_nan()), "{too_large:?}");
    }

    #[test]
    fn zero_on_the_diagonal_is_no_obstacle() {
        let mut lu = DenseLu::new(2);
        lu.matrix().copy_from_slice(&[0.0, 2.0, 3.0, 0.0]);
        lu.factor().unwrap();
        let mut b = [6.0, 4.0];
        lu.solve(&mut b);
        assert_eq!(b, [2.0, 2.0]);
    }

    #[test]
    fn singular_matrices_and_numbers_that_are_not_finite_are_refused() {
        for n in [3, 100] {
            let mut a = pseudo_random(n);
            let twice = a.column(0) * 0.3 + a.column(1) * 0.7;
            a.set_column(2, &twice);
            let mut lu = DenseLu::new(n);
            lu.matrix().copy_from_slice(a.as_slice());
            if n == 3 {
                assert_eq!(lu.factor(), Err(Unsolvable::Singular));
            }
            lu.matrix().fill(0.0);
            assert_eq!(lu.factor(), Err(Unsolvable::Singular));
            a[(1, 2)] = f64::NAN;
            lu.matrix().copy_from_slice(a.as_slice());
            assert_eq!(lu.factor(), Err(Unsolvable::NonFinite));
        }
    }

    /// A Gram matrix of six vectors that span four dimensions, of whole numbers.
    fn gram(k: i32) -> DMatrix<f64> {
        let v = DMatrix::from_fn(6, 4, |i, j| {
            f64::from((7 * k + 5 * i as i32 * (j as i32 + k) + 3 * j as i32 * k) % 7 - 3)
        });
        &v * v.transpose()
    }

    #[test]
    fn a_singular_matrix_is_refused_where_elimination_magnifies_rounding() {
        for k in 0..200 {
            let mut lu = DenseLu::new(6);
            lu.matrix().copy_from_slice(gram(k).as_slice());
            assert_eq!(lu.factor(), Err(Unsolvable::Singular), "{k}");
        }
    }

    #[test]
    fn a_matrix_without_unknowns_is_factored_and_solved() {
        let mut lu = DenseLu::new(0);
        lu.factor().unwrap();
        lu.solve(&mut []);
    }

    #[test]
    fn rounding_is_found_whatever_is_eliminated_after_it() {
        for k in 0..200 {
            // The last two unknowns are regular, though their last pivot is suspicious as well.
            let mut a = DMatrix::zeros(8, 8);
            a.view_mut((0, 0), (6, 6)).copy_from(&gram(k));
            a.view_mut((6, 6), (2, 2)).fill(1.0);
            a[(7, 7)] += 1e-9;
            let mut lu = DenseLu::new(8);
            lu.matrix().copy_from_slice(a.as_slice());
            assert_eq!(lu.factor(), Err(Unsolvable::Singular), "{k}");
            a.view_mut((0, 0), (6, 6)).fill_with_identity();
            lu.matrix().copy_from_slice(a.as_slice());
            assert_eq!(lu.factor(), Ok(()));
        }
    }
}
