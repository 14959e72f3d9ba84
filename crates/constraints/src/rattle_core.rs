//! What the methods with multipliers share: holding a configuration, then a velocity.
//!
//! ```text
//! p <- p - J(q0)^T Lambda,    (q1, p1) = Phi_h(q0, p),    g(t1, q1) = 0     Lambda an impulse (m)
//! p1 <- p1 - J(q1)^T Lambda,  J(q1) M^-1 p1 + dg/dt = 0
//! ```
//! `Phi` the free motion. The first is solved by iterations `S0 delta = g(q1) / h` with `S0 = J0
//! M^-1 J0^T`: Newton's method with J(q1) replaced by J(q0) and the motion by a straight one, so
//! that the factor which the last step's velocity needed serves again. It starts from the
//! unconstrained step and so finds the multipliers of smaller size where there are several; the
//! error shrinks by about h times the turning rate in an iteration, until rounding. The second is
//! linear, one solve.
//!
//! Source: notes 6.5; errata 6.5; Andersen (1983); Leimkuhler and Reich (2004), chapter 7.

use stationary_calculus::{
    Covector, Metric, Potential, SizeError, Space, Storage, System, Vector, first_non_finite,
};
use stationary_integrators::{State, StepError};

use crate::feasible::{Flight, Scales, rounding};
use crate::{Constraint, ConstraintError, FreeMotion, Multipliers, Solver};

/// More iterations than this are too long a step, or equations that contradict each other. A step at the
/// bound that [`Rattle`](crate::Rattle) states may gain no more than a tenth in each.
const ITERATIONS: u32 = 240;

/// Solves for a velocity that stays, at most.
const SOLVES: u32 = 3;

/// A configuration with what is known there.
#[derive(Clone, Debug)]
struct Place<C, X> {
    known: bool,
    t: f64,
    q: C,
    dv: Covector<C>,
    solver: X,
}

/// A system, its constraint, and the memory to keep it.
#[derive(Clone, Debug)]
pub(crate) struct RattleCore<'s, M, P, S, K, C, X: Multipliers, F> {
    system: &'s System<M, P, S>,
    pub(crate) constraint: K,
    pub(crate) motion: F,
    scales: Scales,
    here: Place<C, X>,
    there: Place<C, X>,
    g: X::Numbers,
    displacement: Vector<C>,
    /// The momentum at the start of a drift, with the impulses so far.
    before: Covector<C>,
    pub(crate) next: State<C>,
    /// The impulse of the last [`RattleCore::hold_configuration`] or [`RattleCore::hold_velocity`].
    pub(crate) impulse: X::Numbers,
    pub(crate) differentials: u32,
}

pub(crate) fn zeros<C: Storage>(n: usize) -> Result<C, ConstraintError> {
    let got = size_of::<C>() / size_of::<f64>();
    C::zeros(n).ok_or(SizeError { what: "the storage's numbers", expected: n, got }.into())
}

pub(crate) fn check_sizes<M: Metric, P: Potential, S: Space, C: Storage>(
    system: &System<M, P, S>,
    state: &State<C>,
) -> Result<(), ConstraintError> {
    let n = system.dim();
    let stored = system.space().stored(n);
    SizeError::check("the configuration's numbers", stored, state.q.as_ref().len())?;
    SizeError::check("the momentum's components", n, state.p.components().len())?;
    Ok(check_time(state.t)?)
}

/// An error unless the time is finite.
pub(crate) fn check_time(t: f64) -> Result<(), StepError> {
    if t.is_finite() { Ok(()) } else { Err(StepError::Time(t)) }
}

/// An error unless the state's numbers are finite and its configuration is one of the space.
pub(crate) fn check_state<S: Space, C: Storage>(
    space: &S,
    state: &State<C>,
) -> Result<(), ConstraintError> {
    for (what, numbers) in [("configuration", state.q.as_ref()), ("momentum", state.p.components())]
    {
        if let Some(index) = first_non_finite(numbers) {
            return Err(ConstraintError::NonFinite { what, index });
        }
    }
    check_configuration(space, state.q.as_ref())
}

/// An error unless the configuration is one of the space.
pub(crate) fn check_configuration(space: &impl Space, q: &[f64]) -> Result<(), ConstraintError> {
    match space.first_misfit(q) {
        Some(number) => Err(ConstraintError::Configuration { number }),
        None => Ok(()),
    }
}

impl<'s, M, P, S, K, C, X, F> RattleCore<'s, M, P, S, K, C, X, F>
where
    M: Metric,
    P: Potential,
    S: Space,
    K: Constraint,
    C: Storage,
    X: Multipliers,
    F: FreeMotion<M, S>,
{
    pub(crate) fn new(
        system: &'s System<M, P, S>,
        constraint: K,
        state: &State<C>,
        choice: &impl Solver<C, Multipliers = X>,
        motion: F,
    ) -> Result<Self, ConstraintError> {
        check_sizes(system, state)?;
        check_state(system.space(), state)?;
        let (n, stored) = (system.dim(), state.q.as_ref().len());
        let scales = Scales::new(&constraint)?;
        let solver = choice.analyse(system.metric(), &constraint, state.t, state.q.as_ref())?;
        let numbers = solver.numbers();
        let place =
            Place { known: false, t: state.t, q: zeros(stored)?, dv: Covector(zeros(n)?), solver };
        let mut core = RattleCore {
            system,
            constraint,
            motion,
            scales,
            there: place.clone(),
            here: place,
            g: numbers.clone(),
            displacement: Vector(zeros(n)?),
            before: Covector(zeros(n)?),
            next: State::new(zeros(stored)?, Covector(zeros(n)?)),
            impulse: numbers,
            differentials: 0,
        };
        core.begin(state)?;
        core.check_velocity(state)?;
        Ok(core)
    }

    /// The same core for another constraint.
    pub(crate) fn with_constraint(
        &mut self,
        constraint: K,
        state: &State<C>,
        choice: &impl Solver<C, Multipliers = X>,
    ) -> Result<(), ConstraintError>
    where
        F: Clone,
    {
        *self = RattleCore::new(self.system, constraint, state, choice, self.motion.clone())?;
        Ok(())
    }

    /// Starts a step: a copy of the state to work on, and what must be known where it is.
    pub(crate) fn begin(&mut self, state: &State<C>) -> Result<(), ConstraintError> {
        check_sizes(self.system, state)?;
        self.differentials = 0;
        let here = self.here.known && self.here.t == state.t && self.here.q == state.q;
        if !here {
            check_configuration(self.system.space(), state.q.as_ref())?;
            self.constraint.value(state.t, state.q.as_ref(), self.g.as_mut())?;
            self.scales.check(self.g.as_ref(), state.q.as_ref())?;
            self.examine(state.t, Some(&state.q))?;
            std::mem::swap(&mut self.here, &mut self.there);
        }
        self.next.clone_from(state);
        Ok(())
    }

    /// An error unless the velocity stays on the feasible set.
    pub(crate) fn check_velocity(&mut self, state: &State<C>) -> Result<(), ConstraintError> {
        self.system.metric().sharp(state.p.view(), self.displacement.view_mut());
        self.constraint.rate(state.t, state.q.as_ref(), self.g.as_mut())?;
        self.here.solver.add_along(self.displacement.view(), self.g.as_mut());
        self.scales.check_rates(self.g.as_ref(), self.displacement.components())
    }

    /// A kick with the differential where the step starts.
    pub(crate) fn kick_here(&mut self, h: f64) {
        self.next.p.add_scaled(-h, self.here.dv.view());
    }

    /// A kick with the differential where the step ends.
    pub(crate) fn kick_there(&mut self, h: f64) {
        self.next.p.add_scaled(-h, self.there.dv.view());
    }

    /// Drifts for the time h, with an impulse before it that makes the new configuration feasible;
    /// the iterations that were needed, and what is left of the violation.
    pub(crate) fn hold_configuration(&mut self, h: f64) -> Result<(u32, f64), ConstraintError> {
        let t = self.here.t + h;
        let q0 = &self.here.q;
        let State { q, p, .. } = &mut self.next;
        let (metric, space) = (self.system.metric(), self.system.space());
        let (g, impulse, before) = (self.g.as_mut(), self.impulse.as_mut(), &mut self.before);
        before.copy_from(p.view());
        impulse.fill(0.0);
        let mut iterations = 0;
        let mut last = f64::INFINITY;
        let mut flight = Flight::default();
        let eps = rounding(q0.as_ref());
        loop {
            q.clone_from(q0);
            p.copy_from(before.view());
            let room = self.displacement.view_mut();
            let interval = (self.here.t, h);
            self.motion.advance(metric, space, interval, q.as_mut(), p.view_mut(), room)?;
            self.constraint.value(t, q.as_ref(), g)?;
            let distance = self.scales.distance(g);
            if distance.is_nan() && iterations == 0 {
                return Err(ConstraintError::NonFinite { what: "constraint", index: 0 });
            }
            flight.check(&self.scales, g, self.here.solver.regularity())?;
            let feasible = self.scales.worst(g)?.excess <= eps;
            let stands_still = distance > 0.5 * last || iterations == ITERATIONS;
            if distance <= 0.25 * eps || (feasible && stands_still) {
                self.here.solver.share(impulse)?;
                return Ok((iterations, self.scales.largest_relative(g)));
            }
            if iterations == ITERATIONS {
                let row = self.scales.worst(g)?.row;
                let (violation, _) = self.scales.relative(row, g, q.as_ref());
                return Err(ConstraintError::NotConverged { iterations, row, violation });
            }
            last = distance;
            let per_time = h.recip();
            g.iter_mut().for_each(|g| *g *= per_time);
            self.here.solver.solve(g)?;
            self.here.solver.add_pulled_back(-1.0, g, before.view_mut());
            impulse.iter_mut().zip(&*g).for_each(|(sum, delta)| *sum += delta);
            iterations += 1;
        }
    }

    /// Evaluates everything where the drift has led, and examines the rank there.
    pub(crate) fn arrive(&mut self, h: f64) -> Result<(), ConstraintError> {
        self.examine(self.here.t + h, None)
    }

    /// Evaluates everything at a configuration, or at the next one.
    fn examine(&mut self, t: f64, q: Option<&C>) -> Result<(), ConstraintError> {
        let RattleCore { system, constraint, there, next, .. } = self;
        let q = q.unwrap_or(&next.q);
        there.known = false;
        there.t = t;
        there.q.clone_from(q);
        there.dv.clear();
        system.potential().add_differential(q.as_ref(), there.dv.view_mut());
        self.differentials += 1;
        there.solver.prepare(system.metric(), &*constraint, t, q.as_ref())?;
        there.known = true;
        Ok(())
    }

    /// An impulse that takes away the part of the velocity which leaves the feasible set.
    pub(crate) fn hold_velocity(&mut self) -> Result<(), ConstraintError> {
        let (p, there) = (&mut self.next.p, &mut self.there);
        let (impulse, g) = (self.impulse.as_mut(), self.g.as_mut());
        impulse.fill(0.0);
        // Once is enough but where masses differ by much: there roundings of one solve are removed by
        // another. Where equations share their force, what no force removes is an error.
        for solves in 0..=SOLVES {
            self.system.metric().sharp(p.view(), self.displacement.view_mut());
            self.constraint.rate(there.t, there.q.as_ref(), g)?;
            there.solver.add_along(self.displacement.view(), g);
            if solves > 0 {
                let checked = self.scales.check_rates(g, self.displacement.components());
                if checked.is_ok() || solves == SOLVES {
                    checked?;
                    return there.solver.share(impulse);
                }
            }
            there.solver.solve(g)?;
            there.solver.add_pulled_back(-1.0, g, p.view_mut());
            impulse.iter_mut().zip(&*g).for_each(|(sum, part)| *sum += part);
        }
        Ok(())
    }

    /// The work of an impulse at the start of the step, joules; zero unless something is driven.
    pub(crate) fn work_here(&mut self) -> Result<f64, SizeError> {
        work(&self.constraint, &self.here, self.impulse.as_ref(), self.g.as_mut())
    }

    /// The work of an impulse at the end of the step.
    pub(crate) fn work_there(&mut self) -> Result<f64, SizeError> {
        work(&self.constraint, &self.there, self.impulse.as_ref(), self.g.as_mut())
    }

    /// Hands the new state over if it is finite.
    pub(crate) fn finish(&mut self, state: &mut State<C>, h: f64) -> Result<(), ConstraintError> {
        check_finite(&self.next)?;
        check_time(state.t + h)?;
        self.next.t = state.t + h;
        std::mem::swap(state, &mut self.next);
        if self.there.known && self.there.q == state.q {
            std::mem::swap(&mut self.here, &mut self.there);
        }
        Ok(())
    }
}

/// `<Lambda, dg/dt>`: what an impulse `-J^T Lambda` does on a velocity with `J v = -dg/dt`.
fn work<C: Storage, X>(
    constraint: &impl Constraint,
    place: &Place<C, X>,
    impulse: &[f64],
    rate: &mut [f64],
) -> Result<f64, SizeError> {
    constraint.rate(place.t, place.q.as_ref(), rate)?;
    Ok(impulse.iter().zip(rate).map(|(impulse, rate)| impulse * *rate).sum())
}

/// An error that names the first number that is not finite.
pub(crate) fn check_finite<C: Storage>(state: &State<C>) -> Result<(), StepError> {
    if let Some(freedom) = stationary_calculus::first_non_finite(state.q.as_ref()) {
        return Err(StepError::NonFiniteConfiguration { freedom });
    }
    if let Some(freedom) = stationary_calculus::first_non_finite(state.p.components()) {
        return Err(StepError::NonFiniteMomentum { freedom });
    }
    Ok(())
}

/// An error unless the step is positive and finite.
pub(crate) fn check_step(h: f64) -> Result<(), StepError> {
    if h > 0.0 && h.is_finite() && h.recip().is_finite() { Ok(()) } else { Err(StepError::Step(h)) }
}
