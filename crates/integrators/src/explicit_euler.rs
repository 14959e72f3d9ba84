//! Explicit Euler: follow the vector field at the start of the step.
//!
//! ```text
//! q' = q + h M^-1 p
//! p' = p - h dV(q)
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 1, explicit. Keeps linear momentum, nothing else: an oscillator spirals out by the factor
//! `1 + (h omega)^2` of energy a step, at every h; see
//! `explicit_euler_multiplies_the_energy_of_an_oscillator_at_every_step`.
//! It is here because the notes begin with it, and to be compared with. Source: notes 4.3.

use stationary_calculus::{Metric, Potential, SizeError, Storage, System};

use crate::splitting::Splitting;
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "explicit-euler",
    order: 1,
    stages: 1,
    evaluation: Evaluation::Explicit,
    symmetric: false,
    symplecticity: Symplecticity::No,
    energy: EnergyBehavior::Grows,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::ToOrder,
    stability: Stability::Never,
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Exponential,
};

/// The explicit Euler method.
#[derive(Clone, Debug)]
pub struct ExplicitEuler<'s, M, P, C>(Splitting<'s, M, P, C>);

impl<'s, M: Metric, P: Potential, C: Storage> ExplicitEuler<'s, M, P, C> {
    /// The method on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        Ok(ExplicitEuler(Splitting::new(system)?))
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for ExplicitEuler<'_, M, P, C> {
    fn facts(&self) -> Facts {
        FACTS
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let mut phase = self.0.begin(state, h)?;
        phase.kick_and_drift_at_once(h);
        phase.finish(state, h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::oscillator;

    #[test]
    fn explicit_euler_multiplies_the_energy_of_an_oscillator_at_every_step() {
        let problem = oscillator(1.0).unwrap();
        for h in [1e-3, 0.1, 1.0] {
            let mut state = problem.initial.clone();
            let mut method = ExplicitEuler::new(&problem.system).unwrap();
            let mut energy = problem.energy(&state);
            for _ in 0..20 {
                method.step(&mut state, h).unwrap();
                let next = problem.energy(&state);
                assert!((next / energy - (1.0 + h * h)).abs() < 1e-14);
                energy = next;
            }
        }
    }
}
