//! Conjugate gradients: solves with products alone, where a factor would not fit.
//!
//! ```text
//! (m M + a d2V(q)) x = r,      preconditioned by the blocks of the vertices (notes A.1)
//! ```
//! Only products with the matrix are formed, block by block ([`ProductSink`]). The matrix must be
//! positive definite; a direction in which it is not ends the iteration with an error, as does the
//! bound on the iterations. The residual that is reported is computed at the end, `r - A x`, and not
//! carried along. Takes its memory anew at every call, which is nothing beside the products.

use std::fmt;

use faer::dyn_stack::{MemStack, StackReq};
use faer::matrix_free::conjugate_gradient::{
    CgError, CgParams, conjugate_gradient, conjugate_gradient_scratch,
};
use faer::matrix_free::{InitialGuessStatus, LinOp};
use faer::{MatMut, MatRef, Par};

use crate::equation::{length, power_of_two};
use crate::sparse::SparseError;
use crate::sparse::block_jacobi::BlockJacobi;
use crate::sparse::scratch::Scratch;
use crate::sparse::solver::check_sizes;
use crate::{Metric, Potential, ProductSink, SizeError};

/// A true residual of more than so many tolerances begins the iteration again.
const TRUE: f64 = 10.0;
/// One of more than so many at the end is no solution.
const ALLOWED: f64 = 100.0;
/// Below this a tolerance asks for rounding.
const ROUNDED: f64 = 1e-13;

/// When to stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradient {
    /// Residuals up to this, relative to the right-hand side, are small enough.
    pub tolerance: f64,
    /// No more products than this.
    pub iterations: usize,
}

/// What a solve did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ConjugateGradientReport {
    /// Products with the matrix, but for the one that checks the residual.
    pub iterations: usize,
    /// The length of `r - A x` relative to that of r.
    pub relative_residual: f64,
}

impl ConjugateGradient {
    /// Solves `(m M + a d2V(q)) x = r` from the guess in `x`. After an error x holds the last iterate.
    ///
    /// # Errors
    /// A tolerance that is negative or none, sizes that do not fit, numbers that are not finite, a
    /// direction in which the matrix is not positive, and [`SparseError::NotConverged`] where the
    /// residual itself, not the one that the iteration carries along, stays above a hundred
    /// tolerances.
    #[expect(clippy::too_many_arguments, reason = "the equation has this many symbols")]
    pub fn solve<M: Metric + Sync, P: Potential + Sync>(
        &self,
        m: f64,
        metric: &M,
        a: f64,
        potential: &P,
        q: &[f64],
        r: &[f64],
        x: &mut [f64],
    ) -> Result<ConjugateGradientReport, SparseError> {
        let n = metric.dim();
        self.check()?;
        check_sizes(n, potential, q)?;
        SizeError::check("the right-hand side's components", n, r.len())?;
        SizeError::check("the guess's components", n, x.len())?;
        let matrix = HessianProduct { m, metric, a, potential, q };
        let jacobi = matrix.block_jacobi()?;
        let mut scratch = Scratch::new(n, &[self.scratch(&jacobi, &matrix)])?;
        self.iterate(&jacobi, &matrix, (r, x), &mut scratch)
    }

    /// An error unless the tolerance is a number that is not negative.
    pub(crate) fn check(&self) -> Result<(), SparseError> {
        if self.tolerance >= 0.0 { Ok(()) } else { Err(SparseError::Tolerance(self.tolerance)) }
    }

    pub(crate) fn scratch(&self, jacobi: &BlockJacobi, matrix: &impl Product) -> StackReq {
        conjugate_gradient_scratch(jacobi, &Operator { matrix, scale: 1.0 }, 1, Par::Seq)
    }

    /// Solves `A x = r` from the guess in x, of the same length.
    pub(crate) fn iterate(
        &self,
        jacobi: &BlockJacobi,
        matrix: &impl Product,
        (r, x): (&[f64], &mut [f64]),
        scratch: &mut Scratch,
    ) -> Result<ConjugateGradientReport, SparseError> {
        let mut report = self.run(jacobi, matrix, (r, &mut *x), self.iterations, scratch)?;
        // The residual that is carried along drifts away from the true one: begun again from x, the
        // iteration sees the true one.
        while report.relative_residual > TRUE * self.tolerance.max(f64::EPSILON)
            && report.iterations < self.iterations
        {
            let left = self.iterations - report.iterations;
            let before = report.relative_residual;
            let Ok(again) = self.run(jacobi, matrix, (r, &mut *x), left, scratch) else {
                report.relative_residual = relative_residual(matrix, r, x);
                break;
            };
            report.iterations += again.iterations;
            report.relative_residual = again.relative_residual;
            if again.iterations == 0 || again.relative_residual > 0.5 * before {
                break;
            }
        }
        let ConjugateGradientReport { iterations, relative_residual } = report;
        // So written that NaN is refused.
        if relative_residual <= ALLOWED * self.tolerance.max(ROUNDED) {
            Ok(report)
        } else {
            Err(SparseError::NotConverged { iterations, relative_residual })
        }
    }

    /// One run of the iteration.
    fn run(
        &self,
        jacobi: &BlockJacobi,
        matrix: &impl Product,
        (r, x): (&[f64], &mut [f64]),
        bound: usize,
        scratch: &mut Scratch,
    ) -> Result<ConjugateGradientReport, SparseError> {
        let n = matrix.dim();
        let params = CgParams {
            initial_guess: InitialGuessStatus::MaybeNonZero,
            abs_tolerance: 0.0,
            rel_tolerance: self.tolerance.max(f64::EPSILON),
            max_iters: bound,
            ..CgParams::default()
        };
        // Squares of very large or very small numbers leave the range of numbers.
        let scale = jacobi.scale();
        let load = power_of_two(r.iter().fold(0.0_f64, |m, r| m.max(r.abs())));
        let scaled: Vec<f64>;
        let right = if load == 1.0 {
            r
        } else {
            scaled = r.iter().map(|r| r / load).collect();
            &scaled
        };
        let other_units = scale != 1.0 || load != 1.0;
        if other_units {
            x.iter_mut().for_each(|x| *x = *x / load * scale);
        }
        let mut iterations = 0;
        let solved = conjugate_gradient(
            MatMut::from_column_major_slice_mut(x, n, 1),
            jacobi,
            &Operator { matrix, scale: scale.recip() },
            MatRef::from_column_major_slice(right, n, 1),
            params,
            |_| iterations += 1,
            Par::Seq,
            scratch.stack(),
        );
        if other_units {
            x.iter_mut().for_each(|x| *x = *x / scale * load);
        }
        let relative_residual = relative_residual(matrix, r, x);
        match solved {
            Ok(_) => Ok(ConjugateGradientReport { iterations, relative_residual }),
            Err(CgError::NoConvergence { .. }) => {
                Err(SparseError::NotConverged { iterations, relative_residual })
            }
            Err(_) if relative_residual.is_nan() => Err(SparseError::NonFinite),
            Err(_) => Err(SparseError::NegativeCurvature { iterations }),
        }
    }
}

/// The matrix `m M + a d2V(q)`, as what it does to a vector.
struct HessianProduct<'a, M, P> {
    m: f64,
    metric: &'a M,
    a: f64,
    potential: &'a P,
    q: &'a [f64],
}

/// A symmetric matrix, as what it does to a vector.
pub(crate) trait Product: Sync {
    fn dim(&self) -> usize;

    /// Adds the product with x, of the same length: `y += scale A x`.
    fn add_product(&self, scale: f64, x: &[f64], y: &mut [f64]);
}

fn relative_residual(matrix: &impl Product, r: &[f64], x: &[f64]) -> f64 {
    let mut residual = r.to_vec();
    matrix.add_product(-1.0, x, &mut residual);
    let size = length(r);
    if size == 0.0 { 0.0 } else { length(&residual) / size }
}

impl<M: Metric, P: Potential> HessianProduct<'_, M, P> {
    fn block_jacobi(&self) -> Result<BlockJacobi, SparseError> {
        let mut jacobi = BlockJacobi::analyse(self.metric.dim(), |sink| {
            self.metric.add_matrix(sink);
            self.potential.add_hessian(self.q, sink);
        });
        jacobi.factor(|sink| {
            self.metric.add_matrix(sink.weighted(self.m));
            self.potential.add_hessian(self.q, sink.weighted(self.a));
        })?;
        Ok(jacobi)
    }
}

impl<M: Metric + Sync, P: Potential + Sync> Product for HessianProduct<'_, M, P> {
    fn dim(&self) -> usize {
        self.metric.dim()
    }

    fn add_product(&self, scale: f64, x: &[f64], y: &mut [f64]) {
        if let Some(mut sink) = ProductSink::new(scale * self.m, x, y) {
            self.metric.add_matrix(&mut sink);
        }
        if let Some(mut sink) = ProductSink::new(scale * self.a, x, y) {
            self.potential.add_hessian(self.q, &mut sink);
        }
    }
}

/// A product as faer asks for it.
struct Operator<'a, A> {
    matrix: &'a A,
    scale: f64,
}

impl<A: Product> fmt::Debug for Operator<'_, A> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a matrix of size {}", self.matrix.dim())
    }
}

/// The single column of an n x 1 matrix, which faer keeps contiguous.
pub(crate) fn column<'a>(x: MatRef<'a, f64>) -> &'a [f64] {
    x.col(0).try_as_col_major().map_or(&[], |x| x.as_slice())
}

pub(crate) fn column_mut<'a>(x: MatMut<'a, f64>) -> &'a mut [f64] {
    x.col_mut(0).try_as_col_major_mut().map_or(&mut [], |x| x.as_slice_mut())
}

impl<A: Product> LinOp<f64> for Operator<'_, A> {
    fn apply_scratch(&self, _: usize, _: Par) -> StackReq {
        StackReq::EMPTY
    }

    fn nrows(&self) -> usize {
        self.matrix.dim()
    }

    fn ncols(&self) -> usize {
        self.matrix.dim()
    }

    fn apply(&self, out: MatMut<'_, f64>, x: MatRef<'_, f64>, _: Par, _: &mut MemStack) {
        let y = column_mut(out);
        y.fill(0.0);
        self.matrix.add_product(self.scale, column(x), y);
    }

    fn conj_apply(&self, y: MatMut<'_, f64>, x: MatRef<'_, f64>, par: Par, stack: &mut MemStack) {
        self.apply(y, x, par, stack);
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use crate::{Covector, DiagonalMetric, FIXED, HessianSolver, Sink, SparseSolver};

    /// Springs between neighbours in a row, the first to a wall.
    pub(crate) struct Row(pub(crate) Vec<f64>);

    impl Potential for Row {
        fn dim(&self) -> usize {
            self.0.len()
        }

        fn energy(&self, _: &[f64]) -> f64 {
            0.0
        }

        fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

        fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
            for (i, &k) in self.0.iter().enumerate() {
                hessian.add_symmetric(&[i.checked_sub(1).unwrap_or(FIXED), i], &[k, -k, -k, k]);
            }
        }
    }

    pub(crate) fn row(n: usize) -> (DiagonalMetric<Vec<f64>>, Row, Vec<f64>) {
        let metric = DiagonalMetric::new(vec![1.0; n]).unwrap();
        let springs = Row((0..n).map(|i| 1.0 + (i % 7) as f64).collect());
        (metric, springs, (0..n).map(|i| (i as f64).cos()).collect())
    }

    #[test]
    fn products_alone_give_what_the_factor_gives() {
        let (metric, springs, r) = row(100);
        let cg = ConjugateGradient { tolerance: 1e-13, iterations: 300 };
        let mut x = vec![0.0; 100];
        let report = cg.solve(1.0, &metric, 4.0, &springs, &[0.0; 100], &r, &mut x).unwrap();
        assert!(report.iterations < 150 && report.relative_residual < 1e-12, "{report:?}");
        let mut exact = r.clone();
        let mut solver = SparseSolver::new(&metric, &springs, &[0.0; 100]).unwrap();
        solver.factor(&metric, &springs, &[], 4.0).unwrap();
        solver.solve(&mut exact);
        assert!(x.iter().zip(&exact).all(|(x, exact)| (x - exact).abs() < 1e-12));
        let again = cg.solve(1.0, &metric, 4.0, &springs, &[0.0; 100], &r, &mut x).unwrap();
        assert!(again.iterations <= 1, "the guess is used: {again:?}");
    }

    #[test]
    fn the_bound_ends_the_iteration_with_the_residual_that_is_left() {
        let (metric, springs, r) = row(100);
        let cg = ConjugateGradient { tolerance: 1e-13, iterations: 5 };
        let mut x = vec![0.0; 100];
        let error = cg.solve(0.0, &metric, 1.0, &springs, &[0.0; 100], &r, &mut x).unwrap_err();
        let mut residual = r.clone();
        springs.add_hessian(&[], &mut ProductSink::new(-1.0, &x, &mut residual).unwrap());
        let relative_residual = length(&residual) / length(&r);
        assert_eq!(error, SparseError::NotConverged { iterations: 5, relative_residual });
    }

    #[test]
    fn an_indefinite_matrix_is_refused() {
        let (metric, mut springs, r) = row(100);
        let cg = ConjugateGradient { tolerance: 1e-13, iterations: 300 };
        springs.0[47] = -4.0;
        let error =
            cg.solve(1.0, &metric, 1.0, &springs, &[0.0; 100], &r, &mut [0.0; 100]).unwrap_err();
        assert!(matches!(error, SparseError::NegativeCurvature { .. }), "{error}");
        springs.0[47] = -40.0;
        let error =
            cg.solve(1.0, &metric, 1.0, &springs, &[0.0; 100], &r, &mut [0.0; 100]).unwrap_err();
        assert_eq!(error, SparseError::NotPositiveDefinite { freedom: 46 });
        springs.0[47] = f64::NAN;
        let error =
            cg.solve(1.0, &metric, 1.0, &springs, &[0.0; 100], &r, &mut [0.0; 100]).unwrap_err();
        assert_eq!(error, SparseError::NonFinite);
    }

    #[test]
    fn nothing_is_solved_by_nothing() {
        let (metric, springs, _) = row(4);
        let cg = ConjugateGradient { tolerance: 0.0, iterations: 10 };
        let mut x = [1.0; 4];
        let report = cg.solve(1.0, &metric, 1.0, &springs, &[0.0; 4], &[0.0; 4], &mut x).unwrap();
        assert_eq!((report.iterations, x), (0, [0.0; 4]));
    }

    #[test]
    fn a_system_is_solved_at_every_scale() {
        let (metric, springs, r) = row(100);
        for scale in [1e-300, 1e-200, 1.0, 1e200, 1e300] {
            let cg = ConjugateGradient { tolerance: 1e-13, iterations: 300 };
            let scaled = Row(springs.0.iter().map(|k| k * scale).collect());
            let load: Vec<f64> = r.iter().map(|r| r * scale).collect();
            let (q, mut x, mut y) = ([0.0; 100], [0.0; 100], [0.0; 100]);
            let report = cg.solve(0.0, &metric, 1.0, &scaled, &q, &load, &mut x).unwrap();
            assert!(report.relative_residual <= 1e-11, "{scale} {report:?}");
            cg.solve(0.0, &metric, 1.0, &springs, &q, &r, &mut y).unwrap();
            let largest = y.iter().fold(0.0_f64, |m, y| m.max(y.abs()));
            assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() <= 1e-9 * largest), "{scale}");
        }
    }

    #[test]
    fn a_tolerance_that_is_none_is_refused() {
        let (metric, springs, r) = row(4);
        let cg = ConjugateGradient { tolerance: f64::NAN, iterations: 10 };
        let refused = cg.solve(1.0, &metric, 1.0, &springs, &[0.0; 4], &r, &mut [0.0; 4]);
        assert!(matches!(refused, Err(SparseError::Tolerance(_))), "{refused:?}");
    }
}
