//! Cholesky's method for a sparse positive definite matrix.
//!
//! ```text
//! P A P^T = L L^T
//! ```
//! `A` a [`SymmetricMatrix`] (n x n), `P` the order of elimination ([`Ordering`]), `L` lower triangular. Order, elimination tree and the places of L are found once, by
//! [`SparseCholesky::analyse`]; [`SparseCholesky::factor`] runs numbers only and allocates nothing.
//! Whether L is kept column by column or in dense panels of columns is decided by the work that its
//! fill makes (faer's threshold). A pivot that is not positive, or that rounding left of a zero, is an
//! error that names the freedom; a factor that is not finite is one too.

use std::sync::Arc;

use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::perm::PermRef;
use faer::sparse::FaerError;
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymbolicCholeskyRaw, SymmetricOrdering,
    factorize_symbolic_cholesky, supernodal::SupernodalLltRef,
};
use faer::{Conj, MatMut, Par, Side, Spec};

use crate::equation::solve_in_range;
use crate::first_non_finite;
use crate::pivots::{SUSPICIOUS, is_rounding, load, zero_pivot};
use crate::sparse::SparseError;
use crate::sparse::assembly::SymmetricMatrix;
use crate::sparse::dissection::nested_dissection;
use crate::sparse::pattern::Pattern;
use crate::sparse::scratch::Scratch;

/// How the order of elimination is found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ordering {
    /// Approximate minimum degree: quick to find, best for chains, nets and small systems.
    #[default]
    MinimumDegree,
    /// Nested dissection: slower to find; less fill and a faster factor for bodies in space.
    NestedDissection,
    /// Both are found, and the one with the smaller factor is kept: for factors of long use.
    Smaller,
}

/// The factor of a matrix, or the memory for it.
#[derive(Clone, Debug)]
pub struct SparseCholesky {
    pub(super) pattern: Arc<Pattern>,
    pub(super) symbolic: Arc<SymbolicCholesky<u32>>,
    pub(super) factor: Vec<f64>,
    pub(super) factored: bool,
    pub(super) scratch: Scratch,
    /// Loads on the freedoms of suspicious pivots, and the answer to them.
    loads: Vec<f64>,
    probe: Vec<f64>,
}

pub(crate) fn analysis_error(n: usize, error: FaerError) -> SparseError {
    match error {
        FaerError::IndexOverflow => {
            SparseError::TooLarge { what: "the factor of a matrix of this size", size: n }
        }
        _ => SparseError::OutOfMemory { size: n },
    }
}

impl SparseCholesky {
    /// Finds the order of elimination and takes all memory, from the pattern of `matrix`.
    ///
    /// # Errors
    /// [`SparseError::OutOfMemory`] and [`SparseError::TooLarge`] for a factor that does not fit
    /// into memory or into 32-bit indices.
    pub fn analyse(matrix: &SymmetricMatrix) -> Result<Self, SparseError> {
        SparseCholesky::analyse_by(matrix, Ordering::default())
    }

    /// The same with a choice of how the order is found.
    ///
    /// # Errors
    /// Those of [`SparseCholesky::analyse`].
    pub fn analyse_by(matrix: &SymmetricMatrix, ordering: Ordering) -> Result<Self, SparseError> {
        let n = matrix.dim();
        let symbolic = match ordering {
            Ordering::MinimumDegree => by_minimum_degree(matrix)?,
            Ordering::NestedDissection => by_nested_dissection(matrix)?,
            Ordering::Smaller => {
                let (one, other) = (by_minimum_degree(matrix)?, by_nested_dissection(matrix)?);
                if one.len_val() <= other.len_val() { one } else { other }
            }
        };
        let scratch = Scratch::new(
            n,
            &[
                symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
                symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
            ],
        )?;
        Ok(SparseCholesky {
            pattern: Arc::clone(matrix.pattern()),
            factor: vec![0.0; symbolic.len_val()],
            symbolic: Arc::new(symbolic),
            factored: false,
            scratch,
            loads: vec![0.0; n],
            probe: vec![0.0; n],
        })
    }

    /// Factors a matrix of the analysed pattern.
    ///
    /// # Errors
    /// [`SparseError::OtherPattern`] for a matrix of another analysis, even of the same places;
    /// [`SparseError::NonFinite`]; [`SparseError::NotPositiveDefinite`] with the freedom.
    pub fn factor(&mut self, matrix: &SymmetricMatrix) -> Result<(), SparseError> {
        if !Arc::ptr_eq(&self.pattern, matrix.pattern()) {
            return Err(SparseError::OtherPattern);
        }
        self.factored = false;
        let factored = self.symbolic.factorize_numeric_llt(
            &mut self.factor,
            matrix.lower(),
            Side::Lower,
            LltRegularization::default(),
            Par::Seq,
            self.scratch.stack(),
            Spec::default(),
        );
        match factored {
            Ok(_) => {
                let mut loads = std::mem::take(&mut self.loads);
                loads.fill(0.0);
                let suspicious = self.check_pivots(matrix, &mut loads);
                self.loads = loads;
                self.factored = suspicious.is_ok();
                if suspicious? && self.is_rounding(matrix) {
                    self.factored = false;
                    let freedom = self.softest(matrix);
                    return Err(SparseError::NotPositiveDefinite { freedom });
                }
                Ok(())
            }
            Err(_) if first_non_finite(matrix.values()).is_some() => Err(SparseError::NonFinite),
            Err(LltError::NonPositivePivot { index }) => {
                // faer counts from 1 by columns, and from 0 by panels.
                let by_columns = matches!(self.symbolic.raw(), SymbolicCholeskyRaw::Simplicial(_));
                let freedom = self.freedom(index - usize::from(by_columns));
                Err(SparseError::NotPositiveDefinite { freedom })
            }
        }
    }

    /// Solves `A X = B` in place for right-hand sides one after the other, n numbers each: the factor
    /// is read once for all of them. NaN where the last factorization failed, and where a number of
    /// the solutions is too large. The first call with more of them than before takes memory.
    pub fn solve(&mut self, b: &mut [f64]) {
        let n = self.symbolic.nrows();
        let columns = b.len().checked_div(n).unwrap_or(0);
        if !self.factored || columns * n != b.len() {
            return b.fill(f64::NAN);
        }
        let needed = self.symbolic.solve_in_place_scratch::<f64>(columns, Par::Seq);
        if self.scratch.grow(needed).is_err() {
            return b.fill(f64::NAN);
        }
        let SparseCholesky { symbolic, factor, scratch, .. } = self;
        solve_in_range(b, |b| {
            let b = MatMut::from_column_major_slice_mut(b, n, columns);
            let factor = LltRef::new(symbolic, factor);
            factor.solve_in_place_with_conj(Conj::No, b, Par::Seq, scratch.stack());
        });
    }

    /// The order of elimination and the places of the factor.
    pub(crate) fn symbolic(&self) -> &SymbolicCholesky<u32> {
        &self.symbolic
    }

    pub(crate) fn numbers(&self) -> &[f64] {
        &self.factor
    }

    /// The freedom that is eliminated at the given place.
    fn freedom(&self, place: usize) -> usize {
        match self.symbolic.perm() {
            Some(perm) => perm.arrays().0.get(place).map_or(place, |&freedom| freedom as usize),
            None => place,
        }
    }

    /// Whether pivots that are small beside their diagonal entries are what rounding leaves of zero.
    #[cold]
    fn is_rounding(&mut self, matrix: &SymmetricMatrix) -> bool {
        let mut probe = std::mem::take(&mut self.probe);
        probe.copy_from_slice(&self.loads);
        self.solve(&mut probe);
        let is_rounding = is_rounding(&probe, |i| self.loads[i], |i| matrix.diagonal(i));
        self.probe = probe;
        is_rounding
    }

    /// The suspicious freedom that yields most to the loads.
    #[cold]
    fn softest(&self, matrix: &SymmetricMatrix) -> usize {
        let suspicious = (0..self.loads.len()).filter(|&i| self.loads[i] > 0.0);
        let yields = |i: usize| matrix.diagonal(i).sqrt() * self.probe[i].abs();
        suspicious.max_by(|&i, &j| yields(i).total_cmp(&yields(j))).unwrap_or(0)
    }

    /// faer takes infinite pivots and what rounding leaves of zero ones for positive: not so here. A
    /// number that is not finite anywhere in the factor makes a later pivot infinite or NaN. Whether
    /// pivots are suspicious; their freedoms are given loads.
    fn check_pivots(
        &self,
        matrix: &SymmetricMatrix,
        loads: &mut [f64],
    ) -> Result<bool, SparseError> {
        let zero = zero_pivot(matrix.dim());
        let mut suspicious = false;
        let mut check = |place: usize, root: f64| {
            let freedom = self.freedom(place);
            let pivot = root * root;
            if pivot.is_nan() || pivot == f64::INFINITY {
                Err(SparseError::NonFinite)
            } else if pivot > zero * matrix.diagonal(freedom) {
                if pivot < SUSPICIOUS * matrix.diagonal(freedom) {
                    suspicious = true;
                    loads[freedom] = load(freedom, matrix.diagonal(freedom));
                }
                Ok(())
            } else {
                Err(SparseError::NotPositiveDefinite { freedom })
            }
        };
        match self.symbolic.raw() {
            SymbolicCholeskyRaw::Simplicial(symbolic) => {
                let starts = &symbolic.col_ptr()[..symbolic.ncols()];
                let mut roots = starts.iter().map(|&start| self.factor[start as usize]).enumerate();
                roots.try_for_each(|(place, root)| check(place, root))?;
            }
            SymbolicCholeskyRaw::Supernodal(symbolic) => {
                let factor = SupernodalLltRef::new(symbolic, &self.factor);
                (0..symbolic.n_supernodes()).try_for_each(|s| {
                    let panel = factor.supernode(s);
                    let block = panel.val();
                    (0..block.ncols()).try_for_each(|j| check(panel.start() + j, block[(j, j)]))
                })?;
            }
        }
        Ok(suspicious)
    }
}

type Analysed = Result<SymbolicCholesky<u32>, SparseError>;

fn by_minimum_degree(matrix: &SymmetricMatrix) -> Analysed {
    analysed(matrix, SymmetricOrdering::Amd)
}

fn by_nested_dissection(matrix: &SymmetricMatrix) -> Analysed {
    let order = nested_dissection(matrix.column_starts(), matrix.rows())?;
    let mut places = vec![0; order.len()];
    for (place, &freedom) in order.iter().enumerate() {
        places[freedom as usize] = place as u32;
    }
    let order = PermRef::new_checked(&order, &places, matrix.dim());
    analysed(matrix, SymmetricOrdering::Custom(order))
}

fn analysed(matrix: &SymmetricMatrix, order: SymmetricOrdering<'_, u32>) -> Analysed {
    let columns = matrix.pattern().columns.as_ref();
    let parameters = CholeskySymbolicParams::default();
    factorize_symbolic_cholesky(columns, Side::Lower, order, parameters)
        .map_err(|error| analysis_error(matrix.dim(), error))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{DMatrix, DVector};

    /// Edges of a square grid of `side` x `side` freedoms as blocks `[1 -1; -1 1]`, and `ground` on the
    /// diagonal of each freedom: positive definite for ground > 0, singular for ground = 0.
    fn grid(side: usize, ground: f64) -> Vec<(Vec<usize>, Vec<f64>)> {
        let mut blocks = Vec::new();
        for x in 0..side {
            for y in 0..side {
                let i = x * side + y;
                blocks.push((vec![i], vec![ground]));
                for (neighbour, inside) in [(i + 1, y + 1 < side), (i + side, x + 1 < side)] {
                    if inside {
                        blocks.push((vec![i, neighbour], vec![1.0, -1.0, -1.0, 1.0]));
                    }
                }
            }
        }
        blocks
    }

    /// A grid that is factored by columns, and one that is factored by panels.
    const SIDES: [usize; 2] = [5, 150];

    fn has_panels(cholesky: &SparseCholesky) -> bool {
        matches!(cholesky.symbolic.raw(), SymbolicCholeskyRaw::Supernodal(_))
    }

    #[test]
    fn small_factors_are_kept_by_columns_and_large_ones_by_panels() {
        for side in SIDES {
            let matrix = SymmetricMatrix::from_blocks(side * side, &grid(side, 1.0)).unwrap();
            let cholesky = SparseCholesky::analyse(&matrix).unwrap();
            assert_eq!(has_panels(&cholesky), side == 150);
        }
    }

    #[test]
    fn the_solution_solves_the_system() {
        for side in SIDES {
            let n = side * side;
            let matrix = SymmetricMatrix::from_blocks(n, &grid(side, 0.1)).unwrap();
            let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
            let exact: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
            let mut b = vec![0.0; n];
            matrix.add_product(1.0, &exact, &mut b).unwrap();
            for _ in 0..2 {
                cholesky.factor(&matrix).unwrap();
                let mut x = b.clone();
                cholesky.solve(&mut x);
                for (x, exact) in x.iter().zip(&exact) {
                    assert!((x - exact).abs() < 1e-12);
                }
            }
        }
    }

    /// Cubes of `side` nodes a side, with edges along the axes.
    fn cube(side: usize) -> SymmetricMatrix {
        let mut blocks = Vec::new();
        for v in 0..side.pow(3) {
            blocks.push((vec![v], vec![0.1]));
            for stride in [1, side, side * side] {
                if v / stride % side + 1 < side {
                    blocks.push((vec![v, v + stride], vec![1.0, -1.0, -1.0, 1.0]));
                }
            }
        }
        SymmetricMatrix::from_blocks(side.pow(3), &blocks).unwrap()
    }

    #[test]
    fn dissection_solves_the_same_system_with_less_fill_on_a_body_in_space() {
        let matrix = cube(24);
        let mut factors = [Ordering::NestedDissection, Ordering::MinimumDegree]
            .map(|ordering| SparseCholesky::analyse_by(&matrix, ordering).unwrap());
        let solutions = factors.each_mut().map(|cholesky| {
            let mut x: Vec<f64> = (0..matrix.dim()).map(|i| (i as f64).sin()).collect();
            cholesky.factor(&matrix).unwrap();
            cholesky.solve(&mut x);
            x
        });
        for (a, b) in solutions[0].iter().zip(&solutions[1]) {
            assert!((a - b).abs() < 1e-12);
        }
        assert!(factors[0].factor_len() < factors[1].factor_len());
    }

    #[test]
    fn the_factor_agrees_with_a_dense_one() {
        let matrix = SymmetricMatrix::from_blocks(25, &grid(5, 0.1)).unwrap();
        let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
        cholesky.factor(&matrix).unwrap();
        let mut dense = DMatrix::<f64>::zeros(25, 25);
        for j in 0..25 {
            let mut column = vec![0.0; 25];
            let mut unit = vec![0.0; 25];
            unit[j] = 1.0;
            matrix.add_product(1.0, &unit, &mut column).unwrap();
            dense.set_column(j, &DVector::from_vec(column));
        }
        let inverse = dense.try_inverse().unwrap();
        for j in 0..25 {
            let mut unit = vec![0.0; 25];
            unit[j] = 1.0;
            cholesky.solve(&mut unit);
            assert!((DVector::from_vec(unit) - inverse.column(j)).amax() < 1e-13);
        }
    }

    #[test]
    fn the_freedom_whose_pivot_is_not_positive_is_named() {
        for side in SIDES {
            let n = side * side;
            for (bad, pivot) in [(0, -1.0), (7, -1.0), (n, 0.0)] {
                // One more freedom on its own, in the middle of the numbering.
                let mut blocks = grid(side, 1.0);
                for freedom in blocks.iter_mut().flat_map(|(freedoms, _)| freedoms) {
                    *freedom += usize::from(*freedom >= bad);
                }
                blocks.push((vec![bad], vec![pivot]));
                let matrix = SymmetricMatrix::from_blocks(n + 1, &blocks).unwrap();
                let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
                assert_eq!(has_panels(&cholesky), side == 150);
                let error = cholesky.factor(&matrix).unwrap_err();
                assert_eq!(error, SparseError::NotPositiveDefinite { freedom: bad });
            }
        }
    }

    #[test]
    fn what_rounding_leaves_of_a_zero_pivot_is_not_positive() {
        for side in SIDES {
            for factor in [1.0, 0.1, 0.3] {
                let mut blocks = grid(side, 0.0);
                blocks.iter_mut().flat_map(|(_, entries)| entries).for_each(|e| *e *= factor);
                let matrix = SymmetricMatrix::from_blocks(side * side, &blocks).unwrap();
                let error = SparseCholesky::analyse(&matrix).unwrap().factor(&matrix).unwrap_err();
                assert!(matches!(error, SparseError::NotPositiveDefinite { .. }), "{error}");
            }
        }
    }

    type Blocks = Vec<(Vec<usize>, Vec<f64>)>;

    /// Three freedoms of rank two: elimination magnifies the rounding of the third pivot.
    fn rank_two(delta: f64) -> Blocks {
        let entry = |k: usize| 1.0 + [0.0, 1.0, 10.0][k / 3] * [0.0, 1.0, 10.0][k % 3] * delta;
        vec![((0..3).collect(), (0..9).map(entry).collect())]
    }

    /// Five freedoms, all coupled, from the third on: their sum is held by `least`, all else by 1.
    fn five(least: f64) -> Blocks {
        let entry = |k: usize| f64::from(k.is_multiple_of(6)) - (1.0 - least) / 5.0;
        vec![((3..8).collect(), (0..25).map(entry).collect())]
    }

    #[test]
    fn rounding_is_found_whatever_is_eliminated_after_it() {
        // The last: regular, though its last pivot is suspicious as well.
        for after in [vec![], five(1.0), five(0.9), five(1e-9)] {
            for k in 1..30 {
                let blocks = [rank_two(1.1e-4 * f64::from(k)), after.clone()].concat();
                let matrix = SymmetricMatrix::from_blocks(3 + 5 * (blocks.len() - 1), &blocks);
                let matrix = matrix.unwrap();
                let factored = SparseCholesky::analyse(&matrix).unwrap().factor(&matrix);
                let named = matches!(
                    factored,
                    Err(SparseError::NotPositiveDefinite { freedom }) if freedom < 3
                );
                assert!(named, "{k}: {factored:?}");
            }
        }
        let held = vec![(vec![0], vec![1.0]), (vec![1], vec![1.0]), (vec![2], vec![1.0])];
        let matrix = SymmetricMatrix::from_blocks(8, &[held, five(1e-9)].concat()).unwrap();
        assert_eq!(SparseCholesky::analyse(&matrix).unwrap().factor(&matrix), Ok(()));
    }

    #[test]
    fn numbers_that_are_not_finite_never_pass() {
        for side in SIDES {
            for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
                for (block, entry) in [(0, 0), (1, 0), (1, 1), (3, 2)] {
                    let mut blocks = grid(side, 1.0);
                    let entries = &mut blocks[block].1;
                    let entry = entry.min(entries.len() - 1);
                    entries[entry] = bad;
                    if entries.len() == 4 && (entry == 1 || entry == 2) {
                        entries[3 - entry] = bad;
                    }
                    let matrix = SymmetricMatrix::from_blocks(side * side, &blocks).unwrap();
                    let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
                    assert_eq!(cholesky.factor(&matrix), Err(SparseError::NonFinite));
                }
            }
        }
    }

    #[test]
    fn a_matrix_of_another_pattern_is_refused() {
        let matrix = SymmetricMatrix::from_blocks(25, &grid(5, 1.0)).unwrap();
        let other = SymmetricMatrix::from_blocks(25, &grid(5, 1.0)).unwrap();
        let mut cholesky = SparseCholesky::analyse(&matrix).unwrap();
        assert_eq!(cholesky.factor(&other), Err(SparseError::OtherPattern));
        assert_eq!(cholesky.factor(&matrix.clone()), Ok(()));
    }
}
