//! Multipliers of a few equations: rows turned against each other until they are orthogonal.
//!
//! ```text
//! W D^-1 J M^-1/2 = Sigma Q,     S^-1 = D^-1 W^T Sigma^-2 W D^-1
//! ```
//! `J` m x n with m at most M, `D` the slopes of the equations, `W` a rotation (m x m), `Sigma` the
//! singular values of J M^-1/2 in reference scales, `Q` with orthonormal rows. The roots are never
//! taken: the inner product of two rows is that of covectors, `<a, M^-1 b>`, and so any metric will
//! do. One-sided rotations (Hestenes 1958) find the smallest singular value to rounding of the
//! largest, where the pivots of J M^-1 J^T would only show its square: the rank is judged at every
//! step.
//!
//! Everything lives in arrays: nothing is allocated beyond what the storage C itself takes. The
//! work grows with m^2 n; for many equations see `DiagonalMultipliers`.

use std::array::from_fn;

use stationary_calculus::{Covector, Metric, SizeError, Storage, Vector, first_non_finite};

use crate::carried_sum::CarriedSum;
use crate::multipliers::{DEPENDENT, Diagonal, check_solve};
use crate::rows::check_entries;
use crate::{Constraint, ConstraintError, Multipliers, Redundancy, Rows, Solver};

/// Rounds over all pairs of rows; a handful are the rule.
const SWEEPS: usize = 60;
/// What is named where it is not finite.
const DIFFERENTIAL: &str = "constraint's differential";
/// A row this much shorter than the longest is zero, far below what counts as dependent.
const ROUNDING: f64 = 1e-13;

/// Multipliers of at most M equations, with rows stored as C.
#[derive(Clone, Debug)]
pub struct DenseMultipliers<C, const M: usize> {
    count: usize,
    freedoms: usize,
    prepared: bool,
    redundancy: Redundancy,
    /// One over the slope of each equation.
    inverse_slope: [f64; M],
    /// A singular value that is normal: one over the root of the largest mass that an equation touches, the largest
    /// of all equations.
    normal: f64,
    mass: C,
    rows: [Covector<C>; M],
    turned: [Covector<C>; M],
    raised: [Vector<C>; M],
    rotation: [[f64; M]; M],
    /// One over the square of each singular value, zero for those that are cut.
    inverse_square: [f64; M],
    regularity: f64,
}

/// The choice of [`DenseMultipliers`]: at most M equations, any metric. M is at most three:
/// ```compile_fail
/// # use stationary_constraints::problems::folded_chain;
/// use stationary_constraints::{Dense, Rattle, Redundancy};
/// let chain = folded_chain(4)?;
/// let dense = SparseDiagonal(Redundancy::Refuse);
/// Rattle::new(&chain.system, chain.rods.clone(), &chain.initial, dense)?;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dense<const M: usize>(pub Redundancy);

impl<C: Storage, const M: usize> Solver<C> for Dense<M> {
    type Multipliers = DenseMultipliers<C, M>;

    fn analyse<A: Metric, K: Constraint>(
        &self,
        metric: &A,
        constraint: &K,
        t: f64,
        q: &[f64],
    ) -> Result<DenseMultipliers<C, M>, ConstraintError> {
        const { assert!(M <= 3, "more than three equations are SparseDiagonal's") };
        let (n, count) = (metric.dim(), constraint.count());
        check_entries(constraint, n, t, q)?;
        if count > M {
            return Err(ConstraintError::TooMany { room: M, count });
        }
        let got = size_of::<C>() / size_of::<f64>();
        let what = "the storage's numbers";
        let zeros = C::zeros(n).ok_or(SizeError { what, expected: n, got })?;
        Ok(DenseMultipliers {
            count,
            freedoms: n,
            prepared: false,
            redundancy: self.0,
            inverse_slope: from_fn(|row| {
                if row < count { constraint.scale(row).slope.recip() } else { 0.0 }
            }),
            normal: 0.0,
            mass: zeros.clone(),
            rows: from_fn(|_| Covector(zeros.clone())),
            turned: from_fn(|_| Covector(zeros.clone())),
            raised: from_fn(|_| Vector(zeros.clone())),
            rotation: [[0.0; M]; M],
            inverse_square: [0.0; M],
            regularity: 0.0,
        })
    }
}

/// Numbers of which at most M are used, one for each equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SmallVec<const M: usize> {
    count: usize,
    numbers: [f64; M],
}

impl<const M: usize> AsRef<[f64]> for SmallVec<M> {
    #[inline]
    fn as_ref(&self) -> &[f64] {
        &self.numbers[..self.count]
    }
}

impl<const M: usize> AsMut<[f64]> for SmallVec<M> {
    #[inline]
    fn as_mut(&mut self) -> &mut [f64] {
        &mut self.numbers[..self.count]
    }
}

/// Adds entries to the rows, and finds the first that is in none, and the largest mass that each touches.
struct Fill<'a, C, const M: usize> {
    rows: &'a mut [Covector<C>],
    mass: &'a [f64],
    largest_mass: [f64; M],
    outside: Option<(usize, usize)>,
}

impl<C: Storage, const M: usize> Rows for Fill<'_, C, M> {
    #[inline]
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        let place = self.rows.get_mut(row).and_then(|row| row.components_mut().get_mut(freedom));
        match place {
            Some(entry) => {
                *entry += value;
                self.largest_mass[row] = self.largest_mass[row].max(self.mass[freedom]);
            }
            None => {
                self.outside.get_or_insert((row, freedom));
            }
        }
    }
}

impl<C: Storage, const M: usize> Multipliers for DenseMultipliers<C, M> {
    type Numbers = SmallVec<M>;

    fn numbers(&self) -> SmallVec<M> {
        SmallVec { count: self.count, numbers: [0.0; M] }
    }

    fn prepare(
        &mut self,
        metric: &impl Metric,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.prepared = false;
        let (rows, freedoms) = (self.count, self.freedoms);
        SizeError::check("the constraint's equations", rows, constraint.count())?;
        SizeError::check("the metric's freedoms", freedoms, metric.dim())?;
        self.rows.iter_mut().for_each(Covector::clear);
        Diagonal::refilled(self.mass.as_mut(), metric);
        let (all, mass) = (&mut self.rows[..rows], self.mass.as_ref());
        let mut fill = Fill { rows: all, mass, largest_mass: [0.0; M], outside: None };
        constraint.differential(t, q, &mut fill)?;
        if let Some((row, freedom)) = fill.outside {
            return Err(ConstraintError::UnknownFreedom { row, freedom, rows, freedoms });
        }
        let touched = fill.largest_mass.iter().filter(|mass| **mass > 0.0);
        self.normal = touched.fold(0.0, |most: f64, mass| most.max(mass.recip())).sqrt();
        for row in 0..self.count {
            self.turned[row].clear();
            self.turned[row].add_scaled(self.inverse_slope[row], self.rows[row].view());
            metric.sharp(self.turned[row].view(), self.raised[row].view_mut());
            if let Some(index) = first_non_finite(self.raised[row].components()) {
                return Err(ConstraintError::NonFinite { what: DIFFERENTIAL, index });
            }
            self.rotation[row] = from_fn(|column| f64::from(row == column));
        }
        if !self.orthogonalize() {
            let turned = self.turned[..self.count].iter();
            let index = turned.filter_map(|row| first_non_finite(row.components())).next();
            let index = index.unwrap_or(0);
            return Err(ConstraintError::NonFinite { what: DIFFERENTIAL, index });
        }
        self.examine()?;
        self.prepared = true;
        Ok(())
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), ConstraintError> {
        check_solve(self.prepared, self.count, b)?;
        let (count, slopes) = (self.count, &self.inverse_slope);
        let mut along = [0.0; M];
        let turned = self.rotation.iter().zip(&self.inverse_square).take(count);
        for (along, (rotation, inverse_square)) in along.iter_mut().zip(turned) {
            let terms = rotation.iter().zip(slopes).zip(&*b);
            *along = inverse_square * terms.map(|((w, slope), b)| w * slope * b).sum::<f64>();
        }
        for (j, b) in b.iter_mut().enumerate().take(count) {
            let terms = self.rotation.iter().zip(&along).take(count);
            *b = slopes[j] * terms.map(|(w, along)| w[j] * along).sum::<f64>();
        }
        Ok(())
    }

    fn regularity(&self) -> Option<f64> {
        Some(self.regularity)
    }

    fn redundant(&self) -> usize {
        self.inverse_square.iter().take(self.count).filter(|&&inverse| inverse == 0.0).count()
    }

    fn weakest(&self) -> Option<(usize, f64)> {
        let smallest =
            (0..self.count).min_by(|&i, &j| self.length(i).total_cmp(&self.length(j)))?;
        Some((self.most_involved(smallest), self.regularity))
    }

    fn add_pulled_back(&self, scale: f64, lambda: &[f64], mut p: Covector<&mut [f64]>) {
        for (f, p) in p.components_mut().iter_mut().enumerate() {
            let mut sum = CarriedSum::from([*p]);
            for (row, lambda) in self.rows.iter().zip(lambda).take(self.count) {
                sum.add([scale * lambda * row.components()[f]]);
            }
            [*p] = sum.rounded();
        }
    }

    fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        for (row, rate) in self.rows.iter().zip(rates).take(self.count) {
            *rate += row.apply(&v);
        }
    }
}

impl<C: Storage, const M: usize> DenseMultipliers<C, M> {
    /// The smallest over the largest singular value of J M^-1/2 in reference scales, where it was
    /// prepared last; 1 without equations.
    pub fn regularity(&self) -> f64 {
        self.regularity
    }

    /// Turns pairs of rows until all are orthogonal; false where numbers are not finite.
    fn orthogonalize(&mut self) -> bool {
        let longest = (0..self.count).map(|row| self.length(row)).fold(0.0, f64::max);
        for _ in 0..SWEEPS {
            let mut turned = false;
            for i in 0..self.count {
                for j in i + 1..self.count {
                    turned |= self.turn(i, j, longest);
                }
            }
            if !turned {
                return true;
            }
        }
        false
    }

    /// Turns two rows to be orthogonal; false where they are.
    fn turn(&mut self, i: usize, j: usize, longest: f64) -> bool {
        let product = self.turned[i].apply(&self.raised[j]);
        let (p, q) = (self.length(i), self.length(j));
        // Rounding is all that is left of a row so short: it has no direction to turn, not even
        // against another such row.
        let rounding = p.min(q) <= ROUNDING * longest;
        if rounding || product.abs() <= 4.0 * f64::EPSILON * p * q {
            return false;
        }
        let cotangent = (q - p) * (q + p) / (2.0 * product);
        let tangent = cotangent.signum() / (cotangent.abs() + cotangent.hypot(1.0));
        let cosine = tangent.hypot(1.0).recip();
        let sine = cosine * tangent;
        let (head, tail) = self.turned.split_at_mut(j);
        rotate(head[i].components_mut(), tail[0].components_mut(), cosine, sine);
        let (head, tail) = self.raised.split_at_mut(j);
        rotate(head[i].components_mut(), tail[0].components_mut(), cosine, sine);
        let (head, tail) = self.rotation.split_at_mut(j);
        rotate(&mut head[i], &mut tail[0], cosine, sine);
        true
    }

    /// The length of a turned row; of what rounding leaves of a dependent one, zero.
    fn length(&self, row: usize) -> f64 {
        let square = self.turned[row].apply(&self.raised[row]);
        // Not `max`, which makes zero of what is not a number.
        if square < 0.0 { 0.0 } else { square.sqrt() }
    }

    /// The equation with the largest part in a turned row.
    fn most_involved(&self, turned: usize) -> usize {
        let part = |row: &usize| self.rotation[turned][*row].abs();
        (0..self.count).max_by(|a, b| part(a).total_cmp(&part(b))).unwrap_or(0)
    }

    /// Judges the singular values.
    fn examine(&mut self) -> Result<(), ConstraintError> {
        let mut sigma = [0.0; M];
        for (i, sigma) in sigma.iter_mut().enumerate().take(self.count) {
            *sigma = self.length(i);
        }
        let sigma = &sigma[..self.count];
        if let Some(index) = first_non_finite(sigma) {
            return Err(ConstraintError::NonFinite { what: "size of an equation", index });
        }
        let largest = sigma.iter().fold(self.normal, |a, &b| a.max(b));
        let smallest = (0..self.count).min_by(|&i, &j| sigma[i].total_cmp(&sigma[j]));
        self.regularity = smallest.map_or(1.0, |i| sigma[i] / largest);
        if let Some(i) = smallest
            && self.regularity < DEPENDENT
            && self.redundancy == Redundancy::Refuse
        {
            let row = self.most_involved(i);
            return Err(ConstraintError::Singular { ratio: self.regularity, row });
        }
        for (inverse, sigma) in self.inverse_square.iter_mut().zip(sigma) {
            let kept = *sigma >= DEPENDENT * largest;
            *inverse = if kept { sigma.powi(2).recip() } else { 0.0 };
        }
        Ok(())
    }
}

fn rotate(a: &mut [f64], b: &mut [f64], cosine: f64, sine: f64) {
    for (x, y) in a.iter_mut().zip(b) {
        (*x, *y) = (cosine * *x - sine * *y, sine * *x + cosine * *y);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rod, Rods};
    use nalgebra::{Matrix3, SMatrix, Vector3};
    use proptest::prelude::*;
    use stationary_calculus::DiagonalMetric;

    const MASS: [f64; 4] = [1.0, 1.0, 30.0, 30.0];

    /// Three rods on two points.
    fn rods() -> Rods<2> {
        let hooks = vec![[0.0, 0.0], [3.0, 1.0]];
        let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 0.3), Rod::new([1, 3], 3.0)];
        Rods::new(2, hooks, rods).unwrap()
    }

    /// J as a matrix.
    fn matrix(rods: &Rods<2>, q: &[f64; 4]) -> SMatrix<f64, 3, 4> {
        struct Full(SMatrix<f64, 3, 4>);
        impl Rows for Full {
            fn add(&mut self, row: usize, freedom: usize, value: f64) {
                self.0[(row, freedom)] += value;
            }
        }
        let mut full = Full(SMatrix::zeros());
        rods.differential(0.0, q, &mut full).unwrap();
        full.0
    }

    proptest! {
        #[test]
        fn the_solution_solves_the_system(
            q in prop::array::uniform4(-2.0..2.0),
            b in prop::array::uniform3(-1.0..1.0),
        ) {
            let (rods, metric) = (rods(), DiagonalMetric::new(MASS).unwrap());
            let j = matrix(&rods, &q);
            let weighted = SMatrix::<f64, 3, 4>::from_fn(|i, f| j[(i, f)] / MASS[f]);
            let s: Matrix3<f64> = weighted * j.transpose();
            let choice = Dense::<3>(Redundancy::Refuse);
            let mut dense: DenseMultipliers<[f64; 4], 3> =
                choice.analyse(&metric, &rods, 0.0, &q).unwrap();
            prop_assume!(dense.prepare(&metric, &rods, 0.0, &q).is_ok());
            prop_assume!(dense.regularity() > 1e-2);
            let mut x = b;
            dense.solve(&mut x).unwrap();
            let residual = s * Vector3::from(x) - Vector3::from(b);
            prop_assert!(residual.amax() < 1e-9, "{}", residual);
        }
    }

    #[test]
    fn a_dependence_of_one_part_in_a_hundred_million_is_told_from_a_greater_one() {
        // Two lines that meet at an angle: the ratio is about half of it.
        let metric = DiagonalMetric::new([1.0; 2]).unwrap();
        for (angle, regular) in [(1e-7, true), (1e-9, false)] {
            let lines = crate::Linear::new(vec![
                (vec![(0, 1.0), (1, 0.0)], 0.0),
                (vec![(0, 1.0), (1, angle)], 0.0),
            ])
            .unwrap();
            let choice = Dense::<2>(Redundancy::Refuse);
            let mut dense: DenseMultipliers<[f64; 2], 2> =
                choice.analyse(&metric, &lines, 0.0, &[0.0; 2]).unwrap();
            let prepared = dense.prepare(&metric, &lines, 0.0, &[0.0; 2]);
            assert_eq!(prepared.is_ok(), regular, "{prepared:?}");
            assert!((dense.regularity() / (0.5 * angle) - 1.0).abs() < 1e-6);
        }
    }
}
