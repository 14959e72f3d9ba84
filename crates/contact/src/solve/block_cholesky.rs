//! A sparse symmetric positive definite matrix in blocks, one a body, and its factor.
//!
//! ```text
//! A = L L^T,   L_jj L_jj^T = A_jj - sum_k L_jk L_jk^T,   L_ij = (A_ij - sum_k L_ik L_jk^T) L_jj^-T
//! ```
//! `A_ij` (F x F, F the freedoms of a body) is there where bodies `i` and `j` are joined. Bodies are eliminated in the order
//! of fewest neighbours, which fills in little where a graph is nearly a tree, as that of a heap
//! is. The order and the pattern are kept as long as the same bodies are joined. Source: George and
//! Liu 1989.

/// A block, column after column.
pub(crate) type Block<const F: usize> = [[f64; F]; F];

/// The matrix, and its factor as of the last [`BlockCholesky::factor`].
#[derive(Debug, Default)]
pub(crate) struct BlockCholesky<const F: usize> {
    /// For what the order and the pattern were found.
    joints: Vec<[usize; 2]>,
    /// The bodies with which each is joined when it is eliminated.
    near: Vec<Vec<usize>>,
    /// Bodies that are left, and those that are not, in the order of their elimination.
    left: Vec<usize>,
    order: Vec<usize>,
    /// When each body is eliminated.
    place: Vec<usize>,
    /// Where each column starts in `rows` and `below`.
    starts: Vec<usize>,
    /// The places of the blocks below the diagonal, ascending in each column.
    rows: Vec<usize>,
    /// From which blocks the products of the pairs in a column are taken, column after column.
    targets: Vec<usize>,
    diagonal: Vec<Block<F>>,
    below: Vec<Block<F>>,
    /// The factor's blocks.
    lower_diagonal: Vec<Block<F>>,
    lower_below: Vec<Block<F>>,
    /// What is being solved for, in the order of elimination.
    x: Vec<[f64; F]>,
}

impl<const F: usize> BlockCholesky<F> {
    /// Makes the matrix one, with room where these bodies are joined; pairs may repeat.
    pub(crate) fn reset(&mut self, bodies: usize, joints: &[[usize; 2]]) {
        if self.place.len() != bodies || self.joints != joints {
            self.analyse(bodies, joints);
        }
        let mut one = [[0.0; F]; F];
        (0..F).for_each(|k| one[k][k] = 1.0);
        self.diagonal.clear();
        self.diagonal.resize(bodies, one);
        self.below.clear();
        self.below.resize(self.rows.len(), [[0.0; F]; F]);
    }

    fn analyse(&mut self, bodies: usize, joints: &[[usize; 2]]) {
        self.joints.clear();
        self.joints.extend_from_slice(joints);
        self.near.iter_mut().for_each(Vec::clear);
        self.near.resize_with(self.near.len().max(bodies), Vec::new);
        for &[a, b] in joints {
            self.near[a].push(b);
            self.near[b].push(a);
        }
        for near in &mut self.near {
            near.sort_unstable();
            near.dedup();
        }
        self.place.clear();
        self.place.resize(bodies, 0);
        self.left.clear();
        self.left.extend(0..bodies);
        self.order.clear();
        while let Some(next) = self.least_joined() {
            let body = self.left.swap_remove(next);
            self.place[body] = self.order.len();
            self.order.push(body);
            self.eliminate(body);
        }
        self.starts.clear();
        self.rows.clear();
        self.starts.push(0);
        for &body in &self.order {
            let first = self.rows.len();
            self.rows.extend(self.near[body].iter().map(|&other| self.place[other]));
            self.rows[first..].sort_unstable();
            self.starts.push(self.rows.len());
        }
        self.targets.clear();
        for column in 0..bodies {
            for second in self.column(column) {
                for first in second + 1..self.starts[column + 1] {
                    let target = self.slot(self.rows[first], self.rows[second]);
                    self.targets.push(target);
                }
            }
        }
    }

    /// Where the body with the fewest neighbours is among those that are left.
    fn least_joined(&self) -> Option<usize> {
        let joined = |&at: &usize| (self.near[self.left[at]].len(), self.left[at]);
        (0..self.left.len()).min_by_key(joined)
    }

    /// Joins the neighbours of a body with each other, and takes it from them.
    fn eliminate(&mut self, body: usize) {
        let near = std::mem::take(&mut self.near[body]);
        for &other in &near {
            let own = &mut self.near[other];
            own.extend(near.iter().filter(|&&third| third != other));
            own.sort_unstable();
            own.dedup();
            own.retain(|&third| third != body);
        }
        self.near[body] = near;
    }

    fn column(&self, column: usize) -> std::ops::Range<usize> {
        self.starts[column]..self.starts[column + 1]
    }

    /// Where the block of a row is in a column that has it.
    fn slot(&self, row: usize, column: usize) -> usize {
        let range = self.column(column);
        let start = range.start;
        start + self.rows[range].partition_point(|&other| other < row)
    }

    /// The block of a body.
    pub(crate) fn of(&mut self, body: usize) -> &mut Block<F> {
        &mut self.diagonal[self.place[body]]
    }

    /// The block between two bodies that are joined, and whether the first is its row.
    pub(crate) fn between(&mut self, first: usize, second: usize) -> (&mut Block<F>, bool) {
        let [a, b] = [self.place[first], self.place[second]];
        let slot = self.slot(a.max(b), a.min(b));
        (&mut self.below[slot], a > b)
    }

    /// Factors the matrix; false where it is not positive definite.
    pub(crate) fn factor(&mut self) -> bool {
        self.lower_diagonal.clone_from(&self.diagonal);
        self.lower_below.clone_from(&self.below);
        let mut target = 0;
        for column in 0..self.lower_diagonal.len() {
            if !factor(&mut self.lower_diagonal[column]) {
                return false;
            }
            let range = self.column(column);
            // What is changed belongs to later columns.
            let (own, later) = self.lower_below.split_at_mut(range.end);
            let (own, rows) = (&mut own[range.start..], &self.rows[range.clone()]);
            let (of_column, diagonal) = self.lower_diagonal.split_at_mut(column + 1);
            own.iter_mut().for_each(|block| divide(block, &of_column[column]));
            for (second, by) in own.iter().enumerate() {
                subtract(&mut diagonal[rows[second] - column - 1], by, by);
                for block in &own[second + 1..] {
                    subtract(&mut later[self.targets[target] - range.end], block, by);
                    target += 1;
                }
            }
        }
        true
    }

    /// Solves `A x = b` with the factor, in place; both by bodies. Says what `x.b` is.
    pub(crate) fn solve(&mut self, b: &mut [[f64; F]]) -> f64 {
        let mut x = std::mem::take(&mut self.x);
        x.resize(b.len(), [0.0; F]);
        b.iter().zip(&self.place).for_each(|(b, &place)| x[place] = *b);
        let mut product = 0.0;
        for column in 0..x.len() {
            let of = &self.lower_diagonal[column];
            let mut own = x[column];
            for c in 0..F {
                own[c] /= of[c][c];
                (c + 1..F).for_each(|r| own[r] -= of[c][r] * own[c]);
            }
            product += own.iter().map(|x| x * x).sum::<f64>();
            x[column] = own;
            for at in self.column(column) {
                let row = &mut x[self.rows[at]];
                for (column, own) in self.lower_below[at].iter().zip(&own) {
                    (0..F).for_each(|r| row[r] -= column[r] * own);
                }
            }
        }
        for column in (0..x.len()).rev() {
            let of = &self.lower_diagonal[column];
            let mut own = x[column];
            for at in self.column(column) {
                let row = &x[self.rows[at]];
                for (column, own) in self.lower_below[at].iter().zip(&mut own) {
                    *own -= (0..F).map(|r| column[r] * row[r]).sum::<f64>();
                }
            }
            for c in (0..F).rev() {
                let above: f64 = (c + 1..F).map(|r| of[c][r] * own[r]).sum();
                own[c] = (own[c] - above) / of[c][c];
            }
            x[column] = own;
        }
        b.iter_mut().zip(&self.place).for_each(|(b, &place)| *b = x[place]);
        self.x = x;
        product
    }
}

/// The lower factor of a block in its place.
fn factor<const F: usize>(block: &mut Block<F>) -> bool {
    for c in 0..F {
        for k in 0..c {
            let by = block[k][c];
            let earlier = block[k];
            (c..F).for_each(|r| block[c][r] -= earlier[r] * by);
        }
        if block[c][c] <= 0.0 || block[c][c].is_nan() {
            return false;
        }
        let root = block[c][c].sqrt();
        (c..F).for_each(|r| block[c][r] /= root);
    }
    true
}

/// `B <- B L^-T`
#[inline]
fn divide<const F: usize>(block: &mut Block<F>, lower: &Block<F>) {
    for c in 0..F {
        for k in 0..c {
            let (by, earlier) = (lower[k][c], block[k]);
            (0..F).for_each(|r| block[c][r] -= earlier[r] * by);
        }
        let by = lower[c][c].recip();
        block[c].iter_mut().for_each(|x| *x *= by);
    }
}

/// `A <- A - B C^T`
#[inline]
fn subtract<const F: usize>(a: &mut Block<F>, b: &Block<F>, c: &Block<F>) {
    for column in 0..F {
        let mut sum = a[column];
        for k in 0..F {
            let by = c[k][column];
            (0..F).for_each(|r| sum[r] -= b[k][r] * by);
        }
        a[column] = sum;
    }
}

#[cfg(test)]
mod tests {
    use nalgebra::{DMatrix, DVector};
    use stationary_measure::SplitMix64;

    use super::*;

    #[test]
    fn the_factor_solves_what_the_dense_matrix_solves_whatever_is_joined() {
        the_factor_solves::<3>();
        the_factor_solves::<6>();
    }

    fn the_factor_solves<const F: usize>() {
        let mut random = SplitMix64::new(4);
        let (bodies, mut matrix) = (20, BlockCholesky::<F>::default());
        for joints in [0, 5, 19, 40, 40, 150] {
            let joints: Vec<[usize; 2]> = (0..joints)
                .map(|_| [0, 0].map(|_| (random.symmetric().abs() * 20.0) as usize))
                .filter(|[a, b]| a != b)
                .collect();
            for _ in 0..2 {
                matrix.reset(bodies, &joints);
                let mut dense = DMatrix::<f64>::identity(F * bodies, F * bodies);
                for &[a, b] in &joints {
                    let mut row =
                        || -> [f64; F] { std::array::from_fn(|_| 30.0 * random.symmetric()) };
                    let rows = [row(), row()];
                    for (side, body) in [a, b].into_iter().enumerate() {
                        let block = matrix.of(body);
                        for (c, r) in (0..F * F).map(|k| (k / F, k % F)) {
                            block[c][r] += rows[side][c] * rows[side][r];
                        }
                    }
                    let (block, first) = matrix.between(a, b);
                    let [of_row, of_column] = if first { rows } else { [rows[1], rows[0]] };
                    for (c, r) in (0..F * F).map(|k| (k / F, k % F)) {
                        block[c][r] += of_column[c] * of_row[r];
                    }
                    let mut row = DVector::zeros(F * bodies);
                    row.rows_mut(F * a, F).copy_from_slice(&rows[0]);
                    row.rows_mut(F * b, F).copy_from_slice(&rows[1]);
                    dense += &row * row.transpose();
                }
                let right = DVector::from_fn(F * bodies, |_, _| random.symmetric());
                let mut x: Vec<[f64; F]> =
                    right.as_slice().chunks_exact(F).map(|b| b.try_into().unwrap()).collect();
                assert!(matrix.factor());
                matrix.solve(&mut x);
                let x = DVector::from_vec(x.concat());
                assert!((&dense * &x - &right).amax() < 1e-11, "{}", joints.len());
            }
        }
    }

    #[test]
    fn what_is_not_positive_definite_is_refused() {
        let mut matrix = BlockCholesky::<6>::default();
        matrix.reset(2, &[[0, 1]]);
        matrix.between(0, 1).0[3][3] = 2.0;
        assert!(!matrix.factor());
    }
}
