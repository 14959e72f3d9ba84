//! Impulses: momentum that arrives at an instant, within a step or between two.
//!
//! ```text
//! p <- p + J        at the time t_J; q stays                                        (10.2, 10.3)
//! Phi_h  ->  Phi_(t + h - t_J) . (p <- p + J) . Phi_(t_J - t)       where t < t_J < t + h
//! ```
//! `J` an impulse, a covector (n) in units of momentum, newton seconds where q is a length. It is the
//! limit of a force J/tau over tau seconds: the two differ by O(tau). The step in which an impulse
//! falls is split there, into as many parts as it takes, so that the order of the method is kept.
//!
//! An impulse acts at the start of the step that begins with it: an observer at that instant sees
//! the momentum before. Impulses closer to a step's border than a billionth of the step count as on
//! it. At the end of the horizon there is no step left, and an impulse there is refused.
//! Source: notes 10.2, 10.3; errata 10.3 (its weights h^i), 10.2 (J is of the momentum's kind).

use std::ops::ControlFlow;

use stationary_calculus::{Covector, SizeError, Storage, first_non_finite};

use crate::integrator::zeros;
use crate::{
    Cost, Facts, Horizon, ImpulseError, Integrator, Observation, State, StepError, StepReport,
    simulate,
};

/// Momentum that arrives at an instant.
#[derive(Clone, Debug, PartialEq)]
pub struct Impulse<C> {
    /// When, seconds.
    pub time: f64,
    /// How much.
    pub momentum: Covector<C>,
}

/// Steps `state` to the horizon like [`simulate`], with impulses at their times, in ascending order.
/// Impulses before the first step that is left were for the steps that are done.
///
/// # Errors
/// Where an impulse is not finite, not of the state's size, out of order, or outside of the horizon;
/// and what [`simulate`] returns.
pub fn simulate_with_impulses<C: Storage, I: Integrator<C> + ?Sized>(
    integrator: &mut I,
    state: &mut State<C>,
    horizon: Horizon,
    impulses: &[Impulse<C>],
    observe: impl FnMut(Observation<'_, C>) -> ControlFlow<()>,
) -> Result<Cost, ImpulseError> {
    check(impulses, state, horizon)?;
    let (start, _) = horizon.span();
    let done = impulses.partition_point(|impulse| impulse.time < start - border(horizon.step()));
    let n = state.q.as_ref().len();
    let before = State::new(zeros(n)?, Covector(zeros(state.p.components().len())?));
    let mut struck = Struck { integrator, impulses, next: done, before };
    Ok(simulate(&mut struck, state, horizon, observe)?)
}

/// How far from a step's border an impulse may be to count as on it.
fn border(h: f64) -> f64 {
    1e-9 * h
}

fn check<C: Storage>(
    impulses: &[Impulse<C>],
    state: &State<C>,
    horizon: Horizon,
) -> Result<(), ImpulseError> {
    let first = horizon.time(0);
    let (_, end) = horizon.span();
    let slack = border(horizon.step());
    let mut last = f64::NEG_INFINITY;
    for (index, Impulse { time, momentum }) in impulses.iter().enumerate() {
        let (time, n) = (*time, state.p.components().len());
        SizeError::check("the impulse's components", n, momentum.components().len())?;
        if let Some(freedom) = first_non_finite(momentum.components()) {
            return Err(ImpulseError::NonFinite { index, freedom });
        }
        if !(time >= first - slack && time < end - slack) {
            return Err(ImpulseError::OutsideTheHorizon { index, time, start: first, end });
        }
        if time < last {
            return Err(ImpulseError::Unsorted { index, time, last });
        }
        last = time;
    }
    Ok(())
}

/// An integrator whose steps are split where impulses fall.
struct Struck<'a, I: ?Sized, C> {
    integrator: &'a mut I,
    impulses: &'a [Impulse<C>],
    next: usize,
    before: State<C>,
}

impl<C: Storage, I: Integrator<C> + ?Sized> Integrator<C> for Struck<'_, I, C> {
    fn facts(&self) -> Facts {
        self.integrator.facts()
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<StepReport, StepError> {
        let end = state.t + h;
        let due = |impulse: &&Impulse<C>| impulse.time < end - border(h);
        let count = self.impulses[self.next..].iter().take_while(due).count();
        if count == 0 {
            return self.integrator.step(state, h);
        }
        self.before.clone_from(state);
        let report = self.split(state, end, self.next + count);
        match report {
            Ok(_) => self.next += count,
            Err(_) => state.clone_from(&self.before),
        }
        report
    }
}

impl<C: Storage, I: Integrator<C> + ?Sized> Struck<'_, I, C> {
    /// Parts of a step up to `end`, with the impulses up to `last` between them.
    fn split(
        &mut self,
        state: &mut State<C>,
        end: f64,
        last: usize,
    ) -> Result<StepReport, StepError> {
        let mut report = StepReport::default();
        let shortest = border(end - state.t);
        for impulse in &self.impulses[self.next..last] {
            let wait = impulse.time - state.t;
            if wait > shortest {
                report = both(report, self.integrator.step(state, wait)?);
            }
            state.p.add_scaled(1.0, impulse.momentum.view());
        }
        Ok(both(report, self.integrator.step(state, end - state.t)?))
    }
}

/// What two parts of a step cost together.
fn both(a: StepReport, b: StepReport) -> StepReport {
    StepReport {
        differentials: a.differentials + b.differentials,
        hessians: a.hessians + b.hessians,
        energies: a.energies + b.energies,
        residual: a.residual.max(b.residual),
        rung: a.rung.max(b.rung),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{kepler, oscillator};
    use crate::{Method, StormerVerlet};

    fn at(time: f64, momentum: f64) -> Impulse<[f64; 1]> {
        Impulse { time, momentum: Covector([momentum]) }
    }

    /// The state of an oscillator that starts at rest at 1, after steps of 0.1 up to `end`.
    fn struck(
        method: Method,
        end: f64,
        h: f64,
        impulses: &[Impulse<[f64; 1]>],
    ) -> Result<State<[f64; 1]>, ImpulseError> {
        let problem = oscillator(1.0).unwrap();
        let mut integrator = method.integrator(&problem.system).unwrap();
        let mut state = problem.initial.clone();
        let horizon = Horizon::new(end, h).unwrap();
        let go_on = |_: Observation<'_, _>| ControlFlow::Continue(());
        simulate_with_impulses(&mut *integrator, &mut state, horizon, impulses, go_on)?;
        Ok(state)
    }

    /// cos t and, for each impulse, J sin(t - t_J).
    fn exact(t: f64, impulses: &[Impulse<[f64; 1]>]) -> f64 {
        let due = impulses.iter().filter(|impulse| impulse.time <= t);
        t.cos() + due.map(|i| i.momentum.0[0] * (t - i.time).sin()).sum::<f64>()
    }

    #[test]
    fn the_order_of_a_method_survives_impulses_within_steps() {
        let impulses = [at(0.0, 0.3), at(0.4321, 1.0), at(0.4322, -0.5), at(1.6, 0.7)];
        for method in [Method::StormerVerlet, Method::ImplicitMidpoint, Method::RungeKutta4] {
            let error = |h: f64| {
                let state = struck(method, 2.4, h, &impulses).unwrap();
                (state.q[0] - exact(2.4, &impulses)).abs()
            };
            let order = f64::from(method.facts().order);
            let measured = (error(0.025) / error(0.0125)).log2();
            assert!((measured - order).abs() < 0.25, "{method}: {measured}");
        }
    }

    #[test]
    fn an_impulse_on_a_border_is_given_once_and_needs_no_splitting() {
        let problem = oscillator(1.0).unwrap();
        // 3 times 0.1 is not 0.3 to the last bit.
        for time in [0.3, 3.0 * 0.1, 0.3 - 1e-12, 0.3 + 1e-12] {
            let state = struck(Method::StormerVerlet, 1.0, 0.1, &[at(time, 2.0)]).unwrap();
            let mut by_hand = problem.initial.clone();
            let mut verlet = StormerVerlet::new(&problem.system).unwrap();
            for step in 0..10 {
                by_hand.p.0[0] += if step == 3 { 2.0 } else { 0.0 };
                verlet.step(&mut by_hand, 0.1).unwrap();
            }
            assert!((state.q[0] - by_hand.q[0]).abs() < 1e-11, "at {time}");
            assert!((state.p.0[0] - by_hand.p.0[0]).abs() < 1e-11, "at {time}");
        }
    }

    #[test]
    fn impulses_at_one_instant_add_up() {
        let twice = [at(0.55, 0.4), at(0.55, 0.6)];
        let once = [at(0.55, 1.0)];
        let [a, b] = [&twice[..], &once].map(|i| struck(Method::StormerVerlet, 1.0, 0.1, i));
        assert!((a.unwrap().q[0] - b.unwrap().q[0]).abs() < 1e-15);
    }

    #[test]
    fn a_resumed_simulation_takes_up_the_impulses_that_are_left() {
        let problem = oscillator(1.0).unwrap();
        let impulses = [at(0.3, 1.0), at(0.5, 0.5), at(0.77, -0.2)];
        let horizon = Horizon::new(1.0, 0.1).unwrap();
        let run = |state: &mut State<[f64; 1]>, horizon, last| {
            let mut verlet = StormerVerlet::new(&problem.system).unwrap();
            let until = |now: Observation<'_, _>| match now.step == last {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            simulate_with_impulses(&mut verlet, state, horizon, &impulses, until).unwrap();
        };
        let (mut whole, mut parts) = (problem.initial.clone(), problem.initial.clone());
        run(&mut whole, horizon, 10);
        run(&mut parts, horizon, 5);
        run(&mut parts, horizon.resumed(5).unwrap(), 10);
        assert_eq!(whole, parts);
    }

    #[test]
    fn impulses_that_make_no_sense_are_refused() {
        let run = |impulses: &[Impulse<[f64; 1]>]| {
            struck(Method::StormerVerlet, 1.0, 0.1, impulses).unwrap_err()
        };
        let error = run(&[at(0.5, 1.0), at(0.2, 1.0)]);
        assert_eq!(error, ImpulseError::Unsorted { index: 1, time: 0.2, last: 0.5 });
        for time in [-0.1, 1.0, 1.1, f64::NAN, f64::INFINITY] {
            let error = run(&[at(time, 1.0)]);
            assert!(matches!(error, ImpulseError::OutsideTheHorizon { index: 0, .. }), "{error}");
        }
        let error = run(&[at(0.5, f64::NAN)]);
        assert_eq!(error, ImpulseError::NonFinite { index: 0, freedom: 0 });
        let problem = oscillator(1.0).unwrap();
        let mut verlet = StormerVerlet::new(&problem.system).unwrap();
        let mut state = State::new(vec![1.0], Covector(vec![0.0]));
        let wrong = [Impulse { time: 0.5, momentum: Covector(vec![1.0, 2.0]) }];
        let horizon = Horizon::new(1.0, 0.1).unwrap();
        let go_on = |_: Observation<'_, _>| ControlFlow::Continue(());
        let error = simulate_with_impulses(&mut verlet, &mut state, horizon, &wrong, go_on);
        assert!(matches!(error, Err(ImpulseError::Size(_))));
    }

    #[test]
    fn a_step_that_fails_after_an_impulse_leaves_the_state_as_it_was_before_it() {
        // Either impulse is finite, their sum is not.
        let planet = kepler(0.0).unwrap();
        let mut verlet = StormerVerlet::new(&planet.system).unwrap();
        let mut state = planet.initial.clone();
        let huge = |time| Impulse { time, momentum: Covector([f64::MAX; 2]) };
        let both = [huge(0.25), huge(0.25)];
        let horizon = Horizon::new(1.0, 0.1).unwrap();
        let mut last = state.clone();
        let error = simulate_with_impulses(&mut verlet, &mut state, horizon, &both, |now| {
            last.clone_from(now.state);
            ControlFlow::Continue(())
        })
        .unwrap_err();
        let ImpulseError::Simulation(error) = error else { panic!("{error}") };
        assert_eq!((error.step, &state), (3, &last));
    }
}
