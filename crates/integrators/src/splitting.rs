//! Kicks and drifts: the two exact flows that explicit symplectic methods are composed of.
//!
//! ```text
//! kick    p <- p - h dV(q)          the flow of the potential energy alone
//! drift   q <- q + h M^-1 p         the flow of the kinetic energy alone
//! ```
//! They act on a copy of the state, which [`Phase::finish`] hands over if it is finite. The copy and
//! all scratch memory are lent by value for the length of a step: a small state stays in registers.

use stationary_calculus::{Covector, Metric, Potential, SizeError, Space, Storage, System, Vector};

use crate::integrator::{Remembered, check_step, zeros};
use crate::{State, StepError, StepReport};

/// A system and the memory that kicks and drifts need.
#[derive(Clone, Debug)]
pub(crate) struct Splitting<'s, M, P, C> {
    system: &'s System<M, P>,
    remembered: Remembered<C>,
    differential: Covector<C>,
    displacement: Vector<C>,
    next: State<C>,
}

/// A step under way.
pub(crate) struct Phase<'a, 's, M, P, C> {
    splitting: &'a mut Splitting<'s, M, P, C>,
    differential: Covector<C>,
    displacement: Vector<C>,
    next: State<C>,
    differentials: u32,
}

impl<'s, M: Metric, P: Potential, C: Storage> Splitting<'s, M, P, C> {
    pub(crate) fn new(system: &'s System<M, P>) -> Result<Self, SizeError> {
        let n = system.dim();
        Ok(Splitting {
            system,
            remembered: Remembered::new(n)?,
            differential: Covector(zeros(n)?),
            displacement: Vector(zeros(n)?),
            next: State::new(zeros(n)?, Covector(zeros(n)?)),
        })
    }

    #[inline]
    pub(crate) fn begin(
        &mut self,
        state: &State<C>,
        h: f64,
    ) -> Result<Phase<'_, 's, M, P, C>, StepError> {
        check_step(state, self.system.dim(), h)?;
        let mut next = self.next.lend();
        next.clone_from(state);
        Ok(Phase {
            differential: Covector(self.differential.0.lend()),
            displacement: Vector(self.displacement.0.lend()),
            next,
            differentials: 0,
            splitting: self,
        })
    }
}

impl<M: Metric, P: Potential, C: Storage> Phase<'_, '_, M, P, C> {
    #[inline]
    pub(crate) fn kick(&mut self, h: f64) {
        self.differential.clear();
        let dv = self.differential.view_mut();
        self.splitting.system.potential().add_differential(self.next.q.as_ref(), dv);
        self.next.p.add_scaled(-h, self.differential.view());
        self.differentials += 1;
    }

    /// A kick with the last kick's differential, if it was at this very configuration.
    #[inline]
    pub(crate) fn kick_again(&mut self, h: f64) {
        let Splitting { system, remembered, .. } = &mut *self.splitting;
        let dv = remembered.at(system.potential(), &self.next.q, &mut self.differentials);
        self.next.p.add_scaled(-h, dv.view());
    }

    #[inline]
    pub(crate) fn drift(&mut self, h: f64) {
        let system = self.splitting.system;
        system.metric().drift(h, self.next.p.view(), self.displacement.view_mut());
        system.space().advance(self.next.q.as_mut(), 1.0, self.displacement.view());
    }

    /// A kick and a drift that both start from the same state.
    #[inline]
    pub(crate) fn kick_and_drift_at_once(&mut self, h: f64) {
        let system = self.splitting.system;
        system.metric().drift(h, self.next.p.view(), self.displacement.view_mut());
        self.kick(h);
        system.space().advance(self.next.q.as_mut(), 1.0, self.displacement.view());
    }

    #[inline]
    pub(crate) fn finish(mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let accepted = state.accept(&mut self.next, h);
        let Splitting { differential, displacement, next, .. } = self.splitting;
        differential.0.put_back(self.differential.0);
        displacement.0.put_back(self.displacement.0);
        next.put_back(self.next);
        accepted?;
        Ok(StepReport { differentials: self.differentials, ..StepReport::default() })
    }
}
