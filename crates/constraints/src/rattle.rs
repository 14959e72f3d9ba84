//! RATTLE: Stormer-Verlet with configurations and velocities that both stay.
//!
//! ```text
//! p~ = p  - h/2 dV(q)  - J(q)^T A,        A such that g(t + h, q') = 0
//! (q', p^) = Phi_h(q, p~)                 q' = q exp(h M^-1 p~), p^ = p~ where motion is straight
//! p' = p^ - h/2 dV(q') - J(q')^T B,       B such that J(q') M^-1 p' + dg/dt = 0
//! lambda = (A + B)/h
//! ```
//! `q` configuration, `p` momentum covector (n), `J` the constraint's differential (m x n), `Phi`
//! the free motion, `A B` impulses (m), `lambda` the multipliers of the mean force over the step
//! (m): the tension of a rod is `2 L lambda` newtons, of order 2 at the middle of the step.
//!
//! Order 2, symmetric, symplectic on the feasible set; keeps linear and angular momentum to
//! rounding where potential and constraint do. One differential, one factorization and a few solves
//! a step. The free motion is [`Straight`] on flat space, and on any other the [`FreeMotion`] of that
//! space.
//!
//! ```text
//! theta sqrt(mu) < sigma/2       a step has a solution, and it is found
//! ```
//! `theta` the turn of the fastest rod in a step (rad), `mu` the largest mass over the smallest, `sigma`
//! the smallest over the largest singular value of J in reference scales, masses left aside: 1 for a
//! pendulum, 0.38 for a double one, less where a linkage is nearly singular. A light joint between
//! heavy ones swings with a frequency like `sqrt(mu)`, which the step must resolve: beyond the bound by
//! a few times there is no solution for any solver to find, and the step is an error. The bound is
//! measured, not proved; [`Halving`](crate::Halving) retries such a step in halves where that is asked
//! for.
//!
//! A linkage passes a singular position, where it may go on in more than one way, in a step that begins before and ends beyond
//! it: inertia decides. A step that begins or ends too close for that is
//! [`SingularPosition`](ConstraintError::SingularPosition), which names the equations: it tells so by the impulses
//! at both ends, which of one motion are alike. Source: Andersen (1983); Leimkuhler and Reich (2004), 7.2;
//! notes 6.5.

use stationary_calculus::{Flat, Metric, Potential, Space, Storage, System};
use stationary_integrators::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Saved, Stability, State,
    StepError, Symplecticity,
};

use crate::checks::check_step;
use crate::rattle_core::RattleCore;
use crate::{
    ConstrainedIntegrator, ConstrainedReport, Constraint, ConstraintError, ConstraintOn,
    FreeMotion, Multipliers, Solver, Straight,
};

/// What is known of the method.
const FACTS: Facts = Facts {
    name: "rattle",
    order: 2,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: true,
    symplecticity: Symplecticity::Symplectic,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::Exact,
    stability: Stability::Below(2.0),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// The RATTLE method with multipliers solved for by X.
#[derive(Clone, Debug)]
pub struct Rattle<'s, M, P, S, K, C, X: Multipliers, F = Straight> {
    core: RattleCore<'s, M, P, S, K, C, X, F>,
    /// The impulse at the start of the step.
    start: X::Numbers,
    lambda: X::Numbers,
}

impl<'s, M, P, K, C, X> Rattle<'s, M, P, Flat, K, C, X>
where
    M: Metric,
    P: Potential,
    K: Constraint,
    C: Storage,
    X: Multipliers,
{
    /// The method on a system on flat space under a constraint, from a feasible state.
    ///
    /// # Errors
    /// Sizes that differ, numbers that are not finite, a state that is not feasible, a constraint
    /// without full rank there.
    pub fn new(
        system: &'s System<M, P>,
        constraint: K,
        state: &State<C>,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<Self, ConstraintError> {
        let core = RattleCore::new(system, constraint, state, &choice, Straight)?;
        Ok(Rattle::of(core))
    }
}

impl<'s, M, P, S, K, C, X: Multipliers, F> Rattle<'s, M, P, S, K, C, X, F> {
    fn of(core: RattleCore<'s, M, P, S, K, C, X, F>) -> Self {
        let lambda = X::Numbers::clone(&core.impulse);
        Rattle { start: lambda.clone(), core, lambda }
    }
}

impl<'s, M, P, S, K, C, X, F> Rattle<'s, M, P, S, K, C, X, F>
where
    M: Metric,
    P: Potential,
    S: Space,
    K: ConstraintOn<S>,
    C: Storage,
    X: Multipliers,
    F: FreeMotion<M, S> + Clone,
{
    /// The method on any space, drifting along a free motion of that space.
    ///
    /// # Errors
    /// Those of [`Rattle::new`].
    pub fn along(
        motion: F,
        system: &'s System<M, P, S>,
        constraint: K,
        state: &State<C>,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<Self, ConstraintError> {
        let core = RattleCore::new(system, constraint, state, &choice, motion)?;
        Ok(Rattle::of(core))
    }

    /// The constraint.
    pub fn constraint(&self) -> &K {
        &self.core.constraint
    }

    /// Gives a state that has just been stepped what it was before.
    pub(crate) fn step_back(&mut self, state: &mut State<C>) {
        // A step leaves it there when it hands the new state over.
        std::mem::swap(state, &mut self.core.next);
    }

    /// The free motion: of a [`Forced`](crate::Forced) one the works of the last step's forces.
    pub fn motion(&self) -> &F {
        &self.core.motion
    }

    /// Goes on with another constraint, which the state must satisfy. On an error the method is as
    /// it was.
    ///
    /// # Errors
    /// Those of [`Rattle::new`].
    pub fn set_constraint(
        &mut self,
        constraint: K,
        state: &State<C>,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<(), ConstraintError> {
        self.core.with_constraint(constraint, state, &choice)?;
        self.start = self.core.impulse.clone();
        self.lambda = self.core.impulse.clone();
        Ok(())
    }
}

impl<M, P, S, K, C, X, F> ConstrainedIntegrator<C> for Rattle<'_, M, P, S, K, C, X, F>
where
    M: Metric,
    P: Potential,
    S: Space,
    K: Constraint,
    C: Storage,
    X: Multipliers,
    F: FreeMotion<M, S>,
{
    fn facts(&self) -> Facts {
        FACTS
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<ConstrainedReport, ConstraintError> {
        check_step(h)?;
        self.step_either_way(state, h)
    }

    fn step_either_way(
        &mut self,
        state: &mut State<C>,
        h: f64,
    ) -> Result<ConstrainedReport, ConstraintError> {
        check_step(h.abs())?;
        let core = &mut self.core;
        core.begin(state)?;
        core.kick_here(0.5 * h);
        let (iterations, violation) = core.hold_configuration(h)?;
        self.start.clone_from(&core.impulse);
        let mut work = core.work_here();
        core.arrive(h)?;
        core.kick_there(0.5 * h);
        core.hold_velocity()?;
        core.check_passage()?;
        work += core.work_there();
        core.finish(state, h)?;
        let impulses = self.start.as_ref().iter().zip(core.impulse.as_ref());
        let rate = 1.0 / h;
        for (lambda, (a, b)) in self.lambda.as_mut().iter_mut().zip(impulses) {
            *lambda = (a + b) * rate;
        }
        let differentials = core.differentials;
        Ok(ConstrainedReport { differentials, iterations, violation, work, halvings: 0 })
    }

    fn multipliers(&self) -> &[f64] {
        self.lambda.as_ref()
    }

    fn save(&self) -> Saved {
        self.core.save(FACTS.name)
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.core.load(FACTS.name, saved)
    }
}
