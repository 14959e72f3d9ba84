//! The Hessian solver for many freedoms: sparse, analysed once.
//!
//! ```text
//! (m M + a d2V(q)) x = r
//! ```
//! The places of M and of the Hessian are found when the solver is made; each factorization then
//! refills the values through stored slots and runs numbers only. The rungs of the ladder are those of
//! [`HessianSolver`]; which ones are climbed is the caller's choice of [`Ladder`].

use crate::hessian_solver::{Diagonal, SHIFTS, shift};
use crate::sparse::{SparseCholesky, SparseError, SparseIndefinite, SymmetricMatrix};
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
    pub fn new(
        metric: &impl Metric,
        potential: &impl Potential,
        q: &[f64],
    ) -> Result<Self, SparseError> {
        let n = metric.dim();
        if potential.dim() > n {
            SizeError::check("the potential's freedoms", n, potential.dim())?;
        }
        let matrix = SymmetricMatrix::analyse(n, |sink| {
            metric.add_matrix(sink);
            potential.add_hessian(q, sink);
        })?;
        Ok(SparseSolver {
            ladder: Ladder::default(),
            cholesky: SparseCholesky::analyse(&matrix)?,
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
                let entry = self.matrix.values()[k].abs() / (self.mass[i] * self.mass[j]).sqrt();
                self.row_sums[i] += entry;
                if i != j {
                    self.row_sums[j] += entry;
                }
            }
        }
        self.row_sums.iter().fold(0.0, |largest, &sum| sum.max(largest))
    }

    fn solve_exactly(&mut self) -> Result<Rung, Unsolvable> {
        let indefinite = match &mut self.indefinite {
            Some(indefinite) => indefinite,
            none => none.insert(
                SparseIndefinite::analyse(&self.matrix).map_err(SparseError::unsolvable)?,
            ),
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

impl HessianSolver for SparseSolver {
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
