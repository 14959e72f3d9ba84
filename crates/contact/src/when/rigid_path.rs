//! How a rigid body moves in a step: its centre along a straight line, while it turns.
//!
//! ```text
//! t(s) = t0 + s v,   R(s) = R0 exp(s w)                                        0 <= s <= 1
//! n.x(s + d) = n.x(s) + d n.x'(s) + r,   |r| <= d^2/2 |w|^2 rho
//! ```
//! `v` a way (m, world axes), `w` a turn (radians, body axes); `x` a point of the body at most `rho`
//! from its centre (m), `n` a unit vector. The remainder is what proofs about whole intervals rest
//! on. Source: notes 8.2, 9.4.

use stationary_rigid::LieGroup;

use crate::error::check_finite;
use crate::{ContactError, Dimension};

/// A rigid motion over one unit of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RigidPathIn<G: Dimension> {
    start: G::Motion,
    /// Way and turn as a body stores its velocity.
    rates: G::Velocity,
    way: G::Vector,
    turn: G::Spin,
}

/// A rigid motion of space.
#[cfg(feature = "3d")]
pub type RigidPath = RigidPathIn<crate::Spatial>;
/// A rigid motion of the plane.
#[cfg(feature = "2d")]
pub type PlanarPath = RigidPathIn<crate::Planar>;

impl<G: Dimension> RigidPathIn<G> {
    /// The centre moves straight by `way` (m, world axes) while the body turns by `turn` (radians,
    /// body axes).
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a start, a way or a turn that is not finite.
    pub fn straight(start: G::Motion, way: G::Vector, turn: G::Spin) -> Result<Self, ContactError> {
        let rates = G::join(&G::frame(&G::Motion::identity()), &way, &turn);
        check_finite("the pose of a path", G::numbers(&start).as_ref())?;
        check_finite("the way and the turn of a path", rates.as_ref())?;
        Ok(RigidPathIn { start, rates, way, turn })
    }

    /// A body that stays.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`] for a pose that is not finite.
    pub fn still(pose: G::Motion) -> Result<Self, ContactError> {
        RigidPathIn::straight(pose, G::Vector::default(), G::Spin::default())
    }

    /// The path of a body whose pose and velocity are those of a state, over a time.
    pub(crate) fn of(start: G::Motion, velocity: &G::Velocity, h: f64) -> Self {
        let mut rates = *velocity;
        rates.as_mut().iter_mut().for_each(|rate| *rate *= h);
        let (way, turn) = G::split(&G::frame(&G::Motion::identity()), &rates);
        RigidPathIn { start, rates, way, turn }
    }

    /// Where the body is at a fraction of the time.
    pub fn at(&self, s: f64) -> G::Motion {
        G::walked(&self.start, &self.rates, s)
    }

    /// The body's way, m, world axes.
    pub(crate) fn way(&self) -> &G::Vector {
        &self.way
    }

    /// The body's turn, radians, body axes.
    pub(crate) fn turn(&self) -> &G::Spin {
        &self.turn
    }

    /// A bound on the acceleration of points at most `radius` from the centre; none of what does not
    /// turn, however large it is.
    pub(crate) fn acceleration(&self, radius: f64) -> f64 {
        let turn = G::spin_speed(&self.turn);
        if turn == 0.0 { 0.0 } else { turn * turn * radius }
    }

    /// How far from the origin the centre comes at most, for what rounding can do.
    pub(crate) fn largest(&self) -> f64 {
        let (from, way) = (G::translation(&self.start), self.way);
        G::dot(&from, &from).sqrt() + G::dot(&way, &way).sqrt()
    }
}
