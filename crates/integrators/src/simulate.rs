//! A simulation: step after step to a horizon, with an observer that sees every one.
//!
//! ```text
//! (q, p) at t = t0 + i h,    i = 0, 1, ..., N,    N h = the duration
//! ```
//! Times are products, not sums, so that they do not drift. The observer may look at the state and
//! may end the simulation; it allocates only what it wants to. A state that was saved after k steps
//! goes on from there with [`Horizon::resumed`], to the same bits.

use std::ops::{ControlFlow, RangeInclusive};

use crate::{HorizonError, Integrator, ResumeError, SimulationError, State, StepError, StepReport};

/// A number of equal steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    start: f64,
    step: f64,
    steps: u64,
    done: u64,
}

/// How far from a whole number of steps a duration may be, relative to it: rounding, no more.
const WHOLE: f64 = 1e-9;
/// Steps beyond this cannot be counted one by one.
const COUNTABLE: f64 = (1_u64 << f64::MANTISSA_DIGITS) as f64;

impl Horizon {
    /// Steps of `step` seconds up to `duration` seconds, which must be a whole number of them.
    ///
    /// # Errors
    /// [`HorizonError::Step`] and [`HorizonError::Duration`] unless they are positive and finite;
    /// [`HorizonError::TooMany`] for more than 2^53 steps; [`HorizonError::NotWhole`] for a number
    /// of steps that is off a whole one by more than 1e-9 of it.
    pub fn new(duration: f64, step: f64) -> Result<Self, HorizonError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(HorizonError::Step(step));
        }
        check_duration(duration)?;
        let steps = duration / step;
        let whole = steps.round();
        if whole > COUNTABLE {
            return Err(HorizonError::TooMany { duration, step, steps });
        }
        if whole < 1.0 || (steps - whole).abs() > WHOLE * whole {
            return Err(HorizonError::NotWhole { duration, step, steps });
        }
        Ok(Horizon { start: 0.0, step: duration / whole, steps: whole as u64, done: 0 })
    }

    /// The duration in this many equal steps, at least one.
    ///
    /// # Errors
    /// [`HorizonError::Duration`] for a duration that is not positive and finite;
    /// [`HorizonError::Step`] where it is so short that a step is zero; [`HorizonError::TooMany`] for
    /// more than 2^53 steps; [`HorizonError::NotWhole`] where a step is so short that it is rounded.
    pub fn divided(duration: f64, steps: u64) -> Result<Self, HorizonError> {
        check_duration(duration)?;
        Horizon::new(duration, duration / steps.max(1) as f64)
    }

    /// The same steps from another time than zero.
    pub fn starting(self, start: f64) -> Self {
        Horizon { start, ..self }
    }

    /// The same steps without the first `done`, for the state that followed those.
    ///
    /// # Errors
    /// [`ResumeError`] where the horizon has fewer steps than that.
    pub fn resumed(self, done: u64) -> Result<Self, ResumeError> {
        let Horizon { steps, .. } = self;
        if done <= steps { Ok(Horizon { done, ..self }) } else { Err(ResumeError { done, steps }) }
    }

    /// The step, seconds.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The time after this many of the steps, seconds: a product.
    pub fn time(&self, step: u64) -> f64 {
        self.start + step as f64 * self.step
    }

    /// When the first step that is left begins, and when the last one ends, seconds.
    pub fn span(&self) -> (f64, f64) {
        (self.time(self.done), self.time(self.steps))
    }

    /// The steps that are left, counted from 1.
    pub(crate) fn left(&self) -> RangeInclusive<u64> {
        self.done + 1..=self.steps
    }

    /// The number of steps.
    pub fn steps(&self) -> u64 {
        self.steps
    }
}

fn check_duration(duration: f64) -> Result<(), HorizonError> {
    let positive = duration > 0.0 && duration.is_finite();
    if positive { Ok(()) } else { Err(HorizonError::Duration(duration)) }
}

/// What a simulation cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    /// Steps taken.
    pub steps: u64,
    /// Differentials of the potential evaluated.
    pub differentials: u64,
    /// Hessians of the potential evaluated, each one a factorization.
    pub hessians: u64,
    /// Energies evaluated by line searches.
    pub energies: u64,
    /// Most Newton iterations in one step.
    pub most_iterations: u32,
}

impl Cost {
    /// Adds a step.
    pub fn add(&mut self, report: &StepReport) {
        self.steps += 1;
        self.differentials += u64::from(report.differentials);
        self.hessians += u64::from(report.hessians);
        self.energies += u64::from(report.energies);
        self.most_iterations = self.most_iterations.max(report.hessians);
    }
}

/// What the observer sees after a step.
#[derive(Debug)]
pub struct Observation<'a, C> {
    /// The number of steps taken so far.
    pub step: u64,
    /// The state, with its time.
    pub state: &'a State<C>,
    /// What the step cost, and how it went.
    pub report: &'a StepReport,
}

/// Steps `state` to the horizon, or until the observer breaks off. The horizon sets the state's time.
/// On an error the state is that after the last good step.
///
/// # Errors
/// [`SimulationError`] with the step that failed and why, one of [`Integrator::step`]'s reasons;
/// [`StepError::Time`] before the first step of a horizon whose times are not finite, with the first
/// that is not: the start or the end.
pub fn simulate<C, I: Integrator<C> + ?Sized>(
    integrator: &mut I,
    state: &mut State<C>,
    horizon: Horizon,
    mut observe: impl FnMut(Observation<'_, C>) -> ControlFlow<()>,
) -> Result<Cost, SimulationError> {
    let mut cost = Cost::default();
    let (start, end) = horizon.span();
    if let Some(&time) = [start, end].iter().find(|time| !time.is_finite()) {
        let (step, source) = (horizon.done + 1, StepError::Time(time));
        return Err(SimulationError { step, time: state.t, source });
    }
    state.t = start;
    for step in horizon.left() {
        let time = state.t;
        let report = integrator.step(state, horizon.step).map_err(|source| SimulationError {
            step,
            time,
            source,
        })?;
        cost.add(&report);
        state.t = horizon.time(step);
        if observe(Observation { step, state, report: &report }).is_break() {
            break;
        }
    }
    Ok(cost)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::StormerVerlet;
    use crate::problems::kepler;

    #[test]
    fn a_resumed_simulation_ends_with_the_same_bits() {
        let planet = kepler(0.6).unwrap();
        let horizon = Horizon::new(3.0, 0.01).unwrap().starting(0.1);
        let run = |state: &mut State<[f64; 2]>, horizon, last| {
            let mut verlet = StormerVerlet::new(&planet.system).unwrap();
            let until = |now: Observation<'_, _>| match now.step == last {
                true => ControlFlow::Break(()),
                false => ControlFlow::Continue(()),
            };
            simulate(&mut verlet, state, horizon, until).unwrap();
        };
        let (mut whole, mut parts) = (planet.initial.clone(), planet.initial.clone());
        run(&mut whole, horizon, 300);
        run(&mut parts, horizon, 77);
        assert_ne!(whole, parts);
        run(&mut parts, horizon.resumed(77).unwrap(), 300);
        assert_eq!(whole, parts);
        assert_eq!(whole.t, 0.1 + 300.0 * 0.01);
    }

    #[test]
    fn a_horizon_is_not_resumed_beyond_its_end() {
        let horizon = Horizon::divided(1.0, 10).unwrap();
        assert_eq!(horizon.resumed(20), Err(ResumeError { done: 20, steps: 10 }));
        let planet = kepler(0.6).unwrap();
        let mut verlet = StormerVerlet::new(&planet.system).unwrap();
        let mut state = planet.initial.clone();
        let all = horizon.resumed(10).unwrap();
        let cost = simulate(&mut verlet, &mut state, all, |_| ControlFlow::Continue(()));
        assert_eq!((cost.unwrap().steps, state.t), (0, 1.0));
    }

    #[test]
    fn a_simulation_that_starts_at_no_time_is_refused_and_changes_nothing() {
        let planet = kepler(0.6).unwrap();
        for start in [f64::NAN, f64::INFINITY] {
            let horizon = Horizon::new(1.0, 0.1).unwrap().starting(start);
            let mut verlet = StormerVerlet::new(&planet.system).unwrap();
            let mut state = planet.initial.clone();
            let run = simulate(&mut verlet, &mut state, horizon, |_| ControlFlow::Continue(()));
            assert!(matches!(run.unwrap_err().source, StepError::Time(_)));
            assert_eq!(state, planet.initial);
        }
    }

    #[test]
    fn a_horizon_whose_end_alone_overflows_is_refused_with_its_end() {
        let planet = kepler(0.6).unwrap();
        let horizon = Horizon::new(1e308, 1e307).unwrap().starting(1e308);
        let mut verlet = StormerVerlet::new(&planet.system).unwrap();
        let mut state = planet.initial.clone();
        let run = simulate(&mut verlet, &mut state, horizon, |_| ControlFlow::Continue(()));
        assert_eq!(run.unwrap_err().source, StepError::Time(f64::INFINITY));
        assert_eq!(state, planet.initial);
    }

    #[test]
    fn a_bad_duration_is_named_however_it_is_divided() {
        for bad in [-1.0, 0.0, f64::INFINITY] {
            assert_eq!(Horizon::divided(bad, 10), Err(HorizonError::Duration(bad)));
            assert_eq!(Horizon::new(bad, 0.1), Err(HorizonError::Duration(bad)));
        }
        assert!(matches!(Horizon::divided(f64::NAN, 10), Err(HorizonError::Duration(_))));
        assert_eq!(Horizon::divided(5e-324, 10), Err(HorizonError::Step(0.0)));
    }

    #[test]
    fn a_horizon_that_is_not_a_number_of_steps_is_refused() {
        assert_eq!(Horizon::new(1.0, 0.1).unwrap().steps(), 10);
        assert_eq!(Horizon::new(0.3, 0.1).unwrap().steps(), 3);
        assert!(matches!(Horizon::new(1.0, 0.3), Err(HorizonError::NotWhole { .. })));
        assert!(matches!(Horizon::new(0.1, 1.0), Err(HorizonError::NotWhole { .. })));
        for step in [1e-16, f64::MIN_POSITIVE] {
            assert!(matches!(Horizon::new(1e300, step), Err(HorizonError::TooMany { .. })));
        }
        for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(Horizon::new(1.0, step), Err(HorizonError::Step(_))));
            assert!(matches!(Horizon::new(step, 0.1), Err(HorizonError::Duration(_))));
        }
    }
}
