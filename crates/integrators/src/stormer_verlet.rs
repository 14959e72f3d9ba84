//! Stormer-Verlet: half a kick, a drift, half a kick.
//!
//! ```text
//! p~ = p  - h/2 dV(q)
//! q' = q  + h M^-1 p~
//! p' = p~ - h/2 dV(q')
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 2, explicit, symmetric, symplectic; one differential a step, since the last kick's serves
//! the next step's first. Keeps linear and angular momentum to rounding. Unstable on an oscillator
//! once `h omega > 2`: see `explicit_symplectic_methods_are_unstable_above_two_over_omega`.
//!
//! A leapfrog that starts half a kick ahead, with `p + h/2 F(q)`, visits the same configurations.
//! Source: notes 4.3 (the "Velocity Verlet" printed there is symplectic Euler), errata chapter 4.

use stationary_calculus::{Metric, Potential, SizeError, Storage, System};

use crate::splitting::Splitting;
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "stormer-verlet",
    order: 2,
    stages: 1,
    evaluation: Evaluation::Explicit,
    symmetric: true,
    symplecticity: Symplecticity::Symplectic,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::Exact,
    stability: Stability::Below(2.0),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// The Stormer-Verlet method, kick-drift-kick.
#[derive(Clone, Debug)]
pub struct StormerVerlet<'s, M, P, C>(Splitting<'s, M, P, C>);

impl<'s, M: Metric, P: Potential, C: Storage> StormerVerlet<'s, M, P, C> {
    /// The method on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        Ok(StormerVerlet(Splitting::new(system)?))
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for StormerVerlet<'_, M, P, C> {
    fn facts(&self) -> Facts {
        FACTS
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let mut phase = self.0.begin(state, h)?;
        phase.kick_again(0.5 * h);
        phase.drift(h);
        phase.kick_again(0.5 * h);
        phase.finish(state, h)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::SymplecticEulerKickDrift;
    use crate::problems::kepler;

    #[test]
    fn a_leapfrog_that_starts_half_a_kick_ahead_visits_the_same_configurations() {
        let problem = kepler(0.6).unwrap();
        let h = 0.01;
        let mut state = problem.initial.clone();
        // Kick-drift kicks by all of h first; half of that kick is taken back.
        let mut leapfrog = problem.initial.clone();
        let mut dv = stationary_calculus::Covector([0.0; 2]);
        problem.system.potential().add_differential(&leapfrog.q, dv.view_mut());
        leapfrog.p.add_scaled(0.5 * h, dv.view());
        let mut verlet = StormerVerlet::new(&problem.system).unwrap();
        let mut kick_drift = SymplecticEulerKickDrift::new(&problem.system).unwrap();
        for _ in 0..1000 {
            verlet.step(&mut state, h).unwrap();
            kick_drift.step(&mut leapfrog, h).unwrap();
            for c in 0..2 {
                assert!((state.q[c] - leapfrog.q[c]).abs() < 1e-11);
            }
        }
    }
}
