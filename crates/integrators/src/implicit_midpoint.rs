//! The implicit midpoint rule: follow the vector field in the middle of the step.
//!
//! ```text
//! m  = (q + q')/2
//! p' = p - h dV(m)
//! q' = q + h M^-1 (p + p')/2     M (m - y) + h^2/4 dV(m) = 0,  y = q + h/2 M^-1 p
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 2, implicit, symmetric, symplectic. Keeps linear and angular momentum, and every other
//! quadratic invariant, to rounding. On linear systems an oscillator keeps its energy at any step;
//! on nonlinear ones stability is conditional even if every step is solved to rounding: see
//! `the_implicit_midpoint_rule_fails_on_a_swinging_stiff_spring`. Source: notes 4.3, errata 4.5.

use stationary_calculus::{
    DenseSolver, HessianSolver, Metric, Newton, Potential, SizeError, Space, Storage, System,
    Vector,
};

use crate::integrator::{check_step, zeros};
use crate::stage::{Stage, implicit_method};
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "implicit-midpoint",
    order: 2,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: true,
    symplecticity: Symplecticity::Symplectic,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::Exact,
    stability: Stability::Always,
    damping: Damping::AStable,
    error_growth: ErrorGrowth::Linear,
};

/// The implicit midpoint rule.
#[derive(Clone, Debug)]
pub struct ImplicitMidpoint<'s, M, P, C, L = DenseSolver<C>> {
    stage: Stage<'s, M, P, C, L>,
    velocity: Vector<C>,
    next: State<C>,
}

implicit_method!(ImplicitMidpoint);

impl<M: Metric, P: Potential, C: Storage, L: HessianSolver> Integrator<C>
    for ImplicitMidpoint<'_, M, P, C, L>
{
    fn facts(&self) -> Facts {
        FACTS
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let ImplicitMidpoint { stage, velocity, next } = self;
        let system = stage.system();
        check_step(state, system.dim(), h)?;
        state.step(next, h, |start, State { q, p, .. }| {
            system.metric().sharp(p.view(), velocity.view_mut());
            system.space().advance(q.as_mut(), 0.5 * h, velocity.view());
            stage.y().clone_from(q);
            let mut report = stage.solve(q, 0.25 * h * h)?;
            let dv = stage.differential_at(q, &mut report.differentials);
            p.add_scaled(-0.5 * h, dv.view());
            system.metric().sharp(p.view(), velocity.view_mut());
            p.add_scaled(-0.5 * h, dv.view());
            q.clone_from(&start.q);
            system.space().advance(q.as_mut(), h, velocity.view());
            Ok(report)
        })
    }
}
