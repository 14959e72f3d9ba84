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
use crate::hessian_solver::largest_or_nan;
use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::cholesky::analysis_error;
use crate::sparse::error::TRUSTED;
use crate::sparse::lu::SparseLu;
use crate::sparse::pattern::Pattern;
use crate::sparse::scratch::Scratch;

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
    /// The factors that passed the check; none before that.
    pivoting: Option<Pivoting>,
    given: Vec<f64>,
    correction: Vec<f64>,
    best: Vec<f64>,
    product: Vec<f64>,
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
            pivoting: None,
            given: vec![0.0; n],
            correction: vec![0.0; n],
            best: vec![0.0; n],
            product: vec![0.0; n],
        })
    }

    /// Factors a matrix of the analysed pattern, and says which factors can be trusted.
    pub fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<Pivoting, SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        self.pivoting = None;
        if first_non_finite(matrix.values()).is_some() {
            return Err(SparseError::NonFinite);
        }
        if self.factor_symmetric(matrix) && self.finds_a_known_vector(Pivoting::Symmetric, matrix) {
            return Ok(Pivoting::Symmetric);
        }
        let rows = match &mut self.rows {
            Some(rows) => rows,
            none => none.insert(Unsymmetric::analyse(matrix)?),
        };
        rows.factor(matrix)?;
        if self.finds_a_known_vector(Pivoting::Rows, matrix) {
            return Ok(Pivoting::Rows);
        }
        Err(SparseError::Singular)
    }

    /// Solves `A x = b` in place, with the matrix factored last. After an error b is as it was.
    pub fn solve(
        &mut self,
        matrix: &SymmetricMatrix,
        b: &mut [f64],
    ) -> Result<Refined, SparseError> {
        matrix.pattern().check_vector(b)?;
        let pivoting = self.pivoting.ok_or(SparseError::NotFactored)?;
        self.given.copy_from_slice(b);
        let scale = largest_or_nan(b.iter().map(|b| b.abs()));
        self.once(pivoting, b);
        self.best.copy_from_slice(b);
        let mut residual = self.residual(matrix, b);
        let mut corrections = 0;
        while corrections < CORRECTIONS && residual > 0.0 && residual.is_finite() {
            let mut correction = std::mem::take(&mut self.correction);
            self.once(pivoting, &mut correction);
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
        matrix.add_product_unchecked(-1.0, x, &mut self.correction);
        largest_or_nan(self.correction.iter().map(|r| r.abs()))
    }

    /// One solve without any check.
    fn once(&mut self, pivoting: Pivoting, b: &mut [f64]) {
        match (pivoting, &mut self.rows) {
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

    /// Multiplies a vector without any pattern by the matrix and solves for it; keeps the factors
    /// if it is found again.
    fn finds_a_known_vector(&mut self, pivoting: Pivoting, matrix: &SymmetricMatrix) -> bool {
        let known = |i: usize| 1.0 + (0.618_033_988_749_895 * i as f64).fract();
        self.best.iter_mut().enumerate().for_each(|(i, x)| *x = known(i));
        let mut b = std::mem::take(&mut self.product);
        b.fill(0.0);
        matrix.add_product_unchecked(1.0, &self.best, &mut b);
        self.pivoting = Some(pivoting);
        let found = self.solve(matrix, &mut b).is_ok()
            && b.iter().enumerate().all(|(i, x)| (x - known(i)).abs() <= FOUND_AGAIN);
        self.product = b;
        if !found {
            self.pivoting = None;
        }
        found
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;

    type Blocks = Vec<(Vec<usize>, Vec<f64>)>;

    /// Where the unknowns of a chain are numbered.
    #[derive(Clone, Copy, Debug)]
    enum Numbering {
        LinkByLink,
        MultipliersLast,
        MultipliersFirst,
    }

    /// The saddle system of a planar chain of n links: unit masses, and for each link a row of
    /// the constraint's differential, `2 (x_i - x_(i-1))`, with zeros on its diagonal.
    fn chain(n: usize, numbering: Numbering) -> Blocks {
        let number = |link: usize, c: usize| match numbering {
            Numbering::LinkByLink => 3 * link + c,
            Numbering::MultipliersLast if c == 2 => 2 * n + link,
            Numbering::MultipliersLast => 2 * link + c,
            Numbering::MultipliersFirst if c == 2 => link,
            Numbering::MultipliersFirst => n + 2 * link + c,
        };
        let mut blocks = Vec::new();
        for link in 0..n {
            let angle = 0.3 * link as f64;
            let d = [2.0 * angle.cos(), 2.0 * angle.sin()];
            let lambda = number(link, 2);
            for (c, &d) in d.iter().enumerate() {
                blocks.push((vec![number(link, c)], vec![1.0]));
                blocks.push((vec![number(link, c), lambda], vec![0.0, d, d, 0.0]));
                if link > 0 {
                    let before = number(link - 1, c);
                    blocks.push((vec![before, lambda], vec![0.0, -d, -d, 0.0]));
                }
            }
        }
        blocks
    }

    fn assembled(n: usize, blocks: &Blocks) -> (SymmetricMatrix, SparseIndefinite) {
        let matrix = SymmetricMatrix::from_blocks(n, blocks).unwrap();
        let solver = SparseIndefinite::analyse(&matrix).unwrap();
        (matrix, solver)
    }

    fn relative_residual(matrix: &SymmetricMatrix, x: &[f64], b: &[f64]) -> f64 {
        let mut residual = b.to_vec();
        matrix.add_product(-1.0, x, &mut residual).unwrap();
        let largest = |x: &[f64]| largest_or_nan(x.iter().map(|x| x.abs()));
        largest(&residual) / largest(b)
    }

    #[test]
    fn chains_are_solved_however_they_are_numbered() {
        for links in [1, 2, 30, 1000] {
            for numbering in
                [Numbering::LinkByLink, Numbering::MultipliersLast, Numbering::MultipliersFirst]
            {
                let n = 3 * links;
                let (matrix, mut solver) = assembled(n, &chain(links, numbering));
                let pivoting = solver.factor(&matrix).unwrap();
                let b: Vec<f64> = (0..n).map(|i| (i as f64).cos()).collect();
                let mut x = b.clone();
                let refined = solver.solve(&matrix, &mut x).unwrap();
                assert_eq!(pivoting, Pivoting::Symmetric, "{links} {numbering:?}");
                assert!(relative_residual(&matrix, &x, &b) < 1e-13);
                assert!(refined.relative_residual < 1e-13);
            }
        }
    }

    #[test]
    fn the_solution_agrees_with_a_dense_one() {
        let (n, blocks) = (30, chain(10, Numbering::LinkByLink));
        let (matrix, mut solver) = assembled(n, &blocks);
        solver.factor(&matrix).unwrap();
        let mut dense = DMatrix::<f64>::zeros(n, n);
        for (freedoms, entries) in &blocks {
            for (k, entry) in entries.iter().enumerate() {
                let (i, j) = (freedoms[k % freedoms.len()], freedoms[k / freedoms.len()]);
                dense[(i, j)] += entry;
            }
        }
        let inverse = dense.try_inverse().unwrap();
        for j in 0..n {
            let mut x = vec![0.0; n];
            x[j] = 1.0;
            solver.solve(&matrix, &mut x).unwrap();
            for (x, exact) in x.iter().zip(inverse.column(j).iter()) {
                assert!((x - exact).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn a_zero_diagonal_is_no_obstacle() {
        for n in [2, 200] {
            // Pairs that only know each other: [0 k; k 0].
            let blocks: Blocks = (0..n / 2)
                .map(|i| (vec![i, n - 1 - i], vec![0.0, 1.0 + i as f64, 1.0 + i as f64, 0.0]))
                .collect();
            let (matrix, mut solver) = assembled(n, &blocks);
            solver.factor(&matrix).unwrap();
            let mut x: Vec<f64> = (0..n).map(|i| 1.0 + i as f64).collect();
            solver.solve(&matrix, &mut x).unwrap();
            for (i, x) in x.iter().take(n / 2).enumerate() {
                assert!((x * (1.0 + i as f64) - (n - i) as f64).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn where_exchanges_inside_of_panels_break_down_any_rows_are_exchanged() {
        // Random matrices with nothing on the diagonal.
        let mut state = 1_u64;
        let mut random = |bound: usize| {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 33) as usize % bound
        };
        let mut rows = 0;
        for _ in 0..100 {
            let n = 10 + random(50);
            let mut blocks = Blocks::new();
            for i in 0..2 * n {
                let (i, j) = (i % n, (i + 1 + random(n - 1)) % n);
                if i != j {
                    let entry = random(1000) as f64 / 500.0 - 1.0;
                    blocks.push((vec![i, j], vec![0.0, entry, entry, 0.0]));
                }
            }
            let (matrix, mut solver) = assembled(n, &blocks);
            match solver.factor(&matrix) {
                Ok(Pivoting::Symmetric) => {}
                Ok(Pivoting::Rows) => rows += 1,
                Err(error) => {
                    assert_eq!(error, SparseError::Singular);
                    continue;
                }
            }
            let mut x = vec![1.0; n];
            match solver.solve(&matrix, &mut x) {
                Ok(_) => assert!(relative_residual(&matrix, &x, &vec![1.0; n]) <= TRUSTED),
                Err(SparseError::Untrusted { relative_residual }) => {
                    assert!(relative_residual > TRUSTED);
                }
                Err(error) => panic!("{error}"),
            }
        }
        assert!(rows > 50, "{rows}");
    }

    #[test]
    fn singular_systems_are_refused() {
        // A constraint listed twice, a chain of springs that nothing holds, an unknown without a row.
        let mut twice = chain(5, Numbering::LinkByLink);
        for (freedoms, entries) in twice.clone() {
            if freedoms.len() == 2 && freedoms[1] == 8 {
                twice.push((vec![freedoms[0], 15], entries));
            }
        }
        let free: Blocks = (0..15).map(|i| (vec![i, i + 1], vec![0.1, -0.1, -0.1, 0.1])).collect();
        let empty: Blocks = (0..15).map(|i| (vec![i], vec![1.0])).collect();
        for blocks in [twice, free, empty] {
            let (matrix, mut solver) = assembled(16, &blocks);
            assert_eq!(solver.factor(&matrix), Err(SparseError::Singular));
        }
    }

    #[test]
    fn what_is_not_solved_is_refused_and_left_as_it_was() {
        let (matrix, mut solver) = assembled(15, &chain(5, Numbering::LinkByLink));
        let mut b = [1.0; 15];
        let error = solver.solve(&matrix, &mut b).unwrap_err();
        assert_eq!(error, SparseError::NotFactored);
        assert_eq!(b, [1.0; 15]);
    }

    #[test]
    fn numbers_that_are_not_finite_never_pass() {
        let mut blocks = chain(5, Numbering::LinkByLink);
        blocks[4].1[0] = f64::NAN;
        let (matrix, mut solver) = assembled(15, &blocks);
        assert_eq!(solver.factor(&matrix), Err(SparseError::NonFinite));
        let (matrix, mut solver) = assembled(15, &chain(5, Numbering::LinkByLink));
        solver.factor(&matrix).unwrap();
        let error = solver.solve(&matrix, &mut [f64::NAN; 15]).unwrap_err();
        assert!(matches!(error, SparseError::Untrusted { .. }));
    }
}
