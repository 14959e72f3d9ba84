//! Step and project: a step that ignores the constraint, then back to the feasible set.
//!
//! ```text
//! (q~, p~) = Phi_h(q, p)               any integrator
//! q' = the closest feasible configuration to q~, in the mass metric
//! p^ = p~ + M (q' - q~)/h              the velocity of the correction
//! p' = p^ - J^T mu                     such that J v' + dg/dt = 0
//! ```
//! `q` configuration, `p` momentum covector (n). Order 1 whatever the integrator: the correction
//! points along J(q'), and takes a part of order h^2 of the velocity with it in every step.
//! Configurations and velocities feasible to rounding; keeps linear momentum where potential and
//! constraint do, angular momentum to its order only, and loses energy where the constraint turns
//! the motion. Source: notes 6.3; errata 6.3 (usable, but the velocity needs a projection of its
//! own).

use stationary_calculus::{Covector, Metric, Potential, Space, Storage, System};
use stationary_integrators::{
    Conservation, EnergyBehavior, Facts, Integrator, Saved, State, StepError, Symplecticity,
};

use crate::checks::{check_finite, check_step, check_time, zeros};
use crate::{
    ConstrainedIntegrator, ConstrainedReport, Constraint, ConstraintError, ConstraintOn,
    Multipliers, Projection, Solver,
};

/// Any integrator, followed by a projection.
#[derive(Clone, Debug)]
pub struct StepAndProject<'s, I, M, P, S, K, C, X: Multipliers> {
    integrator: I,
    projection: Projection<'s, M, P, S, K, C, X>,
    next: State<C>,
    lambda: X::Numbers,
}

impl<'s, I, M, P, S, K, C, X> StepAndProject<'s, I, M, P, S, K, C, X>
where
    I: Integrator<C>,
    M: Metric,
    P: Potential,
    S: Space,
    K: Constraint,
    C: Storage,
    X: Multipliers,
{
    /// The method on a system under a constraint, from a feasible state.
    ///
    /// # Errors
    /// Sizes that differ, numbers that are not finite, a configuration or a velocity that is not
    /// feasible, a constraint without full rank there.
    pub fn new(
        integrator: I,
        system: &'s System<M, P, S>,
        constraint: K,
        state: &State<C>,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<Self, ConstraintError>
    where
        K: ConstraintOn<S>,
    {
        let mut projection = Projection::new(system, constraint, state, choice)?;
        let mut g = vec![0.0; projection.constraint().count()];
        projection.constraint().value(state.t, state.q.as_ref(), &mut g)?;
        projection.scales.check(&g, state.q.as_ref())?;
        projection.check_velocity(state)?;
        Ok(StepAndProject {
            integrator,
            next: State::new(zeros(state.q.as_ref().len())?, Covector(zeros(system.dim())?)),
            lambda: X::Numbers::clone(&projection.lambda),
            projection,
        })
    }
}

impl<I, M, P, S, K, C, X> ConstrainedIntegrator<C> for StepAndProject<'_, I, M, P, S, K, C, X>
where
    I: Integrator<C>,
    M: Metric,
    P: Potential,
    S: Space,
    K: Constraint,
    C: Storage,
    X: Multipliers,
{
    fn facts(&self) -> Facts {
        Facts {
            name: "step-and-project",
            order: 1,
            symmetric: false,
            symplecticity: Symplecticity::No,
            energy: EnergyBehavior::Decays,
            angular_momentum: Conservation::ToOrder,
            ..self.integrator.facts()
        }
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<ConstrainedReport, ConstraintError> {
        check_step(h)?;
        check_time(state.t)?;
        let StepAndProject { integrator, projection, next, lambda } = self;
        next.clone_from(state);
        let free = integrator.step(next, h)?;
        let report = projection.project_configuration(next)?;
        projection.add_momentum_of_displacement(h, next);
        projection.project_velocity(next)?;
        check_finite(next)?;
        let work = projection.work(h, next)?;
        let impulses = projection.lambda.as_ref().iter().zip(projection.impulse.as_ref());
        for (lambda, (a, b)) in lambda.as_mut().iter_mut().zip(impulses) {
            *lambda = (a / h + b) / h;
        }
        std::mem::swap(state, next);
        Ok(ConstrainedReport {
            differentials: free.differentials,
            iterations: report.iterations,
            violation: report.violation,
            work,
            halvings: 0,
        })
    }

    fn multipliers(&self) -> &[f64] {
        self.lambda.as_ref()
    }

    fn save(&self) -> Saved {
        self.integrator.save()
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.integrator.load(saved)
    }
}
