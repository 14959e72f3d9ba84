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

    /// The first number at which `q` is no configuration of this space, as a quaternion whose length is
    /// not one; `None` where it is one.
    fn first_misfit(&self, _q: &[f64]) -> Option<usize> {
        None
    }
}

/// A space on which moving is not addition, so that what reads flat configurations does not fit.
pub trait Curved: Space {}

/// A potential that reads the configurations of the space S: all do where S is flat, elsewhere those
/// that say so.
///
/// ```compile_fail
/// use stationary_calculus::{Curved, DiagonalMetric, Potential, Space, System, Vector};
/// struct Circle;
/// impl Curved for Circle {}
/// impl Space for Circle {
///     fn stored(&self, freedoms: usize) -> usize {
///         2 * freedoms
///     }
///     fn advance(&self, _: &mut [f64], _: f64, _: Vector<&[f64]>) {}
/// }
/// // A potential of flat coordinates does not read a point of a circle.
/// fn on_a_circle(metric: DiagonalMetric<[f64; 1]>, flat: impl Potential) {
///     System::on(Circle, metric, flat);
/// }
/// ```
pub trait PotentialOn<S>: Potential {}

impl<P: Potential> PotentialOn<Flat> for P {}
impl<S: Curved, P: PotentialOn<S>> PotentialOn<S> for &P {}
impl<S: Curved, P: PotentialOn<S>> PotentialOn<S> for Option<P> {}
impl<S: Curved, P: PotentialOn<S>> PotentialOn<S> for Vec<P> {}
impl<S: Curved, A: PotentialOn<S>, B: PotentialOn<S>> PotentialOn<S> for (A, B) {}
impl<S: Curved, A: PotentialOn<S>, B: PotentialOn<S>, C: PotentialOn<S>> PotentialOn<S>
    for (A, B, C)
{
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
    ///
    /// # Errors
    /// Those of [`System::on`].
    pub fn new(metric: M, potential: P) -> Result<Self, SizeError> {
        System::on(Flat, metric, potential)
    }
}

impl<M: Metric, P: Potential, S: Space> System<M, P, S> {
    /// A system on any space.
    ///
    /// # Errors
    /// A metric and a potential of different numbers of freedoms.
    pub fn on(space: S, metric: M, potential: P) -> Result<Self, SizeError>
    where
        P: PotentialOn<S>,
    {
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
