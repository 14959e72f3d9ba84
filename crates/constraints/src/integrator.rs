//! What a step under a constraint is, and what it reports.
//!
//! ```text
//! (t, q, p) -> (t + h, q', p')    with g(t + h, q') = 0 again
//! F = -J^T lambda                 the force of the constraint, meant over the step
//! ```
//! `q` a configuration, `p` its momentum (a covector), `lambda` the multipliers. After every step
//! the violation is at most `1e-12 + 8 eps |q|/L` of each length L, or the step is an error and the
//! state as it was.

use stationary_integrators::{Facts, Saved, State, StepError};

use crate::ConstraintError;

/// A map from phase space to itself that stays on the feasible set.
pub trait ConstrainedIntegrator<C> {
    /// What is known of the method; momenta are kept as stated where the constraint, too, is
    /// invariant.
    fn facts(&self) -> Facts;

    /// Moves `state` forward by `h` seconds. On an error the state is as it was.
    ///
    /// # Errors
    /// A step that is not positive and finite; sizes that differ; numbers that are not finite; a
    /// configuration that is not feasible, or from which none is found; equations that depend on
    /// each other; a step without constraints inside that fails, as [`ConstraintError::Step`].
    fn step(&mut self, state: &mut State<C>, h: f64) -> Result<ConstrainedReport, ConstraintError>;

    /// The same for an `h` of either sign, of a method that goes back in time as it goes forward.
    ///
    /// # Errors
    /// Those of [`ConstrainedIntegrator::step`]; a negative step of a method that does not.
    fn step_either_way(
        &mut self,
        state: &mut State<C>,
        h: f64,
    ) -> Result<ConstrainedReport, ConstraintError> {
        self.step(state, h)
    }

    /// The multipliers of the last step: those of its mean force, zero before the first.
    fn multipliers(&self) -> &[f64];

    /// Everything on which the next steps depend beside the state: nothing, of a method that does not
    /// say otherwise.
    fn save(&self) -> Saved {
        Saved { method: self.facts().name.to_owned(), numbers: Vec::new() }
    }

    /// Takes over what the same method had saved, and goes on from its state to the same bits. The
    /// multipliers are those of the next step only after that.
    ///
    /// # Errors
    /// Another method's numbers; the method is then as it was.
    fn load(&mut self, saved: &Saved) -> Result<(), StepError> {
        saved.check_empty(self.facts().name)
    }
}

/// What a step cost, and how it went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ConstrainedReport {
    /// Differentials of the potential evaluated.
    pub differentials: u32,
    /// Iterations towards the feasible configuration, each one solve and one value of g.
    pub iterations: u32,
    /// The largest violation of the new configuration, relative to its equation's length.
    pub violation: f64,
    /// The work that driven constraints did on the system in the step, joules.
    pub work: f64,
    /// How often parts of the step were halved: 0 unless [`Halving`](crate::Halving) was asked for and
    /// needed.
    pub halvings: u32,
}

impl ConstrainedReport {
    /// The report of two parts of a step, one after the other.
    pub(crate) fn followed_by(&self, second: &Self) -> Self {
        ConstrainedReport {
            differentials: self.differentials + second.differentials,
            iterations: self.iterations + second.iterations,
            violation: second.violation,
            work: self.work + second.work,
            halvings: self.halvings + second.halvings,
        }
    }
}
