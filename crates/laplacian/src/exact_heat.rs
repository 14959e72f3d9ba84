//! Heat in closed form in the spectral basis: any time for the same cost.
//!
//! ```text
//! f(t) = sum_i v_i exp(-alpha lambda_i t) <v_i, M f(0)>
//! ```
//! `v_i lambda_i` modes of the Dirichlet energy in the mass M, `lambda >= 0`. Exact for the
//! discrete Laplacian if all modes are there; with the lowest only, what the start has outside of
//! them is left out, and its size kept: fast modes die first, so the error falls with time like
//! the first mode that is missing. Where vertices are held at other values than zero, f is the
//! difference to the steady state. Source: notes 15.2, 15.3; errata chapter 15 (the factor pi^2).

use stationary_calculus::{Metric, SizeError, Vector};
use stationary_modal::Modes;

use crate::LaplacianError;
use crate::error::positive;

/// Heat as a sum of modes.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactHeat<'a> {
    modes: &'a Modes,
    alpha: f64,
    coefficients: Vec<f64>,
    left_out: f64,
}

impl<'a> ExactHeat<'a> {
    /// Heat of diffusivity `alpha` m^2/s from `f` at time zero. Modes of rigid motions (constants)
    /// must be among the modes if they are to be kept.
    ///
    /// # Errors
    /// [`LaplacianError::Parameter`] and [`LaplacianError::Size`].
    pub fn new(
        modes: &'a Modes,
        metric: &impl Metric,
        alpha: f64,
        f: &[f64],
    ) -> Result<Self, LaplacianError> {
        positive("the diffusivity", alpha)?;
        SizeError::check("the modes' freedoms", metric.dim(), modes.dim())?;
        SizeError::check("the function's values", metric.dim(), f.len())?;
        let (mut coefficients, mut rest) = (Vec::new(), f.to_vec());
        for mode in (0..modes.len()).filter_map(|i| modes.vector(i)) {
            let part = metric.inner(mode, Vector(f));
            rest.iter_mut().zip(mode.0).for_each(|(rest, v)| *rest -= part * v);
            coefficients.push(part);
        }
        let size = |f: &[f64]| metric.inner(Vector(f), Vector(f)).max(0.0).sqrt();
        let whole = size(f);
        let left_out = if whole > 0.0 { size(&rest) / whole } else { 0.0 };
        Ok(ExactHeat { modes, alpha, coefficients, left_out })
    }

    /// The part of the start outside of the modes, relative to all of it in the mass.
    pub fn left_out(&self) -> f64 {
        self.left_out
    }

    /// The function at time t, seconds.
    ///
    /// # Errors
    /// [`LaplacianError::Parameter`] for a time that is negative or not finite.
    pub fn at(&self, t: f64) -> Result<Vec<f64>, LaplacianError> {
        if !(t >= 0.0 && t.is_finite()) {
            return Err(LaplacianError::Parameter { what: "the time", value: t });
        }
        let mut f = vec![0.0; self.modes.dim()];
        for (i, (lambda, start)) in self.modes.values().iter().zip(&self.coefficients).enumerate() {
            let part = start * (-self.alpha * lambda * t).exp();
            if let Some(mode) = self.modes.vector(i) {
                f.iter_mut().zip(mode.0).for_each(|(f, v)| *f += part * v);
            }
        }
        Ok(f)
    }
}
