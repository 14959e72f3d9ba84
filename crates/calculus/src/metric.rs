//! The metric of a system: its mass, which turns velocities into momenta and back.
//!
//! ```text
//! flat    p = M v          momentum of a velocity          (notes 1.3.1, 4.1)
//! sharp   v = M^-1 p       velocity of a momentum: solved, never inverted
//! T = 1/2 <M v, v>         kinetic energy, joules          (notes 0.4, 1.5)
//! ```
//! "Configurational tangent space is an inner product space, and mass is the metric." The metrics
//! here are constant: [`DiagonalMetric`] for particles and lumped mass, [`DenseMetric`] for a few
//! coupled freedoms, `SparseMetric` (feature `sparse`) for Galerkin mass. Rotating bodies keep a
//! constant metric as well, in body axes.

use nalgebra::{Cholesky, DMatrix, DVectorView, DVectorViewMut, Dyn};

use crate::{Covector, MetricError, Sink, Vector};

/// A positive definite inner product on velocities.
pub trait Metric {
    /// The number of freedoms n.
    fn dim(&self) -> usize;

    /// Writes the momentum `p = M v`.
    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>);

    /// Writes the velocity `v = M^-1 p`.
    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>);

    /// The same for momenta one after the other, n numbers each.
    fn sharp_each(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        let n = self.dim().max(1);
        for (p, v) in p.0.chunks_exact(n).zip(v.0.chunks_exact_mut(n)) {
            self.sharp(Covector(p), Vector(v));
        }
    }

    /// Writes the displacement `h M^-1 p` of a drift for the time h.
    #[inline]
    fn drift(&self, h: f64, p: Covector<&[f64]>, mut displacement: Vector<&mut [f64]>) {
        self.sharp(p, displacement.view_mut());
        displacement.0.iter_mut().for_each(|x| *x *= h);
    }

    /// Adds `M` to a matrix, block by block, in the same order every time.
    fn add_matrix(&self, sink: &mut impl Sink);

    /// The inner product `<M v, w>`, joules for velocities. Allocates; not for the inside of a step.
    fn inner(&self, v: Vector<&[f64]>, w: Vector<&[f64]>) -> f64 {
        let mut p = Covector(vec![0.0; self.dim()]);
        self.flat(v, p.view_mut());
        p.apply(&w)
    }

    /// The kinetic energy `1/2 <p, M^-1 p>` of a momentum. Allocates; not for the inside of a step.
    fn kinetic_energy(&self, p: Covector<&[f64]>) -> f64 {
        let mut v = Vector(vec![0.0; self.dim()]);
        self.sharp(p, v.view_mut());
        0.5 * p.apply(&v)
    }
}

/// A mass for each freedom: particles, lumped elements, moments of inertia about fixed axes.
#[derive(Clone, Debug, PartialEq)]
pub struct DiagonalMetric<C> {
    mass: C,
    inverse: C,
}

impl<C: crate::Storage> DiagonalMetric<C> {
    /// The masses (kg, or kg m^2 for angles), each positive and finite.
    ///
    /// # Errors
    /// [`MetricError::NotAMass`] for a mass that is not positive and finite, or so small that its
    /// reciprocal is not finite.
    pub fn new(mass: C) -> Result<Self, MetricError> {
        for (freedom, &mass) in mass.as_ref().iter().enumerate() {
            if !(mass > 0.0 && mass.is_finite() && mass.recip().is_finite()) {
                return Err(MetricError::NotAMass { freedom, mass });
            }
        }
        let mut inverse = mass.clone();
        for m in inverse.as_mut() {
            *m = m.recip();
        }
        Ok(DiagonalMetric { mass, inverse })
    }

    /// The masses.
    pub fn masses(&self) -> &[f64] {
        self.mass.as_ref()
    }
}

impl DiagonalMetric<Vec<f64>> {
    /// Particles in D dimensions: each mass (kg) serves D freedoms.
    ///
    /// # Errors
    /// Those of [`DiagonalMetric::new`].
    pub fn particles<const D: usize>(masses: &[f64]) -> Result<Self, MetricError> {
        let each = masses.iter().flat_map(|&m| [m; D]).collect();
        DiagonalMetric::new(each)
    }
}

impl<C: crate::Storage> Metric for DiagonalMetric<C> {
    fn dim(&self) -> usize {
        self.mass.as_ref().len()
    }

    #[inline]
    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        multiply(1.0, self.mass.as_ref(), v.0, p.0);
    }

    #[inline]
    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        multiply(1.0, self.inverse.as_ref(), p.0, v.0);
    }

    /// The time multiplies the masses, not the momentum, which is what the next step waits for.
    #[inline]
    fn drift(&self, h: f64, p: Covector<&[f64]>, displacement: Vector<&mut [f64]>) {
        multiply(h, self.inverse.as_ref(), p.0, displacement.0);
    }

    #[inline]
    fn add_matrix(&self, sink: &mut impl Sink) {
        for (freedom, &mass) in self.mass.as_ref().iter().enumerate() {
            sink.add_symmetric(&[freedom], &[mass]);
        }
    }

    fn kinetic_energy(&self, p: Covector<&[f64]>) -> f64 {
        let inverse = self.inverse.as_ref();
        0.5 * p.0.iter().zip(inverse).map(|(p, w)| p * p * w).sum::<f64>()
    }
}

/// `y = scale d x`, entry by entry.
#[inline]
fn multiply(scale: f64, d: &[f64], x: &[f64], y: &mut [f64]) {
    let n = y.len();
    for ((y, x), d) in y.iter_mut().zip(&x[..n]).zip(&d[..n]) {
        *y = (scale * d) * x;
    }
}

/// A full symmetric positive definite mass matrix of a few freedoms.
#[derive(Clone, Debug)]
pub struct DenseMetric {
    matrix: DMatrix<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl DenseMetric {
    /// The mass matrix (n x n, symmetric positive definite to rounding).
    ///
    /// # Errors
    /// [`MetricError::NotSquare`]; [`MetricError::NotSymmetric`], also for an entry that is not
    /// finite; [`MetricError::NotPositiveDefinite`].
    pub fn new(matrix: DMatrix<f64>) -> Result<Self, MetricError> {
        let n = matrix.nrows();
        if matrix.ncols() != n {
            return Err(MetricError::NotSquare { rows: n, columns: matrix.ncols() });
        }
        let largest = matrix.amax();
        for column in 0..n {
            for row in 0..n {
                let (a, b) = (matrix[(row, column)], matrix[(column, row)]);
                if !((a - b).abs() <= 1e-12 * largest && largest.is_finite()) {
                    return Err(MetricError::NotSymmetric { row, column, entry: a, mirror: b });
                }
            }
        }
        let factor = Cholesky::new(matrix.clone()).ok_or(MetricError::NotPositiveDefinite)?;
        Ok(DenseMetric { matrix, factor })
    }
}

impl Metric for DenseMetric {
    fn dim(&self) -> usize {
        self.matrix.nrows()
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        let n = self.dim();
        let v = DVectorView::from_slice(v.0, n);
        DVectorViewMut::from_slice(p.0, n).gemv(1.0, &self.matrix, &v, 0.0);
    }

    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        v.0.copy_from_slice(p.0);
        self.factor.solve_mut(&mut DVectorViewMut::from_slice(v.0, self.dim()));
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        let n = self.dim();
        for (j, column) in self.matrix.as_slice().chunks_exact(n.max(1)).enumerate() {
            for (i, &entry) in column.iter().enumerate().take(j + 1) {
                if i == j {
                    sink.add_symmetric(&[j], &[entry]);
                } else {
                    sink.add_symmetric(&[i, j], &[0.0, entry, entry, 0.0]);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DenseSink;
    use nalgebra::dmatrix;

    fn dense() -> DenseMetric {
        DenseMetric::new(dmatrix![4.0, 1.0, 0.0; 1.0, 3.0, -1.0; 0.0, -1.0, 2.0]).unwrap()
    }

    fn matrix_of(metric: &impl Metric) -> Vec<f64> {
        let n = metric.dim();
        let mut values = vec![0.0; n * n];
        metric.add_matrix(&mut DenseSink::new(1.0, n, &mut values).unwrap());
        values
    }

    #[test]
    fn sharp_undoes_flat() {
        let v = Vector([1.0, -2.0, 0.5]);
        let (mut p, mut w) = (Covector([0.0; 3]), Vector([0.0; 3]));
        dense().flat(v.view(), p.view_mut());
        assert_eq!(p.0, [2.0, -5.5, 3.0]);
        dense().sharp(p.view(), w.view_mut());
        for (a, b) in v.0.iter().zip(&w.0) {
            assert!((a - b).abs() < 1e-15);
        }
        assert!((dense().kinetic_energy(p.view()) - 0.5 * p.apply(&v)).abs() < 1e-14);
        assert_eq!(dense().inner(v.view(), v.view()), p.apply(&v));
    }

    #[test]
    fn the_matrix_that_reaches_a_sink_is_the_mass() {
        assert_eq!(matrix_of(&dense()), dense().matrix.as_slice());
        let diagonal = DiagonalMetric::new([1.0, 2.0]).unwrap();
        assert_eq!(matrix_of(&diagonal), [1.0, 0.0, 0.0, 2.0]);
    }

    #[test]
    fn a_mass_that_is_not_positive_is_refused_by_name() {
        for mass in [0.0, -1.0, f64::NAN, f64::INFINITY, 1e-320] {
            let error = DiagonalMetric::new([1.0, mass]).unwrap_err();
            assert!(matches!(error, MetricError::NotAMass { freedom: 1, .. }), "{error}");
        }
    }

    #[test]
    fn a_positive_mass_whose_inverse_overflows_is_refused_for_that() {
        let error = DiagonalMetric::new([5.5e-309]).unwrap_err();
        let said = error.to_string();
        assert!(said.contains("5.5e-309") && said.contains("its inverse overflows"), "{said}");
        assert!(DiagonalMetric::new([5.6e-309]).is_ok());
    }

    #[test]
    fn a_mass_matrix_that_is_none_is_refused_by_name() {
        let error = DenseMetric::new(dmatrix![1.0, 2.0; 2.0, 1.0]).unwrap_err();
        assert_eq!(error, MetricError::NotPositiveDefinite);
        let error = DenseMetric::new(dmatrix![1.0, 0.5; 0.4, 1.0]).unwrap_err();
        assert!(matches!(error, MetricError::NotSymmetric { row: 1, column: 0, .. }), "{error}");
        let error = DenseMetric::new(DMatrix::zeros(2, 3)).unwrap_err();
        assert_eq!(error, MetricError::NotSquare { rows: 2, columns: 3 });
    }
}
