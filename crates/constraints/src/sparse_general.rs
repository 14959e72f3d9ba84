//! Multipliers of many equations under any metric: the saddle system, never the inverse of the
//! mass.
//!
//! ```text
//! [ M  J^T ] [  x ]   [ 0 ]
//! [ J   0  ] [ -l ] = [ b ]        l = (J M^-1 J^T)^-1 b
//! ```
//! `M` the metric's matrix (n x n), sparse with entries off its diagonal; `J` m x n. Rows and columns
//! are scaled, so that neither masses nor sizes nor their ratios tell:
//!
//! ```text
//! x = D x',   l = E l',   D = diag(M)^-1/2,   E_i = 1 / (slope_i max_f D_f)    f the freedoms of row i
//! ```
//! The matrix is symmetric and indefinite; its pattern is analysed once, and each solution is refined
//! and refused if its residual is larger than 1e-5: that a known vector is found again to 1e-5 bounds the error of
//! `l`, and rounding `l` alone leaves `eps |l|` of `b`, which is much where `l` is long. Redundant equations are
//! refused: the error for equations that depend on each other is a matrix on which a known vector is found again no
//! better than to 1e-5, from a ratio of singular values of J M^-1/2 of about 1e-5 on. How far they are from it is found
//! by inverse iteration, `y <- S^-1 y`, from place to place: the root of `|y| / |S^-1 y|` in scaled equations, from
//! above.
//! Source: errata conventions; `SparseIndefinite` of calculus, with the traps that it avoids.

use stationary_calculus::{
    Covector, Metric, Sink, SizeError, SparseError, SparseIndefinite, SymmetricMatrix, Vector,
};

use crate::entries::Entries;
use crate::multipliers::{Diagonal, check_solve};
use crate::rows::check_entries;
use crate::{Constraint, ConstraintError, Multipliers, Solver};

/// A known vector that is found again no better than this shows equations that depend on each other:
/// rounding makes what is redundant regular, now and then by as much as 1e-3.
const DEPENDENT: f64 = 1e-5;

/// Inverse iterations at the first place.
const FIRST: u32 = 4;

/// The choice of [`GeneralMultipliers`]: many equations, a metric that couples freedoms.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SparseGeneral;

/// Multipliers of many equations, from the saddle system.
#[derive(Clone, Debug)]
pub struct GeneralMultipliers {
    freedoms: usize,
    count: usize,
    prepared: bool,
    entries: Entries,
    matrix: SymmetricMatrix,
    solver: SparseIndefinite,
    right: Vec<f64>,
    scaling: Scaling,
    /// The combination of equations that is nearest to nothing, in scaled equations and of length 1, as far as
    /// inverse iterations have found it.
    weakest: Vec<f64>,
    regularity: f64,
}

/// D of each freedom, E of each equation.
#[derive(Clone, Debug)]
struct Scaling {
    freedoms: Vec<f64>,
    equations: Vec<f64>,
    /// Where blocks are scaled, as long as the largest.
    block: Vec<f64>,
}

impl Scaling {
    fn of(metric: &impl Metric, constraint: &impl Constraint, entries: &Entries) -> Self {
        let (freedoms, equations) = (vec![0.0; metric.dim()], vec![0.0; constraint.count()]);
        let mut scaling = Scaling { freedoms, equations, block: Vec::new() };
        scaling.renew(metric, constraint, entries);
        scaling
    }

    /// Takes the masses of a metric of as many freedoms.
    fn renew(&mut self, metric: &impl Metric, constraint: &impl Constraint, entries: &Entries) {
        let Scaling { freedoms, equations, .. } = self;
        Diagonal::refilled(&mut freedoms[..], metric);
        freedoms.iter_mut().for_each(|mass| *mass = mass.sqrt().recip());
        equations.fill(0.0);
        for &(row, freedom) in entries.pattern.places.iter() {
            let largest = &mut equations[row as usize];
            *largest = largest.max(freedoms[freedom as usize]);
        }
        for (row, factor) in equations.iter_mut().enumerate() {
            *factor = (constraint.scale(row).slope * *factor).recip();
        }
    }

    /// Brings the blocks of the saddle matrix, scaled.
    fn visit(&mut self, metric: &impl Metric, entries: &Entries, sink: &mut impl Sink) {
        let Scaling { freedoms, equations, block } = self;
        metric.add_matrix(&mut Scaled { by: freedoms, block, sink: &mut *sink });
        for (&(row, freedom), &value) in entries.pattern.places.iter().zip(&entries.values) {
            let (row, freedom) = (row as usize, freedom as usize);
            let value = value * freedoms[freedom] * equations[row];
            let places = [freedom, freedoms.len() + row];
            sink.add_symmetric(&places, &[0.0, value, value, 0.0]);
        }
    }
}

/// Takes blocks of the metric and scales them.
struct Scaled<'a, S> {
    by: &'a [f64],
    block: &'a mut Vec<f64>,
    sink: &'a mut S,
}

impl<S: Sink> Sink for Scaled<'_, S> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        // A freedom that is fixed is in no matrix.
        let factor = |freedom: usize| self.by.get(freedom).copied().unwrap_or(1.0);
        let k = freedoms.len();
        if self.block.len() < block.len() {
            self.block.resize(block.len(), 0.0);
        }
        let scaled = &mut self.block[..block.len()];
        for (place, (scaled, entry)) in scaled.iter_mut().zip(block).enumerate() {
            *scaled = factor(freedoms[place % k]) * factor(freedoms[place / k]) * entry;
        }
        self.sink.add_symmetric(freedoms, scaled);
    }
}

impl<C> Solver<C> for SparseGeneral {
    type Multipliers = GeneralMultipliers;

    fn analyse<M: Metric, K: Constraint>(
        &self,
        metric: &M,
        constraint: &K,
        t: f64,
        q: &[f64],
    ) -> Result<GeneralMultipliers, ConstraintError> {
        let (n, count) = (metric.dim(), constraint.count());
        check_entries(constraint, n, t, q)?;
        let entries = Entries::find(constraint, t, q)?;
        let mut scaling = Scaling::of(metric, constraint, &entries);
        let matrix = SymmetricMatrix::analyse(n + count, |sink| {
            scaling.visit(metric, &entries, sink);
        })?;
        Ok(GeneralMultipliers {
            freedoms: n,
            count,
            prepared: false,
            entries,
            solver: SparseIndefinite::analyse(&matrix)?,
            matrix,
            right: vec![0.0; n + count],
            scaling,
            weakest: Vec::with_capacity(count),
            regularity: 0.0,
        })
    }
}

impl GeneralMultipliers {
    /// Inverse iterations towards the combination of equations that is nearest to nothing: a few from one that
    /// knows nothing, later one from the last place's.
    fn weaken(&mut self) -> Result<(), ConstraintError> {
        let iterations = if self.weakest.is_empty() { FIRST } else { 1 };
        if self.weakest.is_empty() {
            // No two of these are in a ratio that a linkage is likely to have.
            self.weakest.extend((0..self.count).map(|row| (1.0 + row as f64).sin()));
        }
        self.regularity = 1.0;
        for _ in 0..iterations {
            let (above, below) = self.right.split_at_mut(self.freedoms);
            above.fill(0.0);
            let length = |y: &[f64]| y.iter().map(|y| y * y).sum::<f64>().sqrt();
            let size = length(&self.weakest);
            below.iter_mut().zip(&self.weakest).for_each(|(below, y)| *below = y / size);
            if self.solver.solve_within(&self.matrix, &mut self.right, DEPENDENT).is_err() {
                return Err(ConstraintError::Dependent { row: None });
            }
            let found = &self.right[self.freedoms..];
            let grown = length(found);
            if grown > 0.0 && grown.is_finite() {
                self.weakest.iter_mut().zip(found).for_each(|(y, found)| *y = found / grown);
                self.regularity = grown.recip().sqrt().min(1.0);
            }
        }
        Ok(())
    }
}

impl Multipliers for GeneralMultipliers {
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
        SizeError::check("the metric's freedoms", self.freedoms, metric.dim())?;
        self.entries.write(constraint, t, q)?;
        let GeneralMultipliers { entries, matrix, scaling, .. } = self;
        scaling.renew(metric, constraint, entries);
        matrix.refill(|sink| scaling.visit(metric, entries, sink))?;
        match self.solver.factor(&self.matrix) {
            Ok(_) if self.solver.known_vector_error() <= DEPENDENT => {
                self.weaken()?;
                self.prepared = true;
                Ok(())
            }
            Ok(_) | Err(SparseError::Singular) => Err(ConstraintError::Dependent { row: None }),
            Err(other) => Err(other.into()),
        }
    }

    fn regularity(&self) -> Option<f64> {
        Some(self.regularity)
    }

    fn weakest(&self) -> Option<(usize, f64)> {
        let size = |row: &usize| self.weakest[*row].abs();
        let row = (0..self.weakest.len()).max_by(|a, b| size(a).total_cmp(&size(b)))?;
        Some((row, self.regularity))
    }

    fn solve(&mut self, b: &mut [f64]) -> Result<(), ConstraintError> {
        check_solve(self.prepared, self.count, b)?;
        let (above, below) = self.right.split_at_mut(self.freedoms);
        let factors = &self.scaling.equations;
        above.fill(0.0);
        for (below, (b, factor)) in below.iter_mut().zip(b.iter().zip(factors)) {
            *below = factor * b;
        }
        self.solver.solve_within(&self.matrix, &mut self.right, DEPENDENT)?;
        for (b, (l, factor)) in b.iter_mut().zip(self.right[self.freedoms..].iter().zip(factors)) {
            *b = -factor * l;
        }
        Ok(())
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
    use crate::{Rod, Rods};
    use stationary_calculus::DiagonalMetric;

    /// A light particle that carries one 1e9 times as heavy: S = [[1, -1], [-1, 1 + 1e-9]] in scaled
    /// equations, whose least eigenvalue is 5e-10.
    #[test]
    fn a_growth_that_rounding_hides_is_no_dependence() {
        let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 1.0)];
        let rods = Rods::<2>::new(2, vec![[0.0; 2]], rods).unwrap();
        let q = [0.6, -0.8, 1.2, -1.6];
        let metric = DiagonalMetric::new(vec![1.0, 1.0, 1e9, 1e9]).unwrap();
        let analysed = Solver::<Vec<f64>>::analyse(&SparseGeneral, &metric, &rods, 0.0, &q);
        let mut coupled = analysed.unwrap();
        coupled.prepare(&metric, &rods, 0.0, &q).unwrap();
        let ratio = coupled.regularity / 5e-10_f64.sqrt();
        assert!((0.2..5.0).contains(&ratio), "{ratio}");
    }

    #[test]
    fn masses_and_sizes_far_from_one_cost_no_digit() {
        for (size, masses) in [(1.0, [1.0, 1.0]), (1e-6, [1e6, 1e6]), (1e6, [1e-6, 1.0])] {
            let rods = vec![Rod::new([2, 0], size), Rod::new([0, 1], size)];
            let rods = Rods::<2>::new(2, vec![[0.0; 2]], rods).unwrap();
            let q = [0.6 * size, -0.8 * size, 1.6 * size, -0.8 * size];
            let [a, b] = masses;
            let metric = DiagonalMetric::new(vec![a, a, b, b]).unwrap();
            let analysed = Solver::<Vec<f64>>::analyse(&SparseGeneral, &metric, &rods, 0.0, &q);
            let mut coupled = analysed.unwrap();
            coupled.prepare(&metric, &rods, 0.0, &q).unwrap();
            // S by hand: rods of slope 2 L at an angle whose cosine is c.
            let (square, cosine) = (4.0 * size * size, 0.6);
            let s = [[square / a, -square * cosine / a], [0.0, square * (1.0 / a + 1.0 / b)]];
            let right = [0.3, -0.7];
            let mut lambda = right;
            coupled.solve(&mut lambda).unwrap();
            let back = [
                s[0][0] * lambda[0] + s[0][1] * lambda[1],
                s[0][1] * lambda[0] + s[1][1] * lambda[1],
            ];
            assert!(back.iter().zip(&right).all(|(b, r)| (b - r).abs() < 1e-13), "{back:?}");
        }
    }
}
