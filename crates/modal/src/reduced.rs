//! A body with as many freedoms as it has modes that matter.
//!
//! ```text
//! q = q0 + sum_(i <= N) alpha_i v_i,     alpha_i'' = -lambda_i alpha_i + <F, v_i>     (notes 14.3)
//! ```
//! The mass of the reduced body is the identity. A force that is constant over a step is stepped
//! exactly, at any step; there is no stability limit and no error but that of the modes left out.
//! Forces enter by virtual work: a force on the freedoms (n) acts on mode i by its product with v_i.
//!
//! Valid near the equilibrium: modes are straight lines, and a body that turns by an angle `phi` swells
//! by `phi^2/2`. It cannot fold, and it does not know contact.

use stationary_calculus::{Covector, SizeError, Vector};

use crate::motion::Propagator;
use crate::{ModalError, Modes, dense};

/// The freedoms of a reduced body.
#[derive(Clone, Debug, PartialEq)]
pub struct Reduced<'a> {
    modes: &'a Modes,
    alpha: Vec<f64>,
    rates: Vec<f64>,
}

impl<'a> Reduced<'a> {
    /// At rest at the equilibrium.
    pub fn at_rest(modes: &'a Modes) -> Self {
        let zeros = vec![0.0; modes.len()];
        Reduced { modes, alpha: zeros.clone(), rates: zeros }
    }

    /// The reduced displacements alpha, kg^1/2 m.
    pub fn alpha(&self) -> &[f64] {
        &self.alpha
    }

    /// Moves on by `h` seconds under a force that is constant for so long. Exact for any h.
    pub fn step(&mut self, h: f64, force: Covector<&[f64]>) -> Result<(), ModalError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(ModalError::Parameter { what: "the step", value: h });
        }
        SizeError::check("the force's components", self.modes.dim(), force.0.len())?;
        if let Some(&value) = force.0.iter().find(|f| !f.is_finite()) {
            return Err(ModalError::Parameter { what: "a component of the force", value });
        }
        for (i, &lambda) in self.modes.values().iter().enumerate() {
            let f = dense::dot(self.modes.column(i), force.0);
            let step = Propagator::new(lambda, 0.0, h);
            let (x, rate) = step.applied(self.alpha[i], self.rates[i]);
            self.alpha[i] = x + f * pushed(lambda, h, step.c);
            self.rates[i] = rate + f * step.s;
        }
        Ok(())
    }

    /// Writes the displacement from the equilibrium.
    pub fn displacement(&self, d: Vector<&mut [f64]>) -> Result<(), ModalError> {
        SizeError::check("the displacement's components", self.modes.dim(), d.0.len())?;
        d.0.fill(0.0);
        for (i, &alpha) in self.alpha.iter().enumerate() {
            dense::add_scaled(d.0, alpha, self.modes.column(i));
        }
        Ok(())
    }

    /// The energy of all modes, joules.
    pub fn energy(&self) -> f64 {
        let terms = self.modes.values().iter().zip(self.alpha.iter().zip(&self.rates));
        terms.map(|(lambda, (x, rate))| 0.5 * (rate * rate + lambda * x * x)).sum()
    }
}

/// `(1 - cos(sqrt(lambda) h))/lambda`, without cancellation where that is small.
fn pushed(lambda: f64, h: f64, c: f64) -> f64 {
    if lambda > 0.0 {
        let half = (0.5 * lambda.sqrt() * h).sin();
        2.0 * half * half / lambda
    } else if lambda < 0.0 {
        (1.0 - c) / lambda
    } else {
        0.5 * h * h
    }
}
