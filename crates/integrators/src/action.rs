//! The action of a discrete path, and its differential.
//!
//! ```text
//! S(q_0, ..., q_K) = sum_i h_i L_d(q_i, q_i+1, h_i)                       joule seconds
//! dS/dq_i = h_i-1 d2 L_d(q_i-1, q_i) + h_i d1 L_d(q_i, q_i+1) = p_i^- - p_i^+,   0 < i < K
//! ```
//! `q_i` configurations (N each), `h_i` the step from q_i to q_i+1 in seconds; steps may differ.
//! The differential by an interior point is the momentum with which the path arrives there less the
//! one with which it leaves: zero on the discrete motion, and on no other path.
//! Source: notes 5.4, 5.5, 10.3.

use stationary_calculus::{Covector, SizeError};

use crate::{ActionError, DiscreteLagrangian};

/// The action of paths whose points are these steps apart.
#[derive(Clone, Debug, PartialEq)]
pub struct Action<L> {
    pub(crate) lagrangian: L,
    pub(crate) steps: Vec<f64>,
}

impl<L> Action<L> {
    /// The action of a discrete Lagrangian over steps in seconds.
    ///
    /// # Errors
    /// Where there is no step, or one is not positive and finite.
    pub fn new(lagrangian: L, steps: Vec<f64>) -> Result<Self, ActionError> {
        let wrong = steps.iter().position(|h| !(*h > 0.0 && h.is_finite()));
        match wrong {
            _ if steps.is_empty() => Err(ActionError::NoSteps),
            Some(step) => Err(ActionError::Step { step, h: steps[step] }),
            None => Ok(Action { lagrangian, steps }),
        }
    }

    /// The steps, seconds.
    pub fn steps(&self) -> &[f64] {
        &self.steps
    }

    pub(crate) fn check<const N: usize>(&self, path: &[[f64; N]]) -> Result<(), SizeError> {
        SizeError::check("the path's points", self.steps.len() + 1, path.len())
    }

    /// The action of a path, which has one point more than there are steps.
    ///
    /// # Errors
    /// [`SizeError`] unless the path has one point more than there are steps.
    pub fn of<const N: usize>(&self, path: &[[f64; N]]) -> Result<f64, SizeError>
    where
        L: DiscreteLagrangian<N>,
    {
        self.check(path)?;
        let pieces = path.windows(2).zip(&self.steps);
        Ok(pieces.map(|(ends, &h)| h * self.lagrangian.value(ends[0], ends[1], h)).sum())
    }

    /// The differential by the interior points, in their order.
    ///
    /// # Errors
    /// [`SizeError`] unless the path has one point more than there are steps.
    pub fn differential<const N: usize>(
        &self,
        path: &[[f64; N]],
    ) -> Result<Vec<Covector<[f64; N]>>, SizeError>
    where
        L: DiscreteLagrangian<N>,
    {
        self.check(path)?;
        let points = path.windows(3).zip(self.steps.windows(2));
        Ok(points.map(|(points, steps)| self.jump_of_momentum(points, steps)).collect())
    }

    /// The momentum with which a path arrives at the middle of three points, less the one with
    /// which it leaves.
    fn jump_of_momentum<const N: usize>(
        &self,
        points: &[[f64; N]],
        steps: &[f64],
    ) -> Covector<[f64; N]>
    where
        L: DiscreteLagrangian<N>,
    {
        let mut jump = self.lagrangian.momentum_after(points[0], points[1], steps[0]);
        let leaving = self.lagrangian.momentum_before(points[1], points[2], steps[1]);
        jump.add_scaled(-1.0, leaving.view());
        jump
    }
}
