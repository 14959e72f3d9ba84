//! A planet and a spring as discrete Lagrangians.

use stationary_calculus::{Energy, Number};
use stationary_integrators::{Mechanical, Quadrature, Sampled};

/// A planet about a fixed sun: V = -1/|q|.
#[derive(Clone, Copy, Debug)]
pub struct Sun;

impl Energy<2> for Sun {
    fn energy<R: Number>(&self, [x, y]: [R; 2]) -> R {
        -(x * x + y * y).sqrt().recip()
    }
}

/// A unit mass on a spring of stiffness 1: V = q^2/2.
#[derive(Clone, Copy, Debug)]
pub struct Spring;

impl Energy<1> for Spring {
    fn energy<R: Number>(&self, [q]: [R; 1]) -> R {
        q * q * 0.5
    }
}

/// The Lagrangian of unit masses, sampled by a quadrature.
pub fn sampled<E: Energy<N>, const N: usize>(
    energy: E,
    quadrature: Quadrature,
) -> Sampled<Mechanical<E, N>> {
    Sampled { lagrangian: Mechanical::new([1.0; N], energy).unwrap(), quadrature }
}
