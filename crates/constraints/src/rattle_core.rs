//! What the methods with multipliers share: holding a configuration, then a velocity.
//!
//! ```text
//! p <- p - J(q0)^T Lambda,    (q1, p1) = Phi_h(q0, p),    g(t1, q1) = 0     Lambda an impulse (m)
//! p1 <- p1 - J(q1)^T Lambda,  J(q1) M^-1 p1 + dg/dt = 0
//! ```
//! `Phi` the free motion. The first is solved by iterations `S0 delta = g(q1) / h` with `S0 = J0
//! M^-1 J0^T`: Newton's method with J(q1) replaced by J(q0) and the motion by a straight one, so
//! that the factor which the last step's velocity needed serves again. It starts from the impulse that
//! the last three steps lead to expect, or where equations depend on each other, a singular position is near or
//! no step is known, from the unconstrained step, and so finds the multipliers of smaller size where there are
//! several; the error shrinks by about h times the turning rate in an iteration, until rounding. The second is
//! linear, one solve.
//!
//! Source: notes 6.5; errata 6.5; Andersen (1983); Leimkuhler and Reich (2004), chapter 7.

mod passage;

use stationary_calculus::{
    Covector, Metric, Potential, Space, Storage, System, Vector, first_non_finite,
};
use stationary_integrators::{Saved, State, StepError};

use crate::checks::{
    check_configuration, check_finite, check_sizes, check_state, check_time, zeros,
};
use crate::feasible::{Flight, Scales};
use crate::secants::Secants;
use crate::warm_start::WarmStart;
use crate::{Constraint, ConstraintError, FreeMotion, Multipliers, Solver};
use passage::{CLOSE, NEAR, Passage};

/// More iterations than this are too long a step, or equations that contradict each other. A step at the
/// bound that [`Rattle`](crate::Rattle) states may gain no more than a tenth in each.
const ITERATIONS: u32 = 240;

/// Solves for a velocity that stays, at most.
const SOLVES: u32 = 3;

/// Iterations without gain after which learned moves have done what they can.
const PATIENCE: u32 = 6;
/// How often a move that makes values grow is shortened to a quarter.
const TRIES: u32 = 8;
/// A guess that violates an equation by more than this part of its length is none: from farther away iterations
/// might find another way in which a linkage closes.
const TRUSTED: f64 = 1e-3;
/// A place at least as regular as this part of the most regular one is not next to a singular position.
const FAR: f64 = 0.5;

/// A configuration with what is known there.
#[derive(Clone, Debug)]
struct Place<C, X: Multipliers> {
    known: bool,
    t: f64,
    q: C,
    dv: Covector<C>,
    /// dg/dt
    rate: X::Numbers,
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
    secants: Secants<X::Numbers>,
    warm: WarmStart<X::Numbers>,
    /// Whether the step that is being made was misled by it.
    misled: bool,
    /// The impulse at the start of the step that is being made.
    start: X::Numbers,
    passage: Passage<C>,
    displacement: Vector<C>,
    /// The momentum at the start of a drift, with the impulses so far.
    before: Covector<C>,
    pub(crate) next: State<C>,
    /// The impulse of the last [`RattleCore::hold_configuration`] or [`RattleCore::hold_velocity`].
    pub(crate) impulse: X::Numbers,
    pub(crate) differentials: u32,
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
        let scales = Scales::new(&constraint, system.metric())?;
        let solver = choice.analyse(system.metric(), &constraint, state.t, state.q.as_ref())?;
        let numbers = solver.numbers();
        let (q, dv, rate) = (zeros(stored)?, Covector(zeros(n)?), numbers.clone());
        let place = Place { known: false, t: state.t, q, dv, rate, solver };
        let mut core = RattleCore {
            system,
            constraint,
            motion,
            scales,
            there: place.clone(),
            here: place,
            g: numbers.clone(),
            secants: Secants::new(&numbers),
            warm: WarmStart::new(&numbers),
            misled: false,
            start: numbers.clone(),
            passage: Passage::new(n)?,
            displacement: Vector(zeros(n)?),
            before: Covector(zeros(n)?),
            next: State::new(zeros(stored)?, Covector(zeros(n)?)),
            impulse: numbers,
            differentials: 0,
        };
        core.begin(state)?;
        core.passage.see(core.here.solver.regularity());
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
        self.g.clone_from(&self.here.rate);
        self.here.solver.add_along(self.displacement.view(), self.g.as_mut());
        let accelerations = self.before.0.as_mut();
        self.system.metric().sharp(self.here.dv.view(), Vector(&mut *accelerations));
        self.scales.check_rates(self.g.as_ref(), self.displacement.components(), accelerations)
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
        let mut held = self.iterate(h, true);
        self.misled = held.is_err();
        if self.misled {
            self.next.p.copy_from(self.passage.before.view());
            held = self.iterate(h, false);
        }
        let error = match held {
            Err(error) => error,
            held => return held,
        };
        let of_iterations = matches!(
            error,
            ConstraintError::NotConverged { .. }
                | ConstraintError::Diverged { .. }
                | ConstraintError::Dependent { .. }
                | ConstraintError::Step(StepError::Newton(_))
        );
        let begun = (self.here.solver.regularity(), self.here.solver.redundant());
        if of_iterations && self.passage.is_singular(begun.0) {
            return Err(self.nearby_position());
        }
        // Of a start that is singular itself nothing regular was seen so far.
        if of_iterations && begun.1 > 0 && self.examine(self.here.t + h, None).is_ok() {
            let row = self.here.solver.weakest().map_or(0, |(row, _)| row);
            if self.there.solver.redundant() < begun.1 {
                return Err(self.position(0.0, vec![row]));
            }
        }
        Err(error)
    }

    /// The iterations, from the impulse that the last steps lead to expect if they are to be heard.
    fn iterate(&mut self, h: f64, warm: bool) -> Result<(u32, f64), ConstraintError> {
        let t = self.here.t + h;
        let q0 = &self.here.q;
        let State { q, p, .. } = &mut self.next;
        let (metric, space) = (self.system.metric(), self.system.space());
        let (g, impulse, before) = (self.g.as_mut(), self.impulse.as_mut(), &mut self.before);
        let secants = &mut self.secants;
        before.copy_from(p.view());
        self.passage.before.copy_from(p.view());
        secants.forget();
        let regularity = self.here.solver.regularity();
        // Near a singular position places matter that values hardly show.
        let thorough = regularity.is_some_and(|r| r < f64::max(CLOSE, NEAR * self.passage.typical));
        // Of dependent equations the shortest multipliers are those that no guess has lengthened; and a good
        // guess of impulses would hide what iterations show of a singular position that is reached.
        let far = regularity.is_none_or(|r| r >= FAR * self.passage.typical);
        let regular = far && !thorough && self.here.solver.redundant() == 0;
        let mut guessed = warm && regular && self.warm.guess((self.here.t, h), impulse);
        if guessed {
            self.here.solver.add_pulled_back(-1.0, impulse, before.view_mut());
        } else {
            impulse.fill(0.0);
        }
        let (mut iterations, mut tries, mut stale) = (0, 0, 0);
        let (mut last, mut best) = (f64::INFINITY, f64::INFINITY);
        let mut learning = false;
        let mut flight = Flight::default();
        let eps = self.scales.rounding(q0.as_ref());
        let enough = if regular { 0.5 * eps } else { 0.25 * eps };
        loop {
            q.clone_from(q0);
            p.copy_from(before.view());
            let room = self.displacement.view_mut();
            let interval = (self.here.t, h);
            self.motion.advance(metric, space, interval, q.as_mut(), p.view_mut(), room)?;
            self.constraint.value(t, q.as_ref(), g)?;
            let [distance, relative] = self.scales.largest(g);
            let near = relative <= TRUSTED;
            if std::mem::take(&mut guessed) && !near {
                before.copy_from(self.passage.before.view());
                impulse.fill(0.0);
                continue;
            }
            if distance.is_nan() && iterations == 0 {
                let index = first_non_finite(g).unwrap_or(0);
                return Err(ConstraintError::NonFinite { what: "constraint", index });
            }
            flight.check(&self.scales, (g, relative), regularity)?;
            let stands_still = distance > 0.5 * last;
            (best, stale) = if distance < 0.5 * best { (distance, 0) } else { (best, stale + 1) };
            let done = iterations == ITERATIONS
                || if learning {
                    stale >= PATIENCE && distance <= 2.0 * best
                } else {
                    stands_still && !thorough
                };
            if distance <= enough || (done && self.scales.worst(g)?.excess <= eps) {
                self.here.solver.share(impulse)?;
                self.passage.slow = learning;
                self.start.as_mut().copy_from_slice(impulse);
                return Ok((iterations, relative));
            }
            if iterations == ITERATIONS {
                let row = self.scales.worst(g)?.row;
                let (violation, _) = self.scales.relative(row, g, q.as_ref());
                return Err(ConstraintError::NotConverged { iterations, row, violation });
            }
            iterations += 1;
            if learning && distance > 2.0 * last && tries < TRIES {
                // Three quarters of the move are taken back.
                tries += 1;
                let moved = secants.last.as_mut();
                moved.iter_mut().for_each(|x| *x *= 0.75);
                self.here.solver.add_pulled_back(1.0, moved, before.view_mut());
                impulse.iter_mut().zip(&*moved).for_each(|(sum, part)| *sum -= part);
                moved.iter_mut().for_each(|x| *x /= 3.0);
                continue;
            }
            self.scales.scale(g);
            learning |= stands_still && iterations > 1;
            if learning {
                secants.learn(g);
            }
            (last, tries) = (distance, 0);
            secants.reduce(g);
            self.scales.unscale(g, h.recip());
            self.here.solver.solve(g)?;
            let moved = secants.last.as_mut();
            moved.iter_mut().zip(&*g).for_each(|(moved, step)| *moved += step);
            self.here.solver.add_pulled_back(-1.0, moved, before.view_mut());
            impulse.iter_mut().zip(&*moved).for_each(|(sum, delta)| *sum += delta);
        }
    }

    /// Evaluates everything where the drift has led, and examines the rank there: what was independent where
    /// the step began and is dependent here, or the other way, is a singular position.
    pub(crate) fn arrive(&mut self, h: f64) -> Result<(), ConstraintError> {
        if let Err(error) = self.examine(self.here.t + h, None) {
            return Err(match error {
                ConstraintError::Singular { ratio, row }
                | ConstraintError::RankUnclear { row, distance: ratio, .. } => {
                    self.position(ratio, vec![row])
                }
                // Equations that were independent where the step began.
                ConstraintError::Dependent { row } if self.here.solver.redundant() == 0 => {
                    let weakest = self.here.solver.weakest().map(|(row, _)| row);
                    self.position(0.0, row.or(weakest).into_iter().collect())
                }
                error => error,
            });
        }
        let (here, there) = (self.here.solver.redundant(), self.there.solver.redundant());
        if here == there {
            return Ok(());
        }
        let place = if here > there { &self.here } else { &self.there };
        let row = place.solver.weakest().map_or(0, |(row, _)| row);
        Err(self.position(0.0, vec![row]))
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
        constraint.rate(t, q.as_ref(), there.rate.as_mut())?;
        there.known = true;
        Ok(())
    }

    /// An impulse that takes away the part of the velocity which leaves the feasible set.
    pub(crate) fn hold_velocity(&mut self) -> Result<(), ConstraintError> {
        let (p, there) = (&mut self.next.p, &mut self.there);
        let (impulse, g) = (self.impulse.as_mut(), self.g.as_mut());
        impulse.fill(0.0);
        self.passage.after.copy_from(p.view());
        // Once is enough but where masses differ by much: there roundings of one solve are removed by
        // another. Where equations share their force, what no force removes is an error.
        let mut begun = 0.0;
        for solves in 0..=SOLVES {
            self.system.metric().sharp(p.view(), self.displacement.view_mut());
            g.copy_from_slice(there.rate.as_ref());
            there.solver.add_along(self.displacement.view(), g);
            if solves > 0 {
                let checked = self.scales.check_rates(g, self.displacement.components(), &[]);
                if checked.is_ok() || solves == SOLVES {
                    // What is held to rest may have no other velocity left than rounding.
                    if !self.scales.are_left_of(g, begun) {
                        checked?;
                    }
                    return there.solver.share(impulse);
                }
            }
            if solves == 0 {
                begun = self.scales.distance(g);
            }
            there.solver.solve(g)?;
            there.solver.add_pulled_back(-1.0, g, p.view_mut());
            impulse.iter_mut().zip(&*g).for_each(|(sum, part)| *sum += part);
        }
        Ok(())
    }

    /// The work of an impulse at the start of the step, joules; zero unless something is driven.
    pub(crate) fn work_here(&self) -> f64 {
        work::<X>(self.impulse.as_ref(), &self.here.rate)
    }

    /// The work of an impulse at the end of the step.
    pub(crate) fn work_there(&self) -> f64 {
        work::<X>(self.impulse.as_ref(), &self.there.rate)
    }

    /// What the next steps depend on beside the state: the regularity that was seen, and the last impulses.
    pub(crate) fn save(&self, method: &str) -> Saved {
        let mut numbers = vec![self.passage.typical];
        numbers.extend(self.warm.save());
        Saved { method: method.to_owned(), numbers }
    }

    /// Takes over what the method of this name had saved.
    pub(crate) fn load(&mut self, method: &str, saved: &Saved) -> Result<(), StepError> {
        if saved.method != method {
            return Err(StepError::Saved("it is another method's"));
        }
        let Some((&typical, impulses)) = saved.numbers.split_first() else {
            return Err(StepError::Saved("it has no regularity of the constraint"));
        };
        self.warm.load(impulses)?;
        self.passage.typical = typical;
        Ok(())
    }

    /// Hands the new state over if it is finite.
    pub(crate) fn finish(&mut self, state: &mut State<C>, h: f64) -> Result<(), ConstraintError> {
        check_finite(&self.next)?;
        check_time(state.t + h)?;
        self.next.t = state.t + h;
        // A step that is refused leaves what is known as it was.
        if self.misled {
            self.warm.forget();
        }
        self.warm.remember((state.t, h), self.start.as_ref(), self.impulse.as_ref());
        std::mem::swap(state, &mut self.next);
        self.motion.accept();
        self.passage.see(self.there.solver.regularity());
        if self.there.known && self.there.q == state.q {
            std::mem::swap(&mut self.here, &mut self.there);
        }
        Ok(())
    }
}

/// `<Lambda, dg/dt>`: what an impulse `-J^T Lambda` does on a velocity with `J v = -dg/dt`.
fn work<X: Multipliers>(impulse: &[f64], rate: &X::Numbers) -> f64 {
    impulse.iter().zip(rate.as_ref()).map(|(impulse, rate)| impulse * rate).sum()
}
