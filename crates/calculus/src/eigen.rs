//! Eigenvalues of a form relative to a metric, and what symmetry means for each kind of matrix.
//!
//! ```text
//! bilinear form f            symmetric       [f]^T = [f]
//! linear transformation M    self-adjoint    [M]^T [g] = [g] [M]
//! f(v_i, .) = lambda_i v_i^flat              [f] V = [g] V Lambda,    V^T [g] V = I
//! ```
//! `f g` symmetric n x n, `g` positive definite; columns of `V` the eigenvectors, `lambda` ascending.
//! With `g = L L^T` the ordinary eigenvectors Q of `L^-1 f L^-T` give `V = L^-T Q`. A self-adjoint M
//! has the eigenpairs of the form `[g][M]`.
//! The sign of an eigenvector is free: here its largest component is positive, the first of them
//! where several are equal up to a millionth, so that the answer is the same in every run.
//! Source: notes 1.4.1, table 1.2. Dense and small; large sparse problems belong to `modal`.

use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

use crate::{BilinearForm, LinearTransformation, Readable, SizeError};

/// Matrices that have no real eigenvalues and orthonormal eigenvectors.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum EigenError {
    /// Both matrices must be square and of one size.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Both matrices must be finite, and so must be the answer.
    #[error("{which} is not finite")]
    NotFinite {
        /// "the form", "the metric", or "an eigenvalue or an eigenvector".
        which: &'static str,
    },
    /// Both matrices must be symmetric to twelve digits; a transformation must be self-adjoint.
    #[error(
        "{which} is not symmetric: entry ({row}, {column}) is {entry}, its mirror {mirror}",
        entry = Readable(entry), mirror = Readable(mirror)
    )]
    NotSymmetric {
        /// Which matrix: "the form" or "the metric".
        which: &'static str,
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        entry: f64,
        /// The entry at (column, row).
        mirror: f64,
    },
    /// The metric must give every vector but zero a positive length.
    #[error("the metric is not positive definite")]
    NotPositiveDefinite,
    /// The iteration for the eigenvalues did not end.
    #[error("the eigenvalues did not converge")]
    NotConverged,
}

/// The eigenvalues of a form relative to a metric, ascending, and its eigenvectors, orthonormal.
#[derive(Clone, Debug, PartialEq)]
pub struct Eigenpairs {
    /// The eigenvalues, ascending.
    pub values: DVector<f64>,
    /// The eigenvectors V, columns, with `V^T g V = I`.
    pub vectors: DMatrix<f64>,
}

impl BilinearForm {
    /// The eigenpairs of a symmetric form relative to a metric: `[f] v = lambda [g] v`.
    ///
    /// # Errors
    /// [`EigenError`]: matrices that are not square or not of one size, not finite or not
    /// symmetric; a metric that is not positive definite; an iteration that does not converge;
    /// eigenvalues or eigenvectors that overflow.
    pub fn eigenpairs(&self, metric: &BilinearForm) -> Result<Eigenpairs, EigenError> {
        let n = metric.0.nrows();
        check_symmetric("the metric", &metric.0, n)?;
        check_symmetric("the form", &self.0, n)?;
        if n == 0 {
            return Ok(Eigenpairs { values: DVector::zeros(0), vectors: DMatrix::zeros(0, 0) });
        }
        let l = Cholesky::new(metric.0.clone()).ok_or(EigenError::NotPositiveDefinite)?.unpack();
        let singular = EigenError::NotPositiveDefinite;
        let half = l.solve_lower_triangular(&self.0).ok_or(singular)?;
        let whole = l.solve_lower_triangular(&half.transpose()).ok_or(singular)?;
        let symmetric = (&whole + whole.transpose()) * 0.5;
        let ordinary = SymmetricEigen::try_new(symmetric, f64::EPSILON, 100 * n)
            .ok_or(EigenError::NotConverged)?;
        let v = l.tr_solve_lower_triangular(&ordinary.eigenvectors).ok_or(singular)?;
        let pairs = sorted(&ordinary.eigenvalues, &v);
        if pairs.values.iter().chain(pairs.vectors.iter()).all(|x| x.is_finite()) {
            Ok(pairs)
        } else {
            Err(EigenError::NotFinite { which: "an eigenvalue or an eigenvector" })
        }
    }
}

impl LinearTransformation {
    /// The eigenpairs of a transformation that is self-adjoint for the metric: `[M] v = lambda v`.
    ///
    /// # Errors
    /// [`EigenError::NotSymmetric`] for a transformation that is not self-adjoint; else those of
    /// [`BilinearForm::eigenpairs`], of the form `[g][M]`.
    pub fn eigenpairs(&self, metric: &BilinearForm) -> Result<Eigenpairs, EigenError> {
        self.lowered(metric)?.eigenpairs(metric)
    }

    /// Whether `g(v, M w) = g(M v, w)` for all vectors, to twelve digits.
    ///
    /// # Errors
    /// [`SizeError`] unless the transformation has as many rows as the metric has columns. What is
    /// not square or not finite is not self-adjoint.
    pub fn is_self_adjoint(&self, metric: &BilinearForm) -> Result<bool, SizeError> {
        let form = self.lowered(metric)?.0;
        Ok(check_symmetric("the form", &form, form.nrows()).is_ok())
    }

    /// The form `[g][M]`, that is `g(v, M w)`.
    fn lowered(&self, metric: &BilinearForm) -> Result<BilinearForm, SizeError> {
        SizeError::check("the transformation's rows", metric.0.ncols(), self.0.nrows())?;
        Ok(BilinearForm(&metric.0 * &self.0))
    }
}

fn check_symmetric(which: &'static str, a: &DMatrix<f64>, n: usize) -> Result<(), EigenError> {
    SizeError::check("the matrix's rows", n, a.nrows())?;
    SizeError::check("the matrix's columns", n, a.ncols())?;
    if a.iter().any(|entry| !entry.is_finite()) {
        return Err(EigenError::NotFinite { which });
    }
    // Freedoms of unlike units: each entry beside the largest of its own rows and columns.
    let sizes: Vec<f64> = (0..n).map(|k| a.row(k).amax().max(a.column(k).amax()).sqrt()).collect();
    for column in 0..n {
        for row in column + 1..n {
            let (entry, mirror) = (a[(row, column)], a[(column, row)]);
            if (entry - mirror).abs() > 1e-12 * sizes[row] * sizes[column] {
                return Err(EigenError::NotSymmetric { which, row, column, entry, mirror });
            }
        }
    }
    Ok(())
}

fn sorted(values: &DVector<f64>, vectors: &DMatrix<f64>) -> Eigenpairs {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let columns: Vec<DVector<f64>> = order
        .iter()
        .map(|&k| {
            let v = vectors.column(k);
            let nearly_largest = 0.999_999 * v.amax();
            let leading = v.iter().find(|x| x.abs() >= nearly_largest);
            if leading.is_some_and(|&x| x < 0.0) { -v } else { v.into_owned() }
        })
        .collect();
    Eigenpairs {
        values: DVector::from_iterator(order.len(), order.iter().map(|&k| values[k])),
        vectors: DMatrix::from_columns(&columns),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ChangeOfBasis, Vector};
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    fn matrix() -> impl Strategy<Value = DMatrix<f64>> {
        prop::array::uniform9(-1.0..1.0).prop_map(|a| DMatrix::from_column_slice(3, 3, &a))
    }

    fn metric() -> impl Strategy<Value = BilinearForm> {
        matrix().prop_map(|a| BilinearForm(a.tr_mul(&a) + DMatrix::identity(3, 3)))
    }

    fn symmetric() -> impl Strategy<Value = BilinearForm> {
        matrix().prop_map(|a| BilinearForm(&a + a.transpose()))
    }

    proptest! {
        #[test]
        fn eigenvectors_are_orthonormal_and_diagonalize_the_form(f in symmetric(), g in metric()) {
            let Eigenpairs { values, vectors: v } = f.eigenpairs(&g).unwrap();
            let lambda = DMatrix::from_diagonal(&values);
            prop_assert!((v.tr_mul(&(&g.0 * &v)) - DMatrix::identity(3, 3)).amax() < 1e-13);
            prop_assert!((v.tr_mul(&(&f.0 * &v)) - &lambda).amax() < 1e-13);
            prop_assert!((&f.0 * &v - &g.0 * &v * lambda).amax() < 1e-13);
            prop_assert!(values[0] <= values[1] && values[1] <= values[2]);
            prop_assert!(v.column_iter().all(|v| v.max() >= 0.999_998 * v.amax()));
        }

        #[test]
        fn eigenvalues_do_not_depend_on_the_basis(
            f in symmetric(), g in metric(), t in matrix(),
        ) {
            let t = ChangeOfBasis::new(t + 4.0 * DMatrix::identity(3, 3)).unwrap();
            let old = f.eigenpairs(&g).unwrap().values;
            let new = t.form(&f).unwrap().eigenpairs(&t.form(&g).unwrap()).unwrap().values;
            prop_assert!((old - new).amax() < 1e-12);
        }

        #[test]
        fn raising_an_index_of_a_symmetric_form_gives_a_self_adjoint_transformation(
            f in symmetric(), g in metric(),
        ) {
            let m = LinearTransformation(g.0.clone().try_inverse().unwrap() * &f.0);
            prop_assert!(m.is_self_adjoint(&g).unwrap());
            let (form, map) = (f.eigenpairs(&g).unwrap(), m.eigenpairs(&g).unwrap());
            prop_assert!((form.values - map.values).amax() < 1e-12);
        }
    }

    /// Table 1.2 on the polynomials of degree two with the L2 inner product on [0, 1]: Legendre's
    /// operator `-(x (1 - x) v')'` is self-adjoint, its eigenvalues k (k + 1) belong to the shifted
    /// Legendre polynomials, and its matrix is not symmetric.
    #[test]
    fn legendre_polynomials_are_the_eigenvectors_of_a_self_adjoint_transformation() {
        let g = BilinearForm(DMatrix::from_fn(3, 3, |i, j| 1.0 / (i + j + 1) as f64));
        let m = LinearTransformation(dmatrix![0.0, -1.0, 0.0; 0.0, 2.0, -4.0; 0.0, 0.0, 6.0]);
        assert!(m.is_self_adjoint(&g).unwrap());
        assert!(!m.is_self_adjoint(&BilinearForm(DMatrix::identity(3, 3))).unwrap());
        let Eigenpairs { values, vectors } = m.eigenpairs(&g).unwrap();
        // sqrt(2 k + 1) P_k(2 x - 1), of unit length: 1, sqrt 3 (2x - 1), sqrt 5 (6x^2 - 6x + 1).
        let (s3, s5) = (3_f64.sqrt(), 5_f64.sqrt());
        let legendre = dmatrix![1.0, -s3, -s5; 0.0, 2.0 * s3, 6.0 * s5; 0.0, 0.0, -6.0 * s5];
        assert!((values - nalgebra::dvector![0.0, 2.0, 6.0]).amax() < 1e-12);
        assert!((vectors - legendre).amax() < 1e-11);
    }

    #[test]
    fn a_self_adjoint_transformation_moves_from_one_argument_to_the_other() {
        let g = BilinearForm(DMatrix::from_fn(3, 3, |i, j| 1.0 / (i + j + 1) as f64));
        let m = LinearTransformation(dmatrix![0.0, -1.0, 0.0; 0.0, 2.0, -4.0; 0.0, 0.0, 6.0]);
        let (v, w) = (Vector(vec![1.0, -2.0, 1.0]), Vector(vec![0.5, 3.0, -1.0]));
        let left = g.apply(&v, &m.apply(&w).unwrap()).unwrap();
        let right = g.apply(&m.apply(&v).unwrap(), &w).unwrap();
        assert!((left - right).abs() < 1e-14);
    }

    #[test]
    fn repeated_eigenvalues_still_give_an_orthonormal_basis() {
        let g = BilinearForm(dmatrix![2.0, 0.0; 0.0, 0.5]);
        let pairs = g.eigenpairs(&g).unwrap();
        assert!((pairs.values - nalgebra::dvector![1.0, 1.0]).amax() < 1e-15);
        let v = &pairs.vectors;
        assert!((v.tr_mul(&(&g.0 * v)) - DMatrix::identity(2, 2)).amax() < 1e-15);
    }

    #[test]
    fn what_has_no_eigenpairs_is_refused_by_name() {
        let identity = BilinearForm(DMatrix::identity(2, 2));
        let of = |f: DMatrix<f64>, g: &BilinearForm| BilinearForm(f).eigenpairs(g).unwrap_err();
        let error = of(dmatrix![1.0, 2.0; 2.1, 1.0], &identity);
        assert!(matches!(error, EigenError::NotSymmetric { row: 1, column: 0, .. }), "{error}");
        let error = of(DMatrix::identity(2, 2), &BilinearForm(dmatrix![1.0, 2.0; 2.0, 1.0]));
        assert_eq!(error, EigenError::NotPositiveDefinite);
        let error = of(dmatrix![f64::NAN, 0.0; 0.0, 1.0], &identity);
        assert_eq!(error, EigenError::NotFinite { which: "the form" });
        assert!(matches!(of(DMatrix::zeros(3, 3), &identity), EigenError::Size(_)));
        assert!(matches!(of(DMatrix::zeros(2, 3), &identity), EigenError::Size(_)));
        let rotation = LinearTransformation(dmatrix![0.0, -1.0; 1.0, 0.0]);
        let error = rotation.eigenpairs(&identity).unwrap_err();
        assert!(matches!(error, EigenError::NotSymmetric { which: "the form", .. }), "{error}");
        let empty = BilinearForm(DMatrix::zeros(0, 0));
        assert_eq!(empty.eigenpairs(&empty).unwrap().values.len(), 0);
    }
}
