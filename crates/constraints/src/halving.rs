//! Steps that are retried in halves where they fail.
//!
//! ```text
//! Phi_h fails  ->  Phi_h/2 Phi_h/2,  each of which may be halved again, down to h / 2^n
//! lambda = sum of the parts' multipliers, each by its share of h
//! ```
//! A multiplier step has no solution where it turns a light part too far (see
//! [`Rattle`](crate::Rattle)); a shorter one has. Whoever asks for it gets the state at `t + h` all the
//! same, and the report says in how many parts. What it costs: the step depends on the state, so that
//! the method is neither symmetric nor symplectic any more, and the bound on energy is lost wherever
//! halves are taken. Only failures that shorter steps can mend are retried. No part of it is kept
//! where one fails for good.

use stationary_calculus::Storage;
use stationary_integrators::{EnergyBehavior, Facts, Saved, State, StepError, Symplecticity};

use crate::checks::check_step;
use crate::parts::Parts;
use crate::{ConstrainedIntegrator, ConstrainedReport, ConstraintError};

/// A method whose failed steps are retried in halves.
#[derive(Clone, Debug)]
pub struct Halving<I, C> {
    integrator: I,
    most: u32,
    parts: Parts<C>,
}

impl<C: Storage, I: ConstrainedIntegrator<C>> Halving<I, C> {
    /// A method that may halve a step this often, for states as large as this one.
    ///
    /// # Errors
    /// Storage that has not the state's size.
    pub fn new(integrator: I, most: u32, state: &State<C>) -> Result<Self, ConstraintError> {
        let parts = Parts::new(&integrator, state)?;
        Ok(Halving { integrator, most: most.min(MOST), parts })
    }

    /// The method.
    pub fn integrator(&self) -> &I {
        &self.integrator
    }

    /// Moves the copy of the state by a share `2^-depth` of `h`.
    fn advance(&mut self, h: f64, depth: u32) -> Result<ConstrainedReport, ConstraintError> {
        let share = 0.5_f64.powi(depth as i32);
        match self.integrator.step_either_way(&mut self.parts.moving, h * share) {
            Ok(report) => {
                self.parts.add(share, self.integrator.multipliers());
                Ok(report)
            }
            Err(error) if depth < self.most && is_mended_by_shorter_steps(&error) => {
                let first = self.advance(h, depth + 1)?;
                let both = first.followed_by(&self.advance(h, depth + 1)?);
                Ok(ConstrainedReport { halvings: both.halvings + 1, ..both })
            }
            Err(error) => Err(error),
        }
    }
}

/// Halves beyond this are below the rounding of the time.
const MOST: u32 = 40;

/// Whether a failure is one of a step that is too long.
pub(crate) fn is_mended_by_shorter_steps(error: &ConstraintError) -> bool {
    matches!(
        error,
        ConstraintError::NotConverged { .. }
            | ConstraintError::Diverged { .. }
            | ConstraintError::SingularPosition { .. }
            | ConstraintError::Step(StepError::Newton(_))
    )
}

impl<C: Storage, I: ConstrainedIntegrator<C>> ConstrainedIntegrator<C> for Halving<I, C> {
    /// Those of the method, less what a step that depends on the state loses.
    fn facts(&self) -> Facts {
        Facts {
            symmetric: false,
            symplecticity: Symplecticity::No,
            energy: EnergyBehavior::Grows,
            ..self.integrator.facts()
        }
    }

    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<ConstrainedReport, ConstraintError> {
        check_step(h)?;
        self.step_either_way(state, h)
    }

    fn step_either_way(
        &mut self,
        state: &mut State<C>,
        h: f64,
    ) -> Result<ConstrainedReport, ConstraintError> {
        self.parts.begin(state)?;
        let report = self.advance(h, 0)?;
        self.parts.end(state, h);
        Ok(report)
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
