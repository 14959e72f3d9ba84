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

use nalgebra::DMatrix;
use stationary_calculus::{SparseCholesky, SymmetricMatrix};
use stationary_measure::SplitMix64;

use crate::ModalError;
use crate::dense::{Basis, Pairs, dot, eigenpairs, length, times};
use crate::modes::Found;

/// Vectors in a block.
const BLOCK: usize = 8;
/// Restarts before the search is given up.
const RESTARTS: usize = 60;
/// An approximation is good where its residual is this small relative to theta, or what rounding of
/// the largest theta leaves.
const CONVERGED: f64 = 1e-10;
const ROUNDING: f64 = 8.0 * f64::EPSILON;
/// A vector that is left with less than this share of the length that A gave it is replaced by a
/// random one.
const LOST: f64 = 1e-12;
/// A vector that is left with less than this share of that, or of what it was beside its own block, is
/// made orthogonal again: what rounding put into the large part that was taken out is large against the
/// rest. Of the basis it is taken out twice anyway.
const CANCELLED: f64 = 1e-9;
const CANCELLED_IN_BLOCK: f64 = 1e-3;
/// How often that is tried before what is left counts as rounding.
const CLEANINGS: usize = 4;

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
        let width = BLOCK.min(room);
        let (mut block, _) = self.next_block(&basis, vec![0.0; n * width], &vec![0.0; width]);
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
                let known = self.locked.project_out(0, &mut next);
                let share = basis.project_out(coupled, &mut next);
                let taken: Vec<f64> = (0..next.len() / n)
                    .map(|j| size_of_column(&known, self.locked.len(), j))
                    .zip((0..).map(|j| size_of_column(&share, basis.len(), j)))
                    .map(|(known, share)| known.hypot(share))
                    .collect();
                coupled = old;
                projected = bordered(projected, &share, old, block.len());
                let coupling;
                (block, coupling) = self.next_block(&basis, next, &taken);
                if block.len() > 0 && basis.len() < look {
                    continue;
                }
                look = (basis.len() + (basis.len() / BLOCK).max(BLOCK)).min(full);
                let pairs = largest_first(&projected)?;
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
    /// coefficients R: x = (new columns) R. `taken` are the lengths of what was taken out of them.
    /// Lost ones are replaced at random while there is room.
    fn next_block(
        &mut self,
        basis: &Basis,
        columns: Vec<f64>,
        taken: &[f64],
    ) -> (Basis, DMatrix<f64>) {
        let n = self.mass.dim();
        let width = columns.len() / n;
        let mut block = Basis::with_room(n, width);
        let mut r = DMatrix::zeros(width, width);
        let room = n - basis.len() - self.locked.len();
        for (j, column) in columns.chunks_exact(n).enumerate().take(room) {
            let mut x = column.to_vec();
            let shares = block.project_out(0, &mut x);
            let left = length(&x, &times(self.mass, &x));
            let beside = dot(&shares, &shares).sqrt().hypot(left);
            // The length that A gave, of which all that was taken out and the rest are parts.
            let given = taken[j].hypot(beside);
            r.view_mut((0, j), (shares.len(), 1)).copy_from_slice(&shares);
            let known = [&self.locked, basis, &block];
            let is_clean = left > CANCELLED * given && left > CANCELLED_IN_BLOCK * beside;
            let after = if is_clean { left } else { cleaned(self.mass, known, &mut x, left) };
            let after = if after > LOST * given {
                r[(block.len(), j)] = after;
                after
            } else {
                x = (0..n).map(|_| self.random.symmetric()).collect();
                cleaned(self.mass, known, &mut x, f64::INFINITY)
            };
            let moved = times(self.mass, &x);
            block.push(&x, &moved, after);
        }
        (block, r)
    }
}

/// Makes a vector orthogonal to all that is known, until that no longer shortens it; its length then,
/// or zero where nothing but rounding is left.
fn cleaned(mass: &SymmetricMatrix, known: [&Basis; 3], x: &mut [f64], mut before: f64) -> f64 {
    for _ in 0..CLEANINGS {
        for basis in known {
            basis.project_out(0, x);
        }
        let after = length(x, &times(mass, x));
        if after > 0.5 * before {
            return after;
        }
        before = after;
    }
    0.0
}

/// The length of a column of `size` numbers.
fn size_of_column(columns: &[f64], size: usize, j: usize) -> f64 {
    let column = &columns[j * size..(j + 1) * size];
    dot(column, column).sqrt()
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

/// The eigenpairs of T, largest first.
fn largest_first(t: &DMatrix<f64>) -> Result<Pairs, ModalError> {
    let Pairs { mut eigenvalues, mut eigenvectors } = eigenpairs(t.clone())?;
    let n = eigenvalues.len();
    for j in 0..n / 2 {
        eigenvalues.swap_rows(j, n - 1 - j);
        eigenvectors.swap_columns(j, n - 1 - j);
    }
    Ok(Pairs { eigenvalues, eigenvectors })
}

/// The residual of a pair: what the last block of its coefficients leaves outside of the basis.
fn residual(coupling: &DMatrix<f64>, pairs: &Pairs, j: usize) -> f64 {
    let width = coupling.ncols();
    let size = pairs.eigenvectors.nrows();
    let last = pairs.eigenvectors.view((size - width, j), (width, 1));
    (coupling * last).norm()
}
