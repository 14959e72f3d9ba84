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
//! let pairing = Pairing { constraint: rods, multipliers: vec![0.7, -1.3], time: 0.0 };
//! assert_derivatives(&pairing, &[0.6, -0.8, 1.0, 1.1]);
//! # Ok::<(), stationary_constraints::ConstraintError>(())
//! ```

use stationary_calculus::{Covector, Potential, Sink};

use crate::Constraint;
use crate::rows::add_pulled_back;

/// A constraint applied to multipliers, at a fixed time.
#[derive(Clone, Debug)]
pub struct Pairing<K> {
    /// The constraint.
    pub constraint: K,
    /// Its multipliers, as many as it has equations; where some are missing, nothing is a number.
    pub multipliers: Vec<f64>,
    /// The time, seconds.
    pub time: f64,
}

impl<K: Constraint> Potential for Pairing<K> {
    fn dim(&self) -> usize {
        self.constraint.dim()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let mut g = vec![0.0; self.constraint.count()];
        self.constraint.value(self.time, q, &mut g);
        if self.multipliers.len() < g.len() {
            return f64::NAN;
        }
        self.multipliers.iter().zip(&g).map(|(lambda, g)| lambda * g).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        add_pulled_back(&self.constraint, self.time, q, 1.0, &self.multipliers, dv);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.constraint.add_hessian(self.time, q, &self.multipliers, hessian);
    }
}
