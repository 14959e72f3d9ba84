//! Where a body is, how fast, and how impulses move it.
//!
//! ```text
//! v+ = v + M^-1/2 w,   w = M^-1/2 J^T x          J the rate of a point along a direction
//! ```
//! `x` an impulse at the point (N s), `M` the masses and moments (kg, kg m^2), `w` scaled changes of
//! velocities. What no impulse moves has a scale of zeros.

use crate::Dimension;

/// A body before any impulse of a step.
#[derive(Clone, Copy, Debug)]
pub struct BodyState<G: Dimension> {
    /// Where its centre is, m, and how it turns into world axes.
    pub(crate) centre: G::Vector,
    pub(crate) frame: G::Frame,
    /// One over the root of mass and moments; zeros where no impulse moves it.
    pub(crate) scale: G::Velocity,
    /// Its velocity before any impulse, as it is stored.
    pub(crate) velocity: G::Velocity,
}

impl<G: Dimension> BodyState<G> {
    /// A body at its pose among `q` with its velocity among `v`.
    #[inline]
    pub(crate) fn new(body: usize, scale: G::Velocity, q: &[f64], v: &[f64]) -> Self {
        let pose = G::pose(q, body);
        let (centre, frame) = (G::translation(&pose), G::frame(&pose));
        let mut velocity = G::Velocity::default();
        velocity.as_mut().copy_from_slice(&v[G::FREEDOMS * body..][..G::FREEDOMS]);
        BodyState { centre, frame, scale, velocity }
    }

    /// Whether impulses move it.
    #[inline]
    pub(crate) fn moves(&self) -> bool {
        self.scale.as_ref()[0] > 0.0
    }
}

/// How fast what is within a radius of a body's centre moves at most, at this velocity of the body.
#[inline]
pub(crate) fn speed<G: Dimension>(velocity: &[f64], radius: f64) -> f64 {
    let length = |x: &[f64]| x.iter().map(|x| x * x).sum::<f64>().sqrt();
    length(&velocity[..G::TRANSLATION]) + radius * length(&velocity[G::TRANSLATION..])
}
