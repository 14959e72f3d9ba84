//! How many modes an answer needs.
//!
//! ```text
//! rest        <l, H^-1 F> = sum_i l_i f_i/lambda_i,      l_i = <l, v_i>,  f_i = <F, v_i>
//! motion      F put on at once: sum_i l_i f_i (1 - cos w_i t)/lambda_i
//! left out by N modes, at any time:  2 sqrt(tail(l) tail(F)),   tail(F) = <F, H^-1 F> - sum_(i <= N) f_i^2/lambda_i
//! ```
//! `F` a load, `l` an observable: a covector that says what is looked at, as the displacement of a
//! point; `v_i lambda_i` modes. The tails need no further mode: what the whole body says to a static
//! load is one solve, and the modes at hand say their part of it; so the bound is known before any
//! motion is. It holds for undamped motion from rest; a load that is put on in several steps has the sum
//! of theirs. Source: notes 14.3, which leave N to the reader; Cauchy's inequality.

use stationary_calculus::{Covector, Metric, Potential, SizeError};

use crate::{Linearized, ModalError, Modes, dense};

/// What rounding leaves of a tail, relative to the whole.
const ROUNDING: f64 = 1e-15;

/// How much of an observable's answer to a load the lowest modes give.
#[derive(Clone, Debug, PartialEq)]
pub struct Answer {
    /// `<l, H^-1 F>`: the answer of the whole body at rest.
    pub whole: f64,
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
    /// and where the whole answer is zero, to which nothing is relative.
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
        let mut at_rest = [load.0, observable.0].concat();
        self.factored().0.solve(&mut at_rest);
        let (to_load, to_observable) = at_rest.split_at(self.dim());
        let whole = dense::dot(observable.0, to_load);
        if !(whole.abs() > 0.0 && whole.is_finite()) {
            return Err(ModalError::Parameter {
                what: "the answer of the whole body",
                value: whole,
            });
        }
        let mut given = 0.0;
        let mut tails = [dense::dot(load.0, to_load), dense::dot(observable.0, to_observable)];
        let least = tails.map(|tail| ROUNDING * tail);
        let bound =
            |[f, l]: [f64; 2]| 2.0 * (f.max(least[0]) * l.max(least[1])).sqrt() / whole.abs();
        let (mut errors, mut bounds) = (vec![1.0], vec![bound(tails)]);
        for (i, lambda) in modes.values().iter().enumerate() {
            let v = modes.column(i);
            let (f, l) = (dense::dot(load.0, v), dense::dot(observable.0, v));
            given += l * f / lambda;
            tails[0] -= f * f / lambda;
            tails[1] -= l * l / lambda;
            errors.push(((whole - given) / whole).abs());
            bounds.push(bound(tails));
        }
        if let Some(&value) = errors.iter().chain(&bounds).find(|x| !x.is_finite()) {
            return Err(ModalError::Parameter {
                what: "an error relative to the whole answer",
                value,
            });
        }
        Ok(Answer { whole, errors, bounds })
    }
}
