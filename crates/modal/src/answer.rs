//! How many modes an answer needs.
//!
//! ```text
//! rest        <l, H^-1 F> = sum_i l_i f_i/lambda_i,      l_i = <l, v_i>,  f_i = <F, v_i>
//! motion      F put on at once: sum_i l_i f_i (1 - cos w_i t)/lambda_i
//! left out by N modes, at any time:  2 sqrt(tail(l) tail(F)),   tail(F) = <F, H^-1 F> - sum_(i <= N) f_i^2/lambda_i
//! off         the last correction of the solve, and f_i^2 d_i/lambda_i^2 of each mode:
//!             d_i = |H v_i - lambda_i M v_i| and the rounding of <v_i, H v_i>
//! ```
//! `F` a load, `l` an observable: a covector that says what is looked at, as the displacement of a
//! point; `v_i lambda_i` modes. The tails need no further mode: what the whole body says to a static
//! load is one solve, and the modes at hand say their part of it; so the bound is known before any
//! motion is. What the solve and the modes may be off is added to each tail: the tails are small
//! differences, and rounding must not make them less than they are. It holds for undamped motion from rest;
//! a load that is put on in several steps has the sum of theirs. The phases of the modes are taken as they
//! are: after a time of `w_i/d_i` and more they are no longer those of the body. Source: notes 14.3, which
//! leave N to the reader; Cauchy's inequality.

use stationary_calculus::{Covector, Metric, Potential, SizeError};

use crate::refined::{self, Refined};
use crate::{Linearized, ModalError, Modes, dense};

/// What rounding leaves of a sum, relative to its terms without their signs.
const ROUNDING: f64 = 1e-15;

/// How much of an observable's answer to a load the lowest modes give.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// `<l, H^-1 F>`: the answer of the whole body at rest.
    pub whole: f64,
    /// How far `whole` may be off, in its own unit.
    pub whole_off: f64,
    /// The error that the lowest 0, 1, 2, ... modes leave at rest, relative to the whole answer.
    pub errors: Vec<f64>,
    /// What the error of the motion under the load, put on at once, does not exceed at any time,
    /// relative to the whole answer at rest.
    pub bounds: Vec<f64>,
}

impl Answer {
    /// The least number of modes from which on the error at rest stays within a tolerance, or `None`
    /// where all that were given do not do.
    pub fn least_modes(&self, tolerance: f64) -> Option<usize> {
        let within = self.errors.iter().rev().take_while(|error| **error <= tolerance).count();
        (within > 0).then(|| self.errors.len() - within)
    }

    /// The least number of modes that keep the motion within a tolerance at all times, or `None` where
    /// all that were given do not promise it.
    pub fn least_modes_in_motion(&self, tolerance: f64) -> Option<usize> {
        self.bounds.iter().position(|bound| *bound <= tolerance)
    }
}

impl<M: Metric, P: Potential> Linearized<'_, M, P> {
    /// What an observable `<l, d>` says to a load F, by the whole body and by the lowest modes.
    ///
    /// # Errors
    /// [`ModalError::Stiffness`] where the body is not held: under a load it has no static answer.
    /// [`ModalError::Parameter`] for loads that are not finite, for modes whose lambda is not positive,
    /// and where the whole answer is zero, or no more than it may be off: to that nothing is relative.
    pub fn answer(
        &mut self,
        modes: &Modes,
        load: Covector<&[f64]>,
        observable: Covector<&[f64]>,
    ) -> Result<Answer, ModalError> {
        SizeError::check("the modes' freedoms", self.dim(), modes.dim())?;
        SizeError::check("the load's components", self.dim(), load.0.len())?;
        SizeError::check("the observable's components", self.dim(), observable.0.len())?;
        for (what, covector) in
            [("a component of the load", load), ("a component of the observable", observable)]
        {
            if let Some(&value) = covector.0.iter().find(|f| !f.is_finite()) {
                return Err(ModalError::Parameter { what, value });
            }
        }
        if let Some(&value) = modes.values().iter().find(|lambda| **lambda <= 0.0) {
            return Err(ModalError::Parameter { what: "the lambda of a mode", value });
        }
        self.factor(0.0)?.map_err(ModalError::Stiffness)?;
        let to = [load.0, observable.0].map(|b| {
            let (matrix, factor) = self.stiffness_and_factor();
            refined::solve(matrix, factor, b)
        });
        let whole = Sum::of(observable.0, &to[0]);
        if !(whole.value.abs() > whole.off && whole.value.is_finite()) {
            return Err(ModalError::Parameter {
                what: "the answer of the whole body",
                value: whole.value,
            });
        }
        // The least that the whole answer is: what errors are relative to.
        let least = whole.value.abs() - whole.off;
        let mut given = 0.0;
        let mut tails = [Sum::of(load.0, &to[0]), Sum::of(observable.0, &to[1])];
        let bound = |[f, l]: [Sum; 2]| 2.0 * f.at_most().sqrt() * l.at_most().sqrt() / least;
        let (mut errors, mut bounds) = (vec![1.0], vec![bound(tails)]);
        for (i, lambda) in modes.values().iter().enumerate() {
            let v = modes.column(i);
            let off = modes.residuals()[i] + ROUNDING * dense::sum_of_sizes(self.stiffness(), v);
            given += dense::dot(load.0, v) * dense::dot(observable.0, v) / lambda;
            tails[0].subtract_mode(load.0, v, *lambda, off);
            tails[1].subtract_mode(observable.0, v, *lambda, off);
            let error = ((whole.value - given) / whole.value).abs();
            errors.push(error);
            bounds.push(bound(tails).max(error));
        }
        if let Some(&value) = errors.iter().chain(&bounds).find(|x| !x.is_finite()) {
            return Err(ModalError::Parameter {
                what: "an error relative to the whole answer",
                value,
            });
        }
        Ok(Answer { whole: whole.value, whole_off: whole.off, errors, bounds })
    }
}

/// A sum and how far it may be off.
#[derive(Clone, Copy)]
struct Sum {
    value: f64,
    off: f64,
}

impl Sum {
    /// A covector on a solution.
    fn of(covector: &[f64], solution: &Refined) -> Self {
        let value = dense::dot(covector, &solution.x);
        let off = sum_of_sizes(covector, &solution.off);
        Sum { value, off: off + ROUNDING * sum_of_sizes(covector, &solution.x) }
    }

    /// Without a mode's part, `f^2/lambda`, whose lambda may be this far off.
    fn subtract_mode(&mut self, covector: &[f64], v: &[f64], lambda: f64, off: f64) {
        let f = dense::dot(covector, v);
        let f_off = ROUNDING * sum_of_sizes(covector, v);
        let most = f.abs() + f_off;
        self.value -= f * f / lambda;
        self.off += f_off * (most + f.abs()) / lambda + (most / lambda) * (most / lambda) * off;
    }

    fn at_most(&self) -> f64 {
        self.value.max(0.0) + self.off
    }
}

fn sum_of_sizes(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| (x * y).abs()).sum()
}
