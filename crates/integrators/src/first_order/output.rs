//! Output at given times, from the dense output of the steps that pass over them.

use stationary_calculus::Storage;

use super::{AcceptedStep, AdaptiveError, AdaptiveMethod};
use crate::integrator::zeros;

/// Times at which the state is asked for.
#[derive(Clone, Debug)]
pub struct OutputTimes<'a, C> {
    times: &'a [f64],
    y: C,
}

impl<'a, C: Storage> OutputTimes<'a, C> {
    /// Times in ascending order, for a state of `n` numbers.
    ///
    /// # Errors
    /// [`AdaptiveError::OutputTimes`] for the first time that is not finite or does not ascend;
    /// [`AdaptiveError::Size`] for a storage of another size than `n`.
    pub fn new(n: usize, times: &'a [f64]) -> Result<Self, AdaptiveError> {
        for (place, &t) in times.iter().enumerate() {
            let ascends = place == 0 || times[place - 1] < t;
            if !(t.is_finite() && ascends) {
                return Err(AdaptiveError::OutputTimes { place, t });
            }
        }
        Ok(OutputTimes { times, y: zeros(n)? })
    }

    /// The times that are still ahead.
    pub fn ahead(&self) -> &'a [f64] {
        self.times
    }

    /// Hands out the state at every time that the step passes over or ends at. Times before the
    /// step are skipped.
    ///
    /// # Errors
    /// Those of [`AcceptedStep::interpolate`]; the time at which it failed is then still ahead.
    pub fn within<A: AdaptiveMethod<C> + ?Sized>(
        &mut self,
        step: &mut AcceptedStep<'_, C, A>,
        mut take: impl FnMut(f64, &[f64]),
    ) -> Result<(), AdaptiveError> {
        while let [t, rest @ ..] = self.times {
            if *t > step.to() {
                break;
            }
            if *t == step.to() {
                take(*t, step.moment().y.as_ref());
            } else if *t >= step.from() {
                step.interpolate(*t, self.y.as_mut())?;
                take(*t, self.y.as_ref());
            }
            self.times = rest;
        }
        Ok(())
    }
}
