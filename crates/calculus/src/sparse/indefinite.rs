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
//! and refused, with its relative residual, if `|r| <= 1e-8 |b|` does not hold in the end. A matrix on
//! which a known vector is not found again is called singular when it is factored. The signs of B
//! are never read.

use std::sync::Arc;

use faer::perm::PermRef;
use faer::sparse::linalg::SupernodalThreshold;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, IntranodeLbltRef, SymbolicCholesky, SymbolicCholeskyRaw,
    SymmetricOrdering, factorize_symbolic_cholesky,
};
use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::first_non_finite;
use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::cholesky::analysis_error;
use crate::sparse::lu::SparseLu;
use crate::sparse::pattern::Pattern;
use crate::sparse::scratch::Scratch;

/// A relative residual up to this is trusted.
const TRUSTED: f64 = 1e-8;
/// A known vector that is found again up to this, relatively, shows that the matrix is regular.
const FOUND_AGAIN: f64 = 1e-3;
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
    symbolic: Arc<SymbolicCholesky<u32>>,
    factor: Vec<f64>,
    subdiagonal: Vec<f64>,
    forward: Vec<u32>,
    inverse: Vec<u32>,
    scratch: Scratch,
    rows: Option<Unsymmetric>,
    pivoting: Pivoting,
    given: Vec<f64>,
    correction: Vec<f64>,
    best: Vec<f64>,
}

impl SparseIndefinite {
    /// Finds the order of elimination and takes the memory of `L B L^T`, from the pattern of
    /// `matrix`. The memory of `L U` is taken when it is first needed.
    pub fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        let n = matrix.dim();
        let symbolic = factorize_symbolic_cholesky(
            matrix.pattern().columns.as_ref(),
            Side::Lower,
            SymmetricOrdering::Amd,
            CholeskySymbolicParams {
                supernodal_flop_ratio_threshold: SupernodalThreshold::FORCE_SUPERNODAL,
                ..CholeskySymbolicParams::default()
            },
        )
        .map_err(|error| analysis_error(n, error))?;
        let scratch = Scratch::new(
            n,
            &[
                symbolic.factorize_numeric_intranode_lblt_scratch::<f64>(Par::Seq, Spec::default()),
                symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            ],
        )?;
        Ok(SparseIndefinite {
            pattern: Arc::clone(matrix.pattern()),
            factor: vec![0.0; symbolic.len_val()],
            subdiagonal: vec![0.0; n],
            forward: vec![0; n],
            inverse: vec![0; n],
            symbolic: Arc::new(symbolic),
            scratch,
            rows: None,
            pivoting: Pivoting::Symmetric,
            given: vec![0.0; n],
            correction: vec![0.0; n],
            best: vec![0.0; n],
        })
    }

    /// Factors a matrix of the analysed pattern, and says which factors can be trusted.
    pub fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<Pivoting, SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        if first_non_finite(matrix.values()).is_some() {
            return Err(SparseError::NonFinite);
        }
        self.pivoting = Pivoting::Symmetric;
        if self.factor_symmetric(matrix) && self.finds_a_known_vector(matrix) {
            return Ok(self.pivoting);
        }
        self.pivoting = Pivoting::Rows;
        let rows = match &mut self.rows {
            Some(rows) => rows,
            none => none.insert(Unsymmetric::analyse(matrix)?),
        };
        rows.factor(matrix)?;
        if self.finds_a_known_vector(matrix) { Ok(self.pivoting) } else { Err(SparseError::Singular) }
    }

    /// Solves `A x = b` in place, with the matrix factored last. After an error b is as it was.
    pub fn solve(
        &mut self,
        matrix: &SymmetricMatrix,
        b: &mut [f64],
    ) -> Result<Refined, SparseError> {
        matrix.pattern().check_vector(b)?;
        self.given.copy_from_slice(b);
        let scale = largest(b);
        self.once(b);
        self.best.copy_from_slice(b);
        let mut residual = self.residual(matrix, b);
        let mut corrections = 0;
        while corrections < CORRECTIONS && residual > 0.0 && residual.is_finite() {
            let mut correction = std::mem::take(&mut self.correction);
            self.once(&mut correction);
            b.iter_mut().zip(&correction).for_each(|(x, c)| *x += c);
            self.correction = correction;
            let refined = self.residual(matrix, b);
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
        let relative_residual = if residual == 0.0 { 0.0 } else { residual / scale };
        if relative_residual <= TRUSTED {
            b.copy_from_slice(&self.best);
            Ok(Refined { relative_residual, corrections })
        } else {
            b.copy_from_slice(&self.given);
            Err(SparseError::Untrusted { relative_residual })
        }
    }

    /// Writes `given - A x` into `correction`; its largest component.
    fn residual(&mut self, matrix: &SymmetricMatrix, x: &[f64]) -> f64 {
        self.correction.copy_from_slice(&self.given);
        match matrix.add_product(-1.0, x, &mut self.correction) {
            Ok(()) if first_non_finite(&self.correction).is_none() => largest(&self.correction),
            _ => f64::NAN,
        }
    }

    /// One solve without any check.
    fn once(&mut self, b: &mut [f64]) {
        match (self.pivoting, &mut self.rows) {
            (Pivoting::Rows, Some(rows)) => rows.lu.solve(b),
            _ => {
                let n = b.len();
                IntranodeLbltRef::new(
                    &self.symbolic,
                    &self.factor,
                    &self.subdiagonal,
                    PermRef::new_checked(&self.forward, &self.inverse, n),
                )
                .solve_in_place_with_conj(
                    Conj::No,
                    MatMut::from_column_major_slice_mut(b, n, 1),
                    Par::Seq,
                    self.scratch.stack(),
                );
            }
        }
    }

    /// False where the factor is not finite, and where faer has no panels: it would then eliminate
    /// without any exchange and keep its errors to itself.
    fn factor_symmetric(&mut self, matrix: &SymmetricMatrix) -> bool {
        if matches!(self.symbolic.raw(), SymbolicCholeskyRaw::Simplicial(_)) {
            return false;
        }
        self.symbolic.factorize_numeric_intranode_lblt(
            &mut self.factor,
            &mut self.subdiagonal,
            &mut self.forward,
            &mut self.inverse,
            matrix.lower(),
            Side::Lower,
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
        first_non_finite(&self.factor).is_none() && first_non_finite(&self.subdiagonal).is_none()
    }

    /// Multiplies a vector without any pattern by the matrix and solves for it.
    fn finds_a_known_vector(&mut self, matrix: &SymmetricMatrix) -> bool {
        let n = matrix.dim();
        let known = |i: usize| 1.0 + (0.618_033_988_749_895 * i as f64).fract();
        let x: Vec<f64> = (0..n).map(known).collect();
        let mut b = vec![0.0; n];
        matrix.add_product(1.0, &x, &mut b).is_ok()
            && self.solve(matrix, &mut b).is_ok()
            && x.iter().zip(&b).all(|(x, y)| (x - y).abs() <= FOUND_AGAIN)
    }
}

fn largest(x: &[f64]) -> f64 {
    x.iter().fold(0.0, |largest, x| x.abs().max(largest))
}

/// Both triangles of a symmetric matrix, for elimination with any row exchanges.
#[derive(Clone, Debug)]
struct Unsymmetric {
    columns: SymbolicSparseColMat<u32>,
    values: Vec<f64>,
    /// Where each entry comes from in the lower triangle.
    sources: Vec<u32>,
    lu: SparseLu,
}

impl Unsymmetric {
    fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        let (n, lower_starts) = (matrix.dim(), matrix.column_starts());
        let mut entries = Vec::with_capacity(2 * matrix.rows().len());
        for j in 0..n as u32 {
            let column = lower_starts[j as usize]..lower_starts[j as usize + 1];
            for source in column {
                let i = matrix.rows()[source as usize];
                entries.push((j, i, source));
                if i != j {
                    entries.push((i, j, source));
                }
            }
        }
        entries.sort_unstable();
        let mut starts = vec![0_u32; n + 1];
        for &(column, ..) in &entries {
            starts[column as usize + 1] += 1;
        }
        for j in 0..n {
            starts[j + 1] += starts[j];
        }
        let rows = entries.iter().map(|&(_, row, _)| row).collect();
        let columns = SymbolicSparseColMat::new_checked(n, n, starts, None, rows);
        Ok(Unsymmetric {
            lu: SparseLu::analyse(columns.as_ref())?,
            columns,
            values: vec![0.0; entries.len()],
            sources: entries.iter().map(|&(.., source)| source).collect(),
        })
    }

    fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SparseError> {
        for (value, &source) in self.values.iter_mut().zip(&self.sources) {
            *value = matrix.values()[source as usize];
        }
        self.lu.factor(SparseColMatRef::new(self.columns.as_ref(), &self.values))
    }
}
