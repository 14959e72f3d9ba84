//! Equalities alone, by the solver that `constraints` has for them: sparse, of any number and any redundancy.
//!
//! ```text
//! J M^-1 J^T x = w - J v          x the shortest where equations depend on each other
//! ```
//! `M` diagonal. A chain of joints takes work that grows with its links, not with their cube. Joints meet in the
//! same places step after step: the order of their elimination is found once.

use stationary_calculus::{Covector, DiagonalMetric, Sink, SizeError, Vector, first_non_finite};
use stationary_constraints::{
    Constraint, ConstraintError, DiagonalMultipliers, Multipliers, Redundancy, Rows, Scale, Solver,
    SparseDiagonal, VelocityRows,
};

/// Solutions with one factor: each but the first takes off what rounding of those before has left.
const SOLUTIONS: usize = 4;

/// An island of equalities, and the memory of solving it.
#[derive(Debug, Default)]
pub(crate) struct Equalities {
    lines: Lines,
    multipliers: Option<DiagonalMultipliers>,
    /// The freedoms that the rows move, and their masses.
    freedoms: Vec<usize>,
    masses: Vec<f64>,
    /// What the rows lack, and what impulses leave of it.
    lack: Vec<f64>,
    left: Vec<f64>,
    best: Vec<f64>,
    tried: Vec<f64>,
    motion: Covector<Vec<f64>>,
}

impl Equalities {
    /// Writes the impulses of these rows; nothing where their rank is not clear or nothing answers to one of them.
    pub(crate) fn solve(
        &mut self,
        rows: &VelocityRows,
        own: &[usize],
        inverse_masses: &[f64],
        v: &[f64],
        impulses: &mut [f64],
    ) -> Option<()> {
        self.take(rows, own, inverse_masses);
        self.lack.clear();
        self.lack.extend(own.iter().map(|&row| -rows.lack(row, Vector(v))));
        self.prepare()?;
        self.refine()?;
        impulses.copy_from_slice(&self.best);
        Some(())
    }

    /// Takes the entries of these rows. Freedoms that no row touches, or that nothing moves, stay out of it.
    fn take(&mut self, rows: &VelocityRows, own: &[usize], inverse_masses: &[f64]) {
        let Equalities { lines, freedoms, masses, .. } = self;
        let moved = |row: usize| rows.row(row).filter(|&(f, _)| inverse_masses[f] > 0.0);
        freedoms.clear();
        freedoms.extend(own.iter().flat_map(|&row| moved(row)).map(|(freedom, _)| freedom));
        freedoms.sort_unstable();
        freedoms.dedup();
        masses.clear();
        masses.extend(freedoms.iter().map(|&freedom| inverse_masses[freedom].recip()));
        lines.clear(freedoms.len());
        for &row in own {
            lines.begin();
            for (freedom, value) in moved(row) {
                lines.add(freedoms.partition_point(|&other| other < freedom), value);
            }
        }
    }

    /// Factors the equations, as their places were found the last time if they are still there.
    fn prepare(&mut self) -> Option<()> {
        let Equalities { lines, multipliers, masses, .. } = self;
        let moves = |row: usize| lines.scale(row).slope > 0.0;
        if !(0..lines.count()).all(moves) || first_non_finite(masses).is_some() {
            return None;
        }
        match multipliers.as_mut().map(|known| known.renew(masses, lines, 0.0, &[])) {
            None | Some(Err(ConstraintError::PatternChanged { .. } | ConstraintError::Size(_))) => {
                let metric = DiagonalMetric::new(masses.clone()).ok()?;
                let choice = SparseDiagonal(Redundancy::LeastNorm);
                let found = Solver::<Vec<f64>>::analyse(&choice, &metric, lines, 0.0, &[]).ok()?;
                multipliers.insert(found).prepare(&metric, lines, 0.0, &[]).ok()
            }
            Some(renewed) => renewed.ok(),
        }
    }

    fn refine(&mut self) -> Option<()> {
        let Equalities { multipliers, masses, lack, left, best, tried, motion, .. } = self;
        let multipliers = multipliers.as_mut()?;
        left.clone_from(lack);
        best.clear();
        best.resize(lack.len(), 0.0);
        motion.0.clear();
        motion.0.resize(masses.len(), 0.0);
        let mut least = f64::INFINITY;
        for _ in 0..SOLUTIONS {
            tried.clone_from(left);
            multipliers.solve(tried).ok()?;
            tried.iter_mut().zip(&*best).for_each(|(change, x)| *change += x);
            motion.0.fill(0.0);
            multipliers.add_pulled_back(-1.0, tried, motion.view_mut());
            motion.0.iter_mut().zip(&*masses).for_each(|(motion, mass)| *motion *= mass.recip());
            left.clone_from(lack);
            multipliers.add_along(Vector(&motion.0), left);
            let worst = left.iter().fold(0.0, |most: f64, left| most.max(left.abs()));
            if worst >= least {
                break;
            }
            std::mem::swap(best, tried);
            least = worst;
        }
        Some(())
    }
}

/// Linear equations whose numbers change.
#[derive(Debug, Default)]
struct Lines {
    dim: usize,
    starts: Vec<usize>,
    entries: Vec<(usize, f64)>,
}

impl Lines {
    /// Forgets all equations; the next ones are of so many freedoms.
    fn clear(&mut self, dim: usize) {
        self.dim = dim;
        self.starts.clear();
        self.entries.clear();
    }

    /// Begins an equation.
    fn begin(&mut self) {
        self.starts.push(self.entries.len());
    }

    /// Adds to an entry of the last equation.
    fn add(&mut self, freedom: usize, value: f64) {
        let own = self.starts.last().copied().unwrap_or(0);
        match self.entries[own..].iter_mut().find(|entry| entry.0 == freedom) {
            Some(entry) => entry.1 += value,
            None => self.entries.push((freedom, value)),
        }
    }

    fn row(&self, row: usize) -> &[(usize, f64)] {
        let end = self.starts.get(row + 1).copied().unwrap_or(self.entries.len());
        &self.entries[self.starts[row]..end]
    }
}

/// Zero wherever they are asked for: they are solved for a change.
impl Constraint for Lines {
    fn dim(&self) -> usize {
        self.dim
    }

    fn count(&self) -> usize {
        self.starts.len()
    }

    fn value(&self, _: f64, _: &[f64], g: &mut [f64]) -> Result<(), SizeError> {
        g.fill(0.0);
        Ok(())
    }

    fn differential(&self, _: f64, _: &[f64], rows: &mut impl Rows) -> Result<(), SizeError> {
        for row in 0..self.count() {
            self.row(row).iter().for_each(|&(freedom, value)| rows.add(row, freedom, value));
        }
        Ok(())
    }

    fn add_hessian(
        &self,
        _: f64,
        _: &[f64],
        _: &[f64],
        _: &mut impl Sink,
    ) -> Result<(), SizeError> {
        Ok(())
    }

    fn scale(&self, row: usize) -> Scale {
        let slope = self.row(row).iter().map(|(_, a)| a * a).sum::<f64>().sqrt();
        Scale { slope, ..Scale::default() }
    }
}
