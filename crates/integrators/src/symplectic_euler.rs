//! Symplectic Euler: a kick and a drift, in either order.
//!
//! ```text
//! drift, then kick        q' = q + h M^-1 p,    p' = p - h dV(q')
//! kick, then drift        p' = p - h dV(q),     q' = q + h M^-1 p'
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 1, explicit, symplectic, not symmetric: each is the other's adjoint. Keeps linear and
//! angular momentum to rounding. Unstable on an oscillator once `h omega > 2`: see
//! `explicit_symplectic_methods_are_unstable_above_two_over_omega`.
//! Source: notes 4.3, where drift-kick is printed under the name of velocity Verlet; errata 4.3.

use stationary_calculus::{Metric, Potential, SizeError, Storage, System};

use crate::splitting::Splitting;
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// What the two have in common.
const SYMPLECTIC_EULER: Facts = Facts {
    name: "symplectic-euler",
    order: 1,
    stages: 1,
    evaluation: Evaluation::Explicit,
    symmetric: false,
    symplecticity: Symplecticity::Symplectic,
    energy: EnergyBehavior::Bounded,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::Exact,
    stability: Stability::Below(2.0),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// What is known of the method that drifts first.
pub(crate) const DRIFT_KICK: Facts =
    Facts { name: "symplectic-euler-drift-kick", ..SYMPLECTIC_EULER };

/// What is known of the method that kicks first.
pub(crate) const KICK_DRIFT: Facts =
    Facts { name: "symplectic-euler-kick-drift", ..SYMPLECTIC_EULER };

/// Symplectic Euler that drifts first.
#[derive(Clone, Debug)]
pub struct SymplecticEulerDriftKick<'s, M, P, C>(Splitting<'s, M, P, C>);

impl<'s, M: Metric, P: Potential, C: Storage> SymplecticEulerDriftKick<'s, M, P, C> {
    /// The method on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        Ok(SymplecticEulerDriftKick(Splitting::new(system)?))
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for SymplecticEulerDriftKick<'_, M, P, C> {
    fn facts(&self) -> Facts {
        DRIFT_KICK
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let mut phase = self.0.begin(state, h)?;
        phase.drift(h);
        phase.kick(h);
        phase.finish(state, h)
    }
}

/// Symplectic Euler that kicks first.
#[derive(Clone, Debug)]
pub struct SymplecticEulerKickDrift<'s, M, P, C>(Splitting<'s, M, P, C>);

impl<'s, M: Metric, P: Potential, C: Storage> SymplecticEulerKickDrift<'s, M, P, C> {
    /// The method on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        Ok(SymplecticEulerKickDrift(Splitting::new(system)?))
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for SymplecticEulerKickDrift<'_, M, P, C> {
    fn facts(&self) -> Facts {
        KICK_DRIFT
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let mut phase = self.0.begin(state, h)?;
        phase.kick(h);
        phase.drift(h);
        phase.finish(state, h)
    }
}
