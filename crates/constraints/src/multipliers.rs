//! Multipliers: the one linear system behind every way to enforce a constraint.
//!
//! ```text
//! S lambda = b,    S = J M^-1 J^T        m x m, symmetric
//! ```
//! `J` the constraint's differential (m x n) at a time and a configuration, `M` the metric.
//! Removing the velocity that leaves the feasible set, `v - M^-1 J^T S^-1 (J v + dg/dt)`, is the
//! projection in the mass metric, and each iteration towards a feasible configuration is one such
//! solve.
//!
//! Three solvers: [`Dense`](crate::Dense) of up to three equations and any metric, on the stack;
//! [`SparseDiagonal`](crate::SparseDiagonal) of any number with a diagonal metric, linear in the links of a
//! chain and in their redundant equations; `SparseGeneral` (feature `sparse`) with a metric that couples
//! freedoms. Knows nothing of time steps.

use stationary_calculus::{Covector, FIXED, Metric, Sink, Vector};

use crate::{Constraint, ConstraintError, check_multipliers};

/// What to do where equations depend on each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Redundancy {
    /// An error.
    #[default]
    Refuse,
    /// Among all multipliers that do it, those of the least norm in reference scales: force is
    /// shared, and the motion is that of the independent equations.
    LeastNorm,
}

/// Singular values below this part of the largest are zero.
pub(crate) const DEPENDENT: f64 = 1e-8;

/// Solves `J M^-1 J^T lambda = b`, again and again for changing J.
pub trait Multipliers: Clone {
    /// The storage of m numbers.
    type Numbers: AsRef<[f64]> + AsMut<[f64]> + Clone;

    /// Zeros, one for each equation.
    fn numbers(&self) -> Self::Numbers;

    /// Evaluates J at `(t, q)`, takes the masses of the metric, prepares solving, and examines the rank.
    ///
    /// # Errors
    /// A configuration with fewer numbers than the constraint reads; another number of equations or
    /// of freedoms, or other entries, than were analysed; entries that are not finite; rows that
    /// vanish or depend on each other, where the solver refuses them. Nothing is solved until it
    /// succeeds again.
    fn prepare(
        &mut self,
        metric: &impl Metric,
        constraint: &impl Constraint,
        t: f64,
        q: &[f64],
    ) -> Result<(), ConstraintError>;

    /// The smallest over the largest singular value of J M^-1/2 in reference scales, where it was
    /// prepared last, or of a solver of many equations the smallest distance of an independent one from those eliminated
    /// before it, relative to a normal row; `None` of a solver that does not know.
    fn regularity(&self) -> Option<f64> {
        None
    }

    /// How many equations depend on others, where it was prepared last; 0 of a solver that refuses them.
    fn redundant(&self) -> usize {
        0
    }

    /// The equation that is nearest to depending on others, or does, and its distance from them relative to a
    /// normal row; `None` of a solver that does not know.
    fn weakest(&self) -> Option<(usize, f64)> {
        None
    }

    /// Replaces `b` by a solution of `S lambda = b`: the only one, or where equations depend on each
    /// other and are not refused one whose force is that of the shortest.
    ///
    /// # Errors
    /// [`ConstraintError::NotPrepared`] unless the last preparation succeeded;
    /// [`ConstraintError::Size`] for another number of components than of equations; a solution that
    /// cannot be trusted.
    fn solve(&mut self, b: &mut [f64]) -> Result<(), ConstraintError>;

    /// Replaces multipliers by the shortest, in reference scales, with the same force. Sums of solutions
    /// need it once; it does nothing where every solution is the shortest.
    ///
    /// # Errors
    /// Those of [`Multipliers::solve`]; [`ConstraintError::NotShared`] for an iteration that did not
    /// settle.
    fn share(&mut self, _lambda: &mut [f64]) -> Result<(), ConstraintError> {
        Ok(())
    }

    /// Adds `scale J^T lambda` to a covector.
    fn add_pulled_back(&self, scale: f64, lambda: &[f64], p: Covector<&mut [f64]>);

    /// Adds `J v` to m numbers.
    fn add_along(&self, v: Vector<&[f64]>, rates: &mut [f64]);
}

/// A choice of solver, for states stored as C.
pub trait Solver<C> {
    /// The solver.
    type Multipliers: Multipliers;

    /// The solver for a constraint with its memory; J at `(t, q)` is not yet in it.
    ///
    /// # Errors
    /// [`ConstraintError::Freedoms`] for a constraint that needs more freedoms than the metric has, and
    /// [`ConstraintError::UnknownFreedom`] for one that brings an entry outside of its matrix; a
    /// configuration with fewer numbers than the constraint reads; a storage of another size than
    /// the system's; [`ConstraintError::TooMany`] or [`ConstraintError::Coupled`] for what the
    /// solver is not made for; a matrix that cannot be assembled or does not fit into memory.
    fn analyse<M: Metric, K: Constraint>(
        &self,
        metric: &M,
        constraint: &K,
        t: f64,
        q: &[f64],
    ) -> Result<Self::Multipliers, ConstraintError>;
}

/// An error unless the multipliers are prepared, and as many as equations.
#[inline]
pub(crate) fn check_solve(
    prepared: bool,
    count: usize,
    numbers: &[f64],
) -> Result<(), ConstraintError> {
    if !prepared {
        return Err(ConstraintError::NotPrepared);
    }
    Ok(check_multipliers(count, numbers)?)
}

/// The masses on the diagonal of a metric, and the first freedom with another entry.
pub(crate) struct Diagonal<C> {
    pub(crate) mass: C,
    pub(crate) coupled: Option<usize>,
}

impl Diagonal<Vec<f64>> {
    pub(crate) fn of(metric: &impl Metric) -> Self {
        Diagonal::refilled(vec![0.0; metric.dim()], metric)
    }
}

impl<C: AsMut<[f64]>> Diagonal<C> {
    /// Takes the masses of a metric of as many freedoms, in the memory that it has.
    pub(crate) fn refilled(mut mass: C, metric: &impl Metric) -> Self {
        mass.as_mut().fill(0.0);
        let mut diagonal = Diagonal { mass, coupled: None };
        metric.add_matrix(&mut diagonal);
        diagonal
    }
}

impl<C: AsMut<[f64]>> Sink for Diagonal<C> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        let mass = self.mass.as_mut();
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            for (&i, &entry) in freedoms.iter().zip(column) {
                if i == FIXED || j == FIXED {
                    continue;
                }
                if i == j {
                    mass[i] += entry;
                } else if entry != 0.0 {
                    self.coupled.get_or_insert(i);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_of_fixed_freedoms_belong_to_no_mass() {
        let mut diagonal = Diagonal { mass: vec![0.0; 2], coupled: None };
        diagonal.add_symmetric(&[1, FIXED], &[2.0, 0.5, 0.5, 2.0]);
        diagonal.add_symmetric(&[], &[]);
        assert_eq!((diagonal.mass.as_slice(), diagonal.coupled), (&[0.0, 2.0][..], None));
        diagonal.add_symmetric(&[0, 1], &[1.0, 0.5, 0.5, 1.0]);
        assert!(diagonal.coupled.is_some());
    }
}
