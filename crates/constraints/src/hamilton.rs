//! The constrained discrete Hamilton principle: every configuration of the path stays, from the
//! first.
//!
//! ```text
//! S = sum_i h (L(q_i, q_i+1) - <lambda_i, g(q_i)>)                 stationary             (6.3)
//! p' = p - h dV(q) - h J(q)^T lambda,     lambda such that g(t + h, q') = 0
//! (q', p') <- Phi_h(q, p')         q' = q + h M^-1 p' on flat space
//! ```
//! `q` configuration, `p` the momentum of the last interval (n), `Phi` the free motion, [`Straight`]
//! unless another is given; `lambda` the multipliers of the
//! force at the start of the step (m): `F = -J^T lambda`. The notes' loop leaves the first position
//! `q_0 + h v_0` unconstrained; here it has its own multiplier like every other.
//!
//! Order 1, symplectic, explicit but for lambda. Configurations are feasible to rounding,
//! velocities only to O(h): p belongs to the chord from one configuration to the next. Keeps linear
//! and angular momentum to rounding where potential and constraint do. From a tangent velocity the
//! first multiplier carries half of the centripetal force only: the chord starts half a step late.
//! Source: notes 6.5; errata 6.5 (the first step; lambda inside h L is a force).

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
    name: "constrained-hamilton",
    order: 1,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: false,
    symplecticity: Symplecticity::Symplectic,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::Exact,
    stability: Stability::Below(2.0),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// The integrator of the notes' section 6.5 with multipliers solved for by X.
#[derive(Clone, Debug)]
pub struct ConstrainedHamilton<'s, M, P, S, K, C, X: Multipliers, F = Straight> {
    core: RattleCore<'s, M, P, S, K, C, X, F>,
    lambda: X::Numbers,
}

impl<'s, M, P, K, C, X> ConstrainedHamilton<'s, M, P, Flat, K, C, X>
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
        let lambda = X::Numbers::clone(&core.impulse);
        Ok(ConstrainedHamilton { core, lambda })
    }
}

impl<'s, M, P, S, K, C, X, F> ConstrainedHamilton<'s, M, P, S, K, C, X, F>
where
    M: Metric,
    P: Potential,
    S: Space,
    K: ConstraintOn<S>,
    C: Storage,
    X: Multipliers,
    F: FreeMotion<M, S>,
{
    /// The method on any space, drifting along a free motion of that space.
    ///
    /// # Errors
    /// Those of [`ConstrainedHamilton::new`].
    pub fn along(
        motion: F,
        system: &'s System<M, P, S>,
        constraint: K,
        state: &State<C>,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<Self, ConstraintError> {
        let core = RattleCore::new(system, constraint, state, &choice, motion)?;
        let lambda = X::Numbers::clone(&core.impulse);
        Ok(ConstrainedHamilton { core, lambda })
    }
}

impl<M, P, S, K, C, X, F> ConstrainedIntegrator<C> for ConstrainedHamilton<'_, M, P, S, K, C, X, F>
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
        let core = &mut self.core;
        core.begin(state)?;
        core.kick_here(h);
        let (iterations, violation) = core.hold_configuration(h)?;
        let work = core.work_here();
        core.arrive(h)?;
        core.finish(state, h)?;
        for (lambda, a) in self.lambda.as_mut().iter_mut().zip(core.impulse.as_ref()) {
            *lambda = a / h;
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
