//! The positive semidefinite matrix nearest to a symmetric one: negative eigenvalues become zero.
//!
//! ```text
//! H = Q Lambda Q^T,    H+ = Q max(Lambda, 0) Q^T     nearest in the Frobenius norm
//! ```
//! `H` the Hessian of one stencil, n = V D freedoms. With H+ in place of H, Newton's direction
//! descends (notes 4.4), at the price of quadratic convergence where the two differ.
//! A Hessian without negative eigenvalues is returned as it is, to the last bit, and so is one that
//! is not finite, for the step to report. Source: Higham (1988). Dense and small: element by element,
//! never for a whole system.

use nalgebra::{DMatrix, SymmetricEigen};

use crate::StencilHessian;

/// The nearest positive semidefinite matrix, for [`Curvature::Semidefinite`](crate::Curvature).
pub fn project_semidefinite<const V: usize, const D: usize>(
    hessian: &StencilHessian<V, D>,
) -> StencilHessian<V, D> {
    let n = V * D;
    let entries = hessian.as_flattened().as_flattened().as_flattened();
    if n == 0 || entries.iter().any(|entry| !entry.is_finite()) {
        return *hessian;
    }
    let matrix = DMatrix::from_column_slice(n, n, entries);
    let Some(mut eigen) = SymmetricEigen::try_new(matrix, f64::EPSILON, 100 * n) else {
        return *hessian;
    };
    let rounding = n as f64 * f64::EPSILON * eigen.eigenvalues.amax();
    if eigen.eigenvalues.iter().all(|&lambda| lambda >= -rounding) {
        return *hessian;
    }
    eigen.eigenvalues.apply(|lambda| *lambda = lambda.max(0.0));
    let projected = eigen.recompose();
    let mut result = *hessian;
    let columns = result.as_flattened_mut().as_flattened_mut().as_flattened_mut();
    for (k, entry) in columns.iter_mut().enumerate() {
        let (i, j) = (k % n, k / n);
        *entry = 0.5 * (projected[(i, j)] + projected[(j, i)]);
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    type Four = StencilHessian<2, 2>;

    fn by_columns(matrix: &DMatrix<f64>) -> Four {
        let at = |i, j| matrix[(i, j)];
        std::array::from_fn(|b| {
            std::array::from_fn(|d| {
                std::array::from_fn(|a| std::array::from_fn(|c| at(2 * a + c, 2 * b + d)))
            })
        })
    }

    fn matrix(hessian: &Four) -> DMatrix<f64> {
        let entries = hessian.as_flattened().as_flattened().as_flattened();
        DMatrix::from_column_slice(4, 4, entries)
    }

    fn symmetric() -> impl Strategy<Value = DMatrix<f64>> {
        prop::collection::vec(-1.0..1.0, 16).prop_map(|a| {
            let a = DMatrix::from_column_slice(4, 4, &a);
            &a + a.transpose()
        })
    }

    proptest! {
        #[test]
        fn the_projection_keeps_positive_eigenvalues_and_drops_the_others(h in symmetric()) {
            let plus = matrix(&project_semidefinite(&by_columns(&h)));
            prop_assert_eq!(&plus, &plus.transpose());
            let minus = &plus - &h;
            // H = H+ - H-, both semidefinite, with H+ H- = 0: the definition of the nearest one.
            let least = |m: &DMatrix<f64>| m.clone().symmetric_eigenvalues().min();
            prop_assert!(least(&plus) > -1e-12 && least(&minus) > -1e-12);
            prop_assert!((&plus * &minus).amax() < 1e-13);
        }

        #[test]
        fn a_semidefinite_matrix_keeps_its_bits(h in symmetric()) {
            let square = by_columns(&(&h * &h));
            let symmetric = by_columns(&((matrix(&square) + matrix(&square).transpose()) * 0.5));
            prop_assert_eq!(project_semidefinite(&symmetric), symmetric);
        }
    }

    #[test]
    fn what_is_not_finite_is_returned_for_the_step_to_report() {
        let mut h = by_columns(&DMatrix::identity(4, 4));
        h[1][0][0][1] = f64::NAN;
        let same = project_semidefinite(&h);
        assert!(same[1][0][0][1].is_nan() && same[0][0][0][0] == 1.0);
    }

    #[test]
    fn of_one_freedom_a_negative_curvature_becomes_zero_and_a_positive_one_stays() {
        let one: fn(f64) -> StencilHessian<1, 1> = |k| [[[[k]]]];
        assert_eq!(project_semidefinite(&one(-3.0)), one(0.0));
        assert_eq!(project_semidefinite(&one(3.0)), one(3.0));
    }
}
