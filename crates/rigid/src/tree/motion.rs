//! A tree at a configuration, in motion: the workspace of every algorithm.
//!
//! It owns its tree and all memory: nothing here allocates once it is made. Place it with
//! [`TreeMotion::place`], then ask: poses and velocities, accelerations or forces, the mass matrix,
//! energy and momenta of that place.

use nalgebra::{Matrix3, Vector3};

use super::builder::{Link, Tree};
use super::error::TreeError;
use super::inertia::Inertia;
use super::spatial::{SpatialForce, Twist};
use crate::{BodyMotion, LieGroup, RigidMotion, Rotation};

/// Where a body is, in world axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    pub centre: Vector3<f64>,
    pub rotation: Rotation,
    pub matrix: Matrix3<f64>,
    /// From the parent's centre, or the origin, to the origin of the joint's frame on the body.
    pub reach: Vector3<f64>,
    /// From there to the body's centre.
    pub arm: Vector3<f64>,
}

/// How a body moves, in world axes, about its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moving {
    pub twist: Twist,
    /// Its acceleration where the parent's is zero, and that of every speed.
    pub bias: Twist,
}

impl Placed {
    /// The origin, from which what has no parent hangs.
    fn ground() -> Self {
        Placed {
            centre: Vector3::zeros(),
            rotation: Rotation::identity(),
            matrix: Matrix3::identity(),
            reach: Vector3::zeros(),
            arm: Vector3::zeros(),
        }
    }

    /// Turns the body of a link so that its joint's frame has this rotation.
    #[inline]
    pub(super) fn turn_by(&mut self, frame: &Rotation, link: &Link) {
        self.rotation = if link.turned[1] { frame.compose(&link.after.rotation) } else { *frame };
        self.matrix = self.rotation.matrix();
        self.arm = -(self.matrix * link.on_body.translation);
    }

    /// From the parent's centre, or the origin, to the body's.
    #[inline]
    pub(super) fn offset(&self) -> Vector3<f64> {
        self.reach + self.arm
    }

    /// The inertia of a body with these moments times an angular vector.
    #[inline]
    pub(super) fn moments_times(&self, moments: &Vector3<f64>, w: &Vector3<f64>) -> Vector3<f64> {
        self.matrix * moments.component_mul(&self.matrix.tr_mul(w))
    }
}

/// A tree at a configuration, in motion.
#[derive(Clone, Debug)]
pub struct TreeMotion {
    pub(super) tree: Tree,
    pub(super) coordinates: Vec<f64>,
    pub(super) ground: Placed,
    pub(super) placed: Vec<Placed>,
    pub(super) moving: Vec<Moving>,
    /// A twist for every speed, at the centre of the body that it moves first.
    pub(super) columns: Vec<Twist>,
    pub(super) inertias: Vec<Inertia>,
    pub(super) forces: Vec<SpatialForce>,
    pub(super) accelerations: Vec<Twist>,
    /// The inertia of the branch times the twist of a freedom, when that gives way.
    pub(super) levers: Vec<SpatialForce>,
    /// One over the inertia that it meets then.
    pub(super) inverses: Vec<f64>,
    /// The joint force that is left for it.
    pub(super) rest: Vec<f64>,
    /// Speeds that give no way, whatever the forces.
    pub(super) held: Vec<usize>,
}

impl TreeMotion {
    /// A tree at rest, with every joint's frames coincident.
    pub fn new(tree: Tree) -> Self {
        let (n, f) = (tree.bodies(), tree.speeds());
        let still = Moving { twist: Twist::zero(), bias: Twist::zero() };
        let mut motion = TreeMotion {
            coordinates: tree.rest(),
            ground: Placed::ground(),
            placed: vec![Placed::ground(); n],
            moving: vec![still; n],
            columns: vec![Twist::zero(); f],
            inertias: vec![Inertia::zero(); n],
            forces: vec![SpatialForce::zero(); n],
            accelerations: vec![Twist::zero(); n],
            levers: vec![SpatialForce::zero(); f],
            inverses: vec![0.0; f],
            rest: vec![0.0; f],
            held: Vec::new(),
            tree,
        };
        let q = motion.tree.rest();
        motion.put(&q);
        motion
    }

    /// The tree.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }

    /// The coordinates of its joints.
    pub fn coordinates(&self) -> &[f64] {
        &self.coordinates
    }

    /// The pose of a body: its centre, and what turns its axes into the world's.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`].
    pub fn pose(&self, body: usize) -> Result<RigidMotion, TreeError> {
        let placed = self.placed(body)?;
        Ok(RigidMotion { translation: placed.centre, rotation: placed.rotation })
    }

    /// The motion of a body, as [`BodyMetric::state`](crate::BodyMetric::state) takes it.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`].
    pub fn body(&self, body: usize) -> Result<BodyMotion, TreeError> {
        let (placed, twist) = (self.placed(body)?, self.moving[body].twist);
        Ok(BodyMotion {
            pose: RigidMotion { translation: placed.centre, rotation: placed.rotation },
            velocity: twist.linear,
            angular_velocity: placed.matrix.tr_mul(&twist.angular),
        })
    }

    /// The largest of the ways from body to body and of the radii of gyration, metres.
    pub(super) fn extent(&self) -> f64 {
        let way = |at: &Placed| at.reach.norm().max(at.arm.norm());
        self.placed.iter().map(way).fold(self.tree.radius(), f64::max)
    }

    pub(super) fn placed(&self, body: usize) -> Result<&Placed, TreeError> {
        let bodies = self.placed.len();
        self.placed.get(body).ok_or(TreeError::NoSuchBody { body, bodies })
    }
}
