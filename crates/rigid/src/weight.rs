//! What acts on bodies: nothing at all, or their weight.
//!
//! ```text
//! V = -sum m g.(t + R c)                  weight of a mass m at the body's point c
//! dV = (-m g, -m c x R^T g)               world axes, body axes
//! d2V(a, b) = -m [ (a.c)(b.G) + (a.G)(b.c) ]/2 + m (G.c)(a.b),    G = R^T g
//! ```
//! `t R` the body's pose, `a b` turns in body axes. Second derivatives are those of `V(R exp(s a +
//! u b))`, which are symmetric. A body on a fixed point whose centre of mass is at `c` is a heavy
//! top. Source: notes 0.3, 10.1.2; errata 0.3.

use nalgebra::{Matrix3, Vector3};
use stationary_calculus::{Covector, Potential, PotentialOn, Sink};

use crate::BodySpace;
use crate::space::pose_or_none;

/// No potential at all.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Free {
    /// The number of freedoms.
    pub freedoms: usize,
}

impl<S: BodySpace> PotentialOn<S> for Free {}

impl Potential for Free {
    fn dim(&self) -> usize {
        self.freedoms
    }

    #[inline]
    fn energy(&self, _q: &[f64]) -> f64 {
        0.0
    }

    #[inline]
    fn add_differential(&self, _q: &[f64], _dv: Covector<&mut [f64]>) {}

    fn add_hessian(&self, _q: &[f64], _hessian: &mut impl Sink) {}
}

/// A mass at a point of a body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMass {
    /// Its mass, kg.
    pub mass: f64,
    /// Where it is, metres, body axes.
    pub point: Vector3<f64>,
}

/// The weight of bodies in a uniform field, one point mass a body.
#[derive(Clone, Debug, PartialEq)]
pub struct Weight<S> {
    /// The acceleration of gravity, m/s^2, world axes.
    pub gravity: Vector3<f64>,
    /// Where each body's weight acts.
    pub masses: Vec<PointMass>,
    /// Whether the bodies are free or turn about fixed points.
    pub space: S,
}

impl<S: BodySpace> PotentialOn<S> for Weight<S> {}

impl<S: BodySpace> Potential for Weight<S> {
    fn dim(&self) -> usize {
        S::FREEDOMS * self.masses.len()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let one = |(body, load): (usize, &PointMass)| {
            -load.mass * self.gravity.dot(&pose_or_none::<S>(q, body).apply(&load.point))
        };
        self.masses.iter().enumerate().map(one).sum()
    }

    #[inline]
    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let bodies = self.masses.iter().zip(dv.0.chunks_exact_mut(S::FREEDOMS));
        for (body, (load, dv)) in bodies.enumerate() {
            for (dv, g) in dv.iter_mut().zip(&self.gravity).take(S::TRANSLATION) {
                *dv -= load.mass * g;
            }
            let torque =
                load.point.cross(&pose_or_none::<S>(q, body).rotation.rotate_back(&self.gravity));
            for c in 0..3 {
                dv[S::TRANSLATION + c] -= load.mass * torque[c];
            }
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for (body, PointMass { mass, point }) in self.masses.iter().enumerate() {
            let g = pose_or_none::<S>(q, body).rotation.rotate_back(&self.gravity);
            let product = g * point.transpose();
            let block = Matrix3::identity() * g.dot(point) - (product + product.transpose()) * 0.5;
            let first = S::FREEDOMS * body + S::TRANSLATION;
            let freedoms = [first, first + 1, first + 2];
            hessian.add_symmetric(&freedoms, (block * *mass).as_slice());
        }
    }
}
