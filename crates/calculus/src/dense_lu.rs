//! Elimination with row exchanges for a full matrix that is not symmetric.
//!
//! ```text
//! P A = L U
//! ```
//! `A` n x n by columns, factored in place; `P` a permutation of the rows. The memory is taken once.
//! From 64 unknowns on, and with the feature `sparse`, the blocked elimination of faer takes over.

use nalgebra::{DMatrix, DVectorViewMut};

use crate::Unsolvable;
use crate::hessian_solver::zero_pivot;

/// A matrix, or its factors once [`DenseLu::factor`] was called.
#[derive(Clone, Debug)]
pub struct DenseLu {
    matrix: DMatrix<f64>,
    scales: Vec<f64>,
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
    /// Where a pivot vanishes next to its column, or a number of the matrix or its factors is not
    /// finite.
    pub fn factor(&mut self) -> Result<(), Unsolvable> {
        for (scale, column) in self.scales.iter_mut().zip(self.matrix.column_iter()) {
            *scale = column.amax();
        }
        if !self.matrix.iter().all(|entry| entry.is_finite()) {
            return Err(Unsolvable::NonFinite);
        }
        self.eliminate();
        if !self.matrix.iter().all(|entry| entry.is_finite()) {
            return Err(Unsolvable::NonFinite);
        }
        let zero = zero_pivot(self.scales.len());
        let mut pivots = self.scales.iter().enumerate();
        if pivots.all(|(j, scale)| self.matrix[(j, j)].abs() > zero * scale) {
            Ok(())
        } else {
            Err(Unsolvable::Singular)
        }
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

    /// Replaces `b` by `A^-1 b`, once the matrix was factored.
    pub fn solve(&mut self, b: &mut [f64]) {
        if b.is_empty() {
            return;
        }
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
    use nalgebra::DVector;

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

    #[test]
    fn factors_beyond_the_range_of_doubles_are_refused() {
        let mut lu = DenseLu::new(2);
        lu.matrix().copy_from_slice(&[1.0, -1.0, f64::MAX, f64::MAX]);
        assert_eq!(lu.factor(), Err(Unsolvable::NonFinite));
    }

    #[test]
    fn a_matrix_without_unknowns_is_factored_and_solved() {
        let mut lu = DenseLu::new(0);
        lu.factor().unwrap();
        lu.solve(&mut []);
    }
}
