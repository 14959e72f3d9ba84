//! The classical Runge-Kutta method of order 4.
//!
//! ```text
//! k1 = f(y)    k2 = f(y + h/2 k1)    k3 = f(y + h/2 k2)    k4 = f(y + h k3)
//! y' = y + h/6 (k1 + 2 k2 + 2 k3 + k4),        y = (q, p),  f(y) = (M^-1 p, -dV(q))
//! ```
//! `q` configuration (n), `p` momentum covector (n), `M` the metric, `h` step in seconds.
//! Order 4, explicit, four differentials a step; neither symmetric nor symplectic. Keeps linear
//! momentum to rounding. Damps an oscillator while `h omega < 2 sqrt 2` and blows it up above; its
//! angular momentum drifts, as does its energy, with the order of the method: see
//! `runge_kutta_4_is_unstable_above_two_root_two_over_omega`.
//! Source: notes 4.3 names it without a formula; Kutta 1901. The notes' table of 4.5 calls it
//! unstable, which it is not: errata 4.5.

use stationary_calculus::{Covector, Metric, Potential, SizeError, Space, Storage, System, Vector};

use crate::integrator::{check_step, zeros};
use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Integrator, Stability,
    State, StepError, StepReport, Symplecticity,
};

/// What is known of the method.
pub(crate) const FACTS: Facts = Facts {
    name: "runge-kutta-4",
    order: 4,
    stages: 4,
    evaluation: Evaluation::Explicit,
    symmetric: false,
    symplecticity: Symplecticity::No,
    energy: EnergyBehavior::Decays,
    linear_momentum: Conservation::Exact,
    angular_momentum: Conservation::ToOrder,
    stability: Stability::Below(2.0 * std::f64::consts::SQRT_2),
    damping: Damping::Conditional,
    error_growth: ErrorGrowth::Linear,
};

/// The classical Runge-Kutta method of order 4.
#[derive(Clone, Debug)]
pub struct RungeKutta4<'s, M, P, C> {
    system: &'s System<M, P>,
    displacement: Vector<C>,
    differential: Covector<C>,
    stage: State<C>,
    next: State<C>,
}

impl<'s, M: Metric, P: Potential, C: Storage> RungeKutta4<'s, M, P, C> {
    /// The method on a system.
    ///
    /// # Errors
    /// [`SizeError`] for a storage of another size than the system's.
    pub fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        let n = system.dim();
        Ok(RungeKutta4 {
            system,
            displacement: Vector(zeros(n)?),
            differential: Covector(zeros(n)?),
            stage: State::new(zeros(n)?, Covector(zeros(n)?)),
            next: State::new(zeros(n)?, Covector(zeros(n)?)),
        })
    }
}

/// The stages of a step under way: `stage` where the field is evaluated, `next` where it adds up.
struct Stages<'a, M, P, C> {
    system: &'a System<M, P>,
    start: &'a State<C>,
    displacement: Vector<C>,
    differential: Covector<C>,
    stage: State<C>,
    next: State<C>,
}

impl<M: Metric, P: Potential, C: Storage> Stages<'_, M, P, C> {
    /// How far the momentum of `stage` drifts in the time h.
    #[inline]
    fn drift(&mut self, h: f64) {
        self.system.metric().drift(h, self.stage.p.view(), self.displacement.view_mut());
    }

    /// Evaluates the field at `stage` and adds it to `next` with this weight.
    #[inline]
    fn add(&mut self, weight: f64) {
        self.drift(weight);
        self.differential.clear();
        let dv = self.differential.view_mut();
        self.system.potential().add_differential(self.stage.q.as_ref(), dv);
        self.system.space().advance(self.next.q.as_mut(), 1.0, self.displacement.view());
        self.next.p.add_scaled(-weight, self.differential.view());
    }

    /// Puts `stage` at the start moved along the field evaluated last.
    #[inline]
    fn place(&mut self, h: f64) {
        self.drift(h);
        self.stage.clone_from(self.start);
        self.system.space().advance(self.stage.q.as_mut(), 1.0, self.displacement.view());
        self.stage.p.add_scaled(-h, self.differential.view());
    }
}

impl<M: Metric, P: Potential, C: Storage> Integrator<C> for RungeKutta4<'_, M, P, C> {
    fn facts(&self) -> Facts {
        FACTS
    }

    #[inline]
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        check_step(state, self.system.dim(), h)?;
        let mut stages = Stages {
            system: self.system,
            start: state,
            displacement: Vector(self.displacement.0.lend()),
            differential: Covector(self.differential.0.lend()),
            stage: self.stage.lend(),
            next: self.next.lend(),
        };
        stages.stage.clone_from(state);
        stages.next.clone_from(state);
        stages.add(h / 6.0);
        stages.place(h / 2.0);
        stages.add(h / 3.0);
        stages.place(h / 2.0);
        stages.add(h / 3.0);
        stages.place(h);
        stages.add(h / 6.0);
        let Stages { displacement, differential, stage, mut next, .. } = stages;
        let accepted = state.accept(&mut next, h);
        self.displacement.0.put_back(displacement.0);
        self.differential.0.put_back(differential.0);
        self.stage.put_back(stage);
        self.next.put_back(next);
        accepted?;
        Ok(StepReport { differentials: 4, ..StepReport::default() })
    }
}
