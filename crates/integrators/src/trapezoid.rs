//! The trapezoid rule: follow the mean of the vector field at both ends of the step.
//!
//! ```text
//! q' = q + h M^-1 (p + p')/2
//! p' = p - h (dV(q) + dV(q'))/2
//!                                M (q' - y) + h^2/4 dV(q') = 0,  y = q + h M^-1 (p - h/4 dV(q))
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 2, implicit, symmetric. Not symplectic itself, but conjugate to the implicit midpoint rule
//! by half an explicit Euler step, and so its energy stays bounded. Keeps linear momentum to
//! rounding, angular momentum for linear forces only: else that of (q, p) oscillates, while that of
//! the state moved by half an explicit Euler step is kept; see
//! `the_trapezoid_rule_keeps_angular_momentum_after_half_an_explicit_step`.
//! Source: notes 4.3; the notes' tables call it momentum-conserving and derive it from Hamilton's
//! principle, which does not give it: errata 4.5 and 5.

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
    name: "trapezoid",
    order: 2,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: true,
    symplecticity: Symplecticity::Conjugate,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::LinearForces,
    stability: Stability::Always,
    damping: Damping::AStable,
    error_growth: ErrorGrowth::Linear,
};

/// The trapezoid rule.
#[derive(Clone, Debug)]
pub struct Trapezoid<'s, M, P, C, L = DenseSolver<C>> {
    stage: Stage<'s, M, P, C, L>,
    velocity: Vector<C>,
    next: State<C>,
}

implicit_method!(Trapezoid);

impl<M: Metric, P: Potential, C: Storage, L: HessianSolver> Integrator<C>
    for Trapezoid<'_, M, P, C, L>
{
    fn facts(&self) -> Facts {
        FACTS
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let Trapezoid { stage, velocity, next } = self;
        let system = stage.system();
        check_step(state, system.dim(), h)?;
        state.step(next, h, |_, State { q, p, .. }| {
            let mut differentials = 0;
            let dv = stage.differential_at(q, &mut differentials);
            p.add_scaled(-0.25 * h, dv.view());
            system.metric().sharp(p.view(), velocity.view_mut());
            p.add_scaled(-0.25 * h, dv.view());
            system.space().advance(q.as_mut(), h, velocity.view());
            stage.y().clone_from(q);
            let mut report = stage.solve(q, 0.25 * h * h)?;
            report.differentials += differentials;
            let dv = stage.differential_at(q, &mut report.differentials);
            p.add_scaled(-0.5 * h, dv.view());
            Ok(report)
        })
    }
}
