//! The plane and space: what contact needs to know of each, and nothing else of contact does.
//!
//! ```text
//!             planar                          spatial
//! q           x, y, theta                     t (3), quaternion (4)
//! v           x., y., theta.                  t. (3), omega in body axes (3)
//! x = t + R c                                 a point of the body, c in body axes
//! x. = t. + theta. Z R c                      x. = t. + R (omega x c)
//! f.x. = (f, f.Z R c) v                       f.x. = (f, c x R^T f) v                      (10.1)
//! ```
//! `R` the rotation by `theta` (radians, of the world zero) or by the quaternion, `Z` a quarter
//! turn; metres and seconds. Planar bodies live on flat space (7.4). Everything that is the same in
//! both is written once, for a [`Dimension`]; what differs is below, and in one border file for
//! each. Source: notes 7.4, 10.1, 11.2.

use std::fmt::Debug;
use std::ops::{Add, IndexMut, Mul, Sub};

use stationary_calculus::{Metric, Space};
use stationary_rigid::LieGroup;

use crate::broad_phase::BoxTree;
use crate::{ContactError, ContactId};

/// The plane or space; there are no others.
pub trait Dimension: sealed::Sealed + Copy + Debug + PartialEq + 'static {
    /// A point or a direction, metres.
    type Vector: Copy
        + Debug
        + Default
        + PartialEq
        + IndexMut<usize, Output = f64>
        + Add<Output = Self::Vector>
        + Sub<Output = Self::Vector>
        + Mul<f64, Output = Self::Vector>;
    /// Where something is.
    type Motion: LieGroup + Debug;
    /// The shapes that queries accept.
    type Shape: Clone + Debug;
    /// The kinetic-energy metric of bodies.
    type Metric: Metric + Debug;
    /// How configurations of bodies move.
    type Space: Space + Debug;
    /// Directions across a normal: one in the plane, two in space.
    type Across: IntoIterator<Item = Self::Vector>;
    /// The derivatives of something with respect to a body's freedoms.
    type Row: IntoIterator<Item = f64>;

    /// Freedoms of translation of a body, in front of its rotation.
    const TRANSLATION: usize;
    /// Freedoms of a body.
    const FREEDOMS: usize;
    /// Numbers that store a body's configuration.
    const STORED: usize;

    /// Where a body is.
    fn pose(q: &[f64], body: usize) -> Self::Motion;

    /// Checks that every pose is one.
    ///
    /// # Errors
    /// In the plane [`ContactError::NonFinite`]. In space [`ContactError::Rigid`]: numbers that are
    /// not finite or not seven a body, a quaternion whose length is not 1.
    fn check(q: &[f64]) -> Result<(), ContactError>;

    /// Checks that a place is one.
    ///
    /// # Errors
    /// [`ContactError::NonFinite`].
    fn check_place(place: &Self::Motion) -> Result<(), ContactError>;

    /// Where a point of a body is in the world.
    fn apply(pose: &Self::Motion, point: &Self::Vector) -> Self::Vector;

    /// A direction of a body as seen from the world.
    fn turn(pose: &Self::Motion, direction: &Self::Vector) -> Self::Vector;

    /// The inner product.
    fn dot(a: &Self::Vector, b: &Self::Vector) -> f64;

    /// The unit directions across a unit normal and each other, in which friction acts.
    fn across(normal: &Self::Vector) -> Self::Across;

    /// The rate at which a point of a body moves along a direction, by its freedoms.
    fn row(q: &[f64], body: usize, arm: &Self::Vector, direction: &Self::Vector) -> Self::Row;

    /// How fast a point of a body moves.
    fn velocity(q: &[f64], v: &[f64], body: usize, arm: &Self::Vector) -> Self::Vector;

    /// Moves bodies freely: centres straight by `h v`, and what turns keeps its spin.
    ///
    /// # Errors
    /// In space [`ContactError::Step`] where the equation of a turn is not solved; the bodies
    /// before that one have moved. In the plane none.
    fn advance(
        metric: &Self::Metric,
        q: &mut [f64],
        v: &[f64],
        p: &mut [f64],
        h: f64,
    ) -> Result<(), ContactError>;

    /// A pose as the geometry library has it.
    #[doc(hidden)]
    type Pose: Copy;
    /// The geometry library's hierarchy of boxes.
    #[doc(hidden)]
    type Tree: BoxTree<Self>;
    /// What a query needs room for.
    #[doc(hidden)]
    type Room: Default;

    #[doc(hidden)]
    fn convert(pose: &Self::Motion) -> Self::Pose;

    #[doc(hidden)]
    fn name(shape: &Self::Shape) -> &'static str;

    /// The normal of a half-space.
    #[doc(hidden)]
    fn plane(shape: &Self::Shape) -> Option<Self::Vector>;

    /// The radius of a ball about a body's centre that holds a shape at a place.
    #[doc(hidden)]
    fn reach(shape: &Self::Shape, place: &Self::Motion) -> f64;

    /// Appends where two shapes face each other across at most `margin`.
    #[doc(hidden)]
    fn face(
        shapes: [&Self::Shape; 2],
        poses: [&Self::Pose; 2],
        margin: f64,
        room: &mut Self::Room,
        found: &mut Vec<Facing<Self::Vector>>,
    ) -> Answer;
}

/// What is known of where two shapes face each other.
#[doc(hidden)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// There is no query for them.
    None,
    /// Where they are now.
    Now,
    /// Corners of one face a plane of the other, the first (0) or the second (1): after a small
    /// motion they still do.
    Plane(usize),
}

/// Two points of shapes that face each other.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Facing<V> {
    pub parts: [u32; 2],
    pub features: [u32; 2],
    /// Each in the axes of its shape.
    pub points: [V; 2],
    /// From the first to the second, axes of the first.
    pub normal: V,
    pub gap: f64,
}

impl<V> Facing<V> {
    pub(crate) fn id(&self, colliders: [usize; 2]) -> ContactId {
        let colliders = colliders.map(|c| c as u32);
        ContactId { colliders, parts: self.parts, features: self.features }
    }
}

pub(crate) mod sealed {
    pub trait Sealed {}
}
