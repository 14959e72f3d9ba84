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

use crate::detect::broad_phase::BoxTree;
use crate::solve::island_solver::SolvesIslands;
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
    /// A normal, and the directions across it: one in the plane, two in space.
    type Directions: Copy + Debug + AsRef<[Self::Vector]>;
    /// The stored numbers of a body's pose.
    type Stored: AsRef<[f64]> + IntoIterator<Item = f64>;
    /// A body's velocity as it is stored, or the derivatives of something by its freedoms.
    type Velocity: Copy
        + Debug
        + Default
        + PartialEq
        + AsRef<[f64]>
        + AsMut<[f64]>
        + IntoIterator<Item = f64>;
    /// An angular velocity or a torque, world axes.
    type Spin: Copy
        + Debug
        + Default
        + Add<Output = Self::Spin>
        + Sub<Output = Self::Spin>
        + Mul<f64, Output = Self::Spin>;
    /// How a body turns into world axes, in the form that turns vectors fastest.
    type Frame: Copy + Debug;

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

    /// A unit normal, and the unit directions across it and each other, in which friction acts.
    fn directions(normal: &Self::Vector) -> Self::Directions;

    /// Where a motion takes the origin.
    fn translation(motion: &Self::Motion) -> Self::Vector;

    /// How a motion turns.
    fn frame(motion: &Self::Motion) -> Self::Frame;

    /// A direction of a body in world axes.
    fn rotate(frame: &Self::Frame, direction: &Self::Vector) -> Self::Vector;

    /// A direction of the world in a body's axes.
    fn rotate_back(frame: &Self::Frame, direction: &Self::Vector) -> Self::Vector;

    /// The torque of a force at the end of an arm, world axes.
    fn torque(arm: &Self::Vector, force: &Self::Vector) -> Self::Spin;

    /// How fast the end of an arm moves by a spin, world axes.
    fn swing(spin: &Self::Spin, arm: &Self::Vector) -> Self::Vector;

    /// The parts of a spin across a normal and along it: rolling, and torsion, which the plane has not.
    fn parts_of_spin(spin: &Self::Spin, normal: &Self::Vector) -> [Self::Spin; 2];

    /// The inner product of spins.
    fn along_spin(a: &Self::Spin, b: &Self::Spin) -> f64;

    /// The length of a spin.
    fn spin_speed(spin: &Self::Spin) -> f64;

    /// Two halves in world axes, of velocities or of forces, as a body stores them.
    fn join(frame: &Self::Frame, linear: &Self::Vector, spin: &Self::Spin) -> Self::Velocity;

    /// The two halves of what a body stores, in world axes.
    fn split(frame: &Self::Frame, stored: &Self::Velocity) -> (Self::Vector, Self::Spin);

    /// The rate at which the end of an arm (world axes) moves along a direction, by the body's
    /// freedoms.
    #[inline]
    fn row(frame: &Self::Frame, arm: &Self::Vector, direction: &Self::Vector) -> Self::Velocity {
        Self::join(frame, direction, &Self::torque(arm, direction))
    }

    /// The same, with the arm and the direction as the body sees them beside that in world axes.
    fn seen_row(
        arm: &Self::Vector,
        direction: &Self::Vector,
        seen: &Self::Vector,
    ) -> Self::Velocity;

    /// One over the roots of masses and moments, for each body.
    fn scales(metric: &Self::Metric) -> Vec<Self::Velocity>;

    /// The motion of the second as seen from the first.
    fn relative(first: &Self::Motion, second: &Self::Motion) -> Self::Motion;

    /// How far two motions are from each other: metres, and a bound on the angle, radians.
    fn apart(first: &Self::Motion, second: &Self::Motion) -> [f64; 2];

    /// The numbers of a motion, as configurations store it.
    fn numbers(motion: &Self::Motion) -> Self::Stored;

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
    /// What solves the contacts of an island.
    #[doc(hidden)]
    type Solver: SolvesIslands<Self>;

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

    /// A motion that goes on with a velocity, as it is stored, for a time.
    #[doc(hidden)]
    fn walked(motion: &Self::Motion, velocity: &Self::Velocity, time: f64) -> Self::Motion;

    /// The closest points of two convex parts of shapes, world axes, where they are apart and there is
    /// a query.
    #[doc(hidden)]
    fn closest(
        shapes: [&Self::Shape; 2],
        parts: [u32; 2],
        poses: [&Self::Pose; 2],
        room: &mut Self::Room,
        found: &mut Vec<Facing<Self::Vector>>,
    ) -> Option<Closest<Self::Vector>>;

    /// How far a convex part of a shape reaches along a direction of its axes, of any length.
    #[doc(hidden)]
    fn farthest(shape: &Self::Shape, part: u32, direction: &Self::Vector) -> f64;

    /// Writes the numbers of the convex parts of a shape that may reach into a box of its axes.
    #[doc(hidden)]
    fn parts_within(
        shape: &Self::Shape,
        low: &Self::Vector,
        high: &Self::Vector,
        parts: &mut Vec<u32>,
    );

    /// Whether a shape is several parts with edges between them.
    #[doc(hidden)]
    fn has_parts(shape: &Self::Shape) -> bool;

    /// A point amid a part of a shape, axes of the shape.
    #[doc(hidden)]
    fn middle(shape: &Self::Shape, part: u32) -> Self::Vector;

    /// The point of a shape that is closest to a point, which it is where the shape holds it.
    #[doc(hidden)]
    fn nearest(shape: &Self::Shape, point: &Self::Vector) -> Self::Vector;

    /// How far along a ray of unit direction it meets a shape, at most `longest`, and the normal there, against the
    /// ray where that starts inside; in the axes of the shape.
    #[doc(hidden)]
    fn cast(
        shape: &Self::Shape,
        start: &Self::Vector,
        direction: &Self::Vector,
        longest: f64,
    ) -> Option<(f64, Self::Vector)>;

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

/// The closest points of two convex parts that are apart.
#[doc(hidden)]
#[derive(Clone, Copy, Debug)]
pub struct Closest<V> {
    pub points: [V; 2],
    /// From the first to the second, of length 1, where it is known better than by the points.
    pub normal: Option<V>,
    pub distance: f64,
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

/// Directions that differ from a half-space's normal by less are the normal: rotations round.
const SAME_DIRECTION: f64 = 64.0 * f64::EPSILON;

/// How far a half-space through the origin reaches along a direction that differs by so much from
/// its normal.
pub(crate) fn farthest_of_plane(length: f64, differs: f64) -> f64 {
    if length == 0.0 || differs <= SAME_DIRECTION { 0.0 } else { f64::INFINITY }
}

pub(crate) mod sealed {
    pub trait Sealed {}
}
