//! The Hessian solver for more freedoms than a factor can hold: assembled, and solved by iteration.
//!
//! ```text
//! (m M + a d2V(q)) x = r        by conjugate gradients, preconditioned by the blocks of the vertices
//! ```
//! The matrix is kept, a product with which costs a fraction of the blocks' computation; no factor is.
//! What a factor would tell at once is found out on the way: in a direction in which the matrix is not
//! positive the solve ends, and every component of x is NaN; a right-hand side need not lead to one
//! ([`HessianSolver::negative_curvature`] looks for it). Give it a potential whose Hessian is
//! projected ([`Curvature::Semidefinite`](crate::Curvature)) where that may happen.

use crate::sparse::block_jacobi::BlockJacobi;
use crate::sparse::conjugate_gradient::Product;
use crate::sparse::negative_curvature::{negative_curvature, negative_in_block};
use crate::sparse::scratch::Scratch;
use crate::sparse::solver::check_sizes;
use crate::sparse::{ConjugateGradient, ConjugateGradientReport, SparseError, SymmetricMatrix};
use crate::{HessianSolver, Metric, Potential, Rung, SizeError, Unsolvable};

/// A sparse matrix, its preconditioner, and when to stop.
#[derive(Clone, Debug)]
pub struct IterativeSolver {
    method: ConjugateGradient,
    matrix: SymmetricMatrix,
    jacobi: BlockJacobi,
    scratch: Scratch,
    x: Vec<f64>,
    /// Why the preconditioner of the matrix assembled last could not be factored.
    refused: Option<SparseError>,
    last: Option<Result<ConjugateGradientReport, SparseError>>,
}

impl IterativeSolver {
    /// Analyses the pattern of a metric and of a potential's Hessian at `q`.
    ///
    /// # Errors
    /// Those of [`SparseSolver::new`](crate::SparseSolver::new), and [`SparseError::Tolerance`].
    pub fn new(
        method: ConjugateGradient,
        metric: &impl Metric,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Self, SparseError> {
        let n = metric.dim();
        check_sizes(n, potential, q)?;
        method.check()?;
        let matrix = SymmetricMatrix::analyse(n, |sink| {
            metric.add_matrix(sink);
            potential.add_hessian(q, sink);
        })?;
        let jacobi = BlockJacobi::analyse(n, |sink| {
            metric.add_matrix(sink);
            potential.add_hessian(q, sink);
        });
        let scratch = Scratch::new(n, &[method.scratch(&jacobi, &matrix)])?;
        Ok(IterativeSolver {
            method,
            matrix,
            jacobi,
            scratch,
            x: vec![0.0; n],
            refused: None,
            last: None,
        })
    }

    /// The matrix that was assembled last.
    pub fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }

    /// How the last solve ended.
    pub fn last(&self) -> Option<Result<ConjugateGradientReport, SparseError>> {
        self.last
    }
}

impl Product for SymmetricMatrix {
    fn dim(&self) -> usize {
        SymmetricMatrix::dim(self)
    }

    fn add_product(&self, scale: f64, x: &[f64], y: &mut [f64]) {
        self.add_product_unchecked(scale, x, y);
    }
}

impl HessianSolver for IterativeSolver {
    fn dim(&self) -> Option<usize> {
        Some(self.x.len())
    }

    /// Assembles the matrix. The rung is the first one, on trust: see [`IterativeSolver::last`].
    fn factor_weighted<M: Metric, P: Potential>(
        &mut self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
    ) -> Result<Rung, Unsolvable> {
        let filled = self.matrix.refill(|sink| {
            metric.add_matrix(sink.weighted(m));
            potential.add_hessian(q, sink.weighted(a));
        });
        filled.map_err(SparseError::unsolvable)?;
        self.refused = self.jacobi.factor_of(&self.matrix).err();
        self.refused.map_or(Ok(Rung::Cholesky), |error| Err(error.unsolvable()))
    }

    fn solve(&mut self, r: &mut [f64]) {
        if let Err(error) =
            SizeError::check("the right-hand side's components", self.x.len(), r.len())
        {
            self.last = Some(Err(error.into()));
            return r.fill(f64::NAN);
        }
        self.x.fill(0.0);
        let system = (&*r, &mut self.x[..]);
        let end = self.method.iterate(&self.jacobi, &self.matrix, system, &mut self.scratch);
        match end {
            Ok(_) => r.copy_from_slice(&self.x),
            Err(_) => r.fill(f64::NAN),
        }
        self.last = Some(end);
    }

    fn unsolved(&self) -> Option<Unsolvable> {
        self.last?.err().map(SparseError::unsolvable)
    }

    /// By no more products than a solve may take.
    fn negative_curvature(&mut self) -> Result<Option<Vec<f64>>, Unsolvable> {
        let found = match self.refused {
            None => negative_curvature(&self.matrix, &self.jacobi, self.method.iterations),
            Some(SparseError::NotPositiveDefinite { freedom }) => {
                negative_in_block(&self.matrix, self.jacobi.block_of(freedom))
            }
            Some(error) => Err(error),
        };
        found.map_err(SparseError::unsolvable)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sparse::conjugate_gradient::tests::row;
    use crate::{DenseSolver, SparseSolver};

    #[test]
    fn a_right_hand_side_of_another_size_becomes_nan_in_every_solver() {
        let (metric, springs, r) = row(10);
        let method = ConjugateGradient { tolerance: 1e-13, iterations: 300 };
        let mut iterative = IterativeSolver::new(method, &metric, &springs, &[0.0; 10]).unwrap();
        let mut direct = SparseSolver::new(&metric, &springs, &[0.0; 10]).unwrap();
        let mut dense = DenseSolver::<Vec<f64>>::new(10).unwrap();
        fn solved(
            solver: &mut impl HessianSolver,
            system: (&impl Metric, &impl Potential),
            r: &[f64],
        ) -> Vec<f64> {
            solver.factor(system.0, system.1, &[0.0; 10], 1.0).unwrap();
            let mut x = r.to_vec();
            solver.solve(&mut x);
            x
        }
        let system = (&metric, &springs);
        for n in [9, 11, 20] {
            let r = vec![1.0; n];
            let none = |x: Vec<f64>| x.len() == n && x.iter().all(|x| x.is_nan());
            assert!(none(solved(&mut iterative, system, &r)), "{n}");
            assert!(matches!(iterative.last(), Some(Err(SparseError::Size(_)))));
            assert!(none(solved(&mut direct, system, &r)), "{n}");
            assert!(none(solved(&mut dense, system, &r)), "{n}");
        }
        assert!(solved(&mut dense, system, &r).iter().all(|x| x.is_finite()));
    }

    #[test]
    fn the_iteration_solves_what_the_factor_solves() {
        let (metric, mut springs, r) = row(100);
        let method = ConjugateGradient { tolerance: 1e-13, iterations: 300 };
        let mut iterative = IterativeSolver::new(method, &metric, &springs, &[0.0; 100]).unwrap();
        let mut direct = SparseSolver::new(&metric, &springs, &[0.0; 100]).unwrap();
        for a in [0.0, 1.0, 7.0] {
            let (mut x, mut y) = (r.clone(), r.clone());
            iterative.factor(&metric, &springs, &[], a).unwrap();
            direct.factor(&metric, &springs, &[], a).unwrap();
            iterative.solve(&mut x);
            direct.solve(&mut y);
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-12));
            let report = iterative.last().unwrap().unwrap();
            assert!(report.relative_residual < 1e-12 && report.iterations < 150, "{report:?}");
        }
        springs.0[47] = -4.0;
        let mut x = r.clone();
        iterative.factor(&metric, &springs, &[], 1.0).unwrap();
        iterative.solve(&mut x);
        assert!(x.iter().all(|x| x.is_nan()));
        let end = iterative.last().unwrap();
        assert!(matches!(end, Err(SparseError::NegativeCurvature { .. })), "{end:?}");
        assert!(matches!(iterative.unsolved(), Some(Unsolvable::NotPositive { .. })));
        springs.0[47] = -40.0;
        let refused = iterative.factor(&metric, &springs, &[], 1.0);
        assert_eq!(refused, Err(Unsolvable::Singular));
    }

    /// Blocks of a matrix, whatever the configuration.
    struct Given(usize, Vec<([usize; 2], [f64; 4])>);

    impl Potential for Given {
        fn dim(&self) -> usize {
            self.0
        }

        fn energy(&self, _: &[f64]) -> f64 {
            0.0
        }

        fn add_differential(&self, _: &[f64], _: crate::Covector<&mut [f64]>) {}

        fn add_hessian(&self, _: &[f64], hessian: &mut impl crate::Sink) {
            for (freedoms, block) in &self.1 {
                hessian.add_symmetric(freedoms, block);
            }
        }
    }

    #[test]
    fn a_negative_curvature_is_found_or_proved_not_to_be_there() {
        let n = 40;
        let metric = crate::DiagonalMetric::new(vec![1.0; n]).unwrap();
        let zeros = vec![0.0; n];
        let method = ConjugateGradient { tolerance: 1e-10, iterations: 500 };
        // A chain, the lowest eigenvalue of which is 4 sin^2(pi/82) = 5.87e-3, less a number on the diagonal.
        let chain = |less: f64| {
            let link = |i: usize| ([i, i + 1], [0.0, -1.0, -1.0, 0.0]);
            let own = |i: usize| ([i, (i + 1) % n], [2.0 - less, 0.0, 0.0, 0.0]);
            Given(n, (0..n - 1).map(link).chain((0..n).map(own)).collect())
        };
        let cases = [(0.0, true), (5.8e-3, true), (5.95e-3, false), (2.5, false)];
        let scales = [1.0, 2.0_f64.powi(800), 2.0_f64.powi(-800)];
        for ((less, is_definite), scale) in cases.into_iter().flat_map(|c| scales.map(|s| (c, s))) {
            let given = chain(less);
            let mut solver = IterativeSolver::new(method, &metric, &given, &zeros).unwrap();
            let rung = solver.factor_weighted(0.0, &metric, scale, &given, &zeros);
            assert_eq!(rung.is_ok(), less < 2.0, "blocks tell the last one");
            let found = solver.negative_curvature().unwrap();
            assert_eq!(found.is_none(), is_definite, "{less} {scale}");
            if let Some(direction) = found {
                let mut product = zeros.clone();
                solver.matrix().add_product(scale.recip(), &direction, &mut product).unwrap();
                assert!(product.iter().zip(&direction).map(|(y, x)| y * x).sum::<f64>() < 0.0);
            }
        }
        // A free chain is flat, and neither.
        let link = |i: usize| ([i, i + 1], [1.0, -1.0, -1.0, 1.0]);
        let free = Given(n, (0..n - 1).map(link).collect());
        let mut solver = IterativeSolver::new(method, &metric, &free, &zeros).unwrap();
        solver.factor_weighted(0.0, &metric, 1.0, &free, &zeros).unwrap();
        assert!(solver.negative_curvature().is_err());
    }
}
