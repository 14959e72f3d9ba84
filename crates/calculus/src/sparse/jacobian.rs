//! Sparse Jacobians, and the equation that Newton's method solves with one.
//!
//! ```text
//! J_ij = df_i / dx_j        m rows, n columns, entry by entry
//! ```
//! The pattern is found once from a first visit of the entries; later visits bring the same entries in
//! the same order, duplicates are summed, and nothing is searched or allocated. [`SparseEquation`]
//! solves `J delta = f` for a square J that need not be symmetric by elimination with row exchanges,
//! and refuses it where the relative residual is above 1e-8. A symmetric J, a Hessian, is better served by `SymmetricMatrix`.

use faer::sparse::{SparseColMatRef, SymbolicSparseColMat};

use crate::equation::length;
use crate::sparse::SparseError;
use crate::sparse::error::TRUSTED;
use crate::sparse::lu::SparseLu;
use crate::{Equation, SizeError, Unsolvable};

/// A sparse matrix in compressed columns.
#[derive(Clone, Debug)]
pub struct SparseJacobian {
    columns: SymbolicSparseColMat<u32>,
    /// Row, column and slot of each visited entry.
    visit: Vec<(u32, u32, u32)>,
    values: Vec<f64>,
}

/// Takes the entries of a Jacobian, one after another.
#[derive(Debug)]
pub struct JacobianEntries<'a>(Visit<'a>);

#[derive(Debug)]
enum Visit<'a> {
    First {
        rows: usize,
        columns: usize,
        seen: &'a mut Vec<(u32, u32, u32)>,
        error: Option<SparseError>,
    },
    Later {
        expected: &'a [(u32, u32, u32)],
        values: &'a mut [f64],
        at: usize,
        changed: Option<usize>,
    },
}

impl JacobianEntries<'_> {
    /// Adds `value` at (row, column).
    #[inline]
    pub fn add(&mut self, row: usize, column: usize, value: f64) {
        match &mut self.0 {
            Visit::Later { expected, values, at, changed } => {
                match expected.get(*at) {
                    Some(&(i, j, slot)) if i as usize == row && j as usize == column => {
                        values[slot as usize] += value;
                    }
                    _ => {
                        changed.get_or_insert(*at);
                    }
                }
                *at += 1;
            }
            Visit::First { rows, columns, seen, error } => {
                for (index, count) in [(row, *rows), (column, *columns)] {
                    if index >= count {
                        let block = seen.len();
                        let unknown =
                            SparseError::UnknownFreedom { block, freedom: index, freedoms: count };
                        error.get_or_insert(unknown);
                    }
                }
                seen.push((row as u32, column as u32, 0));
            }
        }
    }
}

impl SparseJacobian {
    /// The zero matrix of `rows` x `columns` with the pattern of the entries that `visit` brings.
    ///
    /// # Errors
    /// [`SparseError::UnknownFreedom`] for an entry outside of the matrix, whose number is then
    /// that of the block; [`SparseError::TooLarge`] for more rows, columns or entries than 32-bit
    /// indices can tell apart.
    pub fn analyse(
        rows: usize,
        columns: usize,
        visit: impl FnOnce(&mut JacobianEntries),
    ) -> Result<Self, SparseError> {
        let mut seen = Vec::new();
        let size = rows.max(columns);
        if size >= i32::MAX as usize {
            return Err(SparseError::TooLarge { what: "the number of unknowns", size });
        }
        let first = Visit::First { rows, columns, seen: &mut seen, error: None };
        let mut entries = JacobianEntries(first);
        visit(&mut entries);
        if let Visit::First { error: Some(error), .. } = entries.0 {
            return Err(error);
        }
        let mut places: Vec<(u32, u32)> = seen.iter().map(|&(i, j, _)| (j, i)).collect();
        places.sort_unstable();
        places.dedup();
        if places.len() >= i32::MAX as usize {
            return Err(SparseError::TooLarge {
                what: "the number of entries",
                size: places.len(),
            });
        }
        let mut starts = vec![0_u32; columns + 1];
        for &(j, _) in &places {
            starts[j as usize + 1] += 1;
        }
        for j in 0..columns {
            starts[j + 1] += starts[j];
        }
        for (i, j, slot) in &mut seen {
            *slot = places.partition_point(|place| *place < (*j, *i)) as u32;
        }
        let row_indices = places.iter().map(|&(_, i)| i).collect();
        Ok(SparseJacobian {
            columns: SymbolicSparseColMat::new_checked(rows, columns, starts, None, row_indices),
            visit: seen,
            values: vec![0.0; places.len()],
        })
    }

    /// Sets the values to the sums of the entries that `visit` brings: those that were analysed, in
    /// the same order. After an error the values are not to be used.
    ///
    /// # Errors
    /// [`SparseError::PatternChanged`] for the first entry that differs, is missing or is too many.
    pub fn refill(&mut self, visit: impl FnOnce(&mut JacobianEntries)) -> Result<(), SparseError> {
        self.values.fill(0.0);
        let mut entries = JacobianEntries(Visit::Later {
            expected: &self.visit,
            values: &mut self.values,
            at: 0,
            changed: None,
        });
        visit(&mut entries);
        match entries.0 {
            Visit::Later { changed: Some(block), .. } => Err(SparseError::PatternChanged { block }),
            Visit::Later { at, expected, .. } if at != expected.len() => {
                Err(SparseError::PatternChanged { block: at })
            }
            _ => Ok(()),
        }
    }

    /// The number of rows m.
    pub fn rows(&self) -> usize {
        self.columns.nrows()
    }

    /// The number of columns n.
    pub fn columns(&self) -> usize {
        self.columns.ncols()
    }

    /// Every stored entry as (row, column, value), column by column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> {
        let starts = self.columns.col_ptr();
        (0..self.columns()).flat_map(move |j| {
            (starts[j] as usize..starts[j + 1] as usize)
                .map(move |k| (self.columns.row_idx()[k] as usize, j, self.values[k]))
        })
    }

    /// Adds the product with a vector: `y += scale J x`.
    ///
    /// # Errors
    /// [`SizeError`] unless x has n components and y has m; y is then as it was.
    pub fn add_product(&self, scale: f64, x: &[f64], y: &mut [f64]) -> Result<(), SizeError> {
        SizeError::check("the vector's components", self.columns(), x.len())?;
        SizeError::check("the product's components", self.rows(), y.len())?;
        for (i, j, value) in self.entries() {
            y[i] += scale * value * x[j];
        }
        Ok(())
    }

    /// Adds the product with a covector: `y += scale J^T x`.
    ///
    /// # Errors
    /// [`SizeError`] unless x has m components and y has n; y is then as it was.
    pub fn add_transposed_product(
        &self,
        scale: f64,
        x: &[f64],
        y: &mut [f64],
    ) -> Result<(), SizeError> {
        SizeError::check("the covector's components", self.rows(), x.len())?;
        SizeError::check("the product's components", self.columns(), y.len())?;
        for (i, j, value) in self.entries() {
            y[j] += scale * value * x[i];
        }
        Ok(())
    }
}

/// The equation f(x) = 0 with a sparse square Jacobian.
#[derive(Clone, Debug)]
pub struct SparseEquation<F, D> {
    f: F,
    df: D,
    jacobian: SparseJacobian,
    lu: SparseLu,
    given: Vec<f64>,
}

impl<F: FnMut(&[f64], &mut [f64]), D: FnMut(&[f64], &mut JacobianEntries)> SparseEquation<F, D> {
    /// An equation whose Jacobian has at every x the pattern that it has at this one. `f` writes n
    /// numbers, `df` brings the Jacobian's entries, always in the same order.
    ///
    /// # Errors
    /// Those of [`SparseJacobian::analyse`]; [`SparseError::OutOfMemory`] and
    /// [`SparseError::TooLarge`] for factors that do not fit.
    pub fn new(x: &[f64], f: F, df: D) -> Result<Self, SparseError> {
        let (n, mut df) = (x.len(), df);
        let jacobian = SparseJacobian::analyse(n, n, |entries| df(x, entries))?;
        let lu = SparseLu::analyse(jacobian.columns.as_ref())?;
        Ok(SparseEquation { f, df, jacobian, lu, given: vec![0.0; n] })
    }

    fn factor_and_solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), SparseError> {
        self.jacobian.refill(|entries| (self.df)(x, entries))?;
        let columns = self.jacobian.columns.as_ref();
        self.lu.factor(SparseColMatRef::new(columns, &self.jacobian.values))?;
        self.given.copy_from_slice(f);
        self.lu.solve(f);
        let size = length(&self.given);
        self.jacobian.add_product(-1.0, f, &mut self.given)?;
        let relative_residual = length(&self.given) / size;
        if size == 0.0 || relative_residual <= TRUSTED {
            Ok(())
        } else if relative_residual.is_nan() {
            Err(SparseError::Singular)
        } else {
            Err(SparseError::Untrusted { relative_residual })
        }
    }
}

impl<F: FnMut(&[f64], &mut [f64]), D: FnMut(&[f64], &mut JacobianEntries)> Equation
    for SparseEquation<F, D>
{
    fn residual(&mut self, x: &[f64], f: &mut [f64]) {
        (self.f)(x, f);
    }

    fn solve(&mut self, x: &[f64], f: &mut [f64]) -> Result<(), Unsolvable> {
        self.factor_and_solve(x, f).map_err(SparseError::unsolvable)
    }

    /// The Euclidean length, in the units of f.
    fn norm(&mut self, f: &[f64]) -> f64 {
        length(f)
    }

    fn energy(&mut self, _: &[f64]) -> Option<f64> {
        None
    }

    fn unknowns(&self) -> Option<usize> {
        Some(self.given.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Newton, NewtonError, NewtonFailure, NewtonMemory, NewtonReport};

    #[test]
    fn duplicates_are_summed_and_products_are_transposes_of_each_other() {
        let visit = |entries: &mut JacobianEntries| {
            entries.add(1, 2, 4.0);
            entries.add(0, 0, 1.0);
            entries.add(1, 2, -1.0);
            entries.add(1, 0, 2.0);
        };
        let mut jacobian = SparseJacobian::analyse(2, 3, visit).unwrap();
        jacobian.refill(visit).unwrap();
        let entries: Vec<_> = jacobian.entries().collect();
        assert_eq!(entries, [(0, 0, 1.0), (1, 0, 2.0), (1, 2, 3.0)]);
        let (x, y) = ([1.0, 2.0, -1.0], [3.0, 5.0]);
        let (mut jx, mut jty) = ([0.0; 2], [0.0; 3]);
        jacobian.add_product(2.0, &x, &mut jx).unwrap();
        jacobian.add_transposed_product(2.0, &y, &mut jty).unwrap();
        assert_eq!((jx, jty), ([2.0, -2.0], [26.0, 0.0, 30.0]));
        assert!(jacobian.add_product(1.0, &y, &mut jx).is_err());
    }

    #[test]
    fn a_change_of_the_visit_is_an_error_that_names_the_entry() {
        let visit = |entries: &mut JacobianEntries| {
            entries.add(0, 0, 1.0);
            entries.add(1, 1, 1.0);
        };
        let mut jacobian = SparseJacobian::analyse(2, 2, visit).unwrap();
        let changed = jacobian.refill(|entries| entries.add(1, 1, 1.0)).unwrap_err();
        assert_eq!(changed, SparseError::PatternChanged { block: 0 });
        let changed = jacobian.refill(|entries| entries.add(0, 0, 1.0)).unwrap_err();
        assert_eq!(changed, SparseError::PatternChanged { block: 1 });
        let error = SparseJacobian::analyse(2, 2, |entries| entries.add(0, 2, 1.0)).unwrap_err();
        assert_eq!(error, SparseError::UnknownFreedom { block: 0, freedom: 2, freedoms: 2 });
    }

    /// Broyden's tridiagonal function: (3 - 2 x_i) x_i - x_(i-1) - 2 x_(i+1) + 1, not symmetric.
    /// More, Garbow, Hillstrom 1981, problem 30, start -1.
    fn broyden(n: usize, factor: f64) -> (Result<NewtonReport, NewtonError>, Vec<f64>, Vec<f64>) {
        let f = move |x: &[f64], f: &mut [f64]| {
            for i in 0..n {
                let before = if i > 0 { x[i - 1] } else { 0.0 };
                let after = x.get(i + 1).copied().unwrap_or(0.0);
                f[i] = (3.0 - 2.0 * x[i]) * x[i] - before - 2.0 * after + 1.0;
            }
        };
        let df = move |x: &[f64], df: &mut JacobianEntries| {
            for (i, x) in x.iter().enumerate() {
                df.add(i, i, factor * (3.0 - 4.0 * x));
                if i > 0 {
                    df.add(i, i - 1, -factor);
                    df.add(i - 1, i, factor * -2.0);
                }
            }
        };
        let mut x = vec![-1.0; n];
        let mut equation = SparseEquation::new(&x, f, df).unwrap();
        let mut memory = NewtonMemory::<Vec<f64>>::new(n, 50).unwrap();
        let report = Newton::default().solve(&mut equation, &mut x, &mut memory);
        (report, x, memory.history().to_vec())
    }

    #[test]
    fn a_sparse_equation_is_solved_in_as_few_steps_as_a_small_one() {
        for n in [1, 2, 10, 10_000] {
            let (report, x, history) = broyden(n, 1.0);
            let report = report.unwrap();
            assert!(report.iterations <= 7, "{n}: {history:?}");
            assert!(report.residual < 1e-13 * (n as f64).sqrt());
            if n == 10_000 {
                // Far from both ends the solution is constant: -2 x^2 + 1 = 0.
                assert!((x[5000] + 0.5_f64.sqrt()).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn a_singular_jacobian_is_refused() {
        let (report, ..) = broyden(10, 0.0);
        let failure = report.unwrap_err().failure;
        assert_eq!(failure, NewtonFailure::Unsolvable(Unsolvable::Singular));
        let (report, ..) = broyden(10, f64::NAN);
        let failure = report.unwrap_err().failure;
        assert_eq!(failure, NewtonFailure::Unsolvable(Unsolvable::NonFinite));
    }
}
