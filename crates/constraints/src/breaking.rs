//! Rods that break: a step, and after it the rod that was pulled or pushed too hard is gone.
//!
//! ```text
//! |T| = |2 L lambda| > strength     at the step's mean force: the rod is removed
//! ```
//! `T` the tension in newtons. At most one rod breaks in a step, the one that exceeds its strength
//! by the largest ratio; what the others then carry shows in the next step. Configuration and
//! momentum stay as the step left them. Breaking takes memory, a step without it none. Source:
//! notes 6.5 ("fracture the rod if lambda exceeds some threshold").

use stationary_calculus::{Flat, Metric, Potential, Storage};
use stationary_integrators::State;

use crate::{
    ConstrainedIntegrator, ConstrainedReport, ConstraintError, FreeMotion, Hooks, Multipliers,
    Rattle, Rod, Rods, Solver,
};

/// A rod that broke.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Broken {
    /// Its place among the rods before it broke; those after it have moved up.
    pub index: usize,
    /// The rod.
    pub rod: Rod,
    /// The tension that broke it, newtons; negative for a thrust.
    pub tension: f64,
    /// The end of the step in which it broke, seconds.
    pub time: f64,
}

impl<M, P, C, X, F, H, const D: usize> Rattle<'_, M, P, Flat, Rods<D, H>, C, X, F>
where
    M: Metric,
    P: Potential,
    C: Storage,
    X: Multipliers,
    F: FreeMotion<M, Flat> + Clone,
    H: Hooks<D> + Clone,
{
    /// A step, after which a rod that carried more than its strength is removed.
    ///
    /// # Errors
    /// Those of a step, and of [`Rattle::set_constraint`] for the rods that are left; state and rods are then as
    /// they were.
    pub fn step_and_break(
        &mut self,
        state: &mut State<C>,
        h: f64,
        choice: impl Solver<C, Multipliers = X>,
    ) -> Result<(ConstrainedReport, Option<Broken>), ConstraintError> {
        let report = self.step(state, h)?;
        let load = |(index, rod): (usize, &Rod)| {
            let tension = rod.tension(self.multipliers()[index]);
            (index, tension, tension.abs() / rod.strength())
        };
        let loads = self.constraint().rods().iter().enumerate().map(load);
        let heaviest = loads.filter(|load| load.2 > 1.0).max_by(|a, b| a.2.total_cmp(&b.2));
        let Some((index, tension, _)) = heaviest else { return Ok((report, None)) };
        let mut rods = self.constraint().clone();
        let rod = rods.remove(index);
        if let Err(error) = self.set_constraint(rods, state, choice) {
            self.step_back(state);
            return Err(error);
        }
        Ok((report, Some(Broken { index, rod, tension, time: state.t })))
    }
}
