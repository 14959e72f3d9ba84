//! The Galerkin mass: a sparse metric, which couples the freedoms of neighbours.
//!
//! ```text
//! M_ab = integral of rho phi_a phi_b         kg
//! p = M v,    v = M^-1 p
//! ```
//! `M` a constant [`SymmetricMatrix`] (n x n), factored once by Cholesky's method; `rho` the density,
//! `phi` the shape functions. Entries that are zero, as those between the axes of a vertex, are left
//! out: the factor is then one for each axis, with a ninth of the entries. Lumping its rows gives a
//! diagonal metric, which needs no factor.
//! Source: notes 13.2. Knows nothing of elements: it takes the blocks that they make.

use std::sync::{Mutex, PoisonError};

use crate::sparse::{SparseCholesky, SparseError, SymmetricMatrix};
use crate::{Covector, Metric, Sink, Vector};

/// A constant sparse positive definite mass matrix.
#[derive(Debug)]
pub struct SparseMetric {
    matrix: SymmetricMatrix,
    /// Solving works in the factor's own memory: one solve at a time.
    factor: Mutex<SparseCholesky>,
}

impl SparseMetric {
    /// Factors a mass matrix; an error that names the freedom if it is not positive definite.
    ///
    /// # Errors
    /// [`SparseError::NotPositiveDefinite`] with the freedom; [`SparseError::NonFinite`];
    /// [`SparseError::OutOfMemory`] and [`SparseError::TooLarge`] for a factor that does not fit.
    pub fn new(matrix: SymmetricMatrix) -> Result<Self, SparseError> {
        let matrix = without_zeros(&matrix)?;
        let mut factor = SparseCholesky::analyse(&matrix)?;
        factor.factor(&matrix)?;
        Ok(SparseMetric { matrix, factor: Mutex::new(factor) })
    }

    /// The mass matrix.
    pub fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }
}

impl Clone for SparseMetric {
    fn clone(&self) -> Self {
        let factor = self.factor.lock().unwrap_or_else(PoisonError::into_inner).clone();
        SparseMetric { matrix: self.matrix.clone(), factor: Mutex::new(factor) }
    }
}

impl Metric for SparseMetric {
    fn dim(&self) -> usize {
        self.matrix.dim()
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        p.0.fill(0.0);
        self.matrix.add_product_unchecked(1.0, v.0, p.0);
    }

    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        v.0.copy_from_slice(p.0);
        self.factor.lock().unwrap_or_else(PoisonError::into_inner).solve(v.0);
    }

    /// The factor is read once for all of them.
    fn sharp_each(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        self.sharp(p, v);
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        add_entries(&self.matrix, sink);
    }
}

/// Adds a matrix entry by entry; of those off the diagonal the ones that are not zero.
fn add_entries(matrix: &SymmetricMatrix, sink: &mut impl Sink) {
    for (j, ends) in matrix.column_starts().windows(2).enumerate() {
        for k in ends[0] as usize..ends[1] as usize {
            let (i, entry) = (matrix.rows()[k] as usize, matrix.values()[k]);
            if i == j {
                sink.add_symmetric(&[j], &[entry]);
            } else if entry != 0.0 {
                sink.add_symmetric(&[j, i], &[0.0, entry, entry, 0.0]);
            }
        }
    }
}

/// The same matrix on a pattern of its own.
fn without_zeros(matrix: &SymmetricMatrix) -> Result<SymmetricMatrix, SparseError> {
    let mut own = SymmetricMatrix::analyse(matrix.dim(), |sink| add_entries(matrix, sink))?;
    own.refill(|sink| add_entries(matrix, sink))?;
    Ok(own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{DenseMetric, DenseSink};
    use nalgebra::DMatrix;

    /// The mass of n linear rod elements in a row, 1/6 [2 1; 1 2] each.
    fn rods(n: usize) -> SymmetricMatrix {
        let element = [2.0 / 6.0, 1.0 / 6.0, 1.0 / 6.0, 2.0 / 6.0];
        let blocks: Vec<_> = (0..n).map(|i| ([i, i + 1], element)).collect();
        SymmetricMatrix::from_blocks(n + 1, &blocks).unwrap()
    }

    #[test]
    fn the_sparse_metric_is_the_dense_one() {
        let n = 8;
        let sparse = SparseMetric::new(rods(n - 1)).unwrap();
        let mut values = vec![0.0; n * n];
        sparse.add_matrix(&mut DenseSink::new(1.0, n, &mut values).unwrap());
        let dense = DenseMetric::new(DMatrix::from_vec(n, n, values)).unwrap();
        let v = Vector((0..n).map(|i| (i as f64).sin()).collect::<Vec<_>>());
        let (mut p, mut q) = (Covector(vec![0.0; n]), Covector(vec![0.0; n]));
        sparse.flat(v.view(), p.view_mut());
        dense.flat(v.view(), q.view_mut());
        let mut w = Vector(vec![0.0; n]);
        sparse.sharp(p.view(), w.view_mut());
        for i in 0..n {
            assert!((p.0[i] - q.0[i]).abs() < 1e-15);
            assert!((w.0[i] - v.0[i]).abs() < 1e-14);
        }
        assert!((sparse.kinetic_energy(p.view()) - dense.kinetic_energy(p.view())).abs() < 1e-14);
        let clone = sparse.clone();
        clone.sharp(p.view(), w.view_mut());
        assert!((w.0[3] - v.0[3]).abs() < 1e-14);
        let (both, mut each) = ([p.0.clone(), q.0].concat(), vec![0.0; 2 * n]);
        clone.sharp_each(Covector(&both), Vector(&mut each));
        assert!(each.iter().zip(v.0.iter().cycle()).all(|(w, v)| (w - v).abs() < 1e-14));
    }

    #[test]
    fn zeros_between_the_axes_are_left_out() {
        let element =
            [2.0, 0.0, 1.0, 0.0, 0.0, 2.0, 0.0, 1.0, 1.0, 0.0, 2.0, 0.0, 0.0, 1.0, 0.0, 2.0];
        let freedoms = |i: usize| [2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 3];
        let blocks: Vec<_> = (0..9).map(|i| (freedoms(i), element)).collect();
        let full = SymmetricMatrix::from_blocks(20, &blocks).unwrap();
        let metric = SparseMetric::new(full.clone()).unwrap();
        assert_eq!((full.values().len(), metric.matrix().values().len()), (66, 38));
        let p = Covector((0..20).map(|i| (i as f64).cos()).collect::<Vec<_>>());
        let (mut v, mut back) = (Vector(vec![0.0; 20]), vec![0.0; 20]);
        metric.sharp(p.view(), v.view_mut());
        full.add_product(1.0, &v.0, &mut back).unwrap();
        assert!(back.iter().zip(&p.0).all(|(a, b)| (a - b).abs() < 1e-13));
    }

    #[test]
    fn all_velocities_weigh_as_much_as_the_rods() {
        let metric = SparseMetric::new(rods(30)).unwrap();
        let ones = Vector(vec![1.0; 31]);
        assert!((metric.inner(ones.view(), ones.view()) - 30.0).abs() < 1e-13);
    }

    #[test]
    fn the_metric_assembles_as_what_it_is() {
        let metric = SparseMetric::new(rods(30)).unwrap();
        let again = SymmetricMatrix::mass(&metric).unwrap();
        assert_eq!(again.rows(), metric.matrix().rows());
        assert_eq!(again.values(), metric.matrix().values());
    }

    #[test]
    fn a_mass_that_is_not_positive_is_refused_by_name() {
        let blocks = [(vec![0, 1], vec![2.0, 1.0, 1.0, 2.0]), (vec![2], vec![-1.0])];
        let error = SparseMetric::new(SymmetricMatrix::from_blocks(3, &blocks).unwrap());
        assert_eq!(error.unwrap_err(), SparseError::NotPositiveDefinite { freedom: 2 });
    }

    #[test]
    fn the_metric_serves_several_threads() {
        let metric = SparseMetric::new(rods(30)).unwrap();
        let p = Covector(vec![1.0; 31]);
        let solve = || {
            let mut v = Vector(vec![0.0; 31]);
            metric.sharp(p.view(), v.view_mut());
            v
        };
        let alone = solve();
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(solve)).collect();
            for thread in threads {
                assert_eq!(thread.join().unwrap(), alone);
            }
        });
    }
}
