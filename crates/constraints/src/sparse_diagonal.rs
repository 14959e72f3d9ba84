//! Multipliers of any number of equations under masses that do not couple freedoms.
//!
//! ```text
//! S = J M^-1 J^T = sum over freedoms f of  J_f J_f^T / m_f        m x m, sparse, semidefinite
//! ```
//! `J_f` the column of a freedom, `m_f` its mass. Two equations meet in S where they share a
//! freedom: for a chain S has three diagonals, and elimination in the order that is found once
//! leaves it so, hence the work grows with the number of links.
//!
//! The factor reveals the rank: an equation is dependent where its row of J M^-1/2 is within 1e-8 of a
//! normal row of those eliminated before it, a normal row being `slope / sqrt(m)` with the largest mass
//! that the equation touches. Its multiplier is then zero, and the others solve the equations that are
//! left, for the consistent right-hand side that is nearest to the one given. Where force is
//! to be shared ([`Redundancy::LeastNorm`]) a multiple of each dependence is added afterwards
//! (`sparse_diagonal/shortest_forces.rs`).

mod shortest_forces;

use stationary_calculus::{Covector, Metric, SizeError, Vector};

use crate::elimination::Elimination;
use crate::entries::{Entries, RowEntries, WeightedRows};
use crate::multipliers::{DEPENDENT, Diagonal, check_solve};
use crate::products::Products;
use crate::rank_revealing::{Dependent, RankRevealing, Unclear};
use crate::rows::check_entries;
use crate::{Constraint, ConstraintError, Multipliers, Redundancy, Solver};

/// The choice of [`DiagonalMultipliers`]: any number of equations, a diagonal metric.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SparseDiagonal(pub Redundancy);

/// Multipliers of any number of equations, by a sparse factor that reveals the rank.
#[derive(Clone, Debug)]
pub struct DiagonalMultipliers {
    count: usize,
    prepared: bool,
    redundancy: Redundancy,
    entries: Entries,
    rows: RowEntries,
    products: Products,
    inverse_mass: Vec<f64>,
    slopes: Vec<f64>,
    /// The distance from other rows at which each row counts as dependent.
    thresholds: Vec<f64>,
    factor: RankRevealing,
    /// Numbers for each freedom and for each equation.
    velocity: Vec<f64>,
    right: Vec<f64>,
    gradient: Vec<f64>,
    given: Vec<f64>,
    found: Vec<f64>,
    direction: Vec<f64>,
    image: Vec<f64>,
    left: Vec<f64>,
    rest: Vec<f64>,
}

impl<C> Solver<C> for SparseDiagonal {
    type Multipliers = DiagonalMultipliers;

    fn analyse<M: Metric, K: Constraint>(
        &self,
        metric: &M,
        constraint: &K,
        t: f64,
        q: &[f64],
    ) -> Result<DiagonalMultipliers, ConstraintError> {
        check_entries(constraint, metric.dim(), t, q)?;
        let count = constraint.count();
        let Diagonal { mass, coupled } = Diagonal::of(metric);
        if let Some(freedom) = coupled {
            return Err(ConstraintError::Coupled { freedom });
        }
        let entries = Entries::find(constraint, t, q)?;
        let elements = entries.blocks().map(|block| block.equations.to_vec());
        let elements: Vec<Vec<u32>> = elements.collect();
        let elimination = Elimination::of(count, &elements);
        let zeros = vec![0.0; count];
        let mut multipliers = DiagonalMultipliers {
            count,
            prepared: false,
            redundancy: self.0,
            rows: RowEntries::of(&entries, count),
            products: Products::of(&entries, &elimination),
            thresholds: zeros.clone(),
            inverse_mass: vec![0.0; mass.len()],
            slopes: zeros.clone(),
            factor: RankRevealing::new(elimination, mass.len()),
            velocity: vec![0.0; mass.len()],
            right: zeros.clone(),
            gradient: zeros.clone(),
            given: zeros.clone(),
            found: zeros.clone(),
            direction: zeros.clone(),
            image: zeros.clone(),
            left: zeros.clone(),
            rest: zeros,
            entries,
        };
        multipliers.weigh(&mass, constraint);
        Ok(multipliers)
    }
}

/// Corrections of a solution where rows are close to dependent, and what may be left of its residual,
/// relative to the largest number of the right-hand side, equation by equation in reference scales.
const CORRECTIONS: u32 = 4;
const RESIDUAL: f64 = 1e-3;
/// Equations that depend on others contradict these where a part of more than this of the right-hand side is left
/// by a solution without them.
const CONSISTENT: f64 = 1e-12;

impl DiagonalMultipliers {
    /// How many numbers the factor of S has.
    pub fn factor_len(&self) -> usize {
        self.factor.len()
    }

    /// How many equations depend on the others, where it was prepared last.
    pub fn dependent(&self) -> usize {
        self.factor.dependent.len()
    }

    /// Takes other masses and another constraint whose entries are in the same places, and prepares for a
    /// configuration: what [`Solver::analyse`] finds about places is kept.
    ///
    /// # Errors
    /// [`ConstraintError::PatternChanged`] where entries are in other places; other sizes; those of
    /// [`Multipliers::prepare`].
    pub fn renew(
        &mut self,
        masses: &[f64],
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.prepared = false;
        SizeError::check("the masses", self.inverse_mass.len(), masses.len())?;
        SizeError::check("the constraint's equations", self.count, constraint.count())?;
        self.weigh(masses, constraint);
        self.factor_at(constraint, t, q)
    }

    /// Takes the masses of a metric, where they are not those that it has.
    fn weigh_by(
        &mut self,
        metric: &impl Metric,
        constraint: &impl Constraint,
    ) -> Result<(), ConstraintError> {
        SizeError::check("the metric's freedoms", self.inverse_mass.len(), metric.dim())?;
        let own = Diagonal::refilled(std::mem::take(&mut self.velocity), metric);
        let inverse = own.mass.iter().map(|mass| mass.recip());
        if own.coupled.is_none() && !inverse.eq(self.inverse_mass.iter().copied()) {
            self.weigh(&own.mass, constraint);
        }
        self.velocity = own.mass;
        own.coupled.map_or(Ok(()), |freedom| Err(ConstraintError::Coupled { freedom }))
    }

    /// Takes masses, and how large the entries of each row normally are.
    fn weigh(&mut self, masses: &[f64], constraint: &impl Constraint) {
        let DiagonalMultipliers { entries, inverse_mass, slopes, thresholds, .. } = self;
        inverse_mass.iter_mut().zip(masses).for_each(|(inverse, mass)| *inverse = mass.recip());
        // The largest mass that a row touches, and then what is made of it.
        thresholds.fill(0.0);
        for &(row, freedom) in &entries.pattern.places {
            let largest = &mut thresholds[row as usize];
            *largest = largest.max(masses[freedom as usize]);
        }
        for (row, (slope, threshold)) in slopes.iter_mut().zip(thresholds).enumerate() {
            *slope = constraint.scale(row).slope;
            let normal = if *threshold > 0.0 { threshold.recip().sqrt() } else { 0.0 };
            *threshold = DEPENDENT * *slope * normal;
        }
    }

    fn factor_at(
        &mut self,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.entries.write(constraint, t, q)?;
        let DiagonalMultipliers { entries, rows, products, inverse_mass, factor, .. } = self;
        products.write(entries, inverse_mass, &mut factor.values);
        if let Some(index) = factor.non_finite_row() {
            return Err(ConstraintError::NonFinite { what: "size of an equation", index });
        }
        let rows = WeightedRows { entries, rows, inverse_mass };
        factor.factor(&rows, &self.thresholds).map_err(|unclear| {
            let Unclear { equation: row, distance, error } = unclear;
            let size = self.thresholds[row] / DEPENDENT;
            ConstraintError::RankUnclear { row, distance: distance / size, error: error / size }
        })?;
        if self.redundancy == Redundancy::Refuse
            && let Some(&Dependent { equation, distance }) = factor.dependent.first()
        {
            let row = equation as usize;
            let ratio = distance / (self.thresholds[row] / DEPENDENT);
            return Err(ConstraintError::Singular { ratio, row });
        }
        self.prepared = true;
        Ok(())
    }

    /// Writes `S x` for all equations.
    fn product(&mut self, x: &[f64], image: &mut [f64]) {
        self.velocity.fill(0.0);
        self.entries.add_pulled_back(1.0, x, Covector(&mut self.velocity));
        self.velocity.iter_mut().zip(&self.inverse_mass).for_each(|(v, w)| *v *= w);
        image.fill(0.0);
        self.entries.add_along(Vector(&self.velocity), image);
    }

    /// Solves the equations that are independent; the others' multipliers are zero.
    fn solve_independent(&mut self, b: &mut [f64]) -> Result<(), ConstraintError> {
        if self.factor.close == 0 {
            self.factor.solve(b);
            return Ok(());
        }
        self.right.copy_from_slice(b);
        self.factor.solve(b);
        self.refine(b)
    }

    /// Solves for the nearest right-hand side that does not contradict itself. What contradicts itself is spread
    /// over all equations, not left to the dependent ones: of the residual, so that it is small where that is.
    fn solve_consistent(&mut self, b: &mut [f64], rest: &mut [f64]) -> Result<(), ConstraintError> {
        rest.copy_from_slice(b);
        let whole = self.in_thresholds(b);
        self.solve_independent(b)?;
        let mut image = std::mem::take(&mut self.image);
        self.product(b, &mut image);
        rest.iter_mut().zip(&image).for_each(|(rest, image)| *rest -= image);
        self.image = image;
        if self.in_thresholds(rest) <= CONSISTENT * whole {
            return Ok(());
        }
        rest.iter_mut().zip(&self.slopes).for_each(|(rest, slope)| *rest /= slope);
        self.shorten(rest)?;
        rest.iter_mut().zip(&self.slopes).for_each(|(rest, slope)| *rest *= slope);
        self.solve_independent(rest)?;
        b.iter_mut().zip(&*rest).for_each(|(x, rest)| *x += rest);
        Ok(())
    }

    /// The largest of these values in units of its equation's threshold; no number where one is none.
    fn in_thresholds(&self, values: &[f64]) -> f64 {
        let ratio = |(r, t): (&f64, &f64)| if *t > 0.0 { (r / t).abs() } else { 0.0 };
        let ratios = values.iter().zip(&self.thresholds).map(ratio);
        ratios.fold(0.0, |most, r| if r > most || r.is_nan() { r } else { most })
    }

    /// Where an equation is close to depending on others, corrects a solution by its residual.
    #[cold]
    fn refine(&mut self, x: &mut [f64]) -> Result<(), ConstraintError> {
        let (right, mut change) =
            (std::mem::take(&mut self.right), std::mem::take(&mut self.direction));
        let mut residual = std::mem::take(&mut self.gradient);
        let whole = self.in_thresholds(&right);
        let (mut before, mut left) = (f64::INFINITY, f64::INFINITY);
        for _ in 0..=CORRECTIONS {
            self.product(x, &mut residual);
            residual.iter_mut().zip(&right).for_each(|(r, b)| *r = b - *r);
            for dependent in &self.factor.dependent {
                residual[dependent.equation as usize] = 0.0;
            }
            left = self.in_thresholds(&residual);
            if left.is_nan() || left == 0.0 || left > 0.5 * before {
                break;
            }
            before = left;
            change.copy_from_slice(&residual);
            self.factor.solve(&mut change);
            x.iter_mut().zip(&change).for_each(|(x, change)| *x += change);
        }
        (self.right, self.direction, self.gradient) = (right, change, residual);
        if left.min(before) <= RESIDUAL * whole {
            return Ok(());
        }
        Err(ConstraintError::Dependent { row: None })
    }
}

impl Multipliers for DiagonalMultipliers {
    type Numbers = Vec<f64>;

    fn numbers(&self) -> Vec<f64> {
        vec![0.0; self.count]
    }

    fn prepare(
        &mut self,
        metric: &impl Metric,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError> {
        self.prepared = false;
        self.weigh_by(metric, constraint)?;
        self.factor_at(constraint, t, q)
    }

    fn regularity(&self) -> Option<f64> {
        Some((DEPENDENT * self.factor.weakest.1.sqrt()).min(1.0))
    }

    fn redundant(&self) -> usize {
        self.dependent()
    }

    fn weakest(&self) -> Option<(usize, f64)> {
        match self.factor.dependent.first() {
            Some(dependent) => Some((dependent.equation as usize, 0.0)),
            None => Some((self.factor.weakest.0 as usize, self.regularity()?)),
        }
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), ConstraintError> {
        check_solve(self.prepared, self.count, b)?;
        if self.factor.dependent.is_empty() {
            return self.solve_independent(b);
        }
        let mut rest = std::mem::take(&mut self.rest);
        let solved = self.solve_consistent(b, &mut rest);
        self.rest = rest;
        solved
    }

    fn share(&mut self, lambda: &mut [f64]) -> Result<(), ConstraintError> {
        check_solve(self.prepared, self.count, lambda)?;
        if self.factor.dependent.is_empty() {
            return Ok(());
        }
        lambda.iter_mut().zip(&self.slopes).for_each(|(lambda, slope)| *lambda *= slope);
        // Rounding is that of the longer multipliers that an iteration starts from.
        let shortened = self.shorten(lambda).and_then(|()| self.shorten(lambda));
        lambda.iter_mut().zip(&self.slopes).for_each(|(lambda, slope)| *lambda /= slope);
        shortened
    }

    fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>) {
        self.entries.add_pulled_back(scale, lambda, p);
    }

    fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]) {
        self.entries.add_along(v, rates);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Linear;
    use nalgebra::{DMatrix, DVector};
    use stationary_calculus::DiagonalMetric;
    use stationary_measure::SplitMix64;

    type Prepared = Result<DiagonalMultipliers, ConstraintError>;

    /// The equations `A q = 0`.
    fn lines(a: &DMatrix<f64>) -> Result<Linear, ConstraintError> {
        let rows = a.row_iter().map(|row| {
            let entries = row.iter().copied().enumerate().filter(|entry| entry.1 != 0.0);
            (entries.collect(), 0.0)
        });
        Linear::new(rows.collect())
    }

    /// Their solver under these masses, prepared.
    fn prepared(a: &DMatrix<f64>, mass: &[f64], redundancy: Redundancy) -> Prepared {
        let lines = lines(a)?;
        let metric = DiagonalMetric::new(mass.to_vec()).unwrap();
        let (choice, q) = (SparseDiagonal(redundancy), vec![0.0; mass.len()]);
        let mut solver = Solver::<Vec<f64>>::analyse(&choice, &metric, &lines, 0.0, &q)?;
        solver.prepare(&metric, &lines, 0.0, &q)?;
        Ok(solver)
    }

    #[test]
    fn what_is_independent_by_a_part_in_ten_million_is_told_from_what_is_not() {
        for (angle, told) in [(1e-3, true), (1e-5, true), (1e-7, true), (1e-9, false), (0.0, false)]
        {
            let lines = DMatrix::from_row_slice(2, 2, &[1.0, 0.0, 1.0, angle]);
            let strict = prepared(&lines, &[1.0; 2], Redundancy::Refuse);
            assert_eq!(strict.is_ok(), told, "{angle}: {:?}", strict.err());
            let mut shared = prepared(&lines, &[1.0; 2], Redundancy::LeastNorm).unwrap();
            assert_eq!(shared.dependent(), usize::from(!told));
            // A velocity along the second coordinate alone.
            let mut lambda = [0.0, angle];
            shared.solve(&mut lambda).unwrap();
            shared.share(&mut lambda).unwrap();
            let expected = if told { angle.recip() } else { 0.0 };
            assert!((lambda[1] - expected).abs() <= 1e-6 * expected + angle, "{angle}: {lambda:?}");
        }
    }

    #[test]
    fn where_rounding_hides_the_rank_it_says_so() {
        // e_0, e_i + angle e_i+1, and the last direction alone: it depends on the others with
        // coefficients of one over the angle for each row that is turned.
        let angle = 1e-4;
        for (turned, told) in [(1, true), (3, false)] {
            let mut a = DMatrix::zeros(turned + 2, turned + 1);
            (a[(0, 0)], a[(turned + 1, turned)]) = (1.0, 1.0);
            for row in 1..=turned {
                (a[(row, row - 1)], a[(row, row)]) = (1.0, angle);
            }
            let mass = vec![1.0; turned + 1];
            match prepared(&a, &mass, Redundancy::LeastNorm) {
                Ok(solver) => assert!(told && solver.dependent() == 1, "{turned}"),
                Err(ConstraintError::RankUnclear { .. }) => assert!(!told, "{turned}"),
                Err(other) => panic!("{other}"),
            }
        }
    }

    /// Between 0 and 1.
    fn unit(noise: &mut SplitMix64) -> f64 {
        0.5 + 0.5 * noise.symmetric()
    }

    /// Sparse rows of any size, of which a third are sums of others, and masses within a ratio.
    fn random(noise: &mut SplitMix64, ratio: f64) -> (DMatrix<f64>, Vec<f64>) {
        let below =
            |noise: &mut SplitMix64, n: usize| ((unit(noise) * n as f64) as usize).min(n - 1);
        let (m, n) = (2 + below(noise, 30), 3 + below(noise, 40));
        let mut a = DMatrix::<f64>::zeros(m, n);
        for row in 0..m {
            if row > 2 && unit(noise) < 0.3 {
                for _ in 0..2 {
                    let (other, factor) = (below(noise, row), unit(noise) - 0.5);
                    let sum = a.row(row) + factor * a.row(other);
                    a.row_mut(row).copy_from(&sum);
                }
            }
            if a.row(row).norm() == 0.0 {
                for _ in 0..4 {
                    a[(row, below(noise, n))] = unit(noise) - 0.5;
                }
            }
            let size = a.row(row).norm();
            a.row_mut(row).scale_mut(10_f64.powf(4.0 * unit(noise) - 2.0) / size);
        }
        let mass = (0..n).map(|_| ratio.powf(unit(noise))).collect();
        (a, mass)
    }

    #[test]
    fn shared_multipliers_are_those_of_a_singular_value_decomposition() {
        let mut noise = SplitMix64::new(11);
        let (mut judged, mut redundant) = (0, 0);
        for case in 0..300 {
            let (a, mass) = random(&mut noise, [1.0, 100.0][case % 2]);
            // Rows of length 1 before masses.
            let slopes: Vec<f64> = a.row_iter().map(|row| row.norm()).collect();
            let scaled = DMatrix::from_fn(a.nrows(), a.ncols(), |i, f| {
                a[(i, f)] / slopes[i] / mass[f].sqrt()
            });
            let svd = scaled.clone().svd(true, false);
            let sigma = &svd.singular_values;
            let largest = sigma.max();
            let rank = sigma.iter().filter(|s| **s > 1e-11 * largest).count();
            // Those whose smallest singular values leave the rank open are not cases of this test.
            if sigma.iter().any(|s| *s > 1e-12 * largest && *s < 1e-3 * largest) {
                continue;
            }
            judged += 1;
            let mut solver = prepared(&a, &mass, Redundancy::LeastNorm).unwrap();
            assert_eq!(a.nrows() - solver.dependent(), rank, "case {case}");
            redundant += usize::from(rank < a.nrows());
            let push = DVector::from_fn(a.ncols(), |_, _| noise.symmetric());
            let b = &scaled * push;
            let u = svd.u.as_ref().unwrap();
            let mut along = u.transpose() * &b;
            for (along, sigma) in along.iter_mut().zip(sigma) {
                *along = if *sigma > 1e-11 * largest { *along / sigma.powi(2) } else { 0.0 };
            }
            let exact = u * along;
            let mut lambda: Vec<f64> = b.iter().zip(&slopes).map(|(b, slope)| b * slope).collect();
            solver.solve(&mut lambda).unwrap();
            solver.share(&mut lambda).unwrap();
            let off = (0..a.nrows())
                .map(|i| (lambda[i] * slopes[i] - exact[i]).abs())
                .fold(0.0, f64::max);
            assert!(off <= 1e-8 * exact.amax(), "case {case}: {off:e} of {:e}", exact.amax());
        }
        assert!(judged > 150 && redundant > 50, "{judged} {redundant}");
    }

    #[test]
    fn what_is_renewed_solves_to_the_bit_as_what_is_analysed_anew() {
        let mut noise = SplitMix64::new(17);
        for case in 0..50 {
            let (first, mass) = random(&mut noise, 100.0);
            let (mut other, other_mass) = (first.clone(), random(&mut noise, 100.0).1);
            other.apply(|entry| *entry *= 1.0 + 0.3 * noise.symmetric());
            let masses: Vec<f64> =
                mass.iter().zip(other_mass.iter().cycle()).map(|m| *m.1).collect();
            let mut known = prepared(&first, &mass, Redundancy::LeastNorm).unwrap();
            let mut fresh = prepared(&other, &masses, Redundancy::LeastNorm).unwrap();
            let q = vec![0.0; mass.len()];
            known.renew(&masses, &lines(&other).unwrap(), 0.0, &q).unwrap();
            let mut x: Vec<f64> = (0..other.nrows()).map(|_| noise.symmetric()).collect();
            let mut expected = x.clone();
            known.solve(&mut x).unwrap();
            fresh.solve(&mut expected).unwrap();
            assert_eq!(x, expected, "{case}");
            // Entries in other places, and another number of masses or equations.
            let zero = other.iter().position(|entry| *entry == 0.0).unwrap();
            other[zero] = 1.0;
            let moved = known.renew(&masses, &lines(&other).unwrap(), 0.0, &q);
            assert!(matches!(moved, Err(ConstraintError::PatternChanged { .. })), "{case}");
            let fewer = lines(&other.rows(1, other.nrows() - 1).into_owned()).unwrap();
            assert!(known.renew(&masses, &fewer, 0.0, &q).is_err());
            assert!(known.renew(&masses[1..], &fewer, 0.0, &q).is_err());
            assert_eq!(known.solve(&mut x), Err(ConstraintError::NotPrepared));
        }
    }

    #[test]
    fn what_contradicts_itself_is_spread_and_what_is_no_number_is_refused() {
        // One freedom twice: asked for 1 and for 3, it does 2.
        let twice = DMatrix::from_row_slice(2, 1, &[1.0, 1.0]);
        let mut solver = prepared(&twice, &[1.0], Redundancy::LeastNorm).unwrap();
        let mut lambda = [1.0, 3.0];
        solver.solve(&mut lambda).unwrap();
        assert!((lambda[0] + lambda[1] - 2.0).abs() < 1e-15, "{lambda:?}");
        // Agreed but for a part in 1e9, which is halved.
        let mut lambda = [1.0, 1.0 + 1e-9];
        solver.solve(&mut lambda).unwrap();
        assert!((lambda[0] + lambda[1] - 1.0 - 5e-10).abs() < 1e-15, "{lambda:?}");
        assert!(solver.solve(&mut [1.0, f64::NAN]).is_err());
    }

    #[test]
    fn light_bodies_between_heavy_ones_are_not_taken_for_dependent() {
        // Rods in a line, whose joints weigh a part in 1e12.
        let links = 9;
        let a = DMatrix::from_fn(links, links + 1, |i, f| match f as isize - i as isize {
            0 => -1.0,
            1 => 1.0,
            _ => 0.0,
        });
        let mass: Vec<f64> = (0..=links).map(|f| if f % 2 == 0 { 1.0 } else { 1e-12 }).collect();
        let mut solver = prepared(&a, &mass, Redundancy::Refuse).unwrap();
        assert_eq!(solver.dependent(), 0);
        // Momenta that rods have given: lambda is found again by the force that it makes.
        let force = |lambda: &[f64]| -> Vec<f64> {
            (0..=links).map(|f| (0..links).map(|i| a[(i, f)] * lambda[i]).sum()).collect()
        };
        let given: Vec<f64> = (0..links).map(|i| (1.0 + i as f64).sin()).collect();
        let v: Vec<f64> = force(&given).iter().zip(&mass).map(|(p, m)| p / m).collect();
        let mut lambda: Vec<f64> =
            (0..links).map(|i| (0..=links).map(|f| a[(i, f)] * v[f]).sum()).collect();
        solver.solve(&mut lambda).unwrap();
        for (found, given) in lambda.iter().zip(&given) {
            assert!((found - given).abs() < 1e-3, "{lambda:?}");
        }
    }
}
