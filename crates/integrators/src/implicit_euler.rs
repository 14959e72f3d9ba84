//! Implicit Euler: follow the vector field at the end of the step.
//!
//! ```text
//! q' = q + h M^-1 p'
//! p' = p - h dV(q')            M (q' - q - h M^-1 p) + h^2 dV(q') = 0
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 1, implicit. Keeps linear momentum only. Damps: an oscillator keeps the part
//! `1 / (1 + (h omega)^2)` of its energy a step, so that the error saturates at the size of the
//! motion; see `implicit_euler_divides_the_energy_of_an_oscillator_at_every_step`.
//! Stable at every step on linear systems; a step of a nonlinear one may have several solutions, of
//! which Newton's method finds one near the drifted configuration. Source: notes 4.3-4.4, errata 4.

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
    name: "implicit-euler",
    order: 1,
    stages: 1,
    evaluation: Evaluation::Implicit,
    symmetric: false,
    symplecticity: Symplecticity::No,
    energy: EnergyBehavior::Decays,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::ToOrder,
    stability: Stability::Always,
    damping: Damping::LStable,
    error_growth: ErrorGrowth::Saturates,
};

/// The implicit Euler method.
#[derive(Clone, Debug)]
pub struct ImplicitEuler<'s, M, P, C, L = DenseSolver<C>> {
    stage: Stage<'s, M, P, C, L>,
    velocity: Vector<C>,
    next: State<C>,
}

implicit_method!(ImplicitEuler);

impl<M: Metric, P: Potential, C: Storage, L: HessianSolver> Integrator<C>
    for ImplicitEuler<'_, M, P, C, L>
{
    fn facts(&self) -> Facts {
        FACTS
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let ImplicitEuler { stage, velocity, next } = self;
        let system = stage.system();
        check_step(state, system.dim(), h)?;
        state.step(next, h, |_, State { q, p, .. }| {
            system.metric().sharp(p.view(), velocity.view_mut());
            system.space().advance(q.as_mut(), h, velocity.view());
            stage.y().clone_from(q);
            let mut report = stage.solve(q, h * h)?;
            let dv = stage.differential_at(q, &mut report.differentials);
            p.add_scaled(-h, dv.view());
            Ok(report)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::oscillator;

    #[test]
    fn implicit_euler_divides_the_energy_of_an_oscillator_at_every_step() {
        let problem = oscillator(1.0).unwrap();
        for h in [1e-3, 0.1, 1.0, 100.0] {
            let mut state = problem.initial.clone();
            let mut method = ImplicitEuler::new(&problem.system).unwrap();
            let mut energy = problem.energy(&state);
            for _ in 0..20 {
                method.step(&mut state, h).unwrap();
                let next = problem.energy(&state);
                assert!((next * (1.0 + h * h) / energy - 1.0).abs() < 1e-12);
                energy = next;
            }
        }
    }
}
