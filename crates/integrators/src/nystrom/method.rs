//! A Runge-Kutta-Nystrom pair as one adaptive method among the others.
//!
//! ```text
//! y = (q, p),      t and 2 n numbers that go on from step to step
//! ```
//! `q` the configuration (n), `p` the momentum (n). Events, output times, saving and loading are those
//! of every [`AdaptiveMethod`]. The state is stored by the caller's choice, the stages on the heap,
//! taken once.

use stationary_calculus::{Covector, Metric, Potential, SizeError, Storage, System};

use super::solver::LOOSEST;
use super::step::within;
use super::{Nystrom, NystromPair, Pair8, Pair12};
use crate::{
    AdaptiveError, AdaptiveMethod, Damping, Evaluation, FirstOrderFacts, Moment, State,
    StepControl, Work,
};

/// The pair `T` of `S` stages on a system, standing at a moment y = (q, p).
#[derive(Clone, Debug)]
pub struct NystromMethod<'s, T, M, P, Y, const S: usize> {
    steps: Nystrom<'s, T, M, P, Vec<f64>, S>,
    state: State<Vec<f64>>,
    moment: Moment<Y>,
    inside: State<Vec<f64>>,
    last_begin: Option<f64>,
    work: Work,
}

/// The pair of order 8 as an adaptive method.
pub type NystromMethod8<'s, M, P, Y> = NystromMethod<'s, Pair8, M, P, Y, 9>;
/// The pair of order 12 as an adaptive method.
pub type NystromMethod12<'s, M, P, Y> = NystromMethod<'s, Pair12, M, P, Y, 17>;

impl<'s, T, M, P, Y, const S: usize> NystromMethod<'s, T, M, P, Y, S>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    Y: Storage,
{
    /// The method on a system of n freedoms, starting from a moment of 2 n numbers (q, p).
    ///
    /// # Errors
    /// A moment of another size or not finite, dV there, and another number of tolerances than 1 or
    /// 2 n.
    pub fn new(
        system: &'s System<M, P>,
        control: StepControl,
        start: Moment<Y>,
    ) -> Result<Self, AdaptiveError> {
        let zero = vec![0.0; system.dim()];
        let state = State::new(zero.clone(), Covector(zero));
        let mut method = NystromMethod {
            steps: Nystrom::new(system, control)?,
            inside: state.clone(),
            state,
            moment: start.clone(),
            last_begin: None,
            work: Work::default(),
        };
        method.restart(&start)?;
        Ok(method)
    }

    fn dim(&self) -> usize {
        2 * self.state.q.len()
    }
}

/// Takes a state from a moment.
fn read(state: &mut State<Vec<f64>>, moment: &Moment<impl Storage>) {
    let (q, p) = moment.y.as_ref().split_at(state.q.len());
    state.q.copy_from_slice(q);
    state.p.components_mut().copy_from_slice(p);
    state.t = moment.t;
}

/// Writes (q, p).
fn write(state: &State<Vec<f64>>, y: &mut [f64]) {
    let (q, p) = y.split_at_mut(state.q.len());
    q.copy_from_slice(&state.q);
    p.copy_from_slice(state.p.components());
}

impl<T, M, P, Y, const S: usize> AdaptiveMethod<Y> for NystromMethod<'_, T, M, P, Y, S>
where
    T: NystromPair<S>,
    M: Metric,
    P: Potential,
    Y: Storage,
{
    fn facts(&self) -> FirstOrderFacts {
        let stages = S as u32 - u32::from(T::FIRST_SAME_AS_LAST);
        FirstOrderFacts {
            name: T::NAME,
            order: T::ORDERS.0,
            dense_order: T::ORDERS.0,
            stages,
            dense_stages: S as u32 - 1,
            evaluation: Evaluation::Explicit,
            loosest: LOOSEST,
            damping: Damping::Conditional,
            sector: 0.0,
        }
    }

    fn moment(&self) -> &Moment<Y> {
        &self.moment
    }

    fn work(&self) -> &Work {
        &self.work
    }

    fn step(&mut self, end: f64) -> Result<(), AdaptiveError> {
        super::solver::check_end(self.state.t, end)?;
        // What the last step began with is overwritten: a failure leaves nothing to look into.
        if self.last_begin.take().is_some() {
            self.steps.go_on();
        }
        let begin = self.state.t;
        self.steps.step(&mut self.state, end, &mut self.work)?;
        self.last_begin = Some(begin);
        self.moment.t = self.state.t;
        write(&self.state, self.moment.y.as_mut());
        Ok(())
    }

    fn last_begin(&self) -> Option<f64> {
        self.last_begin
    }

    fn write_inside(&mut self, t: f64, y: &mut [f64]) -> Result<(), AdaptiveError> {
        let Nystrom { stages, other, first, .. } = &mut self.steps;
        let ends = [&*other, &self.state];
        self.work.evaluations += within(stages, ends, first, t, &mut self.inside)?;
        write(&self.inside, y);
        Ok(())
    }

    fn restart(&mut self, moment: &Moment<Y>) -> Result<(), AdaptiveError> {
        SizeError::check("the state's numbers", self.dim(), moment.y.as_ref().len())?;
        moment.check(self.dim())?;
        read(&mut self.inside, moment);
        self.steps.begin(&self.inside, &mut self.work)?;
        self.state.clone_from(&self.inside);
        self.moment.clone_from(moment);
        self.last_begin = None;
        Ok(())
    }

    fn visit(&mut self, visit: &mut dyn FnMut(&mut f64)) {
        visit(&mut self.moment.t);
        self.moment.y.as_mut().iter_mut().for_each(&mut *visit);
        visit(&mut self.steps.h);
        self.steps.trend.visit(visit);
        self.work.visit(visit);
    }

    fn settle(&mut self) -> Result<(), AdaptiveError> {
        self.moment.check(self.dim())?;
        if self.steps.h.is_nan() || self.steps.h <= 0.0 {
            return Err(AdaptiveError::Saved("its step is not positive"));
        }
        if !self.steps.trend.is_possible() {
            return Err(AdaptiveError::Saved("no steps leave such a trend behind"));
        }
        self.last_begin = None;
        read(&mut self.state, &self.moment);
        let Nystrom { stages, first, .. } = &mut self.steps;
        stages.differential_at(&self.state.q, first);
        crate::first_order::check_finite("dV", self.moment.t, first.components())
    }
}
