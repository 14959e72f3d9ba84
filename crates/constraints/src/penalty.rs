//! The penalty: a stiff spring in place of each equation.
//!
//! ```text
//! V = k/2 sum_i (g_i / slope_i)^2                       k in N/m                            (6.2)
//! dV = k sum_i (g_i / slope_i^2) dg_i
//! d2V = k sum_i (dg_i dg_i^T + g_i d2g_i) / slope_i^2
//! h omega < 2,    omega^2 = k sigma^2                   the stable step of Stormer-Verlet
//! ```
//! `g / slope` a length, so that k is a stiffness: to first order the rod is a spring of stiffness
//! k. `sigma` the largest singular value of D^-1 J M^-1/2. The constraint is violated by about F/k
//! under a force F, and the stable step shrinks with the root of k: no k is right for both. The
//! potential has no time: a driven constraint is frozen at the time given. Source: notes 6.2. Works
//! in memory of its own behind a lock, taken once.

use std::sync::{Mutex, MutexGuard, PoisonError};

use stationary_calculus::{Covector, Metric, Potential, Sink, SizeError, Vector};
use stationary_integrators::{Facts, Stability};

use crate::feasible::checked;
use crate::rows::add_pulled_back;
use crate::{Constraint, ConstraintError, Rows};

/// The penalty potential of a constraint.
#[derive(Debug)]
pub struct Penalty<K> {
    constraint: K,
    stiffness: f64,
    time: f64,
    inverse_square_slope: Vec<f64>,
    memory: Mutex<Memory>,
}

#[derive(Debug, Default)]
struct Memory {
    weights: Vec<f64>,
    freedoms: Vec<usize>,
    values: Vec<f64>,
    block: Vec<f64>,
}

impl<K: Constraint> Penalty<K> {
    /// Springs of stiffness `stiffness`, N/m, for a constraint at a time.
    ///
    /// # Errors
    /// A stiffness or a scale that is not positive and finite, a time that is not finite.
    pub fn new(constraint: K, stiffness: f64, time: f64) -> Result<Self, ConstraintError> {
        if !(stiffness > 0.0 && stiffness.is_finite()) {
            let (what, range) = ("stiffness", "positive and finite");
            return Err(ConstraintError::Parameter { what, value: stiffness, range });
        }
        if !time.is_finite() {
            let (what, range) = ("time", "finite");
            return Err(ConstraintError::Parameter { what, value: time, range });
        }
        checked(&constraint)?;
        let inverse_square_slope =
            (0..constraint.count()).map(|row| constraint.scale(row).slope.powi(-2)).collect();
        let memory = Memory { weights: vec![0.0; constraint.count()], ..Memory::default() };
        let memory = Mutex::new(memory);
        Ok(Penalty { constraint, stiffness, time, inverse_square_slope, memory })
    }

    /// The constraint.
    pub fn constraint(&self) -> &K {
        &self.constraint
    }

    fn memory(&self) -> MutexGuard<'_, Memory> {
        self.memory.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Replaces the weights by `k g / slope^2`.
    fn weigh(&self, q: &[f64], weights: &mut [f64]) -> Result<(), SizeError> {
        self.constraint.value(self.time, q, weights)?;
        for (weight, slope) in weights.iter_mut().zip(&self.inverse_square_slope) {
            *weight *= self.stiffness * slope;
        }
        Ok(())
    }

    fn try_add_hessian(&self, q: &[f64], hessian: &mut impl Sink) -> Result<(), SizeError> {
        let memory = &mut *self.memory();
        self.weigh(q, &mut memory.weights)?;
        self.constraint.add_hessian(self.time, q, &memory.weights, hessian)?;
        memory.freedoms.clear();
        memory.values.clear();
        let mut squares = Squares { penalty: self, memory, row: 0, hessian };
        self.constraint.differential(self.time, q, &mut squares)?;
        squares.finish_row();
        Ok(())
    }

    /// The highest angular frequency that the springs alone have at a feasible configuration,
    /// radians a second: predicted from the stiffness, by power iteration. Takes memory.
    ///
    /// # Errors
    /// A metric or a configuration that has fewer freedoms than the constraint.
    pub fn highest_frequency(&self, metric: &impl Metric, q: &[f64]) -> Result<f64, SizeError> {
        let (n, needed) = (metric.dim(), self.constraint.dim());
        SizeError::check("the metric's freedoms", needed, n.min(needed))?;
        let (mut v, mut p) = (Vector(vec![0.0; n]), Covector(vec![0.0; n]));
        // Springs that are stretched, by lengths no two of which are in a ratio that a linkage is likely to have.
        let first = |(row, square): (usize, &f64)| (1.0 + row as f64).sin() * square.sqrt();
        let mut rates: Vec<f64> = self.inverse_square_slope.iter().enumerate().map(first).collect();
        let mut square = 0.0;
        for _ in 0..=POWERS {
            p.clear();
            add_pulled_back(&self.constraint, self.time, q, self.stiffness, &rates, p.view_mut())?;
            metric.sharp(p.view(), v.view_mut());
            square = p.apply(&v).sqrt();
            if square == 0.0 {
                return Ok(0.0);
            }
            let mut flat = Covector(vec![0.0; n]);
            metric.flat(v.view(), flat.view_mut());
            let length = flat.apply(&v).sqrt();
            v.0.iter_mut().for_each(|x| *x /= length);
            rates.fill(0.0);
            self.constraint.differential(
                self.time,
                q,
                &mut Along { v: &v.0, rates: &mut rates },
            )?;
            let slopes = rates.iter_mut().zip(&self.inverse_square_slope);
            slopes.for_each(|(rate, slope)| *rate *= slope);
        }
        Ok(square.sqrt())
    }

    /// The step below which a method is stable on these springs, seconds: infinite where it always
    /// is, zero where it never is.
    ///
    /// # Errors
    /// Those of [`Penalty::highest_frequency`].
    pub fn stable_step(
        &self,
        facts: Facts,
        metric: &impl Metric,
        q: &[f64],
    ) -> Result<f64, SizeError> {
        Ok(match facts.stability {
            Stability::Below(limit) => limit / self.highest_frequency(metric, q)?,
            Stability::Always => f64::INFINITY,
            Stability::Never => 0.0,
        })
    }
}

/// Power iterations: the largest of well separated frequencies to a few digits, and of close ones
/// to what their closeness allows.
const POWERS: u32 = 200;

/// Adds J v to m numbers.
struct Along<'a> {
    v: &'a [f64],
    rates: &'a mut [f64],
}

impl Rows for Along<'_> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.rates[row] += value * self.v[freedom];
    }
}

/// A system checks sizes once, when it is made; of a configuration that is too short nothing is finite.
impl<K: Constraint> Potential for Penalty<K> {
    fn dim(&self) -> usize {
        self.constraint.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let weights = &mut self.memory().weights;
        if self.constraint.value(self.time, q, weights).is_err() {
            return f64::NAN;
        }
        let squares = weights.iter().zip(&self.inverse_square_slope).map(|(g, s)| g * g * s);
        0.5 * self.stiffness * squares.sum::<f64>()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        let weights = &mut self.memory().weights;
        let weighed = self.weigh(q, weights);
        let (constraint, t) = (&self.constraint, self.time);
        let pulled =
            weighed.and_then(|()| add_pulled_back(constraint, t, q, 1.0, weights, dv.view_mut()));
        if pulled.is_err() {
            dv.0.fill(f64::NAN);
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        if self.try_add_hessian(q, hessian).is_err() {
            hessian.add_symmetric(&[0], &[f64::NAN]);
        }
    }
}

/// Collects a row, and adds `k dg dg^T / slope^2` when it is complete.
struct Squares<'a, K, H> {
    penalty: &'a Penalty<K>,
    memory: &'a mut Memory,
    row: usize,
    hessian: &'a mut H,
}

impl<K, H: Sink> Squares<'_, K, H> {
    fn finish_row(&mut self) {
        let Memory { freedoms, values, block, .. } = &mut *self.memory;
        if !freedoms.is_empty() {
            let scale = self.penalty.stiffness * self.penalty.inverse_square_slope[self.row];
            block.clear();
            let products = values.iter().flat_map(|b| values.iter().map(move |a| scale * (a * b)));
            block.extend(products);
            self.hessian.add_symmetric(freedoms, block);
        }
        freedoms.clear();
        values.clear();
    }
}

impl<K, H: Sink> Rows for Squares<'_, K, H> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        if row != self.row {
            self.finish_row();
            self.row = row;
        }
        self.memory.freedoms.push(freedom);
        self.memory.values.push(value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Rod, Rods};
    use stationary_calculus::{DiagonalMetric, assert_derivatives};

    fn rods() -> Rods<2> {
        let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0)];
        Rods::new(2, vec![[0.0, 0.0]], rods).unwrap()
    }

    #[test]
    fn the_derivatives_are_right() {
        let penalty = Penalty::new(rods(), 50.0, 0.0).unwrap();
        assert_derivatives(&penalty, &[0.7, -0.9, 1.4, 0.8]);
    }

    #[test]
    fn the_frequency_is_the_root_of_stiffness_over_mass() {
        let metric = DiagonalMetric::new([5.0, 5.0]).unwrap();
        for length in [0.1, 0.5, 3.0] {
            let rod = Rods::new(1, vec![[0.0, 0.0]], vec![Rod::new([1, 0], length)]).unwrap();
            let penalty = Penalty::new(rod, 80.0, 0.0).unwrap();
            let highest = penalty.highest_frequency(&metric, &[0.6 * length, 0.8 * length]);
            assert!((highest.unwrap() - 4.0).abs() < 1e-12, "{length}");
        }
    }

    #[test]
    fn the_frequency_of_a_rod_does_not_depend_on_which_points_it_joins() {
        let metric = DiagonalMetric::new(vec![1.0; 48]).unwrap();
        for other in 1..16 {
            let mut q = vec![0.0; 48];
            q[3 * other] = 1.0;
            let rods = Rods::<3>::new(16, vec![], vec![Rod::new([0, other], 1.0)]).unwrap();
            let penalty = Penalty::new(rods, 2.0, 0.0).unwrap();
            let highest = penalty.highest_frequency(&metric, &q).unwrap();
            assert!((highest - 2.0).abs() < 1e-12, "{other}: {highest}");
        }
    }

    #[test]
    fn a_stiffness_that_is_not_positive_is_refused() {
        for stiffness in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let error = Penalty::new(rods(), stiffness, 0.0).unwrap_err();
            assert!(matches!(error, ConstraintError::Parameter { what: "stiffness", .. }));
        }
    }
}
