//! Cholesky's method on rows that may depend on each other: which do, and a solution without them.
//!
//! ```text
//! S_ij = <a_i, a_j>,     P S P^T = L L^T,     L_ii = distance of a_i from the rows before it
//! ```
//! `a_i` the rows of J M^-1/2 (m), eliminated in an order P that is found once. A row is dependent where
//! its distance is at most `threshold_i`; its column of L is then zero and its multiplier with it, and
//! what is left is the factor of the rows that are independent.
//!
//! A pivot shows the square of the distance: below a part of 1e-7 of its row's square rounding has
//! taken digits from it. There the distance is measured,
//!
//! ```text
//! r = a_i - sum_j w_j a_j,    L^T w = l_i,     w <- w + S^-1 <a, r>,     |r| +- 4 eps sum |w_j| |a_j|
//! ```
//! as a residual among rows and not among their products, to rounding of the rows: a part in 1e8 of a
//! row is told from nothing. Where the rows that it almost depends on depend almost on each other, `w`
//! is large; a distance whose error does not leave open on which side of the threshold it is decides,
//! and any other is [`ConstraintError::RankUnclear`].
//!
//! Source: Higham, Accuracy and Stability (2002), 10.3 (semidefinite matrices), 20.6 (the seminormal
//! equations and their correction).

use std::sync::Arc;

use stationary_calculus::first_non_finite;

use crate::elimination::Elimination;
use crate::entries::WeightedRows;

/// A pivot below this part of its diagonal entry has its distance measured.
const SUSPICIOUS: f64 = 1e-7;
/// Units of rounding in a residual, of the sum of its terms' sizes.
const ROUNDINGS: f64 = 4.0;
/// Corrections of w, at most.
const CORRECTIONS: u32 = 3;
/// What a coefficient must contribute, relative to the row, to be one.
const NOTHING: f64 = 1e-17;

/// What a factorization cannot tell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Unclear {
    pub(crate) equation: usize,
    /// The distance that was found, and its error.
    pub(crate) distance: f64,
    pub(crate) error: f64,
}

/// An equation that depends on those eliminated before it, to a distance in the units of its row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Dependent {
    pub(crate) equation: u32,
    pub(crate) distance: f64,
}

/// The factor, with the memory to make it.
#[derive(Clone, Debug)]
pub(crate) struct RankRevealing {
    /// Which copies share.
    pub(crate) elimination: Arc<Elimination>,
    /// S below the diagonal by rows of the factor, then its diagonal.
    pub(crate) values: Vec<f64>,
    /// L below the diagonal by columns, and where each column ends so far.
    factor: Vec<f64>,
    ends: Vec<usize>,
    /// One over the diagonal of L; zero for a dependent row.
    inverse: Vec<f64>,
    /// A row of L in the making; zero between.
    row: Vec<f64>,
    /// A combination of rows, over freedoms; zero between.
    dense: Vec<f64>,
    /// The coefficients of a combination, and products with rows.
    weights: Vec<f64>,
    products: Vec<f64>,
    /// The equations that depend on those eliminated before them.
    pub(crate) dependent: Vec<Dependent>,
    /// The row that is closest to dependent and is not, by the square of its distance over its threshold.
    pub(crate) weakest: (u32, f64),
    /// How many rows are so close to dependent that they were measured, and are not.
    pub(crate) close: usize,
}

impl RankRevealing {
    /// Of rows with so many freedoms.
    pub(crate) fn new(elimination: Elimination, freedoms: usize) -> Self {
        let (count, len) = (elimination.order.len(), elimination.len());
        let zeros = vec![0.0; count];
        RankRevealing {
            values: vec![0.0; len + count],
            factor: vec![0.0; len],
            ends: vec![0; count],
            inverse: zeros.clone(),
            row: zeros.clone(),
            dense: vec![0.0; freedoms],
            weights: zeros.clone(),
            products: zeros,
            dependent: Vec::with_capacity(count),
            weakest: (0, f64::INFINITY),
            close: 0,
            elimination: Arc::new(elimination),
        }
    }

    /// The numbers of the factor.
    pub(crate) fn len(&self) -> usize {
        self.factor.len() + self.inverse.len()
    }

    /// Whether an equation depends on those eliminated before it.
    pub(crate) fn is_dependent(&self, equation: usize) -> bool {
        self.inverse[self.elimination.place[equation] as usize] == 0.0
    }

    /// An equation whose row is longer than any number.
    pub(crate) fn non_finite_row(&self) -> Option<usize> {
        let place = first_non_finite(&self.values[self.factor.len()..])?;
        Some(self.elimination.order[place] as usize)
    }

    /// Factors the products in `values`, which are those of `rows`. What is no farther from the rows
    /// before it than its `threshold`, equation by equation, is dependent.
    pub(crate) fn factor(
        &mut self,
        rows: &WeightedRows<'_>,
        thresholds: &[f64],
    ) -> Result<(), Unclear> {
        let count = self.inverse.len();
        self.dependent.clear();
        self.close = 0;
        self.weakest = (0, f64::INFINITY);
        self.ends.copy_from_slice(&self.elimination.column_starts[..count]);
        for place in 0..count {
            let diagonal = self.values[self.factor.len() + place];
            let pivot = self.eliminate(place, diagonal);
            let equation = self.elimination.order[place];
            let threshold = thresholds[equation as usize];
            if pivot > SUSPICIOUS * diagonal && pivot > 4.0 * threshold * threshold {
                self.inverse[place] = pivot.sqrt().recip();
                self.weaken(equation, pivot, threshold);
                continue;
            }
            let distance = self.distance(place, rows, threshold)?;
            if distance > threshold {
                self.inverse[place] = distance.recip();
                self.weaken(equation, distance * distance, threshold);
                self.close += 1;
            } else {
                self.inverse[place] = 0.0;
                self.dependent.push(Dependent { equation, distance });
            }
        }
        Ok(())
    }

    #[inline]
    fn weaken(&mut self, equation: u32, square: f64, threshold: f64) {
        let ratio = square / (threshold * threshold);
        if ratio < self.weakest.1 {
            self.weakest = (equation, ratio);
        }
    }

    /// Writes the row of L at a place; the square of its diagonal entry.
    #[inline]
    fn eliminate(&mut self, place: usize, diagonal: f64) -> f64 {
        let RankRevealing { elimination, values, factor, ends, inverse, row, .. } = self;
        let own = elimination.row_starts[place]..elimination.row_starts[place + 1];
        let columns = &elimination.row_columns[own.clone()];
        for (&column, value) in columns.iter().zip(&values[own]) {
            row[column as usize] = *value;
        }
        let mut pivot = diagonal;
        for &column in columns {
            let column = column as usize;
            let entry = row[column] * inverse[column];
            row[column] = 0.0;
            pivot -= entry * entry;
            let (start, end) = (elimination.column_starts[column], ends[column]);
            let before = elimination.column_rows[start..end].iter().zip(&factor[start..end]);
            for (&below, value) in before {
                row[below as usize] -= value * entry;
            }
            factor[end] = entry;
            ends[column] = end + 1;
        }
        pivot
    }

    /// The distance of a row from those before it, measured. What is at most the threshold is a bound.
    #[cold]
    fn distance(
        &mut self,
        place: usize,
        rows: &WeightedRows<'_>,
        threshold: f64,
    ) -> Result<f64, Unclear> {
        let RankRevealing { elimination, values, factor, ends, inverse, dense, .. } = self;
        let (weights, products) = (&mut self.weights, &mut self.products);
        let length = |place: usize| values[factor.len() + place].sqrt();
        let equation = |place: usize| elimination.order[place] as usize;
        let first = |place: usize| {
            let own = elimination.row_starts[place]..elimination.row_starts[place + 1];
            elimination.row_columns[own].first().map_or(place, |&column| column as usize)
        };
        let column = |column: usize| {
            let own = elimination.column_starts[column]..ends[column];
            elimination.column_rows[own.clone()].iter().zip(&factor[own])
        };
        // L^T w = l from the last row to the first that matters: -1 stands for the row itself.
        let mut reach = first(place);
        weights[place] = -1.0;
        let mut at = place;
        while at > reach {
            at -= 1;
            let sum: f64 = column(at).map(|(&below, l)| l * weights[below as usize]).sum();
            weights[at] = -sum * inverse[at];
            if weights[at].abs() * length(at) <= NOTHING * length(place) {
                weights[at] = 0.0;
            } else {
                reach = reach.min(first(at));
            }
        }
        let within = || (reach..=place).rev();
        let mut found =
            Err(Unclear { equation: equation(place), distance: f64::NAN, error: f64::NAN });
        for _ in 0..=CORRECTIONS {
            let mut sizes = 0.0;
            for at in within().filter(|&at| weights[at] != 0.0) {
                rows.add(equation(at), weights[at], dense);
                sizes += weights[at].abs() * length(at);
            }
            let error = ROUNDINGS * f64::EPSILON * sizes;
            // What of the residual is still in the span of the rows before.
            for (at, product) in products.iter_mut().enumerate().take(place).skip(reach) {
                *product = rows.product(equation(at), dense);
            }
            let mut inside = 0.0;
            for at in reach..place {
                products[at] *= inverse[at];
                let product = products[at];
                inside += product * product;
                for (&below, l) in column(at).filter(|(below, _)| (**below as usize) < place) {
                    products[below as usize] -= l * product;
                }
            }
            let mut square = 0.0;
            for at in within().filter(|&at| weights[at] != 0.0) {
                square += rows.take_square(equation(at), dense);
            }
            let distance = (square - inside).max(0.0).sqrt();
            found = Err(Unclear { equation: equation(place), distance, error });
            if square.sqrt() <= threshold && error <= threshold {
                found = Ok(square.sqrt());
                break;
            }
            if inside <= 0.01 * square && distance - error > threshold && error < 0.1 * distance {
                found = Ok(distance);
                break;
            }
            for at in (reach..place).rev() {
                let below = column(at).filter(|(below, _)| (**below as usize) < place);
                let sum: f64 = below.map(|(&below, l)| l * products[below as usize]).sum();
                products[at] = (products[at] - sum) * inverse[at];
                weights[at] -= products[at];
            }
        }
        weights[reach..=place].fill(0.0);
        found
    }

    /// Replaces numbers, equation by equation, by the solution without the dependent equations, whose
    /// multipliers are zero.
    pub(crate) fn solve(&mut self, b: &mut [f64]) {
        let RankRevealing { elimination, factor, inverse, products: x, .. } = self;
        let starts = &elimination.column_starts;
        let column = |at: usize| {
            let own = starts[at]..starts[at + 1];
            elimination.column_rows[own.clone()].iter().zip(&factor[own])
        };
        for (x, &equation) in x.iter_mut().zip(&elimination.order) {
            *x = b[equation as usize];
        }
        for at in 0..x.len() {
            let value = x[at] * inverse[at];
            x[at] = value;
            column(at).for_each(|(&below, l)| x[below as usize] -= l * value);
        }
        for at in (0..x.len()).rev() {
            let own = starts[at]..starts[at + 1];
            // Two sums side by side, so that none waits for the one before it.
            let (rows, rows_left) = elimination.column_rows[own.clone()].as_chunks::<2>();
            let (values, values_left) = factor[own].as_chunks::<2>();
            let mut sums = [0.0; 2];
            for ([a, b], [l, k]) in rows.iter().zip(values) {
                sums[0] += l * x[*a as usize];
                sums[1] += k * x[*b as usize];
            }
            for (&below, l) in rows_left.iter().zip(values_left) {
                sums[0] += l * x[below as usize];
            }
            x[at] = (x[at] - (sums[0] + sums[1])) * inverse[at];
        }
        for (x, &equation) in x.iter().zip(&elimination.order) {
            b[equation as usize] = *x;
        }
    }
}
