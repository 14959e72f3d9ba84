//! Methods of order 4, 6 and 8 under constraints: a symmetric method composed of itself.
//!
//! ```text
//! Phi_c1h Phi_c2h ... Phi_c1h           the steps of a Scheme, a palindrome, some of them backward
//! lambda = sum_i c_i lambda_i           the multipliers of the mean force over the step
//! ```
//! Every part is a step of the method, forward or back in time, so that what it keeps is kept: the
//! constraints, a symplectic form, momenta. The order is the scheme's where the method is symmetric and
//! what it steps through is smooth. A damper acts backward in backward parts: composed steps are for what
//! is damped little. A failed step leaves the state. Source: Hairer, Lubich and Wanner, Geometric
//! Numerical Integration, II.4 and V.3; Reich (1996).

use stationary_calculus::{Covector, SizeError, Storage};
use stationary_integrators::{Facts, Saved, Scheme, State, StepError};

use crate::rattle_core::{check_step, zeros};
use crate::{ConstrainedIntegrator, ConstrainedReport, ConstraintError};

/// A symmetric method with the steps of a [`Scheme`].
#[derive(Clone, Debug)]
pub struct Composed<I, C> {
    integrator: I,
    scheme: Scheme,
    parts: Vec<f64>,
    moving: State<C>,
    lambda: Vec<f64>,
}

impl<C: Storage, I: ConstrainedIntegrator<C>> Composed<I, C> {
    /// A method composed of itself, for states as large as this one.
    ///
    /// # Errors
    /// A scheme that is not one of whole steps; storage that has not the state's size.
    pub fn new(integrator: I, scheme: Scheme, state: &State<C>) -> Result<Self, ConstraintError> {
        let Some(parts) = scheme.steps() else {
            return Err(ConstraintError::NotOfSteps { scheme: scheme.facts().name });
        };
        let (stored, n) = (state.q.as_ref().len(), state.p.components().len());
        let lambda = vec![0.0; integrator.multipliers().len()];
        let moving = State::new(zeros(stored)?, Covector(zeros(n)?));
        Ok(Composed { integrator, scheme, parts, moving, lambda })
    }

    /// The method.
    pub fn integrator(&self) -> &I {
        &self.integrator
    }
}

impl<C: Storage, I: ConstrainedIntegrator<C>> ConstrainedIntegrator<C> for Composed<I, C> {
    /// Those of the method, with the order and stages of the scheme.
    fn facts(&self) -> Facts {
        let Facts { name, order, stages, stability, .. } = self.scheme.facts();
        Facts { name, order, stages, stability, ..self.integrator.facts() }
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<ConstrainedReport, ConstraintError> {
        check_step(h)?;
        let n = self.moving.q.as_ref().len();
        SizeError::check("the configuration's numbers", n, state.q.as_ref().len())?;
        self.moving.clone_from(state);
        self.lambda.fill(0.0);
        let mut whole = ConstrainedReport::default();
        for part in &self.parts {
            let report = self.integrator.step_either_way(&mut self.moving, part * h)?;
            whole.differentials += report.differentials;
            whole.iterations += report.iterations;
            whole.violation = report.violation;
            whole.work += report.work;
            let own = self.integrator.multipliers();
            self.lambda.iter_mut().zip(own).for_each(|(sum, own)| *sum += part * own);
        }
        // Parts add up to the step but for rounding.
        self.moving.t = state.t + h;
        std::mem::swap(state, &mut self.moving);
        Ok(whole)
    }

    fn multipliers(&self) -> &[f64] {
        &self.lambda
    }

    fn save(&self) -> Saved {
        self.integrator.save()
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.integrator.load(saved)
    }
}
