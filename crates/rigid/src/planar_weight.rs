//! The weight of bodies in the plane.
//!
//! ```text
//! V = -sum m g.x,    dV = (-m g, 0)
//! ```
//! `x` the centre of mass (m), which is where the freedoms (x, y, theta) of a planar body turn; `m`
//! kg, `g` m/s^2. Linear: no second derivative. Source: notes 0.3, 7.4; errata 0.3.

use nalgebra::Vector2;
use stationary_calculus::{Covector, Potential, Sink};

/// The weight of planar bodies in a uniform field.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarWeight {
    /// The acceleration of gravity, m/s^2.
    pub gravity: Vector2<f64>,
    /// Each body's mass, kg.
    pub masses: Vec<f64>,
}

impl Potential for PlanarWeight {
    fn dim(&self) -> usize {
        3 * self.masses.len()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        // A system checks sizes when it is made; fewer bodies have no energy.
        if q.len() < self.dim() {
            return f64::NAN;
        }
        let bodies = self.masses.iter().zip(q.as_chunks::<3>().0);
        bodies.map(|(m, [x, y, _])| -m * (self.gravity.x * x + self.gravity.y * y)).sum()
    }

    fn add_differential(&self, _q: &[f64], dv: Covector<&mut [f64]>) {
        for (m, [x, y, _]) in self.masses.iter().zip(dv.0.as_chunks_mut::<3>().0) {
            *x -= m * self.gravity.x;
            *y -= m * self.gravity.y;
        }
    }

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}
