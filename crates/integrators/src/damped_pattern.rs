//! Where the matrix of an implicit step with a force has its entries.
//!
//! ```text
//! d2V(q) + K + C,    K = -dF/dq,  C = -dF/dv       n x n, symmetric; a step weighs them, which moves no entry
//! ```
//! A sparse solver is analysed with this in place of the potential. It is no potential of the
//! motion: nothing but its entries' places is used.

use stationary_calculus::{Covector, Force, Potential, Sink, Vector};

/// A potential and a force beside it, for the pattern of their step's matrix.
#[derive(Clone, Copy, Debug)]
pub struct DampedPattern<'a, P, F> {
    /// The potential.
    pub potential: &'a P,
    /// The force.
    pub force: &'a F,
}

impl<P: Potential, F: Force> Potential for DampedPattern<'_, P, F> {
    fn dim(&self) -> usize {
        self.potential.dim().max(self.force.dim())
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.potential.energy(q)
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        self.potential.add_differential(q, dv);
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        self.potential.add_hessian(q, hessian);
        self.force.add_stiffness(0.0, q, hessian);
        let rest = vec![0.0; self.dim()];
        self.force.add_damping(0.0, q, Vector(&rest), hessian);
    }
}
