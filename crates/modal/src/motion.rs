//! Motion near an equilibrium in closed form, at any time for the same cost.
//!
//! ```text
//! d(t) = sum_i v_i (mu_i c_i(t) + nu_i s_i(t)),   mu_i = v_i^T M d(0),   nu_i = v_i^T M d'(0)
//! c = e^-gt (cos wt + g s~),  s = e^-gt s~,  s~ = sin(wt)/w        lambda > g^2, w^2 = lambda - g^2
//! c, s with cosh and sinh                                          lambda < g^2
//! c = 1 + gt, s = t, times e^-gt                                   lambda = g^2: rigid motions drift
//! E_i = 1/2 (nu_i^2 + lambda_i mu_i^2)                             energy of a mode, joules
//! ```
//! `v_i lambda_i` the modes, `d` the displacement (n), `g` half the mode's damping rate in 1/s (zero
//! without damping). What the initial data have outside of the modes is left out, and its size is kept.
//! Source: notes 14.2, with the order of the factors in the velocity's equation as in errata 14.2.

use stationary_calculus::{SizeError, SymmetricMatrix, Vector};

use crate::{ModalError, Modes, dense};

/// A motion as a sum of modes.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion<'a> {
    modes: &'a Modes,
    displacements: Vec<f64>,
    rates: Vec<f64>,
    damping: Vec<f64>,
    left_out: f64,
}

impl<'a> Motion<'a> {
    /// The motion from the displacement `d` and the velocity `v` at time zero.
    pub fn new(
        modes: &'a Modes,
        mass: &SymmetricMatrix,
        d: Vector<&[f64]>,
        v: Vector<&[f64]>,
    ) -> Result<Self, ModalError> {
        let n = modes.dim();
        SizeError::check("the mass matrix's size", n, mass.dim())?;
        SizeError::check("the displacement's components", n, d.0.len())?;
        SizeError::check("the velocity's components", n, v.0.len())?;
        let coefficients = |x: &[f64]| -> Result<Vec<f64>, ModalError> {
            let mut mx = vec![0.0; n];
            mass.add_product(1.0, x, &mut mx)?;
            Ok((0..modes.len()).map(|i| dense::dot(modes.column(i), &mx)).collect())
        };
        let (displacements, rates) = (coefficients(d.0)?, coefficients(v.0)?);
        let mut rest = d.0.to_vec();
        for (i, mu) in displacements.iter().enumerate() {
            dense::add_scaled(&mut rest, -mu, modes.column(i));
        }
        let square = |x: &[f64]| dense::dot(x, &dense::times(mass, x)).max(0.0);
        let (all, left) = (square(d.0), square(&rest));
        let left_out = if all > 0.0 { (left / all).sqrt() } else { 0.0 };
        let damping = vec![0.0; modes.len()];
        Ok(Motion { modes, displacements, rates, damping, left_out })
    }

    /// The same start with damping ratios zeta: mode i decays like `exp(-zeta_i sqrt(lambda_i) t)`.
    pub fn with_damping(mut self, ratios: &[f64]) -> Result<Self, ModalError> {
        SizeError::check("the damping ratios", self.modes.len(), ratios.len())?;
        for (i, &zeta) in ratios.iter().enumerate() {
            if !(zeta >= 0.0 && zeta.is_finite()) {
                return Err(ModalError::Parameter { what: "a damping ratio", value: zeta });
            }
            self.damping[i] = zeta * self.modes.values()[i].max(0.0).sqrt();
        }
        Ok(self)
    }

    /// The part of the initial displacement outside of the modes, relative to all of it in the mass.
    pub fn left_out(&self) -> f64 {
        self.left_out
    }

    /// Writes the displacement and the velocity at time t, seconds; t may be negative.
    pub fn at(
        &self,
        t: f64,
        d: Vector<&mut [f64]>,
        v: Vector<&mut [f64]>,
    ) -> Result<(), ModalError> {
        SizeError::check("the displacement's components", self.modes.dim(), d.0.len())?;
        SizeError::check("the velocity's components", self.modes.dim(), v.0.len())?;
        d.0.fill(0.0);
        v.0.fill(0.0);
        for i in 0..self.modes.len() {
            let (x, rate) = self.mode_at(i, t);
            dense::add_scaled(d.0, x, self.modes.column(i));
            dense::add_scaled(v.0, rate, self.modes.column(i));
        }
        Ok(())
    }

    /// The energy of mode i at time t, joules; `None` where there are not so many.
    pub fn energy(&self, i: usize, t: f64) -> Option<f64> {
        let lambda = self.modes.values().get(i)?;
        let (x, rate) = self.mode_at(i, t);
        Some(0.5 * (rate * rate + lambda * x * x))
    }

    fn mode_at(&self, i: usize, t: f64) -> (f64, f64) {
        let (lambda, g) = (self.modes.values()[i], self.damping[i]);
        Propagator::new(lambda, g, t).applied(self.displacements[i], self.rates[i])
    }
}

/// What a mode's displacement and rate become over a time.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Propagator {
    pub(crate) c: f64,
    pub(crate) s: f64,
    c_rate: f64,
    s_rate: f64,
}

impl Propagator {
    pub(crate) fn new(lambda: f64, g: f64, t: f64) -> Self {
        let (c, s) = undamped(lambda - g * g, t);
        let decay = (-g * t).exp();
        Propagator {
            c: decay * (c + g * s),
            s: decay * s,
            c_rate: -decay * lambda * s,
            s_rate: decay * (c - g * s),
        }
    }

    pub(crate) fn applied(self, x: f64, rate: f64) -> (f64, f64) {
        (self.c * x + self.s * rate, self.c_rate * x + self.s_rate * rate)
    }
}

/// `cos(sqrt(lambda) t)` and `sin(sqrt(lambda) t)/sqrt(lambda)`, continued to lambda <= 0.
fn undamped(lambda: f64, t: f64) -> (f64, f64) {
    let root = lambda.abs().sqrt();
    if root == 0.0 {
        (1.0, t)
    } else if lambda > 0.0 {
        ((root * t).cos(), (root * t).sin() / root)
    } else {
        ((root * t).cosh(), (root * t).sinh() / root)
    }
}
