//! A mechanical system: a metric, a potential, and how its configurations move.
//!
//! ```text
//! E(q, p) = 1/2 <p, M^-1 p> + V(q)        energy, joules
//! q <- q exp(h v)                          how a configuration moves along a velocity
//! ```
//! On flat spaces moving is addition, `q + h v` ([`Flat`]); where rotations live it is the
//! exponential map, and `q` stores more numbers than there are freedoms.

use crate::{Covector, Metric, Potential, SizeError, Vector};

/// How the configurations of a system move along velocities.
pub trait Space {
    /// How many numbers store a configuration of `freedoms` freedoms.
    fn stored(&self, freedoms: usize) -> usize;

    /// Moves `q` along the velocity `v` for the time `h`.
    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>);
}

/// The flat space R^n, where moving is addition.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Flat;

impl Space for Flat {
    fn stored(&self, freedoms: usize) -> usize {
        freedoms
    }

    #[inline]
    fn advance(&self, q: &mut [f64], h: f64, v: Vector<&[f64]>) {
        crate::vectors::add_scaled(q, h, v.0);
    }
}

/// A metric and a potential of the same dimension on a space.
#[derive(Clone, Debug)]
pub struct System<M, P, S = Flat> {
    metric: M,
    potential: P,
    space: S,
}

impl<M: Metric, P: Potential> System<M, P> {
    /// A system on flat space.
    pub fn new(metric: M, potential: P) -> Result<Self, SizeError> {
        System::on(Flat, metric, potential)
    }
}

impl<M: Metric, P: Potential, S: Space> System<M, P, S> {
    /// A system on any space.
    pub fn on(space: S, metric: M, potential: P) -> Result<Self, SizeError> {
        SizeError::check("the potential's freedoms", metric.dim(), potential.dim())?;
        Ok(System { metric, potential, space })
    }

    /// The number of freedoms n: of velocities, momenta and differentials.
    #[inline]
    pub fn dim(&self) -> usize {
        self.metric.dim()
    }

    /// The kinetic-energy metric.
    #[inline]
    pub fn metric(&self) -> &M {
        &self.metric
    }

    /// The potential.
    #[inline]
    pub fn potential(&self) -> &P {
        &self.potential
    }

    /// The space on which configurations move.
    #[inline]
    pub fn space(&self) -> &S {
        &self.space
    }

    /// The energy `1/2 <p, M^-1 p> + V(q)`, joules.
    pub fn energy(&self, q: &[f64], p: Covector<&[f64]>) -> f64 {
        self.metric.kinetic_energy(p) + self.potential.energy(q)
    }
}
