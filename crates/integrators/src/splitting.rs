//! Kicks and drifts: the two exact flows that explicit symplectic methods are composed of.
//!
//! ```text
//! kick    p <- p - h dV(q)          the flow of the potential energy alone
//! drift   q <- q + h M^-1 p         the flow of the kinetic energy alone
//! ```
//! They act on a copy of the state, which [`Splitting::finish`] hands over if it is finite.

use stationary_calculus::{Metric, Potential, SizeError, Space, Storage, System, Vector};

use crate::integrator::{Remembered, check_step, zeros};
use crate::{State, StepError, StepReport};

/// A system and the memory that kicks and drifts need.
#[derive(Clone, Debug)]
pub(crate) struct Splitting<'s, M, P, C> {
    system: &'s System<M, P>,
    differential: Remembered<C>,
    velocity: Vector<C>,
    next: State<C>,
    report: StepReport,
}

impl<'s, M: Metric, P: Potential, C: Storage> Splitting<'s, M, P, C> {
    pub(crate) fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        let n = system.dim();
        Ok(Splitting {
            system,
            differential: Remembered::new(n)?,
            velocity: Vector(zeros(n)?),
            next: State::new(zeros(n)?, zeros(n)?),
            report: StepReport::default(),
        })
    }

    #[inline]
    pub(crate) fn begin(&mut self, state: &State<C>, h: f64) -> Result<(), StepError> {
        check_step(state, self.system.dim(), h)?;
        self.next.clone_from(state);
        self.report = StepReport::default();
        Ok(())
    }

    #[inline]
    pub(crate) fn kick(&mut self, h: f64) {
        let evaluations = &mut self.report.differentials;
        let dv = self.differential.at(self.system.potential(), &self.next.q, evaluations);
        self.next.p.add_scaled(-h, dv.view());
    }

    #[inline]
    pub(crate) fn drift(&mut self, h: f64) {
        self.system.metric().sharp(self.next.p.view(), self.velocity.view_mut());
        self.system.space().advance(self.next.q.as_mut(), h, self.velocity.view());
    }

    /// A kick and a drift that both start from the same state.
    #[inline]
    pub(crate) fn kick_and_drift_at_once(&mut self, h: f64) {
        self.system.metric().sharp(self.next.p.view(), self.velocity.view_mut());
        self.kick(h);
        self.system.space().advance(self.next.q.as_mut(), h, self.velocity.view());
    }

    #[inline]
    pub(crate) fn finish(&mut self, state: &mut State<C>) -> Result<StepReport, StepError> {
        state.accept(&mut self.next)?;
        Ok(self.report)
    }
}
