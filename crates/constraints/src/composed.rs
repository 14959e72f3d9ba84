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

use stationary_calculus::Storage;
use stationary_integrators::{Facts, Saved, Scheme, State, StepError};

use crate::checks::check_step;
use crate::parts::Parts;
use crate::{ConstrainedIntegrator, ConstrainedReport, ConstraintError};

/// A symmetric method with the steps of a [`Scheme`].
#[derive(Clone, Debug)]
pub struct Composed<I, C> {
    integrator: I,
    scheme: Scheme,
    shares: Vec<f64>,
    parts: Parts<C>,
}

impl<C: Storage, I: ConstrainedIntegrator<C>> Composed<I, C> {
    /// A method composed of itself, for states as large as this one.
    ///
    /// # Errors
    /// A scheme that is not one of whole steps; storage that has not the state's size.
    pub fn new(integrator: I, scheme: Scheme, state: &State<C>) -> Result<Self, ConstraintError> {
        let Some(shares) = scheme.steps() else {
            return Err(ConstraintError::NotOfSteps { scheme: scheme.facts().name });
        };
        let parts = Parts::new(&integrator, state)?;
        Ok(Composed { integrator, scheme, shares, parts })
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
        self.parts.begin(state)?;
        let mut whole = ConstrainedReport::default();
        for &share in &self.shares {
            let report = self.integrator.step_either_way(&mut self.parts.moving, share * h)?;
            whole = whole.followed_by(&report);
            self.parts.add(share, self.integrator.multipliers());
        }
        self.parts.end(state, h);
        Ok(whole)
    }

    fn multipliers(&self) -> &[f64] {
        &self.parts.lambda
    }

    fn save(&self) -> Saved {
        self.integrator.save()
    }

    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        self.integrator.load(saved)
    }
}
