//! Cholesky's method without roots on rows that may depend on each other: which do, and a solution without them.
//!
//! ```text
//! S_ij = <a_i, a_j>,     P S P^T = L D L^T,     L_ii = 1
//! d_i = the square of the distance of a_i from the rows before it
//! ```
//! `a_i` the rows of J M^-1/2 (m), eliminated in an order P that is found once, front by front (columns
//! with the same rows below them). A row is dependent where
//! its distance is at most `threshold_i`; its column below the diagonal is then zero and its multiplier with it, and
//! what is left is the factor of the rows that are independent. No step waits for a root.
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

use stationary_calculus::{array, first_non_finite};

use crate::elimination::{Elimination, Front, Update, WIDEST};
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
    /// S below the diagonal in the blocks of fronts, which L replaces, then the diagonal of S.
    pub(crate) values: Vec<f64>,
    /// D, so far.
    pivots: Vec<f64>,
    /// One over D; zero for a dependent row.
    inverse: Vec<f64>,
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
            pivots: zeros.clone(),
            inverse: zeros.clone(),
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
        self.values.len()
    }

    /// Whether an equation depends on those eliminated before it.
    pub(crate) fn is_dependent(&self, equation: usize) -> bool {
        self.inverse[self.elimination.place[equation] as usize] == 0.0
    }

    /// An equation whose row is longer than any number.
    pub(crate) fn non_finite_row(&self) -> Option<usize> {
        let place = first_non_finite(&self.values[self.elimination.len()..])?;
        Some(self.elimination.order[place] as usize)
    }

    /// Factors the products in `values`, which are those of `rows`. What is no farther from the rows
    /// before it than its `threshold`, equation by equation, is dependent.
    pub(crate) fn factor(
        &mut self,
        rows: &WeightedRows<'_>,
        thresholds: &[f64],
    ) -> Result<(), Unclear> {
        let elimination = Arc::clone(&self.elimination);
        self.dependent.clear();
        self.close = 0;
        self.weakest = (0, f64::INFINITY);
        self.pivots.copy_from_slice(&self.values[elimination.len()..]);
        let mut updates = &elimination.updates[..];
        for front in &elimination.fronts {
            let (own, later) = updates.split_at(front.updates);
            let judged = (front, own, rows, thresholds);
            match front.width {
                1 => self.factor_front::<1>(judged),
                2 => self.factor_front::<2>(judged),
                3 => self.factor_front::<3>(judged),
                4 => self.factor_front::<4>(judged),
                5 => self.factor_front::<5>(judged),
                _ => self.factor_front::<WIDEST>(judged),
            }?;
            updates = later;
        }
        Ok(())
    }

    /// Factors the W columns of a front, and takes their products from those of later fronts.
    #[inline]
    fn factor_front<const W: usize>(
        &mut self,
        (front, updates, rows, thresholds): (&Front, &[Update], &WeightedRows<'_>, &[f64]),
    ) -> Result<(), Unclear> {
        let start = front.start;
        for own in 0..W {
            let block = self.values[front.block()].as_chunks_mut::<W>().0;
            let (before, row) = block.split_at_mut(own);
            let Some(row) = row.first_mut() else { break };
            let mut products = *row;
            for (j, above) in before.iter().enumerate() {
                products[j] = reduced(&products, above, j);
                row[j] = products[j] * self.inverse[start + j];
                self.pivots[start + own] -= products[j] * row[j];
            }
            let threshold = thresholds[self.elimination.order[start + own] as usize];
            self.judge(start + own, rows, threshold)?;
        }
        let RankRevealing { elimination, values, pivots, inverse, .. } = self;
        let (values, later) = values.split_at_mut(front.block().end);
        let (top, below) = values[front.block..].as_chunks_mut::<W>().0.split_at_mut(W);
        let (done, pivots) = pivots.split_at_mut(start + W);
        let (own, inverse) = (&done[start..], &inverse[start..start + W]);
        for (row, &at) in below.iter_mut().zip(elimination.below(front)) {
            let mut products = *row;
            let pivot = &mut pivots[at as usize - (start + W)];
            for j in 0..W {
                products[j] = reduced(&products, &top[j], j);
                row[j] = products[j] * inverse[j];
                *pivot -= products[j] * row[j];
            }
        }
        for &Update { row, from, len, to } in updates {
            let (row, from, to) = (&below[row as usize], from as usize, to as usize);
            let row: [f64; W] = array(|k| row[k] * own[k]);
            let others = below[from..].iter().take(len as usize);
            for (entry, other) in later[to..].iter_mut().zip(others) {
                *entry = (0..W).fold(*entry, |entry, k| entry - row[k] * other[k]);
            }
        }
        Ok(())
    }

    /// Finds one over the entry of D at a place, whose row has its entries.
    #[inline]
    fn judge(
        &mut self,
        place: usize,
        rows: &WeightedRows<'_>,
        threshold: f64,
    ) -> Result<(), Unclear> {
        let equation = self.elimination.order[place];
        let (pivot, diagonal) = (self.pivots[place], self.values[self.elimination.len() + place]);
        if pivot > SUSPICIOUS * diagonal && pivot > 4.0 * threshold * threshold {
            self.inverse[place] = pivot.recip();
            self.weaken(equation, pivot, threshold);
            return Ok(());
        }
        let distance = self.distance(place, rows, threshold)?;
        if distance > threshold {
            self.pivots[place] = distance * distance;
            self.inverse[place] = self.pivots[place].recip();
            self.weaken(equation, distance * distance, threshold);
            self.close += 1;
        } else {
            self.inverse[place] = 0.0;
            self.dependent.push(Dependent { equation, distance });
        }
        Ok(())
    }

    #[inline]
    fn weaken(&mut self, equation: u32, square: f64, threshold: f64) {
        let allowed = threshold * threshold;
        if square < self.weakest.1 * allowed {
            self.weakest = (equation, square / allowed);
        }
    }

    /// The distance of a row from those before it, measured. What is at most the threshold is a bound.
    #[cold]
    fn distance(
        &mut self,
        place: usize,
        rows: &WeightedRows<'_>,
        threshold: f64,
    ) -> Result<f64, Unclear> {
        let RankRevealing { elimination, values, inverse, dense, .. } = self;
        let (weights, products) = (&mut self.weights, &mut self.products);
        let length = |place: usize| values[elimination.len() + place].sqrt();
        let equation = |place: usize| elimination.order[place] as usize;
        let first = |place: usize| elimination.first[place] as usize;
        let column = |column: usize| elimination.column(column).map(|(row, at)| (row, values[at]));
        // L^T w = l from the last row to the first that matters: -1 stands for the row itself.
        let mut reach = first(place);
        weights[place] = -1.0;
        let mut at = place;
        while at > reach {
            at -= 1;
            let sum: f64 = column(at).map(|(below, l)| l * weights[below]).sum();
            weights[at] = if inverse[at] > 0.0 { -sum } else { 0.0 };
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
                let product = products[at];
                products[at] *= inverse[at];
                inside += product * products[at];
                for (below, l) in column(at).filter(|(below, _)| *below < place) {
                    products[below] -= l * product;
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
                let below = column(at).filter(|(below, _)| *below < place);
                let sum: f64 = below.map(|(below, l)| l * products[below]).sum();
                products[at] = if inverse[at] > 0.0 { products[at] - sum } else { 0.0 };
                weights[at] -= products[at];
            }
        }
        weights[reach..=place].fill(0.0);
        found
    }

    /// Replaces numbers, equation by equation, by the solution without the dependent equations, whose
    /// multipliers are zero.
    pub(crate) fn solve(&mut self, b: &mut [f64]) {
        for (x, &equation) in self.products.iter_mut().zip(&self.elimination.order) {
            *x = b[equation as usize];
        }
        let elimination = Arc::clone(&self.elimination);
        for front in &elimination.fronts {
            match front.width {
                1 => self.forward::<1>(front),
                2 => self.forward::<2>(front),
                3 => self.forward::<3>(front),
                4 => self.forward::<4>(front),
                5 => self.forward::<5>(front),
                _ => self.forward::<WIDEST>(front),
            }
        }
        self.products.iter_mut().zip(&self.inverse).for_each(|(x, inverse)| *x *= inverse);
        for front in elimination.fronts.iter().rev() {
            match front.width {
                1 => self.backward::<1>(front),
                2 => self.backward::<2>(front),
                3 => self.backward::<3>(front),
                4 => self.backward::<4>(front),
                5 => self.backward::<5>(front),
                _ => self.backward::<WIDEST>(front),
            }
        }
        for (x, &equation) in self.products.iter().zip(&elimination.order) {
            b[equation as usize] = *x;
        }
    }

    /// `L x = b` of the W columns of a front, whose part is taken from the rows below.
    #[inline]
    fn forward<const W: usize>(&mut self, front: &Front) {
        let RankRevealing { elimination, values, products, .. } = self;
        let (top, below) = values[front.block()].as_chunks::<W>().0.split_at(W);
        let mut x = [0.0; W];
        let own = &mut products[front.start..front.start + W];
        for i in 0..W {
            x[i] = (0..i).fold(own[i], |sum, k| sum - top[i][k] * x[k]);
        }
        own.copy_from_slice(&x);
        for (row, &at) in below.iter().zip(elimination.below(front)) {
            let sum = &mut products[at as usize];
            *sum = (0..W).fold(*sum, |sum, k| sum - row[k] * x[k]);
        }
    }

    /// `L^T x = b` of the W columns of a front, by what is known of the rows below.
    #[inline]
    fn backward<const W: usize>(&mut self, front: &Front) {
        let RankRevealing { elimination, values, products, .. } = self;
        let (top, below) = values[front.block()].as_chunks::<W>().0.split_at(W);
        let mut x = [0.0; W];
        x.copy_from_slice(&products[front.start..front.start + W]);
        for (row, &at) in below.iter().zip(elimination.below(front)) {
            let value = products[at as usize];
            (0..W).for_each(|k| x[k] -= row[k] * value);
        }
        for i in (0..W).rev() {
            let value = x[i];
            (0..i).for_each(|k| x[k] -= top[i][k] * value);
        }
        products[front.start..front.start + W].copy_from_slice(&x);
    }
}

/// The entry of a row in column j without what the columns before take of it.
#[inline]
fn reduced<const W: usize>(row: &[f64; W], above: &[f64; W], j: usize) -> f64 {
    (0..j).fold(row[j], |entry, k| entry - row[k] * above[k])
}
