//! Where a loaded body comes to rest.
//!
//! ```text
//! dV(q) = t f,   held coordinates at (1 - t) start + t end,      t = 1/n, 2/n, ..., 1
//! reaction = dV at the held coordinates - the load there
//! ```
//! `f` a dead load (N), `t` the fraction of it: each step starts where the one before came to rest,
//! so that Newton's method has a good guess. The line search lowers the energy; where the Hessian
//! is not positive definite it is shifted by the mass (the ladder of calculus). What is found is a
//! minimum of the energy, not of all of them the lowest. A body that can still move as a whole is
//! refused before any solve: its Hessian has no inverse, and the answer would be whatever rounding
//! makes of it. Source: notes 4.4; load stepping after Bonet and Wood (2008).

use stationary_calculus::{
    ConjugateGradient, DiagonalMetric, Equilibrium, EquilibriumReport, HessianSolver,
    IterativeSolver, Newton, Ordering, Potential, SparseSolver,
};

use crate::rigid_motions::check_held;
use crate::{DeadLoad, ElasticityError, Material, Solid};

/// How each of Newton's steps is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Solves {
    /// By a factor, whose order of elimination is found this way.
    Factor(Ordering),
    /// By conjugate gradients, for bodies whose factor is too large or too slow. Where the Hessian is
    /// not positive definite it gives up: project it ([`Solid::with_curvature`]).
    Iterate(ConjugateGradient),
}

/// How a load is put on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statics {
    /// In how many equal steps.
    pub steps: usize,
    /// When Newton's method stops, in kg^1/2 m/s^2: see [`Equilibrium`].
    pub newton: Newton,
    /// How its linear equations are solved.
    pub solves: Solves,
}

impl Default for Statics {
    /// In one step, to rounding, by a factor.
    fn default() -> Self {
        let solves = Solves::Factor(Ordering::default());
        Statics { steps: 1, newton: Newton::default(), solves }
    }
}

/// A body at rest under its load.
#[derive(Clone, Debug, PartialEq)]
pub struct AtRest {
    /// What Newton's method did in each load step.
    pub steps: Vec<EquilibriumReport>,
    /// The forces that hold the held coordinates, in their order, newtons.
    pub reactions: Vec<f64>,
}

impl AtRest {
    /// Newton steps in all, each one factorization.
    pub fn iterations(&self) -> u32 {
        self.steps.iter().map(|step| step.newton.iterations).sum()
    }
}

impl Statics {
    /// Moves `q` to where the body rests under the load, with its held coordinates moved to
    /// `places` along the way. On failure both are left as they were.
    pub fn solve<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        solid: &mut Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        places: &[f64],
        q: &mut [f64],
    ) -> Result<AtRest, ElasticityError>
    where
        M: Material<D, R>,
    {
        solid.freedoms().check(q.len())?;
        let before = solid.freedoms().places().to_vec();
        let mut x = q.to_vec();
        check_held(solid, &x)?;
        let solved = self.climb(solid, load, metric, (&before, places), &mut x);
        match solved {
            Ok(steps) => {
                q.copy_from_slice(&x);
                let differential = solid.held_differential(q)?;
                let reactions = differential.iter().zip(load.at_held()).map(|(dv, f)| dv - f);
                Ok(AtRest { steps, reactions: reactions.collect() })
            }
            Err(error) => {
                solid.hold_at(&before)?;
                Err(error)
            }
        }
    }

    fn climb<M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        solid: &mut Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        (start, end): (&[f64], &[f64]),
        x: &mut [f64],
    ) -> Result<Vec<EquilibriumReport>, ElasticityError>
    where
        M: Material<D, R>,
    {
        if self.steps == 0 {
            return Err(ElasticityError::NoSteps);
        }
        solid.hold_at(end)?;
        match self.solves {
            Solves::Factor(ordering) => {
                let solver = SparseSolver::by_ordering(metric, &*solid, x, ordering)?;
                self.climb_by(solver, solid, load, metric, (start, end), x)
            }
            Solves::Iterate(method) => {
                let solver = IterativeSolver::new(method, metric, &*solid, x)?;
                self.climb_by(solver, solid, load, metric, (start, end), x)
            }
        }
    }

    fn climb_by<L, M, const N: usize, const D: usize, const R: usize, const Q: usize>(
        &self,
        mut solver: L,
        solid: &mut Solid<M, N, D, R, Q>,
        load: &DeadLoad<D>,
        metric: &DiagonalMetric<Vec<f64>>,
        (start, end): (&[f64], &[f64]),
        x: &mut [f64],
    ) -> Result<Vec<EquilibriumReport>, ElasticityError>
    where
        L: HessianSolver,
        M: Material<D, R>,
    {
        let steps = self.steps;
        let mut reports = Vec::with_capacity(steps);
        for step in 1..=steps {
            let t = step as f64 / steps as f64;
            let between: Vec<f64> =
                start.iter().zip(end).map(|(a, b)| (1.0 - t) * a + t * b).collect();
            solid.hold_at(&between)?;
            let potential = (&*solid, load.scaled(t));
            potential.0.freedoms().check(potential.1.dim())?;
            let mut search = Equilibrium::new(metric, &potential, &mut solver, self.newton)?;
            let found = search.find(x);
            reports.push(found.map_err(|source| ElasticityError::Statics {
                step,
                steps,
                source,
            })?);
        }
        Ok(reports)
    }
}
