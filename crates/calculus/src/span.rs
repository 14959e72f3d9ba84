//! What rows span, and what is normal to that: orthonormal bases by Gram and Schmidt, twice.
//!
//! ```text
//! rest = row - sum u_k <u_k, row>,      again,      u = rest/|rest|
//! ```
//! The basis is orthonormal to rounding, however nearly parallel the rows are; eigenvectors of `J^T J` lose
//! twice the digits. Source: Giraud, Langou and Rozloznik 2005.

use nalgebra::{DMatrix, DVector};

use crate::equation::power_of_two;

/// The rows that no rows before them imply, to this part of their lengths, and an orthonormal basis of
/// their span: by Gram and Schmidt, twice.
pub fn independent_rows(a: &DMatrix<f64>, least: f64) -> (Vec<usize>, Vec<DVector<f64>>) {
    let (mut rows, mut basis) = (Vec::new(), Vec::<DVector<f64>>::new());
    for (number, row) in a.row_iter().enumerate() {
        // In a power of two of its own, so that no square leaves the range of numbers.
        let row = row.transpose() / power_of_two(row.amax());
        let length = row.norm();
        let rest = beside(&basis, row);
        if length > 0.0 && rest.norm() > least * length {
            rows.push(number);
            basis.push(rest.normalize());
        }
    }
    (rows, basis)
}

/// An orthonormal basis of all that is normal to an orthonormal one, n numbers each.
pub fn complement(mut basis: Vec<DVector<f64>>, n: usize) -> DMatrix<f64> {
    let span = basis.len();
    let mut left = DVector::repeat(n, 1.0);
    let take = |left: &mut DVector<f64>, unit: &DVector<f64>| {
        left.zip_apply(unit, |left, entry| *left -= entry * entry);
    };
    basis.iter().for_each(|unit| take(&mut left, unit));
    while basis.len() < n {
        let mut axis = DVector::zeros(n);
        axis[left.imax()] = 1.0;
        let unit = beside(&basis, axis).normalize();
        take(&mut left, &unit);
        basis.push(unit);
    }
    DMatrix::from_fn(n, n - span, |row, column| basis[span + column][row])
}

/// What of a vector is normal to an orthonormal basis.
fn beside(basis: &[DVector<f64>], mut rest: DVector<f64>) -> DVector<f64> {
    for _ in 0..2 {
        for unit in basis {
            let part = unit.dot(&rest);
            rest.axpy(-part, unit, 1.0);
        }
    }
    rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::dmatrix;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn span_and_complement_are_one_orthonormal_basis_however_nearly_parallel_the_rows_are(
            entries in prop::collection::vec(-1.0..1.0_f64, 12),
            apart in -9.0..0.0_f64,
        ) {
            let mut a = DMatrix::from_row_slice(2, 6, &entries);
            let near = a.row(0) + a.row(1) * 10.0_f64.powf(apart);
            a.set_row(1, &near);
            let (rows, basis) = independent_rows(&a, 1e-12);
            prop_assert_eq!(rows, vec![0, 1]);
            let free = complement(basis.clone(), 6);
            prop_assert_eq!(free.ncols(), 4);
            prop_assert!((&a * &free).amax() < 1e-14);
            let all = DMatrix::from_columns(
                &basis.into_iter().chain(free.column_iter().map(|c| c.into_owned())).collect::<Vec<_>>(),
            );
            prop_assert!((all.tr_mul(&all) - DMatrix::identity(6, 6)).amax() < 1e-14);
        }
    }

    #[test]
    fn rows_that_others_imply_and_rows_of_zeros_are_left_out() {
        let a = dmatrix![1.0, 2.0, 0.0; 0.0, 0.0, 0.0; 2.0, 4.0, 0.0; 1.0, 2.0, 1e-5];
        assert_eq!(independent_rows(&a, 1e-7).0, [0, 3]);
        assert_eq!(independent_rows(&a, 1e-5).0, [0]);
        assert_eq!(complement(Vec::new(), 3), DMatrix::identity(3, 3));
    }

    #[test]
    fn what_depends_on_what_does_not_depend_on_the_sizes_of_rows() {
        let a = dmatrix![3.0, 4.0, 0.0; 0.5, 2.0, 1.0; 3.5, 6.0, 1.0];
        let (rows, basis) = independent_rows(&a, 1e-9);
        assert_eq!(rows, [0, 1]);
        for (one, other) in [(-700, -700), (700, 700), (600, -1000)]
            .map(|(one, other)| (2.0_f64.powi(one), 2.0_f64.powi(other)))
        {
            let mut sized = a.clone();
            [one, other, one]
                .into_iter()
                .enumerate()
                .for_each(|(k, s)| sized.row_mut(k).scale_mut(s));
            assert_eq!(independent_rows(&sized, 1e-9), (rows.clone(), basis.clone()));
        }
    }
}
