//! Solves with a sparse symmetric matrix that is not definite, and proves each solution.
//!
//! ```text
//! P A P^T = L B L^T      B diagonal, with blocks of 1 and 2 on it
//! P A Q   = L U          where the first is not to be trusted
//! ```
//! `A` a [`SymmetricMatrix`] (n x n): a saddle system, a Hessian at an unstable equilibrium, a shifted
//! stiffness. `L B L^T` keeps the fill of Cholesky's method, but exchanges rows within a panel of
//! columns only, so that it may break down on matrices that are perfectly regular; `L U` exchanges
//! any rows and costs more. Neither is believed: every solution is refined,
//!
//! ```text
//! r = b - A x,    x <- x + A^-1 r       while the residual halves,
//! ```
//! and refused, with its relative residual, if `|r| <= 1e-8 |b|` does not hold in the end: rounding x
//! alone leaves `eps |A| |x|`, so that from a condition of 1e8 on some b are refused. Before it is, `L U` takes
//! over from `L B L^T`, of which entries may have grown unseen. A matrix is
//! called singular when it is factored if a known vector v is not found again up to 1e-3, or if
//! rounding alone could have moved it by more,
//!
//! ```text
//! eps | |A^-1| |A| |v| |_inf  >=  eps | A^-1 d |_inf,     d_i = sgn((A^-1 v)_i) (|A| |v|)_i
//! ```
//! which luck cannot hide: where A is nearly singular `A^-1 v` points along its null vector, and d is
//! not orthogonal to that (Hager, Condition estimates, SIAM J. Sci. Stat. Comput. 5, 1984). The signs of B are never read.
//! Products of entries that leave the range of numbers are kept within it by a power of two.

mod rows;
mod symmetric;
#[cfg(test)]
mod tests;

use std::sync::Arc;

use crate::equation::power_of_two;
use crate::first_non_finite;
use crate::hessian_solver::largest_or_nan;
use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::error::TRUSTED;
use crate::sparse::pattern::Pattern;
use rows::RowPivoting;
use symmetric::SymmetricPivoting;

/// A known vector that is found again up to this, relatively, shows that the matrix is regular.
const FOUND_AGAIN: f64 = 1e-3;
/// Numbers below this do not have all their digits, so that a residual relative to them is no measure.
const LEAST: f64 = f64::MIN_POSITIVE / f64::EPSILON;
/// Refinement stops after this many corrections.
const CORRECTIONS: u32 = 5;

/// Which factors passed the check.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pivoting {
    /// `L B L^T`, with exchanges inside of panels.
    Symmetric,
    /// `L U`, with exchanges of any rows.
    Rows,
}

/// A solution that passed the check.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refined {
    /// The residual relative to the right-hand side, both by their largest component.
    pub relative_residual: f64,
    /// Corrections that made the residual smaller.
    pub corrections: u32,
}

/// The factors of a symmetric indefinite matrix, or the memory for them.
#[derive(Clone, Debug)]
pub struct SparseIndefinite {
    pattern: Arc<Pattern>,
    symmetric: SymmetricPivoting,
    rows: Option<RowPivoting>,
    /// The factors that passed the check; none before that.
    pivoting: Option<Pivoting>,
    /// How far off the known vector was found again.
    found_off: f64,
    /// The power of two by which the matrix was divided before it was factored.
    unit: f64,
    given: Vec<f64>,
    correction: Vec<f64>,
    best: Vec<f64>,
    product: Vec<f64>,
}

impl SparseIndefinite {
    /// Finds the order of elimination and takes the memory of `L B L^T`, from the pattern of
    /// `matrix`. The memory of `L U` is taken when it is first needed.
    ///
    /// # Errors
    /// [`SparseError::OutOfMemory`] and [`SparseError::TooLarge`] for a factor that does not fit
    /// into memory or into 32-bit indices.
    pub fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        let n = matrix.dim();
        Ok(SparseIndefinite {
            pattern: Arc::clone(matrix.pattern()),
            symmetric: SymmetricPivoting::analyse(matrix)?,
            rows: None,
            pivoting: None,
            found_off: f64::INFINITY,
            unit: 1.0,
            given: vec![0.0; n],
            correction: vec![0.0; n],
            best: vec![0.0; n],
            product: vec![0.0; n],
        })
    }

    /// Factors a matrix of the analysed pattern, and says which factors can be trusted.
    ///
    /// # Errors
    /// [`SparseError::OtherPattern`] for a matrix of another analysis; [`SparseError::NonFinite`]
    /// for an entry; [`SparseError::Singular`] where neither factors find a known vector again;
    /// those of [`SparseIndefinite::analyse`] where `L U` needs its memory.
    pub fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<Pivoting, SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        self.pivoting = None;
        if first_non_finite(matrix.values()).is_some() {
            return Err(SparseError::NonFinite);
        }
        self.unit = power_of_two(largest_or_nan(matrix.values().iter().map(|entry| entry.abs())));
        let in_range = self.in_range(matrix);
        let factored = in_range.as_ref().unwrap_or(matrix);
        if self.symmetric.factor(factored) && self.finds_a_known_vector(Pivoting::Symmetric, matrix)
        {
            return Ok(Pivoting::Symmetric);
        }
        self.factor_by_rows(matrix)
    }

    /// The matrix over its unit, where that is not 1.
    fn in_range(&self, matrix: &SymmetricMatrix) -> Option<SymmetricMatrix> {
        (self.unit != 1.0).then(|| matrix.divided_by(self.unit))
    }

    fn factor_by_rows(&mut self, matrix: &SymmetricMatrix) -> Result<Pivoting, SparseError> {
        let in_range = self.in_range(matrix);
        let rows = match &mut self.rows {
            Some(rows) => rows,
            none => none.insert(RowPivoting::analyse(matrix)?),
        };
        rows.factor(in_range.as_ref().unwrap_or(matrix))?;
        if self.finds_a_known_vector(Pivoting::Rows, matrix) {
            return Ok(Pivoting::Rows);
        }
        Err(SparseError::Singular)
    }

    /// Solves `A x = b` in place, with the matrix factored last. After an error b is as it was.
    ///
    /// # Errors
    /// [`SparseError::OtherPattern`] for a matrix of another analysis; [`SparseError::Size`] unless b
    /// has n components; [`SparseError::NotFactored`] unless the
    /// last factorization succeeded; [`SparseError::Untrusted`] for a relative residual above 1e-8,
    /// also where b or x is not finite.
    pub fn solve(
        &mut self,
        matrix: &SymmetricMatrix,
        b: &mut [f64],
    ) -> Result<Refined, SparseError> {
        self.solve_within(matrix, b, TRUSTED)
    }

    /// The same where another relative residual is trusted: for who has bounded the condition by
    /// [`SparseIndefinite::known_vector_error`], and so the error of `x`, which a residual is no measure of where
    /// rounding `x` alone leaves it.
    ///
    /// # Errors
    /// Those of [`SparseIndefinite::solve`], and for a residual that is larger than `trusted`.
    pub fn solve_within(
        &mut self,
        matrix: &SymmetricMatrix,
        b: &mut [f64],
        trusted: f64,
    ) -> Result<Refined, SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        self.pattern.check_vector(b)?;
        let pivoting = self.pivoting.ok_or(SparseError::NotFactored)?;
        match self.solve_by(pivoting, matrix, b, trusted) {
            // Exchanges within panels let entries of L grow, by which a known vector is found again and b is not.
            Err(SparseError::Untrusted { relative_residual })
                if pivoting == Pivoting::Symmetric && relative_residual.is_finite() =>
            {
                let known_vector_error = self.found_off;
                if self.factor_by_rows(matrix).is_ok() {
                    return self.solve_by(Pivoting::Rows, matrix, b, trusted);
                }
                (self.pivoting, self.found_off) = (Some(pivoting), known_vector_error);
                Err(SparseError::Untrusted { relative_residual })
            }
            solved => solved,
        }
    }

    /// Solves by these factors; after an error b is as it was.
    fn solve_by(
        &mut self,
        pivoting: Pivoting,
        matrix: &SymmetricMatrix,
        b: &mut [f64],
        trusted: f64,
    ) -> Result<Refined, SparseError> {
        self.given.copy_from_slice(b);
        let scale = largest_or_nan(b.iter().map(|b| b.abs()));
        // What is large is divided, as the terms of the residual may be larger than both A and x.
        let load = power_of_two(scale).max(1.0);
        if load > 1.0 {
            b.iter_mut().for_each(|b| *b /= load);
        }
        self.once(pivoting, b);
        self.best.copy_from_slice(b);
        let mut residual = self.residual(matrix, load, b);
        let mut corrections = 0;
        while corrections < CORRECTIONS && residual > 0.0 && residual.is_finite() {
            let mut correction = std::mem::take(&mut self.correction);
            self.once(pivoting, &mut correction);
            b.iter_mut().zip(&correction).for_each(|(x, c)| *x += c);
            self.correction = correction;
            let refined = self.residual(matrix, load, b);
            if refined < residual {
                self.best.copy_from_slice(b);
                corrections += 1;
            }
            let halved = refined <= 0.5 * residual;
            residual = residual.min(refined);
            if !halved {
                break;
            }
        }
        let least = (scale / load).max(LEAST);
        let relative_residual = if residual == 0.0 { 0.0 } else { residual / least };
        b.iter_mut().zip(&self.best).for_each(|(b, best)| *b = best * load);
        // Of what is too large for a number no residual is left that says anything.
        let is_number = first_non_finite(b).is_none();
        let relative_residual = if is_number { relative_residual } else { f64::INFINITY };
        if relative_residual <= trusted {
            Ok(Refined { relative_residual, corrections })
        } else {
            b.copy_from_slice(&self.given);
            Err(SparseError::Untrusted { relative_residual })
        }
    }

    /// Writes `given / load - A x` into `correction`; its largest component.
    fn residual(&mut self, matrix: &SymmetricMatrix, load: f64, x: &[f64]) -> f64 {
        self.correction.iter_mut().zip(&self.given).for_each(|(r, b)| *r = b / load);
        matrix.add_product_unchecked(-1.0, x, &mut self.correction);
        largest_or_nan(self.correction.iter().map(|r| r.abs()))
    }

    /// One solve without any check.
    fn once(&mut self, pivoting: Pivoting, b: &mut [f64]) {
        let load = power_of_two(largest_or_nan(b.iter().map(|b| b.abs())));
        if load != 1.0 {
            b.iter_mut().for_each(|x| *x /= load);
        }
        self.substitute(pivoting, b);
        if load != 1.0 || self.unit != 1.0 {
            let unit = load / self.unit;
            b.iter_mut().for_each(|x| *x *= unit);
        }
    }

    /// A solve with the matrix over its unit.
    fn substitute(&mut self, pivoting: Pivoting, b: &mut [f64]) {
        match (pivoting, &mut self.rows) {
            (Pivoting::Rows, Some(rows)) => rows.solve(b),
            _ => self.symmetric.solve(b),
        }
    }

    /// Multiplies a vector without any pattern by the matrix and solves for it; keeps the factors
    /// if it is found again.
    fn finds_a_known_vector(&mut self, pivoting: Pivoting, matrix: &SymmetricMatrix) -> bool {
        // In units in which the product is neither large nor small.
        let unit = self.unit;
        self.best.iter_mut().enumerate().for_each(|(i, x)| *x = known(i) / unit);
        let mut b = std::mem::take(&mut self.product);
        b.fill(0.0);
        matrix.add_product_unchecked(1.0, &self.best, &mut b);
        let solved = self.solve_by(pivoting, matrix, &mut b, TRUSTED).is_ok();
        let off = largest_or_nan(b.iter().enumerate().map(|(i, x)| (x * unit - known(i)).abs()));
        self.product = b;
        let moved = self.moved_by_rounding(pivoting, matrix);
        let found = solved && off <= FOUND_AGAIN && moved <= FOUND_AGAIN;
        self.found_off = if found { off } else { f64::INFINITY };
        self.pivoting = found.then_some(pivoting);
        found
    }

    /// How far rounding the product `A v` moves the known vector v, from below: `eps |A^-1 d|` of
    /// Hager's estimate.
    fn moved_by_rounding(&mut self, pivoting: Pivoting, matrix: &SymmetricMatrix) -> f64 {
        let mut x = std::mem::take(&mut self.product);
        x.iter_mut().enumerate().for_each(|(i, x)| *x = known(i));
        self.substitute(pivoting, &mut x);
        let unit = self.unit;
        self.best.iter_mut().enumerate().for_each(|(i, v)| *v = known(i) / unit);
        matrix.sizes_of_product(&self.best, &mut self.correction);
        x.iter_mut().zip(&self.correction).for_each(|(x, size)| *x = size.copysign(*x));
        self.substitute(pivoting, &mut x);
        let moved = f64::EPSILON * largest_or_nan(x.iter().map(|x| x.abs()));
        self.product = x;
        moved
    }

    /// How far off, relatively, a known vector was found again with the matrix factored last: about
    /// rounding times its condition, and infinite where it was not found.
    pub fn known_vector_error(&self) -> f64 {
        self.found_off
    }
}

/// A vector without any pattern.
fn known(i: usize) -> f64 {
    1.0 + (0.618_033_988_749_895 * i as f64).fract()
}
