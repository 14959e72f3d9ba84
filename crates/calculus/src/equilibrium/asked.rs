//! What a search asks of a potential, its metric and the solver of its Hessian: by their address, so that it is
//! compiled once and not for every potential.

use super::terms::Magnitudes;
use crate::hessian_solver::Diagonal;
use crate::{
    Covector, HessianSolver, Metric, Potential, ProductSink, Rung, SizeError, Unsolvable, Vector,
};

/// A potential, its metric, and the solver of its Hessian.
#[derive(Clone, Debug)]
pub(super) struct Landscape<'a, M, P, L> {
    metric: &'a M,
    potential: &'a P,
    solver: L,
}

impl<'a, M: Metric, P: Potential, L: HessianSolver> Landscape<'a, M, P, L> {
    pub(super) fn new(metric: &'a M, potential: &'a P, solver: L) -> Result<Self, SizeError> {
        let n = metric.dim();
        SizeError::check("the potential's freedoms", n, potential.dim())?;
        SizeError::check("the solver's freedoms", n, solver.dim().unwrap_or(n))?;
        Ok(Landscape { metric, potential, solver })
    }
}

pub(super) trait Asked {
    fn freedoms(&self) -> usize;
    fn energy(&self, q: &[f64]) -> f64;
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>);
    /// Adds `H x` to y.
    fn add_product(&self, q: &[f64], x: &[f64], y: &mut [f64]);
    /// Writes `|H| |x|` block by block into y.
    fn magnitudes(&self, q: &[f64], x: &[f64], y: &mut [f64]);
    /// Writes `p = M v`.
    fn flat(&self, v: &[f64], p: &mut [f64]);
    /// Writes `v = M^-1 p`.
    fn sharp(&self, p: &[f64], v: &mut [f64]);
    /// The diagonal of `M`.
    fn masses(&self) -> Vec<f64>;
    /// Factors `H + sigma M`.
    fn factor(&mut self, sigma: f64, q: &[f64]) -> Result<Rung, Unsolvable>;
    /// Replaces r by x, with the matrix factored last.
    fn solve(&mut self, r: &mut [f64]);
    /// Why the last solve left NaN, where the solver can tell.
    fn unsolved(&self) -> Option<Unsolvable>;
}

impl<M: Metric, P: Potential, L: HessianSolver> Asked for Landscape<'_, M, P, L> {
    fn freedoms(&self) -> usize {
        self.metric.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.potential.energy(q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.potential.add_differential(q, dv);
    }

    fn add_product(&self, q: &[f64], x: &[f64], y: &mut [f64]) {
        if let Some(mut sink) = ProductSink::new(1.0, x, y) {
            self.potential.add_hessian(q, &mut sink);
        }
    }

    fn magnitudes(&self, q: &[f64], x: &[f64], y: &mut [f64]) {
        y.fill(0.0);
        self.potential.add_hessian(q, &mut Magnitudes { x, y });
    }

    fn flat(&self, v: &[f64], p: &mut [f64]) {
        self.metric.flat(Vector(v), Covector(p));
    }

    fn sharp(&self, p: &[f64], v: &mut [f64]) {
        self.metric.sharp(Covector(p), Vector(v));
    }

    fn masses(&self) -> Vec<f64> {
        let mut masses = vec![0.0; self.metric.dim()];
        self.metric.add_matrix(&mut Diagonal { weight: 1.0, values: &mut masses });
        masses
    }

    fn factor(&mut self, sigma: f64, q: &[f64]) -> Result<Rung, Unsolvable> {
        self.solver.factor_weighted(sigma, self.metric, 1.0, self.potential, q)
    }

    fn solve(&mut self, r: &mut [f64]) {
        self.solver.solve(r);
    }

    fn unsolved(&self) -> Option<Unsolvable> {
        self.solver.unsolved()
    }
}
