//! Which way down: Newton's step where the energy is convex, the lowest curvature where it is not, the
//! force where there is no curvature at all.
//!
//! ```text
//! definite         p = -H^-1 f
//! not definite     p = -(H + sigma M)^-1 f + l w,    <f, w> <= 0
//! no Hessian       p = -M^-1 f
//! ```
//! `f` the differential, `w` the direction of the lowest curvature, `l` the length of the first part,
//! once the residual has become small: a ridge is followed to its saddle before it is left. Where p has
//! no length of its own, because the Hessian is not definite, what of it is soft is kept beside it.
//! Source: Nocedal and Wright, Numerical Optimization, chapter 3.4.

use super::{Descent, largest};
use crate::equilibrium::terms::{dot, length};
use crate::{NewtonFailure, Rung, Unsolvable, first_non_finite};

/// What a direction knows of its own length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Step {
    /// Newton's: its length is 1.
    Newton,
    /// It goes on for as long as the energy falls.
    Open,
    /// Newton's to any place at rest: it may rise.
    ToAnyRest,
}

impl Descent<'_> {
    /// Writes the direction.
    ///
    /// `falls`: whether the residual is still far from what it was at first.
    pub(super) fn direction(
        &mut self,
        q: &[f64],
        falls: bool,
    ) -> Result<(Step, Rung), NewtonFailure> {
        let (kind, rung) = match self.factor(q) {
            Ok(Rung::Cholesky) => {
                self.solve();
                (Step::Newton, Rung::Cholesky)
            }
            Ok(rung @ Rung::Indefinite) => {
                self.solve();
                if first_non_finite(&self.step).is_some() {
                    self.along_the_force(q);
                    self.soft.copy_from_slice(&self.step);
                    (Step::Open, rung)
                } else {
                    (Step::ToAnyRest, rung)
                }
            }
            Ok(rung) => (self.without_convexity(q, falls)?, rung),
            Err(Unsolvable::Singular) => (self.without_convexity(q, falls)?, Rung::Indefinite),
            Err(error) => return Err(NewtonFailure::Unsolvable(error)),
        };
        match first_non_finite(&self.step) {
            Some(unknown) => Err(self
                .asked
                .unsolved()
                .map_or(NewtonFailure::NonFinite(unknown), NewtonFailure::Unsolvable)),
            None => Ok((kind, rung)),
        }
    }

    /// Writes `-A^-1 f` for the matrix that was factored last.
    pub(super) fn solve(&mut self) {
        self.step.copy_from_slice(&self.force);
        self.asked.solve(&mut self.step);
        self.step.iter_mut().for_each(|p| *p = -*p);
    }

    /// Writes the direction where the Hessian is not definite, and the part of it that is soft.
    fn without_convexity(&mut self, q: &[f64], falls: bool) -> Result<Step, NewtonFailure> {
        let lowest = match self.lowest(q)? {
            Some(lowest) => lowest,
            None => {
                self.along_the_force(q);
                self.soft.copy_from_slice(&self.step);
                return Ok(Step::Open);
            }
        };
        self.solve();
        if lowest.is_negative && !falls {
            // Along w as far as along the rest, to the side to which the force leads.
            self.asked.flat(&lowest.direction, &mut self.scratch);
            let backwards = dot(&self.scratch, &self.step) < 0.0;
            let l = length(self.asked, &self.step, &mut self.scratch);
            let l = if backwards { -l } else { l };
            self.step.iter_mut().zip(&lowest.direction).for_each(|(p, w)| *p += l * w);
        }
        // The factor at hand leaves of a vector what the Hessian does not hold back.
        self.soft.copy_from_slice(&self.step);
        for _ in 0..2 {
            self.asked.flat(&self.soft, &mut self.scratch);
            self.scratch.iter_mut().for_each(|p| *p *= lowest.sigma);
            self.asked.solve(&mut self.scratch);
            self.soft.copy_from_slice(&self.scratch);
        }
        if first_non_finite(&self.step).or(first_non_finite(&self.soft)).is_some() {
            self.along_the_force(q);
            self.soft.copy_from_slice(&self.step);
        }
        Ok(Step::Open)
    }

    /// Writes `-M^-1 f`, a thousandth of q long.
    fn along_the_force(&mut self, q: &[f64]) {
        let f = largest(&self.force);
        self.scratch.iter_mut().zip(&self.force).for_each(|(g, f0)| *g = f0 / f);
        self.asked.sharp(&self.scratch, &mut self.step);
        let (way, far) = (largest(&self.step), largest(q));
        let wanted = if far > 0.0 { 1e-3 * far } else { 1.0 };
        self.step.iter_mut().for_each(|p| *p *= -wanted / way);
    }
}
