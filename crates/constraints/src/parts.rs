//! A step that is made of parts: a copy of the state that moves, and the mean of the parts' forces.
//!
//! ```text
//! lambda = sum_i c_i lambda_i         c_i the share of the step that part i takes
//! ```
//! The state itself and the multipliers change where all parts have succeeded, and not before.

use stationary_calculus::{Covector, SizeError, Storage};
use stationary_integrators::State;

use crate::checks::zeros;
use crate::{ConstrainedIntegrator, ConstraintError};

/// The state between parts, the multipliers that they had so far, and those of the last whole step.
#[derive(Clone, Debug)]
pub(crate) struct Parts<C> {
    pub(crate) moving: State<C>,
    sum: Vec<f64>,
    pub(crate) lambda: Vec<f64>,
}

impl<C: Storage> Parts<C> {
    pub(crate) fn new(
        integrator: &impl ConstrainedIntegrator<C>,
        state: &State<C>,
    ) -> Result<Self, ConstraintError> {
        let (stored, n) = (state.q.as_ref().len(), state.p.components().len());
        let lambda = vec![0.0; integrator.multipliers().len()];
        let moving = State::new(zeros(stored)?, Covector(zeros(n)?));
        Ok(Parts { moving, sum: lambda.clone(), lambda })
    }

    /// Starts from a state.
    pub(crate) fn begin(&mut self, state: &State<C>) -> Result<(), SizeError> {
        let n = self.moving.q.as_ref().len();
        SizeError::check("the configuration's numbers", n, state.q.as_ref().len())?;
        self.moving.clone_from(state);
        self.sum.fill(0.0);
        Ok(())
    }

    /// Adds the multipliers of a part that took this share of the step.
    pub(crate) fn add(&mut self, share: f64, multipliers: &[f64]) {
        self.sum.iter_mut().zip(multipliers).for_each(|(sum, own)| *sum += share * own);
    }

    /// Gives the state the end of the step, whose multipliers these are.
    pub(crate) fn end(&mut self, state: &mut State<C>, h: f64) {
        // Parts add up to the step but for rounding.
        self.moving.t = state.t + h;
        std::mem::swap(state, &mut self.moving);
        std::mem::swap(&mut self.lambda, &mut self.sum);
    }
}
