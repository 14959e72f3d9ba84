//! A constraint applied to multipliers: one number, and so a potential.
//!
//! ```text
//! V(q) = sum_i lambda_i g_i(t, q),    dV = J^T lambda,    d2V = sum_i lambda_i d2g_i
//! ```
//! It is the term that the Lagrangian of a constrained system gains (notes 6.4, 6.5), and the way
//! to check a constraint that is written by hand: every entry of J and of the second differential
//! is wrong in V's derivatives if it is wrong at all. Takes memory at each energy; not for a step.
//!
//! ```
//! use stationary_calculus::assert_derivatives;
//! use stationary_constraints::{Pairing, Rod, Rods};
//! let rods = Rods::new(2, vec![[0.0, 0.0]], vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0)])?;
//! let pairing = Pairing::new(rods, vec![0.7, -1.3], 0.0)?;
//! assert_derivatives(&pairing, &[0.6, -0.8, 1.0, 1.1]);
//! # Ok::<(), stationary_constraints::ConstraintError>(())
//! ```

use stationary_calculus::{Covector, Potential, Sink, SizeError};

use crate::rows::add_pulled_back;
use crate::{Constraint, check_multipliers};

/// A constraint applied to multipliers, at a fixed time.
#[derive(Clone, Debug)]
pub struct Pairing<K> {
    constraint: K,
    multipliers: Vec<f64>,
    time: f64,
}

impl<K: Constraint> Pairing<K> {
    /// A constraint with its multipliers, at a time in seconds.
    ///
    /// # Errors
    /// Another number of multipliers than of equations.
    pub fn new(constraint: K, multipliers: Vec<f64>, time: f64) -> Result<Self, SizeError> {
        check_multipliers(constraint.count(), &multipliers)?;
        Ok(Pairing { constraint, multipliers, time })
    }
}

/// A system checks sizes once, when it is made; of a configuration that is too short nothing is finite.
impl<K: Constraint> Potential for Pairing<K> {
    fn dim(&self) -> usize {
        self.constraint.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let mut g = vec![0.0; self.constraint.count()];
        if self.constraint.value(self.time, q, &mut g).is_err() {
            return f64::NAN;
        }
        self.multipliers.iter().zip(&g).map(|(lambda, g)| lambda * g).sum()
    }

    fn add_differential(&self, q: &[f64], mut dv: Covector<&mut [f64]>) {
        let Pairing { constraint, multipliers, time } = self;
        if add_pulled_back(constraint, *time, q, 1.0, multipliers, dv.view_mut()).is_err() {
            dv.0.fill(f64::NAN);
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        if self.constraint.add_hessian(self.time, q, &self.multipliers, hessian).is_err() {
            hessian.add_symmetric(&[0], &[f64::NAN]);
        }
    }
}
