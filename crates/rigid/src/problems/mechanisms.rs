//! Mechanisms that the multibody community publishes, as their definitions give them.
//!
//! | problem | published as | what it asks for |
//! | --- | --- | --- |
//! | [`four_bars`] | benchmark A02 of the IFToMM library, there with two loops | singular where it lies flat |
//! | [`bricard`] | A04 | redundant equations, everywhere |
//! | [`governor`] | A05 | stiff springs and dampers |
//! | [`squeezer`] | Andrews' mechanism, of the test set for initial value problems | fast turns, three loops |
//!
//! The first of that library, A01, is a point on a rod let go level: a
//! [`pendulum`](stationary_constraints::problems::pendulum) that passes the bottom with the speed `sqrt(2)` in units
//! of its length and of `sqrt(length / gravity)`.
//!
//! Each is told once, by joints between frames, and gives both: bodies held by joints in full coordinates, and a tree
//! whose loops are closed. Joint `k` hangs body `k` from its first end. Sources: Gonzalez, Dopico, Lugris and Cuadrado
//! 2006 (the library); Schiehlen (ed.), Multibody Systems Handbook (1990); Mazzia and Magherini, Test Set for Initial
//! Value Problem Solvers (2008), II-7; Hairer and Wanner, Solving Ordinary Differential Equations II, VII.7.

mod iftomm;
mod squeezer;

use nalgebra::Vector3;
use stationary_calculus::System;
use stationary_integrators::State;

pub use iftomm::{bricard, four_bars, governor};
pub use squeezer::{SQUEEZED, squeezer};

use crate::tree::{Tree, TreeBuilder, TreeError, TreeForces, TreeLoops, TreeMotion};
use crate::{
    Attachment, Body, BodyForces, BodyMetric, BodyMotion, Joint, JointEnd, JointKind, LieGroup,
    PointMass, Poses, RigidError, RigidMotion, Rotation, Weight,
};

/// A spring with a damper between two points.
#[derive(Clone, Copy, Debug)]
pub struct Strut {
    /// The points.
    pub ends: [Attachment; 2],
    /// N/m.
    pub stiffness: f64,
    /// N s/m.
    pub damping: f64,
    /// The length at which the spring is slack, metres.
    pub rest: f64,
}

impl Strut {
    /// The force with which it pushes its ends apart, N, at a length and its rate.
    pub fn push(&self, length: f64, rate: f64) -> f64 {
        self.stiffness * (self.rest - length) - self.damping * rate
    }
}

/// A mechanism in full coordinates and as a tree.
#[derive(Clone, Debug)]
pub struct Mechanism {
    /// Its name, with lower-case letters and hyphens.
    pub name: &'static str,
    /// Its bodies under their weight.
    pub system: System<BodyMetric<Poses>, Weight<Poses>, Poses>,
    /// Its joints; the first, as many as bodies, hang one each.
    pub joints: Vec<Joint<Poses>>,
    /// What closes the loops of the tree: independent rows of the other joints.
    pub closing: Vec<(JointKind, [JointEnd; 2])>,
    /// Springs and dampers.
    pub struts: Vec<Strut>,
    /// Constant torques on bodies, world axes, N m.
    pub torques: Vec<(usize, Vector3<f64>)>,
    /// Where it starts, in full coordinates.
    pub initial: State<Vec<f64>>,
    /// Where it starts, by the coordinates and the speeds of the tree.
    pub start: [Vec<f64>; 2],
    /// The time over which it is asked for, seconds.
    pub horizon: f64,
}

/// What a mechanism is made of beside its bodies.
struct Parts {
    joints: Vec<(JointKind, [JointEnd; 2])>,
    closing: Vec<(JointKind, [JointEnd; 2])>,
    struts: Vec<Strut>,
    torques: Vec<(usize, Vector3<f64>)>,
    start: [Vec<f64>; 2],
}

impl Mechanism {
    fn new(
        (name, horizon): (&'static str, f64),
        bodies: Vec<Body>,
        motions: &[BodyMotion],
        gravity: Vector3<f64>,
        parts: Parts,
    ) -> Result<Self, RigidError> {
        let Parts { joints, closing, struts, torques, start } = parts;
        let count = bodies.len();
        let joint = |(kind, ends)| Joint::new(Poses, count, kind, ends);
        let joints = joints.into_iter().map(joint).collect::<Result<_, _>>()?;
        let load = |body: &Body| PointMass { mass: body.mass(), point: Vector3::zeros() };
        let weight = Weight { gravity, masses: bodies.iter().map(load).collect(), space: Poses };
        let metric = BodyMetric::<Poses>::new(bodies);
        let initial = metric.state(motions)?;
        let system = metric.under(weight)?;
        Ok(Mechanism { name, system, joints, closing, struts, torques, initial, start, horizon })
    }

    /// What acts on the bodies beside their weight.
    ///
    /// # Errors
    /// A strut or a torque on a body that is not there.
    pub fn forces(&self) -> Result<BodyForces<Poses>, RigidError> {
        let mut forces = BodyForces::new(Poses, self.system.metric().bodies().len());
        for &strut in &self.struts {
            let push = move |_: f64, length: f64, rate: f64| strut.push(length, rate);
            forces.between_points(strut.ends, push)?;
        }
        for &(body, torque) in &self.torques {
            forces.on_body(body, move |_, _, _| torque)?;
        }
        Ok(forces)
    }

    /// The same bodies as a tree.
    ///
    /// # Errors
    /// Joints that make none.
    pub fn tree(&self) -> Result<Tree, TreeError> {
        let mut builder = TreeBuilder::default();
        for (body, joint) in self.system.metric().bodies().iter().zip(&self.joints) {
            let [foot, own] = joint.ends();
            builder.hang(foot.body, *joint.kind(), [foot.frame, own.frame], *body);
        }
        builder.build()
    }

    /// The loops of the tree.
    ///
    /// # Errors
    /// A joint that closes none.
    pub fn loops(&self, tree: &Tree) -> Result<TreeLoops, TreeError> {
        let mut loops = TreeLoops::new(tree);
        for (kind, ends) in &self.closing {
            loops.join(tree, *kind, *ends)?;
        }
        Ok(loops)
    }

    /// Adds to the forces on the tree what acts beside the weight.
    ///
    /// # Errors
    /// The motion of another tree.
    pub fn act(&self, motion: &TreeMotion, forces: &mut TreeForces) -> Result<(), TreeError> {
        for strut in &self.struts {
            let [(a, v), (b, w)] = [moving(motion, strut.ends[0])?, moving(motion, strut.ends[1])?];
            let apart = b - a;
            let unit = apart.normalize();
            let push = unit * strut.push(apart.norm(), unit.dot(&(w - v)));
            for (end, push) in strut.ends.iter().zip([-push, push]) {
                if let Attachment::Body(body, point) = end {
                    forces.add_force(motion, *body, point, push)?;
                }
            }
        }
        self.torques.iter().try_for_each(|&(body, torque)| forces.add_torque(body, torque))
    }
}

/// Place and velocity of a point.
fn moving(motion: &TreeMotion, end: Attachment) -> Result<(Vector3<f64>, Vector3<f64>), TreeError> {
    match end {
        Attachment::World(place) => Ok((place, Vector3::zeros())),
        Attachment::Body(body, point) => {
            let body = motion.body(body)?;
            let turned = body.pose.rotation.rotate(&body.angular_velocity.cross(&point));
            Ok((body.pose.apply(&point), body.velocity + turned))
        }
    }
}

fn placed(translation: Vector3<f64>, rotation: Rotation) -> RigidMotion {
    RigidMotion { translation, rotation }
}

fn still(pose: RigidMotion) -> BodyMotion {
    BodyMotion { pose, velocity: Vector3::zeros(), angular_velocity: Vector3::zeros() }
}

fn turned(axis: Vector3<f64>, angle: f64) -> Rotation {
    Rotation::exp(axis * angle)
}
