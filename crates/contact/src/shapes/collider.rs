//! A collider: a shape, who carries it, and what its surface is like.
//!
//! ```text
//! world = pose of the body, then the place of the shape on it
//! c = min(c1, c2),   mu = sqrt(mu1 mu2)          of a pair of surfaces
//! ```
//! `c` restitution, 0 to 1; `mu` friction. Both are properties of a pair of materials; where only
//! single surfaces are known these rules combine them. Notes 11.4.2.

use stationary_rigid::LieGroup;

use crate::{ContactError, Dimension};

/// Who carries a shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Carrier {
    /// The body of this number; the shape is placed in its axes.
    Body(usize),
    /// Nobody: the shape is placed in the world, and stays.
    World,
}

/// A shape in the plane or in space.
#[derive(Clone, Debug)]
pub struct ColliderIn<G: Dimension> {
    /// Its shape.
    pub shape: G::Shape,
    /// Who carries it.
    pub carrier: Carrier,
    /// Where it is on its carrier.
    pub place: G::Motion,
    /// Its restitution, 0 to 1.
    pub restitution: f64,
    /// Its friction, at least 0.
    pub friction: f64,
    /// The groups that it is in, a bit each.
    pub groups: u32,
    /// The groups that it meets, a bit each.
    pub meets: u32,
    /// Whether it only feels what overlaps it ([`crate::DetectorIn::sensed`]), and takes no impulse.
    pub sensor: bool,
}

/// A shape in space.
#[cfg(feature = "3d")]
pub type Collider = ColliderIn<crate::Spatial>;
/// A shape in the plane.
#[cfg(feature = "2d")]
pub type PlanarCollider = ColliderIn<crate::Planar>;

impl<G: Dimension> ColliderIn<G> {
    fn new(carrier: Carrier, shape: G::Shape, place: G::Motion, surface: f64) -> Self {
        let (restitution, friction) = (surface, surface);
        let (groups, meets, sensor) = (u32::MAX, u32::MAX, false);
        ColliderIn { shape, carrier, place, restitution, friction, groups, meets, sensor }
    }

    /// A shape in the axes of a body, inelastic and without friction, in all groups.
    pub fn on_body(body: usize, shape: G::Shape) -> Self {
        Self::new(Carrier::Body(body), shape, G::Motion::identity(), 0.0)
    }

    /// A shape that stays where it is, perfectly elastic and perfectly rough, so that what touches
    /// it decides.
    pub fn fixed(place: G::Motion, shape: G::Shape) -> Self {
        Self::new(Carrier::World, shape, place, 1.0)
    }

    /// The same with this restitution.
    pub fn with_restitution(self, restitution: f64) -> Self {
        ColliderIn { restitution, ..self }
    }

    /// The same with this friction.
    pub fn with_friction(self, friction: f64) -> Self {
        ColliderIn { friction, ..self }
    }

    /// The same in these groups, a bit each, and meeting those. Two colliders have contacts where each is in a group
    /// that the other meets: in no group, or meeting none, it passes through everything.
    pub fn in_groups(self, groups: u32, meets: u32) -> Self {
        ColliderIn { groups, meets, ..self }
    }

    /// The same as a sensor: it takes no impulse, and says what overlaps it ([`crate::DetectorIn::sensed`]).
    pub fn as_sensor(self) -> Self {
        ColliderIn { sensor: true, ..self }
    }

    /// Whether each of two is in a group that the other meets.
    pub(crate) fn meets(&self, other: &Self) -> bool {
        self.groups & other.meets != 0 && other.groups & self.meets != 0
    }

    /// The body that carries it.
    pub fn body(&self) -> Option<usize> {
        match self.carrier {
            Carrier::Body(body) => Some(body),
            Carrier::World => None,
        }
    }

    pub(crate) fn check(&self, contact: usize) -> Result<(), ContactError> {
        G::check_place(&self.place)?;
        check_surface(contact, self.restitution, self.friction)
    }
}

pub(crate) fn check_surface(
    contact: usize,
    restitution: f64,
    friction: f64,
) -> Result<(), ContactError> {
    if !(0.0..=1.0).contains(&restitution) {
        return Err(ContactError::Restitution { contact, value: restitution });
    }
    if !(friction >= 0.0 && friction.is_finite()) {
        return Err(ContactError::Friction { contact, value: friction });
    }
    Ok(())
}
