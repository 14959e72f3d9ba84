//! The Hessian solver for many freedoms: sparse, analysed once.
//!
//! ```text
//! (m M + a d2V(q)) x = r
//! ```
//! The places of M and of the Hessian are found when the solver is made; each factorization then
//! refills the values through stored slots and runs numbers only. The rungs of the ladder are those of
//! [`HessianSolver`]; which ones are climbed is the caller's choice of [`Ladder`].

use crate::hessian_solver::{Diagonal, SHIFTS, largest_or_nan, shift};
use crate::sparse::{Ordering, SparseCholesky, SparseError, SparseIndefinite, SymmetricMatrix};
use crate::{HessianSolver, Metric, Potential, Rung, SizeError, Unsolvable};

/// What to do where the matrix is not positive definite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ladder {
    /// Shift it by the mass, so that x descends; solve the indefinite system only if no shift will
    /// do. For implicit steps and for minima.
    #[default]
    Descent,
    /// Solve the indefinite system. For saddles and unstable equilibria.
    Exact,
}

/// A sparse matrix, its factor, and the ladder.
#[derive(Clone, Debug)]
pub struct SparseSolver {
    ladder: Ladder,
    matrix: SymmetricMatrix,
    cholesky: SparseCholesky,
    indefinite: Option<SparseIndefinite>,
    rung: Rung,
    mass: Vec<f64>,
    row_sums: Vec<f64>,
}

impl SparseSolver {
    /// Analyses the pattern of a metric and of a potential's Hessian at `q`. A Hessian must visit the
    /// same blocks in the same order at every other configuration.
    ///
    /// # Errors
    /// [`SparseError::Size`] unless the potential has at most the metric's freedoms and q as many numbers;
    /// blocks that name what is not there; a factor that does not fit into memory.
    pub fn new(
        metric: &impl Metric,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Self, SparseError> {
        SparseSolver::by_ordering(metric, potential, q, Ordering::default())
    }

    /// The same with a choice of how the order of elimination is found.
    ///
    /// # Errors
    /// Those of [`SparseSolver::new`].
    pub fn by_ordering(
        metric: &impl Metric,
        potential: &impl Potential,
        q: &[f64],
        ordering: Ordering,
    ) -> Result<Self, SparseError> {
        let n = metric.dim();
        check_sizes(n, potential, q)?;
        let matrix = SymmetricMatrix::analyse(n, |sink| {
            metric.add_matrix(sink);
            potential.add_hessian(q, sink);
        })?;
        Ok(SparseSolver {
            ladder: Ladder::default(),
            cholesky: SparseCholesky::analyse_by(&matrix, ordering)?,
            indefinite: None,
            matrix,
            rung: Rung::Cholesky,
            mass: vec![0.0; n],
            row_sums: vec![0.0; n],
        })
    }

    /// The same solver with another choice of rungs.
    pub fn with_ladder(self, ladder: Ladder) -> Self {
        SparseSolver { ladder, ..self }
    }

    /// The matrix that was factored last.
    pub fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }

    /// The factorization of the first two rungs.
    pub fn cholesky(&self) -> &SparseCholesky {
        &self.cholesky
    }

    /// Refills the matrix with `m M + a d2V(q)`.
    #[inline]
    fn assemble<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<(), Unsolvable> {
        let filled = self.matrix.refill(|sink| {
            metric.add_matrix(sink.weighted(m));
            potential.add_hessian(q, sink.weighted(a));
        });
        filled.map_err(SparseError::unsolvable)
    }

    /// The scale `s` of the shifts.
    fn shift_scale(&mut self, metric: &impl Metric) -> f64 {
        self.mass.fill(0.0);
        metric.add_matrix(&mut Diagonal { weight: 1.0, values: &mut self.mass });
        self.row_sums.fill(0.0);
        for (j, ends) in self.matrix.column_starts().windows(2).enumerate() {
            for k in ends[0] as usize..ends[1] as usize {
                let i = self.matrix.rows()[k] as usize;
                let mass = self.mass[i].sqrt() * self.mass[j].sqrt();
                let entry = self.matrix.values()[k].abs() / mass;
                self.row_sums[i] += entry;
                if i != j {
                    self.row_sums[j] += entry;
                }
            }
        }
        largest_or_nan(self.row_sums.iter().copied())
    }

    fn solve_exactly(&mut self) -> Result<Rung, Unsolvable> {
        let indefinite = match &mut self.indefinite {
            Some(indefinite) => indefinite,
            none => none
                .insert(SparseIndefinite::analyse(&self.matrix).map_err(SparseError::unsolvable)?),
        };
        indefinite.factor(&self.matrix).map_err(SparseError::unsolvable)?;
        Ok(Rung::Indefinite)
    }

    fn climb<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable> {
        if self.ladder == Ladder::Exact {
            return self.solve_exactly();
        }
        let scale = self.shift_scale(metric);
        for tries in 1..=SHIFTS {
            self.assemble(m + shift(scale, tries), metric, a, potential, q)?;
            if self.cholesky.factor(&self.matrix).is_ok() {
                return Ok(Rung::Shifted { tries });
            }
        }
        self.assemble(m, metric, a, potential, q)?;
        self.solve_exactly()
    }
}

/// A potential of the metric's freedoms or fewer, and a configuration of them.
pub(super) fn check_sizes(
    n: usize,
    potential: &impl Potential,
    q: &[f64],
) -> Result<(), SizeError> {
    if potential.dim() > n {
        SizeError::check("the potential's freedoms", n, potential.dim())?;
    }
    SizeError::check("the configuration's numbers", n, q.len())
}

impl HessianSolver for SparseSolver {
    fn dim(&self) -> Option<usize> {
        Some(self.mass.len())
    }

    fn factor_weighted<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable> {
        self.assemble(m, metric, a, potential, q)?;
        self.rung = match self.cholesky.factor(&self.matrix) {
            Ok(()) => Rung::Cholesky,
            Err(SparseError::NotPositiveDefinite { .. }) => {
                self.climb(m, metric, a, potential, q)?
            }
            Err(error) => return Err(error.unsolvable()),
        };
        Ok(self.rung)
    }

    fn solve(&mut self, r: &mut [f64]) {
        if r.len() != self.mass.len() {
            return r.fill(f64::NAN);
        }
        match (self.rung, &mut self.indefinite) {
            (Rung::Indefinite, Some(indefinite)) => {
                if indefinite.solve(&self.matrix, r).is_err() {
                    r.fill(f64::NAN);
                }
            }
            _ => self.cholesky.solve(r),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Covector, DenseSolver, DiagonalMetric, FIXED, Sink, Vector};

    /// Configurations that the springs do not look at.
    const Q: [f64; 12] = [0.0; 12];

    /// Springs of stiffness k between neighbours, the first to a wall: energy k/2 |x_i - x_(i-1)|^2, and
    /// of the order `visit` when it is asked for its Hessian.
    struct Row {
        stiffness: Vec<f64>,
    }

    impl Potential for Row {
        fn dim(&self) -> usize {
            self.stiffness.len()
        }

        fn energy(&self, _: &[f64]) -> f64 {
            0.0
        }

        fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

        fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
            for (i, &k) in self.stiffness.iter().enumerate() {
                hessian.add_symmetric(&[i.checked_sub(1).unwrap_or(FIXED), i], &[k, -k, -k, k]);
            }
        }
    }

    fn row(n: usize, stiffness: impl Fn(usize) -> f64) -> (DiagonalMetric<Vec<f64>>, Row) {
        let mass = (0..n).map(|i| 1.0 + i as f64 / n as f64).collect();
        (DiagonalMetric::new(mass).unwrap(), Row { stiffness: (0..n).map(stiffness).collect() })
    }

    #[test]
    fn the_sparse_solver_climbs_as_the_dense_one_does() {
        for k in [1.0, 1e-12, 1e9, -0.1, -1.0, -1e9] {
            let (metric, springs) = row(12, |i| if i % 3 == 0 { k } else { k.abs() });
            let mut sparse = SparseSolver::new(&metric, &springs, &Q[..metric.dim()]).unwrap();
            let mut dense = DenseSolver::<Vec<f64>>::new(12).unwrap();
            for (m, a) in [(1.0, 1.0), (1.0, 0.0), (0.0, 1.0), (2.0, 0.5)] {
                let expected = dense.factor_weighted(m, &metric, a, &springs, &[]).unwrap();
                let rung = sparse.factor_weighted(m, &metric, a, &springs, &[]).unwrap();
                assert_eq!(rung, expected);
                let r: Vec<f64> = (0..12).map(|i| (i as f64).cos()).collect();
                let (mut x, mut y) = (r.clone(), r.clone());
                dense.solve(&mut x);
                sparse.solve(&mut y);
                let largest = x.iter().fold(0.0_f64, |s, x| s.max(x.abs()));
                assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() <= 1e-8 * largest));
                assert!(Covector(r).apply(&Vector(y)) > 0.0);
            }
        }
    }

    #[test]
    fn the_exact_ladder_solves_what_the_other_shifts() {
        let (metric, springs) = row(12, |i| if i == 5 { -3.0 } else { 1.0 });
        let r: Vec<f64> = (0..12).map(|i| (i as f64).cos()).collect();
        let mut solver = SparseSolver::new(&metric, &springs, &Q[..metric.dim()]).unwrap();
        let rung = solver.factor(&metric, &springs, &[], 1.0).unwrap();
        assert!(matches!(rung, Rung::Shifted { .. }), "{rung:?}");
        let mut solver = solver.with_ladder(Ladder::Exact);
        assert_eq!(solver.factor(&metric, &springs, &[], 1.0), Ok(Rung::Indefinite));
        let (mut x, mut product) = (r.clone(), vec![0.0; 12]);
        solver.solve(&mut x);
        solver.matrix().add_product(1.0, &x, &mut product).unwrap();
        assert!(product.iter().zip(&r).all(|(p, r)| (p - r).abs() < 1e-14));
        // The next matrix may be definite again.
        assert_eq!(solver.factor(&metric, &springs, &[], 0.1), Ok(Rung::Cholesky));
    }

    #[test]
    fn a_hessian_that_visits_other_blocks_is_refused() {
        let (metric, springs) = row(4, |_| 1.0);
        let mut solver = SparseSolver::new(&metric, &springs, &Q[..metric.dim()]).unwrap();
        let (_, fewer) = row(3, |_| 1.0);
        let refused = solver.factor(&metric, &fewer, &[], 1.0);
        assert_eq!(refused, Err(Unsolvable::PatternChanged { block: 7 }));
        let sum = (&springs, &fewer);
        let refused = solver.factor(&metric, &sum, &[], 1.0);
        assert_eq!(refused, Err(Unsolvable::PatternChanged { block: 8 }));
        assert_eq!(solver.factor(&metric, &springs, &[], 1.0), Ok(Rung::Cholesky));
    }

    #[test]
    fn numbers_that_are_not_finite_are_unsolvable() {
        for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let (metric, springs) = row(4, |i| if i == 2 { bad } else { 1.0 });
            let mut solver = SparseSolver::new(&metric, &springs, &Q[..metric.dim()]).unwrap();
            let refused = solver.factor(&metric, &springs, &[], 1.0);
            assert_eq!(refused, Err(Unsolvable::NonFinite));
        }
    }

    #[test]
    fn a_potential_of_more_freedoms_than_the_metric_is_refused() {
        let (metric, _) = row(3, |_| 1.0);
        let (_, springs) = row(4, |_| 1.0);
        let error = SparseSolver::new(&metric, &springs, &Q[..metric.dim()]).unwrap_err();
        assert!(matches!(error, SparseError::Size(SizeError { expected: 3, got: 4, .. })));
    }
}
