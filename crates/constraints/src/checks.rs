//! What steps ask of their states before and after: sizes, a time, configurations of the space, finite numbers.

use stationary_calculus::{Metric, Potential, SizeError, Space, Storage, System, first_non_finite};
use stationary_integrators::{State, StepError};

use crate::ConstraintError;

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

/// An error that names the first number that is not finite.
pub(crate) fn check_finite<C: Storage>(state: &State<C>) -> Result<(), StepError> {
    if let Some(freedom) = first_non_finite(state.q.as_ref()) {
        return Err(StepError::NonFiniteConfiguration { freedom });
    }
    if let Some(freedom) = first_non_finite(state.p.components()) {
        return Err(StepError::NonFiniteMomentum { freedom });
    }
    Ok(())
}

/// An error unless the step is positive and finite.
pub(crate) fn check_step(h: f64) -> Result<(), StepError> {
    if h > 0.0 && h.is_finite() && h.recip().is_finite() { Ok(()) } else { Err(StepError::Step(h)) }
}
