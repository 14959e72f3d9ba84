//! What every step on poses begins and ends with.

use stationary_calculus::{SizeError, first_non_finite};
use stationary_integrators::{State, StepError};

use crate::BodySpace;

/// An error unless the step is positive and finite and the state one of the system's.
#[inline]
pub(crate) fn check_step<S: BodySpace>(
    state: &State<Vec<f64>>,
    freedoms: usize,
    h: f64,
) -> Result<(), StepError> {
    if !(h > 0.0 && h.is_finite()) {
        return Err(StepError::Step(h));
    }
    let stored = freedoms / S::FREEDOMS * S::STORED;
    SizeError::check("the configuration's numbers", stored, state.q.len())?;
    SizeError::check("the momentum's components", freedoms, state.p.components().len())?;
    if !(state.t + h).is_finite() {
        return Err(StepError::Time(state.t + h));
    }
    match S::SPACE.first_misfit(&state.q) {
        Some(number) => Err(StepError::Configuration { number }),
        None => Ok(()),
    }
}

/// Takes over `next`, `h` seconds later, or returns an error and stays as it was.
#[inline]
pub(crate) fn accept(
    state: &mut State<Vec<f64>>,
    next: &mut State<Vec<f64>>,
    h: f64,
) -> Result<(), StepError> {
    if let Some(freedom) = first_non_finite(&next.q) {
        return Err(StepError::NonFiniteConfiguration { freedom });
    }
    if let Some(freedom) = first_non_finite(next.p.components()) {
        return Err(StepError::NonFiniteMomentum { freedom });
    }
    next.t = state.t + h;
    std::mem::swap(state, next);
    Ok(())
}
