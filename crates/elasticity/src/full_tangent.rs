//! The whole second derivative of an energy density, and its projection to positive semidefinite.
//!
//! ```text
//! A_ikjl = d2W/dF_ik dF_jl,    A[l][j][k][i]          (D R)^2 entries, symmetric
//! A+ = Q max(Lambda, 0) Q^T                           nearest in the Frobenius norm
//! ```
//! If A is positive semidefinite at each quadrature point, so is every element's Hessian. The
//! projection here finds eigenvalues by iteration, in the space of F and not in that of the
//! vertices: four freedoms for a sheet, nine for a solid, however many nodes an element has.
//! Isotropic materials know theirs in closed form and do not come here. What is not finite is left
//! as it is, for the step to report. Source: Teran et al. (2005).

use nalgebra::{DMatrix, SymmetricEigen};
use stationary_calculus::array;

use crate::{Real, Tangent};

/// A second derivative with all its entries.
#[derive(Clone, Copy, Debug)]
pub struct FullTangent<T, const D: usize, const R: usize>(pub [[[[T; D]; R]; D]; R]);

impl<T: Real, const D: usize, const R: usize> FullTangent<T, D, R> {
    /// All entries of a tangent: its blocks between the reference directions.
    pub fn of(tangent: &impl Tangent<T, D, R>) -> Self {
        let unit = |k: usize| {
            let direction = array(|l| T::splat(if k == l { 1.0 } else { 0.0 }));
            tangent.node(&direction)
        };
        let mut entries = [[[[T::splat(0.0); D]; R]; D]; R];
        for l in 0..R {
            for k in 0..R {
                let block = tangent.block(&unit(k), &unit(l));
                for (j, column) in block.iter().enumerate() {
                    entries[l][j][k] = *column;
                }
            }
        }
        FullTangent(entries)
    }

    /// The nearest positive semidefinite one.
    #[must_use]
    pub fn projected(&self) -> Self {
        let n = D * R;
        let mut result = *self;
        let columns = self.0.as_flattened().as_flattened().as_flattened();
        let entries = result.0.as_flattened_mut().as_flattened_mut().as_flattened_mut();
        for lane in 0..T::WIDTH {
            let numbers = columns.iter().map(|entry| entry.lane(lane));
            let Some(projected) = project(DMatrix::from_iterator(n, n, numbers)) else { continue };
            for (k, entry) in entries.iter_mut().enumerate() {
                let (i, j) = (k % n, k / n);
                entry.set_lane(lane, 0.5 * (projected[(i, j)] + projected[(j, i)]));
            }
        }
        result
    }
}

/// The nearest positive semidefinite matrix; `None` where the matrix is that already, or not
/// finite.
fn project(matrix: DMatrix<f64>) -> Option<DMatrix<f64>> {
    if matrix.iter().any(|entry| !entry.is_finite()) {
        return None;
    }
    let n = matrix.nrows();
    let mut eigen = SymmetricEigen::try_new(matrix, f64::EPSILON, 100 * n)?;
    if eigen.eigenvalues.iter().all(|&lambda| lambda >= 0.0) {
        return None;
    }
    eigen.eigenvalues.apply(|lambda| *lambda = lambda.max(0.0));
    Some(eigen.recompose())
}

impl<T: Real, const D: usize, const R: usize> Tangent<T, D, R> for FullTangent<T, D, R> {
    /// `[j][k][i]`: the sum over l of A times the gradient.
    type Node = ([T; R], [[[T; D]; R]; D]);

    #[inline(always)]
    fn node(&self, gradient: &[T; R]) -> Self::Node {
        let mut contracted = [[[T::splat(0.0); D]; R]; D];
        for (entries, &g) in self.0.iter().zip(gradient) {
            for (sum, entry) in contracted
                .as_flattened_mut()
                .as_flattened_mut()
                .iter_mut()
                .zip(entries.as_flattened().as_flattened())
            {
                *sum = entry.multiply_add(g, *sum);
            }
        }
        (*gradient, contracted)
    }

    #[inline(always)]
    fn block(&self, a: &Self::Node, b: &Self::Node) -> [[T; D]; D] {
        array(|j| crate::tensor::apply(&b.1[j], &a.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Lame, Lanes, Material, SaintVenantKirchhoff};

    fn matrix<T: Real>(tangent: &FullTangent<T, 3, 3>, lane: usize) -> DMatrix<f64> {
        let entries = tangent.0.as_flattened().as_flattened().as_flattened();
        DMatrix::from_iterator(9, 9, entries.iter().map(|entry| entry.lane(lane)))
    }

    #[test]
    fn the_projection_keeps_what_is_positive_in_every_lane() {
        let material = SaintVenantKirchhoff::new(Lame::<3>::from_young_poisson(1.0, 0.3).unwrap());
        let f: [[Lanes; 3]; 3] = std::array::from_fn(|k| {
            std::array::from_fn(|i| {
                let at = |lane: usize| ((7 * k + 3 * i + lane) as f64).sin();
                let stretch = |lane: usize| if k == i { 0.4 + 0.3 * lane as f64 } else { 0.0 };
                Lanes::from(std::array::from_fn(|lane| stretch(lane) + 0.1 * at(lane)))
            })
        });
        let full = FullTangent::of(&material.tangent(&f, Lanes::from([1.0; 4])));
        let projected = full.projected();
        let mut changed = 0;
        for lane in 0..4 {
            let (exact, plus) = (matrix(&full, lane), matrix(&projected, lane));
            assert!((&exact - exact.transpose()).amax() < 1e-15);
            let minus = &plus - &exact;
            assert!(plus.clone().symmetric_eigenvalues().min() > -1e-14);
            assert!(minus.clone().symmetric_eigenvalues().min() > -1e-14);
            assert!((&plus * &minus).amax() < 1e-14);
            changed += usize::from(minus.amax() > 1e-3);
        }
        assert!(0 < changed && changed < 4, "{changed}");
    }
}
