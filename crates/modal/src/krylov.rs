//! Block Lanczos in the mass inner product, with thick restarts.
//!
//! ```text
//! A = (H + delta M)^-1 M,     A v = theta v,     theta = 1/(lambda + delta)
//! A V_j = V T + V_(j+1) R_j,  V^T M V = I,       T = V^T M A V
//! ```
//! `H + delta M` is positive definite, so the lowest lambda are the largest theta, and Cholesky's
//! factor is enough. The basis V grows by a block of b vectors at a time, each orthogonal to all
//! before it; when it is full, the best approximations are kept and it grows again. A block finds
//! modes of multiplicity up to b at once and reads the factor once for all of its solves.
//! Source: Grimes, Lewis and Simon, "A shifted block Lanczos algorithm for solving sparse symmetric
//! generalized eigenproblems" (SIAM J. Matrix Anal. 15, 1994); Wu and Simon, thick restarts (the
//! same journal, 22, 2000).

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::{SparseCholesky, SplitMix64, SymmetricMatrix};

use crate::ModalError;
use crate::dense::{add_product, dot, mass_times, project_out};

/// Vectors in a block.
const BLOCK: usize = 8;
/// Restarts before the search is given up.
const RESTARTS: usize = 60;
/// An approximation is good where its residual is this small relative to theta, or what rounding of
/// the largest theta leaves.
const CONVERGED: f64 = 1e-12;
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A vector that is left with less than this share of its length is replaced by a random one.
const LOST: f64 = 1e-12;

/// The search for the largest theta.
pub(crate) struct Krylov<'a> {
    cholesky: &'a mut SparseCholesky,
    mass: &'a SymmetricMatrix,
    /// Orthonormal vectors that every other is kept orthogonal to.
    locked: &'a [f64],
    random: SplitMix64,
    solves: u64,
}

/// Vectors, orthonormal in the mass, that span the largest theta.
pub(crate) type Ritz = Vec<f64>;

impl<'a> Krylov<'a> {
    pub(crate) fn new(
        cholesky: &'a mut SparseCholesky,
        mass: &'a SymmetricMatrix,
        locked: &'a [f64],
    ) -> Self {
        Krylov { cholesky, mass, locked, random: SplitMix64::new(14), solves: 0 }
    }

    /// How many right sides were solved for.
    pub(crate) fn solves(&self) -> u64 {
        self.solves
    }

    /// The vectors of the `count` largest theta.
    pub(crate) fn largest(&mut self, count: usize) -> Result<Ritz, ModalError> {
        let n = self.mass.dim();
        let room = n - self.locked.len() / n;
        let full = (2 * count + 4 * BLOCK).max(count + 6 * BLOCK).min(room);
        let mut basis: Vec<f64> = Vec::new();
        let mut projected = DMatrix::<f64>::zeros(0, 0);
        let (mut block, _) = self.next_block(&basis, vec![0.0; n * BLOCK.min(room)]);
        let mut converged = 0;
        for _ in 0..RESTARTS {
            let mut coupling = DMatrix::zeros(0, 0);
            while basis.len() / n < full {
                let old = basis.len() / n;
                basis.extend_from_slice(&block);
                let mut next = mass_times(self.mass, &block);
                self.cholesky.solve(&mut next);
                self.solves += (next.len() / n) as u64;
                project_out(self.mass, self.locked, &mut next);
                let share = project_out(self.mass, &basis, &mut next);
                projected = bordered(projected, &share, old, block.len() / n);
                (block, coupling) = self.next_block(&basis, next);
                if block.is_empty() {
                    break;
                }
            }
            let pairs = sorted(&projected);
            let residual = |j: usize| residual(&coupling, &pairs, j);
            let theta = |j: usize| pairs.eigenvalues[j].abs();
            let allowed = |j: usize| (CONVERGED * theta(j)).max(ROUNDING * theta(0));
            converged = (0..count).take_while(|&j| residual(j) <= allowed(j)).count();
            let keep = if converged == count || block.is_empty() {
                count
            } else {
                (count + (full - count) / 3).min(basis.len() / n)
            };
            let mut kept = vec![0.0; n * keep];
            add_product(
                n,
                &mut kept,
                1.0,
                &basis,
                &pairs.eigenvectors.as_slice()[..keep * basis.len() / n],
            );
            if converged == count || block.is_empty() {
                return Ok(kept);
            }
            basis = kept;
            projected = DMatrix::from_diagonal(&pairs.eigenvalues.rows(0, keep).into_owned());
        }
        Err(ModalError::NotConverged { converged, asked: count, restarts: RESTARTS })
    }

    /// The columns made orthonormal, given that they are orthogonal to the basis already, and their
    /// coefficients R: x = (new columns) R. Lost ones are replaced at random while there is room.
    fn next_block(&mut self, basis: &[f64], columns: Vec<f64>) -> (Vec<f64>, DMatrix<f64>) {
        let n = self.mass.dim();
        let width = columns.len() / n;
        let mut block: Vec<f64> = Vec::with_capacity(columns.len());
        let mut r = DMatrix::zeros(width, width);
        let room = n - basis.len() / n - self.locked.len() / n;
        for (j, column) in columns.chunks_exact(n).enumerate() {
            if block.len() / n == room {
                break;
            }
            let mut x = column.to_vec();
            let before = self.length(&x);
            let share = project_out(self.mass, &block, &mut x);
            let mut after = self.length(&x);
            for (i, share) in share.iter().enumerate() {
                r[(i, j)] = *share;
            }
            if after > LOST * before {
                r[(block.len() / n, j)] = after;
            } else {
                x = self.fresh(basis, &block);
                after = self.length(&x);
            }
            block.extend(x.iter().map(|x| x / after));
        }
        (block, r)
    }

    /// A random vector orthogonal to everything.
    fn fresh(&mut self, basis: &[f64], block: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = (0..self.mass.dim()).map(|_| self.random.symmetric()).collect();
        for known in [self.locked, basis, block] {
            project_out(self.mass, known, &mut x);
        }
        x
    }

    fn length(&self, x: &[f64]) -> f64 {
        dot(x, &mass_times(self.mass, x)).max(0.0).sqrt()
    }
}

/// T of the first `old` vectors with `width` more columns, and their mirror.
fn bordered(t: DMatrix<f64>, share: &[f64], old: usize, width: usize) -> DMatrix<f64> {
    let size = old + width;
    let mut grown = t.resize(size, size, 0.0);
    for (j, column) in share.chunks_exact(size).enumerate() {
        for (i, &entry) in column.iter().enumerate() {
            if i < old {
                grown[(i, old + j)] = entry;
                grown[(old + j, i)] = entry;
            } else {
                // Symmetric but for rounding: the mean of both.
                grown[(i, old + j)] += 0.5 * entry;
                grown[(old + j, i)] += 0.5 * entry;
            }
        }
    }
    grown
}

struct Pairs {
    eigenvalues: nalgebra::DVector<f64>,
    eigenvectors: DMatrix<f64>,
}

/// The eigenpairs of T, largest first.
fn sorted(t: &DMatrix<f64>) -> Pairs {
    let pairs = SymmetricEigen::new(t.clone());
    let mut order: Vec<usize> = (0..t.nrows()).collect();
    order.sort_by(|&i, &j| pairs.eigenvalues[j].total_cmp(&pairs.eigenvalues[i]));
    Pairs {
        eigenvalues: nalgebra::DVector::from_iterator(
            order.len(),
            order.iter().map(|&i| pairs.eigenvalues[i]),
        ),
        eigenvectors: pairs.eigenvectors.select_columns(&order),
    }
}

/// The residual of a pair: what the last block of its coefficients leaves outside of the basis.
fn residual(coupling: &DMatrix<f64>, pairs: &Pairs, j: usize) -> f64 {
    let width = coupling.ncols();
    let size = pairs.eigenvectors.nrows();
    let last = pairs.eigenvectors.view((size - width, j), (width, 1));
    (coupling * last).norm()
}
