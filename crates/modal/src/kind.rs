//! What kind of equilibrium it is: the second derivative test, counted.
//!
//! ```text
//! negative eigenvalues of H + sigma M  =  number of lambda < -sigma
//! negative eigenvalues of H - sigma M  =  number of lambda <  sigma
//! ```
//! A free body's Hessian is singular, and the signs of its zeros are rounding; so both counts are
//! taken a little off zero, at a sigma well below the first elastic eigenvalue, and the eigenvalues
//! between them are the zeros. Where there are more zeros than rigid motions the test has nothing to
//! say: `V = x^3` and `V = x^4` look alike. Source: notes 14.1; errata 14.1.

use stationary_calculus::{Metric, Potential};

use crate::{Linearized, ModalError, RigidMotions};

/// The kind of an equilibrium.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Every direction but the rigid motions costs energy: a minimum.
    Stable,
    /// No direction costs energy, and some give it: a maximum.
    Maximum {
        /// How many directions lower the energy.
        descents: usize,
    },
    /// Some directions cost energy, some give it.
    Saddle {
        /// How many directions lower the energy.
        descents: usize,
    },
    /// Second derivatives do not tell: there are flat directions that are no rigid motions.
    Undecided {
        /// How many flat directions there are, rigid motions included.
        flat: usize,
    },
}

/// Sigma relative to the eigenvalue of least size.
const WELL_BELOW: f64 = 1e-3;
/// Eigenvalues of less than this share of the scale are flat.
const FLAT: f64 = 1e-9;

impl<M: Metric, P: Potential> Linearized<'_, M, P> {
    /// The kind of the equilibrium, rigid motions aside.
    ///
    /// # Errors
    /// Where a count cannot be trusted.
    pub fn kind(&mut self, rigid: &RigidMotions) -> Result<Kind, ModalError> {
        let n = self.dim();
        if rigid.len() == n {
            return Ok(Kind::Undecided { flat: n });
        }
        let first = self.lowest(1, rigid)?.values()[0].abs();
        let sigma = WELL_BELOW * first.max(FLAT * self.scale() / WELL_BELOW);
        let descents = self.count_below(-sigma)?;
        let flat = self.count_below(sigma)? - descents;
        Ok(if descents > 0 && descents + flat == n {
            Kind::Maximum { descents }
        } else if descents > 0 {
            Kind::Saddle { descents }
        } else if flat > rigid.len() {
            Kind::Undecided { flat }
        } else {
            Kind::Stable
        })
    }
}
