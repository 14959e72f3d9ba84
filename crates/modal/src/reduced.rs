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

use stationary_calculus::{Covector, SizeError, Vector, first_non_finite};

use crate::motion::{LOST, OUT_OF_RANGE, Propagator};
use crate::{ModalError, Modes, dense};

/// The freedoms of a reduced body.
#[derive(Clone, Debug)]
pub struct Reduced<'a> {
    modes: &'a Modes,
    alpha: Vec<f64>,
    rates: Vec<f64>,
    /// Room for both after a step, until it is known to be good.
    after: [Vec<f64>; 2],
}

/// The same modes in the same state.
impl PartialEq for Reduced<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.modes == other.modes && self.alpha == other.alpha && self.rates == other.rates
    }
}

impl<'a> Reduced<'a> {
    /// At rest at the equilibrium.
    pub fn at_rest(modes: &'a Modes) -> Self {
        let zeros = vec![0.0; modes.len()];
        let after = [zeros.clone(), zeros.clone()];
        Reduced { modes, alpha: zeros.clone(), rates: zeros, after }
    }

    /// The reduced displacements alpha, kg^1/2 m.
    pub fn alpha(&self) -> &[f64] {
        &self.alpha
    }

    /// Moves on by `h` seconds under a force that is constant for so long. Exact for any h, but for
    /// rounding of the phase.
    ///
    /// # Errors
    /// [`ModalError::Size`]; [`ModalError::Parameter`] for a step that is not positive, a force that is
    /// not finite, and where the motion leaves the range of numbers; [`ModalError::PhaseLost`] for a
    /// step in which a mode turns so often that no digit of its phase is left. After an error the body
    /// is where it was.
    pub fn step(&mut self, h: f64, force: Covector<&[f64]>) -> Result<(), ModalError> {
        if !(h > 0.0 && h.is_finite()) {
            return Err(ModalError::Parameter { what: "the step", value: h });
        }
        SizeError::check("the force's components", self.modes.dim(), force.0.len())?;
        if let Some(&value) = force.0.iter().find(|f| !f.is_finite()) {
            return Err(ModalError::Parameter { what: "a component of the force", value });
        }
        for (i, &lambda) in self.modes.values().iter().enumerate() {
            let radians = lambda.max(0.0).sqrt() * h;
            if f64::EPSILON * radians > LOST {
                return Err(ModalError::PhaseLost { mode: i, radians });
            }
            let f = dense::dot(self.modes.column(i), force.0);
            let step = Propagator::new(lambda, 0.0, h);
            let (x, rate) = step.applied(self.alpha[i], self.rates[i]);
            let (x, rate) = (x + f * pushed(lambda, h), rate + f * step.s);
            if !(x.is_finite() && rate.is_finite()) {
                return Err(ModalError::Parameter { what: OUT_OF_RANGE, value: h });
            }
            (self.after[0][i], self.after[1][i]) = (x, rate);
        }
        std::mem::swap(&mut self.alpha, &mut self.after[0]);
        std::mem::swap(&mut self.rates, &mut self.after[1]);
        Ok(())
    }

    /// Writes the displacement from the equilibrium.
    ///
    /// # Errors
    /// [`ModalError::Size`]; [`ModalError::Parameter`] where a component is too large for a number, `d` is then
    /// not to be used.
    pub fn displacement(&self, d: Vector<&mut [f64]>) -> Result<(), ModalError> {
        SizeError::check("the displacement's components", self.modes.dim(), d.0.len())?;
        d.0.fill(0.0);
        for (i, &alpha) in self.alpha.iter().enumerate() {
            dense::add_scaled(d.0, alpha, self.modes.column(i));
        }
        match first_non_finite(d.0) {
            None => Ok(()),
            Some(k) => Err(ModalError::Parameter {
                what: "a component of the displacement",
                value: d.0[k],
            }),
        }
    }

    /// The energy of all modes, joules.
    pub fn energy(&self) -> f64 {
        let terms = self.modes.values().iter().zip(self.alpha.iter().zip(&self.rates));
        terms.map(|(lambda, (x, rate))| 0.5 * (rate * rate + lambda * x * x)).sum()
    }
}

/// `(1 - cos(sqrt(lambda) h))/lambda = h^2/2 (sin(y)/y)^2`, `y = sqrt(lambda) h/2`; with sinh for
/// lambda < 0.
fn pushed(lambda: f64, h: f64) -> f64 {
    let y = 0.5 * lambda.abs().sqrt() * h;
    let shape = if y == 0.0 {
        1.0
    } else if lambda > 0.0 {
        y.sin() / y
    } else {
        y.sinh() / y
    };
    0.5 * (h * shape).powi(2)
}
