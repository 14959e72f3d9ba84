//! Cholesky's method on a full matrix, for a few freedoms.
//!
//! ```text
//! L L^T = m M + a d2V(q)                                   (n x n)
//! L L^T = (m + sigma) M + a d2V(q)                         where that is not positive definite
//! ```
//! The rungs and `sigma` are those of [`HessianSolver`].

use crate::equation::solve_in_range;
use crate::hessian_solver::{Diagonal, SHIFTS, largest_or_nan, shift};
use crate::pivots::{SUSPICIOUS, is_rounding, load, zero_pivot};
use crate::{FIXED, HessianSolver, Metric, Potential, Rung, Sink, SizeError, Storage, Unsolvable};

/// Cholesky's method on a full matrix of a few freedoms. Its memory is taken once, by
/// [`DenseSolver::new`]; for `[f64; N]` the compiler knows the length of every loop.
#[derive(Clone, Debug)]
pub struct DenseSolver<C: Storage> {
    /// Columns of the matrix, then of its factor; on the diagonal the reciprocal of the factor's.
    columns: C::Columns,
    mass: C,
}

impl<C: Storage> DenseSolver<C> {
    /// A solver for `n` freedoms; `None` where C holds another number.
    pub fn new(n: usize) -> Option<Self> {
        let mass = C::zeros(n)?;
        let mut solver = DenseSolver { columns: C::columns(n)?, mass };
        solver.forget();
        Some(solver)
    }

    /// Leaves no factor: what is solved for with it is NaN.
    #[cold]
    fn forget(&mut self) {
        for column in self.columns.as_mut() {
            column.as_mut().fill(f64::NAN);
        }
    }

    fn assemble<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) {
        let columns = self.columns.as_mut();
        columns.iter_mut().for_each(|column| column.as_mut().fill(0.0));
        metric.add_matrix(&mut Columns { weight: m, columns });
        potential.add_hessian(q, &mut Columns { weight: a, columns });
    }

    /// The second rung.
    #[cold]
    fn shifted<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable> {
        self.mass.as_mut().fill(0.0);
        metric.add_matrix(&mut Diagonal { weight: 1.0, values: self.mass.as_mut() });
        self.assemble(m, metric, a, potential, q);
        let scale = self.shift_scale();
        if !scale.is_finite() {
            self.forget();
            return Err(Unsolvable::NonFinite);
        }
        for tries in 1..=SHIFTS {
            self.assemble(m + shift(scale, tries), metric, a, potential, q);
            if self.factor_in_place() {
                return Ok(Rung::Shifted { tries });
            }
        }
        self.forget();
        Err(Unsolvable::Singular)
    }

    /// The scale `s` of the shifts. The matrix must be in `columns`, the diagonal of M in `mass`.
    fn shift_scale(&self) -> f64 {
        let mass = self.mass.as_ref();
        let row = |(column, m): (&C, &f64)| -> f64 {
            let entries = column.as_ref().iter().zip(mass);
            entries.map(|(entry, mass)| entry.abs() / (m.sqrt() * mass.sqrt())).sum()
        };
        largest_or_nan(self.columns.as_ref().iter().zip(mass).map(row))
    }

    /// Replaces the lower triangle by its factor; false where a pivot is not positive.
    #[inline]
    fn factor_in_place(&mut self) -> bool {
        let n = self.mass.as_ref().len();
        let columns = &mut self.columns.as_mut()[..n];
        let mut suspicious = false;
        for j in 0..n {
            let (done, rest) = columns.split_at_mut(j);
            let column = &mut rest[0].as_mut()[..n];
            let before = column[j].abs();
            let zero = zero_pivot(n) * before;
            for factor in done.iter() {
                let factor = &factor.as_ref()[..n];
                for i in j..n {
                    column[i] -= factor[j] * factor[i];
                }
            }
            if !(column[j] > zero && column[j] < f64::INFINITY) {
                return false;
            }
            suspicious |= column[j] < SUSPICIOUS * before;
            let reciprocal = column[j].sqrt().recip();
            column[j] = reciprocal;
            for entry in &mut column[j + 1..] {
                *entry *= reciprocal;
            }
        }
        !(suspicious && self.is_rounding())
    }

    /// Whether pivots that are small beside their diagonal entries are what rounding leaves of zero.
    #[cold]
    fn is_rounding(&mut self) -> bool {
        let n = self.mass.as_ref().len();
        let (columns, x) = (&self.columns.as_ref()[..n], &mut self.mass.as_mut()[..n]);
        let pivot = |i: usize| columns[i].as_ref()[i].powi(-2);
        let diagonal = |i: usize| {
            let square = |k: usize| columns[k].as_ref()[i].powi(2);
            (0..i).map(square).sum::<f64>() + pivot(i)
        };
        // The diagonal is known to rounding only: a little more is suspicious.
        let suspicious = |i: usize| pivot(i) < 2.0 * SUSPICIOUS * diagonal(i);
        let load = |i: usize| if suspicious(i) { load(i, diagonal(i)) } else { 0.0 };
        x.iter_mut().enumerate().for_each(|(i, x)| *x = load(i));
        substitute(columns, x);
        is_rounding(x, load, diagonal)
    }
}

/// Replaces r by the solution, by the columns of a factor with the reciprocals of its diagonal.
#[inline]
fn substitute<C: Storage>(columns: &[C], r: &mut [f64]) {
    let n = columns.len();
    for j in 0..n {
        let column = &columns[j].as_ref()[..n];
        r[j] *= column[j];
        for i in j + 1..n {
            r[i] -= column[i] * r[j];
        }
    }
    for j in (0..n).rev() {
        let column = &columns[j].as_ref()[..n];
        let mut sum = r[j];
        for i in j + 1..n {
            sum -= column[i] * r[i];
        }
        r[j] = sum * column[j];
    }
}

impl<C: Storage> HessianSolver for DenseSolver<C> {
    #[inline]
    fn dim(&self) -> Option<usize> {
        Some(self.mass.as_ref().len())
    }

    #[inline]
    fn factor_weighted<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable> {
        let n = self.mass.as_ref().len();
        SizeError::check("the metric's freedoms", n, metric.dim())?;
        if potential.dim() > n {
            SizeError::check("the potential's freedoms", n, potential.dim())?;
        }
        self.assemble(m, metric, a, potential, q);
        if self.factor_in_place() {
            Ok(Rung::Cholesky)
        } else {
            self.shifted(m, metric, a, potential, q)
        }
    }

    #[inline]
    fn solve(&mut self, r: &mut [f64]) {
        let n = self.mass.as_ref().len();
        if r.len() != n {
            return r.fill(f64::NAN);
        }
        solve_in_range(r, |r| substitute(&self.columns.as_ref()[..n], r));
    }
}

/// Adds `weight` times what it is given to a matrix of separate columns.
struct Columns<'a, C> {
    weight: f64,
    columns: &'a mut [C],
}

impl<C: Storage> Sink for Columns<'_, C> {
    #[inline]
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, entries) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            if j == FIXED {
                continue;
            }
            let column = self.columns[j].as_mut();
            for (&i, entry) in freedoms.iter().zip(entries) {
                if i != FIXED {
                    column[i] += self.weight * entry;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Covector, DenseMetric, DenseSink, DiagonalMetric};
    use nalgebra::{DMatrix, DVector, dmatrix};
    use proptest::prelude::*;

    /// The potential 1/2 q^T K q.
    struct Quadratic(DMatrix<f64>);

    impl Potential for Quadratic {
        fn dim(&self) -> usize {
            self.0.nrows()
        }

        fn energy(&self, q: &[f64]) -> f64 {
            let q = DVector::from_column_slice(q);
            0.5 * q.dot(&(&self.0 * &q))
        }

        fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
            dv.add_scaled(1.0, Covector((&self.0 * DVector::from_column_slice(q)).as_slice()));
        }

        fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
            let freedoms: Vec<usize> = (0..self.dim()).collect();
            hessian.add_symmetric(&freedoms, self.0.as_slice());
        }
    }

    #[test]
    fn what_is_solved_for_without_a_factor_is_nan() {
        let metric = DiagonalMetric::new([1.0; 2]).unwrap();
        let mut solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
        let solved = |solver: &mut DenseSolver<[f64; 2]>| {
            let mut r = [1.0, 2.0];
            solver.solve(&mut r);
            r
        };
        assert!(solved(&mut solver).iter().all(|x| x.is_nan()));
        let stiff = Quadratic(dmatrix![1.0, 0.0; 0.0, 1.0]);
        solver.factor(&metric, &stiff, &[0.0; 2], 1.0).unwrap();
        assert!(solved(&mut solver).iter().all(|x| x.is_finite()));
        let broken = Quadratic(dmatrix![1.0, f64::NAN; f64::NAN, 1.0]);
        solver.factor(&metric, &broken, &[0.0; 2], 1.0).unwrap_err();
        assert!(solved(&mut solver).iter().all(|x| x.is_nan()));
    }

    fn matrix_of(metric: &impl Metric, m: f64, a: f64, k: &Quadratic) -> DMatrix<f64> {
        let n = metric.dim();
        let mut values = vec![0.0; n * n];
        metric.add_matrix(&mut DenseSink::new(m, n, &mut values).unwrap());
        k.add_hessian(&[], &mut DenseSink::new(a, n, &mut values).unwrap());
        DMatrix::from_vec(n, n, values)
    }

    proptest! {
        #[test]
        fn the_solution_solves_the_system(
            entries in prop::array::uniform9(-1.0..1.0_f64),
            r in prop::array::uniform3(-1.0..1.0_f64),
            a in 0.0..10.0_f64,
        ) {
            let square = DMatrix::from_column_slice(3, 3, &entries);
            let k = Quadratic(&square * square.transpose());
            let metric = DiagonalMetric::new([1.0, 2.0, 3.0]).unwrap();
            let mut solver = DenseSolver::<[f64; 3]>::new(3).unwrap();
            prop_assert_eq!(solver.factor(&metric, &k, &[0.0; 3], a), Ok(Rung::Cholesky));
            let mut x = r;
            solver.solve(&mut x);
            let residual = matrix_of(&metric, 1.0, a, &k) * DVector::from_column_slice(&x)
                - DVector::from_column_slice(&r);
            prop_assert!(residual.amax() < 1e-13);
        }

        #[test]
        fn a_shifted_solution_descends_and_says_that_it_is_shifted(
            entries in prop::array::uniform9(-1.0..1.0_f64),
            r in prop::array::uniform3(-1.0..1.0_f64),
            scale in -12.0..12.0_f64,
        ) {
            let square = DMatrix::from_column_slice(3, 3, &entries) * 10.0_f64.powf(scale);
            let k = Quadratic(&square + square.transpose());
            let mass = dmatrix![2.0, 1.0, 0.0; 1.0, 2.0, 1.0; 0.0, 1.0, 2.0];
            let metric = DenseMetric::new(mass).unwrap();
            let matrix = matrix_of(&metric, 1.0, 1.0, &k);
            let smallest = matrix.symmetric_eigenvalues().min();
            let mut solver = DenseSolver::<Vec<f64>>::new(3).unwrap();
            let rung = solver.factor(&metric, &k, &[0.0; 3], 1.0).unwrap();
            if smallest < 0.0 {
                prop_assert!(matches!(rung, Rung::Shifted { tries: 1..=6 }), "{:?}", rung);
            }
            let mut x = r;
            solver.solve(&mut x);
            prop_assert!(Covector(r).apply(&crate::Vector(x)) > 0.0);
        }
    }

    #[test]
    fn a_zero_mode_is_seen_and_shifted() {
        // Two particles on a free spring: the Hessian alone cannot tell where they are.
        let spring = Quadratic(dmatrix![0.1, -0.1; -0.1, 0.1] * 3.0);
        let metric = DiagonalMetric::new([1.0, 5.0]).unwrap();
        let mut solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
        let rung = solver.factor_weighted(0.0, &metric, 1.0, &spring, &[0.0; 2]).unwrap();
        assert_eq!(rung, Rung::Shifted { tries: 1 });
    }

    /// A Gram matrix of six vectors that span four dimensions, of whole numbers: an elimination that
    /// magnifies rounding leaves more of its last pivot than the number of its steps explains.
    #[test]
    fn a_singular_matrix_is_not_definite_where_elimination_magnifies_rounding() {
        let a = dmatrix![
            32.0, 15.0, 18.0, 7.0, 6.0, 18.0;
            15.0, 25.0, -3.0, -7.0, -11.0, -3.0;
            18.0, -3.0, 29.0, 27.0, 29.0, 33.0;
            7.0, -7.0, 27.0, 31.0, 33.0, 33.0;
            6.0, -11.0, 29.0, 33.0, 37.0, 33.0;
            18.0, -3.0, 33.0, 33.0, 33.0, 45.0
        ];
        let metric = DiagonalMetric::new(vec![1.0; 6]).unwrap();
        for scale in [1e-250, 1.0, 1e250] {
            let gram = Quadratic(&a * scale);
            let mut solver = DenseSolver::<Vec<f64>>::new(6).unwrap();
            let rung = solver.factor_weighted(0.0, &metric, 1.0, &gram, &[0.0; 6]).unwrap();
            assert!(matches!(rung, Rung::Shifted { .. }), "{scale} {rung:?}");
        }
    }

    #[test]
    fn a_matrix_of_condition_1e12_is_definite() {
        // A spring chain that is 1e12 times stiffer than what holds it.
        let n = 20;
        let chain = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 if i == 0 => 1.0 + 1e-12,
            0 if i + 1 == n => 1.0,
            0 => 2.0,
            1 => -1.0,
            _ => 0.0,
        });
        let metric = DiagonalMetric::new(vec![1.0; n]).unwrap();
        let mut solver = DenseSolver::<Vec<f64>>::new(n).unwrap();
        let q = vec![0.0; n];
        let rung = solver.factor_weighted(0.0, &metric, 1.0, &Quadratic(chain), &q);
        assert_eq!(rung, Ok(Rung::Cholesky));
    }

    #[test]
    fn numbers_that_are_not_finite_are_unsolvable() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let metric = DiagonalMetric::new([1.0, 1.0]).unwrap();
            let mut solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
            for k in [dmatrix![1.0, 0.0; 0.0, bad], dmatrix![1.0, bad; bad, 1.0]] {
                let rung = solver.factor(&metric, &Quadratic(k), &[0.0; 2], 1.0);
                assert_eq!(rung, Err(Unsolvable::NonFinite), "{bad}");
            }
        }
    }

    #[test]
    fn a_solution_too_large_for_a_number_is_nan_in_every_component() {
        let k = Quadratic(dmatrix![1e-310, 0.0, 0.0; 0.0, 1.0, 0.0; 0.0, 0.0, 1.0]);
        let metric = DiagonalMetric::new(vec![1.0; 3]).unwrap();
        let mut solver = DenseSolver::<Vec<f64>>::new(3).unwrap();
        let rung = solver.factor_weighted(0.0, &metric, 1.0, &k, &[0.0; 3]);
        assert_eq!(rung, Ok(Rung::Cholesky));
        let mut x = [1.0; 3];
        solver.solve(&mut x);
        assert!(x.iter().all(|x| x.is_nan()), "{x:?}");
    }

    #[test]
    fn the_solver_holds_the_storages_number_of_freedoms_only() {
        assert!(DenseSolver::<[f64; 2]>::new(3).is_none());
        assert!(DenseSolver::<[f64; 2]>::new(2).is_some());
    }

    #[test]
    fn rounding_is_found_whatever_is_eliminated_after_it() {
        // Rank two, and two freedoms apart that are regular though their last pivot is suspicious.
        let w = [0.0, 1.0, 10.0];
        let metric = DiagonalMetric::new([1.0; 5]).unwrap();
        for k in 1..30 {
            let delta = 1.1e-4 * f64::from(k);
            let mut a = DMatrix::zeros(5, 5);
            a.view_mut((0, 0), (3, 3))
                .copy_from(&DMatrix::from_fn(3, 3, |i, j| 1.0 + w[i] * w[j] * delta));
            a.view_mut((3, 3), (2, 2)).copy_from(&dmatrix![1.0, 1.0; 1.0, 1.0 + 1e-9]);
            let mut solver = DenseSolver::<[f64; 5]>::new(5).unwrap();
            let rung = solver.factor_weighted(0.0, &metric, 1.0, &Quadratic(a.clone()), &[0.0; 5]);
            assert_ne!(rung, Ok(Rung::Cholesky), "{k}");
            (0..3).for_each(|i| a[(i, i)] += 1.0);
            let rung = solver.factor_weighted(0.0, &metric, 1.0, &Quadratic(a), &[0.0; 5]);
            assert_eq!(rung, Ok(Rung::Cholesky), "{k}");
        }
    }
}
