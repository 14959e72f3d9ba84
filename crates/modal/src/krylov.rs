//! Block Lanczos in the mass inner product, with thick restarts.
//!
//! ```text
//! A = (H + delta M)^-1 M,     A v = theta v,     theta = 1/(lambda + delta)
//! A V_j = V T + V_(j+1) R_j,  V^T M V = I,       T = V^T M A V
//! ```
//! `H + delta M` is positive definite, so the lowest lambda are the largest theta, and Cholesky's
//! factor is enough. The basis V grows by a block of b vectors at a time, each orthogonal to all
//! before it, until enough of its approximations are good; where it is full before that, the best are
//! kept and it grows again. A block finds modes of multiplicity up to b at once and reads the factor
//! once for all of its solves.
//! Source: Grimes, Lewis and Simon, "A shifted block Lanczos algorithm for solving sparse symmetric
//! generalized eigenproblems" (SIAM J. Matrix Anal. 15, 1994); Wu and Simon, thick restarts (the same
//! journal, 22, 2000).

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::{SparseCholesky, SplitMix64, SymmetricMatrix};

use crate::ModalError;
use crate::dense::{Basis, dot, length, times};
use crate::modes::Found;

/// Vectors in a block.
const BLOCK: usize = 8;
/// Restarts before the search is given up.
const RESTARTS: usize = 60;
/// An approximation is good where its residual is this small relative to theta, or what rounding of
/// the largest theta leaves.
const CONVERGED: f64 = 1e-10;
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A vector that is left with less than this share of its length is replaced by a random one.
const LOST: f64 = 1e-12;

/// The search for the largest theta, with a factor of `H + delta M`.
pub(crate) struct Krylov<'a> {
    cholesky: &'a mut SparseCholesky,
    mass: &'a SymmetricMatrix,
    delta: f64,
    /// Vectors that every other is kept orthogonal to.
    locked: Basis,
    random: SplitMix64,
    solves: u64,
}

impl<'a> Krylov<'a> {
    pub(crate) fn new(
        cholesky: &'a mut SparseCholesky,
        mass: &'a SymmetricMatrix,
        delta: f64,
        locked: &[f64],
    ) -> Self {
        let locked = Basis::of(mass, locked);
        Krylov { cholesky, mass, delta, locked, random: SplitMix64::new(14), solves: 0 }
    }

    /// The vectors of the `count` largest theta, that is of the lowest lambda.
    pub(crate) fn lowest(&mut self, count: usize) -> Result<Found, ModalError> {
        let n = self.mass.dim();
        let room = n - self.locked.len();
        let full = (2 * count + 10 * BLOCK).min(room);
        let mut basis = Basis::with_room(n, full + BLOCK);
        let mut projected = DMatrix::<f64>::zeros(0, 0);
        let (mut block, _) = self.next_block(&basis, vec![0.0; n * BLOCK.min(room)]);
        let mut converged = 0;
        for _ in 0..RESTARTS {
            // What A makes of a block is coupled to that block and to the one before; of the first
            // block to all that was kept.
            let mut coupled = 0;
            // Approximations are looked at when the basis has grown by an eighth since.
            let mut look = (count + BLOCK).min(full);
            loop {
                let old = basis.len();
                basis.append(&block);
                let mut next = block.moved().to_vec();
                self.cholesky.solve(&mut next);
                self.solves += (next.len() / n) as u64;
                self.locked.project_out(0, &mut next);
                let share = basis.project_out(coupled, &mut next);
                coupled = old;
                projected = bordered(projected, &share, old, block.len());
                let coupling;
                (block, coupling) = self.next_block(&basis, next);
                if block.len() > 0 && basis.len() < look {
                    continue;
                }
                look = (basis.len() + (basis.len() / BLOCK).max(BLOCK)).min(full);
                let pairs = sorted(&projected);
                let theta = |j: usize| pairs.eigenvalues[j].abs();
                let allowed = |j: usize| (CONVERGED * theta(j)).max(ROUNDING * theta(0));
                let good = |j: &usize| residual(&coupling, &pairs, *j) <= allowed(*j);
                converged = (0..count).take_while(good).count();
                if converged == count || block.len() == 0 {
                    let weights = &pairs.eigenvectors.as_slice()[..count * basis.len()];
                    let next = pairs.eigenvalues.get(count).map(|theta| 1.0 / theta - self.delta);
                    let vectors = basis.combined(weights).vectors().to_vec();
                    return Ok(Found { vectors, next, solves: self.solves });
                }
                if basis.len() >= full {
                    let keep = (count + (full - count) / 3).min(basis.len());
                    let weights = &pairs.eigenvectors.as_slice()[..keep * basis.len()];
                    let kept = basis.combined(weights);
                    basis.clear();
                    basis.append(&kept);
                    let kept = pairs.eigenvalues.rows(0, keep).into_owned();
                    projected = DMatrix::from_diagonal(&kept);
                    break;
                }
            }
        }
        Err(ModalError::NotConverged { converged, asked: count, restarts: RESTARTS })
    }

    /// The columns made orthonormal, given that they are orthogonal to the basis already, and their
    /// coefficients R: x = (new columns) R. Lost ones are replaced at random while there is room.
    fn next_block(&mut self, basis: &Basis, columns: Vec<f64>) -> (Basis, DMatrix<f64>) {
        let n = self.mass.dim();
        let width = columns.len() / n;
        let mut block = Basis::with_room(n, width);
        let mut r = DMatrix::zeros(width, width);
        let room = n - basis.len() - self.locked.len();
        for (j, column) in columns.chunks_exact(n).enumerate().take(room) {
            let mut x = column.to_vec();
            let shares = block.project_out(0, &mut x);
            let mut moved = times(self.mass, &x);
            let mut after = length(&x, &moved);
            // The column's own length, of which the shares and the rest are orthogonal parts.
            let before = dot(&shares, &shares).sqrt().hypot(after);
            r.view_mut((0, j), (shares.len(), 1)).copy_from_slice(&shares);
            if after > LOST * before {
                r[(block.len(), j)] = after;
            } else {
                x = self.fresh(basis, &block);
                moved = times(self.mass, &x);
                after = length(&x, &moved);
            }
            block.push(&x, &moved, after);
        }
        (block, r)
    }

    /// A random vector orthogonal to everything.
    fn fresh(&mut self, basis: &Basis, block: &Basis) -> Vec<f64> {
        let mut x: Vec<f64> = (0..self.mass.dim()).map(|_| self.random.symmetric()).collect();
        for known in [&self.locked, basis, block] {
            known.project_out(0, &mut x);
        }
        x
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
