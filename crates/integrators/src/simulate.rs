//! A simulation: step after step to a horizon, with an observer that sees every one.
//!
//! ```text
//! (q, p) at t = i h,    i = 0, 1, ..., N,    N h = the horizon
//! ```
//! Times are products, not sums, so that they do not drift. The observer may look at the state and
//! may end the simulation; it allocates only what it wants to.

use std::ops::ControlFlow;

use crate::{HorizonError, Integrator, SimulationError, State, StepReport};

/// A number of equal steps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    step: f64,
    steps: u64,
}

/// How far from a whole number of steps a duration may be, relative to it: rounding, no more.
const WHOLE: f64 = 1e-9;

impl Horizon {
    /// Steps of `step` seconds up to `duration` seconds, which must be a whole number of them.
    pub fn new(duration: f64, step: f64) -> Result<Self, HorizonError> {
        if !(step > 0.0 && step.is_finite()) {
            return Err(HorizonError::Step(step));
        }
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(HorizonError::Duration(duration));
        }
        let steps = duration / step;
        let whole = steps.round();
        if whole < 1.0 || (steps - whole).abs() > WHOLE * whole || whole > 2_f64.powi(53) {
            return Err(HorizonError::NotWhole { duration, step, steps });
        }
        Ok(Horizon { step: duration / whole, steps: whole as u64 })
    }

    /// The duration in this many equal steps, at least one.
    pub fn divided(duration: f64, steps: u64) -> Result<Self, HorizonError> {
        Horizon::new(duration, duration / steps.max(1) as f64)
    }

    /// The step, seconds.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The number of steps.
    pub fn steps(&self) -> u64 {
        self.steps
    }
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
    fn add(&mut self, report: &StepReport) {
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
    /// The time, seconds.
    pub time: f64,
    /// The state.
    pub state: &'a State<C>,
    /// What the step cost, and how it went.
    pub report: &'a StepReport,
}

/// Steps `state` to the horizon, or until the observer breaks off. On an error the state is that
/// after the last good step.
pub fn simulate<C, I: Integrator<C> + ?Sized>(
    integrator: &mut I,
    state: &mut State<C>,
    horizon: Horizon,
    mut observe: impl FnMut(Observation<'_, C>) -> ControlFlow<()>,
) -> Result<Cost, SimulationError> {
    let mut cost = Cost::default();
    for step in 1..=horizon.steps {
        let report = integrator.step(state, horizon.step).map_err(|source| SimulationError {
            step,
            time: (step - 1) as f64 * horizon.step,
            source,
        })?;
        cost.add(&report);
        let time = step as f64 * horizon.step;
        if observe(Observation { step, time, state, report: &report }).is_break() {
            break;
        }
    }
    Ok(cost)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_horizon_that_is_not_a_number_of_steps_is_refused() {
        assert_eq!(Horizon::new(1.0, 0.1).unwrap().steps(), 10);
        assert_eq!(Horizon::new(0.3, 0.1).unwrap().steps(), 3);
        assert!(matches!(Horizon::new(1.0, 0.3), Err(HorizonError::NotWhole { .. })));
        assert!(matches!(Horizon::new(0.1, 1.0), Err(HorizonError::NotWhole { .. })));
        for step in [0.0, -0.1, f64::NAN, f64::INFINITY] {
            assert!(matches!(Horizon::new(1.0, step), Err(HorizonError::Step(_))));
            assert!(matches!(Horizon::new(step, 0.1), Err(HorizonError::Duration(_))));
        }
    }
}
