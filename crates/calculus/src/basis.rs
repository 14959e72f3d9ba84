//! Change of basis: one object, many buckets of numbers.
//!
//! ```text
//! B~ = B T                                    column j of T is b~_j in the old basis, d x d
//! vector                    v                 [v]~  = T^-1 [v]
//! covector                  nu(v) = [nu][v]   [nu]~ = [nu] T
//! linear transformation     A(v) = [A][v]     [A]~  = T^-1 [A] T
//! bilinear form             g(v, w)           [g]~  = T^T [g] T          a metric is one
//! contravariant 2-tensor    F                 [F]~  = T^-1 [F] T^-T      an inverse metric is one
//! ```
//! What a number means does not depend on the basis: `nu(v)`, `A(v)`, `g(v, w)` are natural. The
//! same d x d bucket can hold three kinds of object that transform in three ways, hence three types.
//! A frame, d vectors side by side, is no tensor: each column transforms as the vector that it is.
//! Source: notes 1.1-1.4, table 1.1 (which gives the frame's rule for the contravariant 2-tensor,
//! errata chapter 1). Curved coordinates, where T varies from point to point, are not treated.

use nalgebra::{DMatrix, DVectorView, Dyn, FullPivLU};

use crate::{Covector, SizeError, Vector};

/// A linear function from vectors to vectors, `A(v) = [A][v]`.
#[derive(Clone, Debug, PartialEq)]
pub struct LinearTransformation(pub DMatrix<f64>);

/// A bilinear function of two vectors, `g(v, w) = [v]^T [g] [w]`: a metric, a Hessian.
#[derive(Clone, Debug, PartialEq)]
pub struct BilinearForm(pub DMatrix<f64>);

/// A bilinear function of two covectors: the inverse of a metric, the covariance of a vector.
#[derive(Clone, Debug, PartialEq)]
pub struct ContravariantTensor(pub DMatrix<f64>);

impl LinearTransformation {
    /// The vector `A(v)`.
    ///
    /// # Errors
    /// [`SizeError`] unless the vector has a component for each of the matrix's columns.
    pub fn apply<C: AsRef<[f64]>>(&self, v: &Vector<C>) -> Result<Vector<Vec<f64>>, SizeError> {
        SizeError::check("the vector's components", self.0.ncols(), v.components().len())?;
        Ok(Vector((&self.0 * column(v.components())).data.into()))
    }
}

impl BilinearForm {
    /// The number `g(v, w)`.
    ///
    /// # Errors
    /// [`SizeError`] unless the first vector has a component for each row of the matrix and the
    /// second one for each column.
    pub fn apply<C: AsRef<[f64]>>(&self, v: &Vector<C>, w: &Vector<C>) -> Result<f64, SizeError> {
        SizeError::check("the first vector's components", self.0.nrows(), v.components().len())?;
        SizeError::check("the second vector's components", self.0.ncols(), w.components().len())?;
        Ok(column(v.components()).dot(&(&self.0 * column(w.components()))))
    }
}

/// The passage from a basis B to the basis `B~ = B T`.
#[derive(Clone, Debug)]
pub struct ChangeOfBasis {
    t: DMatrix<f64>,
    /// The powers of two by which rows and columns were divided, so that units do not tell.
    rows: Vec<f64>,
    columns: Vec<f64>,
    factor: FullPivLU<f64, Dyn, Dyn>,
}

/// A matrix that is no change of basis.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum BasisError {
    /// A basis has as many vectors as the space has dimensions.
    #[error(transparent)]
    Size(#[from] SizeError),
    /// Every entry must be finite.
    #[error("entry ({row}, {column}) of the change of basis is {entry}")]
    NotFinite {
        /// Row of the entry.
        row: usize,
        /// Column of the entry.
        column: usize,
        /// The entry.
        entry: f64,
    },
    /// The new basis vectors must be linearly independent.
    #[error("the new basis vectors are linearly dependent to working precision: {rank} of {dim}")]
    Singular {
        /// How many of them are independent.
        rank: usize,
        /// The dimension of the space.
        dim: usize,
    },
    /// Vectors too short to divide by.
    #[error("the inverse of the change of basis is not finite: its largest entry is {largest:e}")]
    InverseNotFinite {
        /// The largest entry of the matrix.
        largest: f64,
    },
}

impl ChangeOfBasis {
    /// The passage whose column j holds the components of the new basis vector j in the old basis.
    ///
    /// # Errors
    /// [`BasisError::Size`] for a matrix that is not square, [`BasisError::NotFinite`] for an
    /// entry, [`BasisError::Singular`] for columns that depend on each other to working precision,
    /// whatever their units, [`BasisError::InverseNotFinite`] for columns so short that the inverse overflows.
    pub fn new(t: DMatrix<f64>) -> Result<Self, BasisError> {
        let dim = t.nrows();
        SizeError::check("the new basis vectors", dim, t.ncols())?;
        if let Some(bad) = t.iter().position(|entry| !entry.is_finite()) {
            let (row, column) = (bad % dim, bad / dim);
            return Err(BasisError::NotFinite { row, column, entry: t[bad] });
        }
        let mut scaled = t.clone();
        let columns: Vec<f64> = t.column_iter().map(|column| power_below(column.amax())).collect();
        scaled.column_iter_mut().zip(&columns).for_each(|(mut c, unit)| c.unscale_mut(*unit));
        let rows: Vec<f64> = scaled.row_iter().map(|row| power_below(row.amax())).collect();
        scaled.row_iter_mut().zip(&rows).for_each(|(mut row, unit)| row.unscale_mut(*unit));
        let factor = FullPivLU::new(scaled);
        let pivots = factor.u().diagonal();
        let negligible = dim as f64 * f64::EPSILON * pivots.amax();
        let rank = pivots.iter().filter(|pivot| pivot.abs() > negligible).count();
        if rank < dim {
            return Err(BasisError::Singular { rank, dim });
        }
        let change = ChangeOfBasis { t, rows, columns, factor };
        let inverse = change.solved(DMatrix::identity(dim, dim));
        if inverse.iter().any(|entry| !entry.is_finite()) {
            return Err(BasisError::InverseNotFinite { largest: change.t.amax() });
        }
        Ok(change)
    }

    /// The matrix T.
    pub fn matrix(&self) -> &DMatrix<f64> {
        &self.t
    }

    /// `[v]~ = T^-1 [v]`.
    ///
    /// # Errors
    /// [`SizeError`] unless the vector has d components.
    pub fn vector<C: AsRef<[f64]>>(&self, v: &Vector<C>) -> Result<Vector<Vec<f64>>, SizeError> {
        SizeError::check("the vector's components", self.t.nrows(), v.components().len())?;
        let given = DMatrix::from_column_slice(v.components().len(), 1, v.components());
        Ok(Vector(self.solved(given).data.into()))
    }

    /// `[nu]~ = [nu] T`.
    ///
    /// # Errors
    /// [`SizeError`] unless the covector has d components.
    pub fn covector<C: AsRef<[f64]>>(
        &self,
        nu: &Covector<C>,
    ) -> Result<Covector<Vec<f64>>, SizeError> {
        SizeError::check("the covector's components", self.t.nrows(), nu.components().len())?;
        Ok(Covector(self.t.tr_mul(&column(nu.components())).data.into()))
    }

    /// `[A]~ = T^-1 [A] T`.
    ///
    /// # Errors
    /// [`SizeError`] unless the matrix is d x d, as the change of basis is.
    pub fn transformation(
        &self,
        a: &LinearTransformation,
    ) -> Result<LinearTransformation, SizeError> {
        self.fits(&a.0)?;
        Ok(LinearTransformation(self.solved(&a.0 * &self.t)))
    }

    /// `[g]~ = T^T [g] T`.
    ///
    /// # Errors
    /// [`SizeError`] unless the matrix is d x d, as the change of basis is.
    pub fn form(&self, g: &BilinearForm) -> Result<BilinearForm, SizeError> {
        self.fits(&g.0)?;
        Ok(BilinearForm(self.t.tr_mul(&(&g.0 * &self.t))))
    }

    /// `[F]~ = T^-1 [F] T^-T`.
    ///
    /// # Errors
    /// [`SizeError`] unless the matrix is d x d, as the change of basis is.
    pub fn contravariant(&self, f: &ContravariantTensor) -> Result<ContravariantTensor, SizeError> {
        self.fits(&f.0)?;
        let left = self.solved(f.0.clone());
        Ok(ContravariantTensor(self.solved(left.transpose()).transpose()))
    }

    fn solved(&self, mut columns: DMatrix<f64>) -> DMatrix<f64> {
        columns.row_iter_mut().zip(&self.rows).for_each(|(mut row, unit)| row.unscale_mut(*unit));
        if !columns.is_empty() {
            self.factor.solve_mut(&mut columns);
        }
        columns
            .row_iter_mut()
            .zip(&self.columns)
            .for_each(|(mut row, unit)| row.unscale_mut(*unit));
        columns
    }

    fn fits(&self, matrix: &DMatrix<f64>) -> Result<(), SizeError> {
        SizeError::check("the matrix's rows", self.t.nrows(), matrix.nrows())?;
        SizeError::check("the matrix's columns", self.t.nrows(), matrix.ncols())
    }
}

/// The power of two below a size; 1 for zero.
fn power_below(size: f64) -> f64 {
    if size == 0.0 { 1.0 } else { 2.0_f64.powi(size.log2().floor().max(-1022.0) as i32) }
}

fn column(components: &[f64]) -> DVectorView<'_, f64> {
    DVectorView::from_slice(components, components.len())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    /// From {1, x, x^2} to {x^2 - 1, x + 1, x - 1} (notes 1.1).
    fn polynomials() -> ChangeOfBasis {
        ChangeOfBasis::new(dmatrix![-1.0, 1.0, -1.0; 0.0, 1.0, 1.0; 1.0, 0.0, 0.0]).unwrap()
    }

    /// The L2 inner product of {1, x, x^2} on [0, 1]: g(x^i, x^j) = 1/(i + j + 1) (notes 1.3).
    fn l2() -> BilinearForm {
        BilinearForm(DMatrix::from_fn(3, 3, |i, j| 1.0 / (i + j + 1) as f64))
    }

    /// x^2 - 2 x + 1.
    const V: Vector<[f64; 3]> = Vector([1.0, -2.0, 1.0]);

    fn close(a: &[f64], b: &[f64]) -> bool {
        let size = b.iter().fold(1.0_f64, |m, x| m.max(x.abs()));
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| (a - b).abs() <= 1e-10 * size)
    }

    #[test]
    fn a_polynomial_has_the_components_that_the_notes_compute() {
        assert!(close(&polynomials().vector(&V).unwrap().0, &[1.0, 0.0, -2.0]));
    }

    #[test]
    fn evaluation_at_two_is_a_covector() {
        let nu = Covector([1.0, 2.0, 4.0]);
        assert_eq!(nu.apply(&V), 1.0);
        let (nu, v) = (polynomials().covector(&nu).unwrap(), polynomials().vector(&V).unwrap());
        // The values of x^2 - 1, x + 1 and x - 1 at 2.
        assert_eq!(nu.0, [3.0, 3.0, 1.0]);
        assert!((nu.apply(&v) - 1.0).abs() < 1e-15);
    }

    #[test]
    fn transposing_a_vector_into_a_covector_is_not_natural() {
        let nu = polynomials().covector(&Covector(V.0)).unwrap();
        assert_eq!(nu.0, [0.0, -1.0, -3.0]);
        assert!(!close(&nu.0, &polynomials().vector(&V).unwrap().0));
    }

    #[test]
    fn the_l2_inner_product_is_an_integral_in_either_basis() {
        // g(v, v) = int (x - 1)^4 dx = 1/5; new entry (0, 0) = int (x^2 - 1)^2 dx = 8/15.
        let (g, v) = (polynomials().form(&l2()).unwrap(), polynomials().vector(&V).unwrap());
        assert!((l2().apply(&V, &V).unwrap() - 0.2).abs() < 1e-15);
        assert!((g.apply(&v, &v).unwrap() - 0.2).abs() < 1e-15);
        assert!((g.0[(0, 0)] - 8.0 / 15.0).abs() < 1e-15);
    }

    /// Two balls on a line (notes 0.1): p = (c1 + c2)/2 and s = c2 - c1.
    #[test]
    fn centre_and_separation_have_total_and_reduced_mass() {
        let (m1, m2) = (2.0, 3.0);
        let t = ChangeOfBasis::new(dmatrix![1.0, -0.5; 1.0, 0.5]).unwrap();
        let c = Vector([0.3, 0.7]);
        assert!(close(&t.vector(&c).unwrap().0, &[0.5, 0.4]));
        let equal = t.form(&BilinearForm(dmatrix![m1, 0.0; 0.0, m1])).unwrap();
        assert_eq!(equal.0, dmatrix![2.0 * m1, 0.0; 0.0, m1 / 2.0]);
        let unequal = t.form(&BilinearForm(dmatrix![m1, 0.0; 0.0, m2])).unwrap();
        assert_eq!(unequal.0, dmatrix![5.0, 0.5; 0.5, 1.25]);
        // Equal and opposite forces on the balls do no work on their centre.
        assert_eq!(t.covector(&Covector([-4.0, 4.0])).unwrap().0, [0.0, 4.0]);
    }

    #[test]
    fn differentiation_of_polynomials_is_a_linear_transformation() {
        let d = LinearTransformation(dmatrix![0.0, 1.0, 0.0; 0.0, 0.0, 2.0; 0.0, 0.0, 0.0]);
        let derivative = polynomials().vector(&d.apply(&V).unwrap()).unwrap();
        let d = polynomials().transformation(&d).unwrap();
        let v = polynomials().vector(&V).unwrap();
        assert!(close(&d.apply(&v).unwrap().0, &derivative.0));
    }

    #[test]
    fn the_inverse_metric_obeys_the_contravariant_rule_and_not_the_frame_rule() {
        let t = polynomials();
        let inverse = ContravariantTensor(l2().0.try_inverse().unwrap());
        let expected = t.form(&l2()).unwrap().0.try_inverse().unwrap();
        let got = t.contravariant(&inverse).unwrap().0;
        assert!((&got - &expected).amax() < 1e-10 * expected.amax());
        let printed = t.solved(inverse.0);
        assert!((printed - &expected).amax() > 1.0);
    }

    #[test]
    fn units_of_components_and_of_new_vectors_do_not_make_a_basis_singular() {
        let t = dmatrix![3.0, 1.0, 0.5; -1.0, 2.0, 0.25; 0.5, 1.0, -2.0];
        let (rows, columns) = ([1.0, 1e-90, 1e40], [1e-20, 1e30, 1.0]);
        let sized = DMatrix::from_fn(3, 3, |i, j| t[(i, j)] * rows[i] * columns[j]);
        let change = ChangeOfBasis::new(sized).unwrap();
        // The vector whose new components are 1, -2 and 3 in units of their own.
        let old = &t * nalgebra::dvector![1.0, -2.0, 3.0];
        let new =
            change.vector(&Vector((0..3).map(|i| old[i] * rows[i]).collect::<Vec<_>>())).unwrap();
        for (k, expected) in [1.0, -2.0, 3.0].into_iter().enumerate() {
            assert!((new.0[k] * columns[k] / expected - 1.0).abs() < 1e-14, "{new:?}");
        }
    }

    #[test]
    fn what_is_no_basis_is_refused_by_name() {
        let error = ChangeOfBasis::new(dmatrix![1.0, 2.0; 2.0, 4.0]).unwrap_err();
        assert_eq!(error, BasisError::Singular { rank: 1, dim: 2 });
        let error = ChangeOfBasis::new(DMatrix::zeros(2, 2)).unwrap_err();
        assert_eq!(error, BasisError::Singular { rank: 0, dim: 2 });
        let error = ChangeOfBasis::new(dmatrix![1.0, f64::INFINITY; 2.0, 4.0]).unwrap_err();
        assert!(matches!(error, BasisError::NotFinite { row: 0, column: 1, .. }), "{error}");
        let error = ChangeOfBasis::new(DMatrix::zeros(3, 2)).unwrap_err();
        assert!(matches!(error, BasisError::Size(_)), "{error}");
        assert!(polynomials().vector(&Vector([1.0])).is_err());
        assert!(polynomials().form(&BilinearForm(DMatrix::zeros(3, 2))).is_err());
        assert_eq!(ChangeOfBasis::new(DMatrix::zeros(0, 0)).unwrap().matrix().len(), 0);
        let error = ChangeOfBasis::new(dmatrix![5e-324]).unwrap_err();
        assert_eq!(error, BasisError::InverseNotFinite { largest: 5e-324 });
    }

    fn matrix() -> impl Strategy<Value = DMatrix<f64>> {
        prop::array::uniform9(-1.0..1.0).prop_map(|a| DMatrix::from_column_slice(3, 3, &a))
    }

    /// A change of basis, kept well-conditioned by a dominant diagonal.
    fn basis() -> impl Strategy<Value = ChangeOfBasis> {
        matrix().prop_map(|a| ChangeOfBasis::new(a + 4.0 * DMatrix::identity(3, 3)).unwrap())
    }

    proptest! {
        #[test]
        fn what_objects_do_does_not_depend_on_the_basis(
            t in basis(),
            v in prop::array::uniform3(-1.0..1.0),
            w in prop::array::uniform3(-1.0..1.0),
            nu in prop::array::uniform3(-1.0..1.0),
            a in matrix(),
        ) {
            let (v, w, nu) = (Vector(v), Vector(w), Covector(nu));
            let (v_new, w_new) = (t.vector(&v).unwrap(), t.vector(&w).unwrap());
            let nu_new = t.covector(&nu).unwrap();
            prop_assert!((nu.apply(&v) - nu_new.apply(&v_new)).abs() < 1e-13);

            let g = BilinearForm(a.clone());
            let (old, new) = (g.apply(&v, &w), t.form(&g).unwrap().apply(&v_new, &w_new));
            prop_assert!((old.unwrap() - new.unwrap()).abs() < 1e-13);

            let m = LinearTransformation(a);
            let image = t.vector(&m.apply(&v).unwrap()).unwrap();
            prop_assert!(close(&t.transformation(&m).unwrap().apply(&v_new).unwrap().0, &image.0));

            let f = ContravariantTensor(m.0);
            let f_new = BilinearForm(t.contravariant(&f).unwrap().0);
            let (f, as_pair) = (BilinearForm(f.0), |nu: &[f64]| Vector(nu.to_vec()));
            let old = f.apply(&as_pair(&nu.0), &as_pair(&nu.0)).unwrap();
            let new = f_new.apply(&as_pair(&nu_new.0), &as_pair(&nu_new.0)).unwrap();
            prop_assert!((old - new).abs() < 1e-13);
        }
    }
}
