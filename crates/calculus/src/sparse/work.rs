//! What a factor takes and what finding it takes, counted from its pattern: the same on every
//! machine.
//!
//! ```text
//! multiplications = sum over columns of c (c + 1)/2        c numbers of a column, its root too
//! ```
//! A column is divided by its root, and each pair of what is below it is taken off another column.

use faer::sparse::linalg::cholesky::SymbolicCholeskyRaw;
use faer::sparse::linalg::cholesky::supernodal::SupernodalLltRef;

use crate::sparse::SparseCholesky;

/// Of `columns` columns, the first one of `first` numbers, each one shorter than the one before.
fn of_panel(first: usize, columns: usize) -> f64 {
    (0..columns).map(|j| ((first - j) * (first - j + 1)) as f64 / 2.0).sum()
}

impl SparseCholesky {
    /// How many numbers the factor has.
    pub fn factor_len(&self) -> usize {
        self.numbers().len()
    }

    /// How many multiplications a factorization takes, where panels are kept those with their
    /// zeros.
    pub fn multiplications(&self) -> f64 {
        match self.symbolic().raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let lengths = symbolic.col_ptr().windows(2).map(|ends| ends[1] - ends[0]);
                lengths.map(|length| of_panel(length as usize, 1)).sum()
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLltRef::new(symbolic, self.numbers());
                let panels = (0..symbolic.n_supernodes()).map(|s| factor.supernode(s).val());
                panels.map(|panel| of_panel(panel.nrows(), panel.ncols())).sum()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::SymmetricMatrix;
    use crate::sparse::SparseCholesky;

    #[test]
    fn a_full_matrix_takes_a_sixth_of_its_cube_and_a_chain_three_a_link() {
        for n in [3, 40, 200_usize] {
            let freedoms: Vec<usize> = (0..n).collect();
            let matrix = SymmetricMatrix::from_blocks(n, &[(freedoms, vec![1.0; n * n])]).unwrap();
            let full = SparseCholesky::analyse(&matrix).unwrap().multiplications();
            assert_eq!(full, (n * (n + 1) * (n + 2)) as f64 / 6.0);
        }
        let links: Vec<_> = (0..99).map(|i| (vec![i, i + 1], vec![1.0; 4])).collect();
        let chain = SymmetricMatrix::from_blocks(100, &links).unwrap();
        let chain = SparseCholesky::analyse(&chain).unwrap().multiplications();
        assert_eq!(chain, 99.0 * 3.0 + 1.0);
    }
}
