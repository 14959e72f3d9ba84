//! Nystrom's method of order 4: a Runge-Kutta method for accelerations that depend on position
//! alone.
//!
//! ```text
//! f1 = f(q)    f2 = f(q + h/2 v + h^2/8 f1)    f3 = f(q + h v + h^2/2 f2)
//! q' = q + h v + h^2/6 (f1 + 2 f2),    v' = v + h/6 (f1 + 4 f2 + f3),     f(q) = -M^-1 dV(q)
//! ```
//! `q` configuration (n), `v = M^-1 p` velocity (n), `M` the metric, `h` step in seconds. Order 4,
//! explicit, three differentials a step where the classical Runge-Kutta method takes four; neither
//! symmetric nor symplectic. Keeps linear momentum to rounding. Damps an oscillator while `h omega
//! < 2.5865`, the root of `x^6 - 24 x^4 + 288 x^2 = 1152`, and blows it up above; energy and
//! angular momentum drift with the order of the method. Source: Nystrom 1925; Hairer, Norsett and
//! Wanner, Solving Ordinary Differential Equations I, II.14.

use stationary_calculus::{Covector, Metric, Potential, SizeError, Space, Storage, System, Vector};

use crate::integrator::{check_step, zeros};
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "nystrom-4",
    order: 4,
    stages: 3,
    evaluation: Evaluation::Explicit,
    symmetric: false,
    symplecticity: Symplecticity::No,
    energy: EnergyBehavior::Decays,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::ToOrder,
    stability: Stability::Below(2.586_518_894_519_56),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// Nystrom's method of order 4.
#[derive(Clone, Debug)]
pub struct Nystrom4<'s, M, P, C> {
    system: &'s System<M, P>,
    drift: Vector<C>,
    bend: Vector<C>,
    differential: Covector<C>,
    stage: C,
    next: State<C>,
}

impl<'s, M: Metric, P: Potential, C: Storage> Nystrom4<'s, M, P, C> {
    /// The method on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        let n = system.dim();
        Ok(Nystrom4 {
            system,
            drift: Vector(zeros(n)?),
            bend: Vector(zeros(n)?),
            differential: Covector(zeros(n)?),
            stage: zeros(n)?,
            next: State::new(zeros(n)?, Covector(zeros(n)?)),
        })
    }

    /// Evaluates dV at the stage and adds `-weight dV` to the momentum, `-weight reach M^-1 dV` to
    /// the configuration.
    fn add(&mut self, weight: f64, reach: f64) {
        let (system, next) = (self.system, &mut self.next);
        self.differential.clear();
        let dv = self.differential.view_mut();
        system.potential().add_differential(self.stage.as_ref(), dv);
        next.p.add_scaled(-weight, self.differential.view());
        system.metric().sharp(self.differential.view(), self.bend.view_mut());
        system.space().advance(next.q.as_mut(), -weight * reach, self.bend.view());
    }

    /// Puts the stage a part of the step ahead, bent by the acceleration evaluated last.
    fn place(&mut self, q: &C, part: f64, h: f64) {
        self.stage.clone_from(q);
        let space = self.system.space();
        space.advance(self.stage.as_mut(), part, self.drift.view());
        space.advance(self.stage.as_mut(), -0.5 * (part * h) * (part * h), self.bend.view());
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for Nystrom4<'_, M, P, C> {
    fn facts(&self) -> Facts {
        FACTS
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        check_step(state, self.system.dim(), h)?;
        self.next.clone_from(state);
        self.stage.clone_from(&state.q);
        self.system.metric().drift(h, state.p.view(), self.drift.view_mut());
        self.system.space().advance(self.next.q.as_mut(), 1.0, self.drift.view());
        self.add(h / 6.0, h);
        self.place(&state.q, 0.5, h);
        self.add(4.0 * h / 6.0, 0.5 * h);
        self.place(&state.q, 1.0, h);
        self.add(h / 6.0, 0.0);
        state.accept(&mut self.next, h)?;
        Ok(StepReport { differentials: 3, ..StepReport::default() })
    }
}
