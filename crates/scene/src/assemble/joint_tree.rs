//! The bodies of a scene as a tree, in the coordinates of their joints.
//!
//! ```text
//! x_b = x_b(q),   u_b = J_b(q) v          poses and velocities of the bodies
//! p = sum J_b^T P_b,   v = M^-1 p         the speeds of joints, from the momenta of bodies
//! ```
//! `q v` coordinates and speeds of the joints, `P` momenta. Joints that close loops are rows beside the tree, and so
//! are rods, whose pins may move; motors with a speed are schedules of coordinates. In the plane every turn is about
//! the third axis.

use nalgebra::Vector3;
use stationary_calculus::Covector;
use stationary_integrators::State;
use stationary_rigid::tree::{
    Tree, TreeBuilder, TreeDrive, TreeError, TreeForces, TreeLoops, TreeMotion,
};
use stationary_rigid::{Body, BodyMotion, JointEnd, JointKind, LieGroup, RigidMotion, Rotation};

use crate::JointKind as SceneJointKind;
use crate::assemble::body_system::{Turned, ends_in_space};
use crate::assemble::error::AssemblyError;
use crate::assemble::spanning_tree::{Hung, SpanningTree};
use crate::model::drives::PinMotion;
use crate::model::items::{RigidBody, SceneJoint};
use crate::model::scene::Scene;
use crate::model::strength::Strength;

/// A scene's bodies as a tree.
#[derive(Clone, Debug)]
pub(crate) struct JointTree {
    pub(crate) tree: Tree,
    /// The place of each body of the scene in the tree.
    places: Vec<usize>,
    /// The bodies in the order of the tree, and how each of them starts turned in the plane.
    order: Vec<(usize, f64)>,
    /// Mass and moments of each.
    inertias: Vec<(f64, Vector3<f64>)>,
    dimension: usize,
    /// Rows of joints that close loops, then of rods.
    pub(crate) loops: TreeLoops,
    /// How many rows are of rods, and how many equations full coordinates have of joints.
    pub(crate) rods: usize,
    pub(crate) rows_of_joints: usize,
    /// Motors with a speed, and their speeds along the coordinates.
    pub(crate) drives: Vec<TreeDrive>,
    pub(crate) speeds: Vec<Strength>,
    /// How pins that move rods do.
    pub(crate) pins: Vec<PinMotion>,
}

impl Scene {
    /// Its bodies as a tree.
    pub(crate) fn joint_tree(&self) -> Result<JointTree, AssemblyError> {
        let SpanningTree { hung, closing } = self.spanning_tree();
        let mut places = vec![0; self.bodies.len()];
        let mut builder = TreeBuilder::default();
        for &Hung { body, by } in &hung {
            let of = &self.bodies[body];
            let (parent, kind, frames) = match by {
                Some((joint, end)) => {
                    let joint = &self.joints[joint];
                    let ends: [JointEnd; 2] = ends_in_space(&self.bodies, joint);
                    let parent = joint.between[1 - end].map(|parent| places[parent]);
                    (parent, self.kind_of(joint), [ends[1 - end].frame, ends[end].frame])
                }
                None => (None, self.free_kind(), [pose(of), RigidMotion::identity()]),
            };
            places[body] =
                builder.hang(parent, kind, frames, Body::new(of.mass, self.moments(of))?);
        }
        let tree = builder.build()?;
        let loops = self.loops(&tree, &places, &closing)?;
        let inertia = |body: &RigidBody| (body.mass, Vector3::from(self.moments(body)));
        let (mut drives, mut speeds) = (Vec::new(), Vec::new());
        for motor in self.speeds() {
            let by = |hung: &&Hung| hung.by.is_some_and(|(joint, _)| joint == motor.joint);
            let Some(&Hung { body, by: Some((_, end)) }) = hung.iter().find(by) else {
                return Err(self.closes(motor.joint));
            };
            // The coordinate is the turn of what hangs.
            let speed = motor.strength.clone();
            let speed = if end == 1 { speed } else { speed.reversed() };
            drives.push(TreeDrive::new(&tree, places[body], 0, Turned(speed.clone()))?);
            speeds.push(speed);
        }
        Ok(JointTree {
            tree,
            places,
            order: hung
                .iter()
                .map(|hung| (hung.body, self.bodies[hung.body].rotation[2]))
                .collect(),
            inertias: self.bodies.iter().map(inertia).collect(),
            dimension: self.dimension,
            loops,
            rods: self.rods.len(),
            rows_of_joints: self.rows_of_joints(),
            drives,
            speeds,
            pins: self.rods.iter().filter_map(|rod| self.pin_of(rod).cloned()).collect(),
        })
    }

    /// Joints that close loops, but for the rows that the tree holds, then rods.
    fn loops(
        &self,
        tree: &Tree,
        places: &[usize],
        closing: &[usize],
    ) -> Result<TreeLoops, AssemblyError> {
        let mut loops = TreeLoops::new(tree);
        let in_tree = |ends: [JointEnd; 2]| {
            ends.map(|end| JointEnd { body: end.body.map(|body| places[body]), ..end })
        };
        for joint in closing.iter().map(|&joint| &self.joints[joint]) {
            let ends = ends_in_space(&self.bodies, joint);
            loops.join(tree, self.kind_of(joint), in_tree(ends))?;
        }
        if !closing.is_empty() {
            loops.keep_independent(&mut TreeMotion::new(tree.clone()))?;
        }
        for rod in &self.rods {
            let kind = JointKind::Rod { length: rod.length };
            let ends = in_tree(self.rod_ends(rod));
            match self.pin_of(rod).cloned() {
                None => loops.join(tree, kind, ends)?,
                Some(pin) => loops.join_moving(tree, kind, ends, move |t| pin.path(t))?,
            }
        }
        Ok(loops)
    }

    fn closes(&self, joint: usize) -> AssemblyError {
        let [first, second] = self.ends_named(&self.joints[joint]).map(str::to_owned);
        AssemblyError::ClosesLoop { first, second }
    }

    fn kind_of(&self, joint: &SceneJoint) -> JointKind {
        match (joint.kind, self.dimension) {
            (SceneJointKind::Ball, 2) => JointKind::Hinge { axis: Vector3::z() },
            (SceneJointKind::Ball, _) => JointKind::Ball,
            (SceneJointKind::Hinge, _) => JointKind::Hinge { axis: joint.axis.into() },
            (SceneJointKind::Slider, _) => JointKind::Slider { axis: joint.axis.into() },
            (SceneJointKind::Fixed, _) => JointKind::Weld,
        }
    }

    fn free_kind(&self) -> JointKind {
        match self.dimension {
            2 => JointKind::Planar { axes: [Vector3::x(), Vector3::y()] },
            _ => JointKind::Free,
        }
    }

    /// The moments of a body; in the plane that about the third axis stands for all, and the others are
    /// never asked.
    fn moments(&self, body: &RigidBody) -> [f64; 3] {
        if self.dimension == 2 { [body.moments[2]; 3] } else { body.moments }
    }
}

fn pose(body: &RigidBody) -> RigidMotion {
    RigidMotion { translation: body.position.into(), rotation: body.turned() }
}

impl JointTree {
    /// Coordinates and speeds of the joints where the bodies start: moving as these allow, as was checked when
    /// the scene was read.
    pub(crate) fn start(&self, scene: &Scene) -> Result<[Vec<f64>; 2], AssemblyError> {
        let (q, mut v) = (self.tree.rest(), vec![0.0; self.tree.speeds()]);
        let mut motion = TreeMotion::new(self.tree.clone());
        motion.place(&q, &v)?;
        let mut momenta = TreeForces::none(&self.tree);
        for (body, &place) in scene.bodies.iter().zip(&self.places) {
            momenta.add_force(
                &motion,
                place,
                &Vector3::zeros(),
                Vector3::from(body.velocity) * body.mass,
            )?;
            let spin = Vector3::from(self.inertia_times(body));
            momenta.add_torque(place, motion.pose(place)?.rotation.rotate(&spin))?;
        }
        // At rest, what holds these forces is their opposite along the joints.
        let mut p = vec![0.0; v.len()];
        motion.inverse_dynamics(&momenta, &v, &mut p)?;
        p.iter_mut().for_each(|p| *p = -*p);
        motion.speeds_of(&p, &mut v)?;
        Ok([q, v])
    }

    fn inertia_times(&self, body: &RigidBody) -> [f64; 3] {
        let [x, y, z] = body.angular_velocity;
        let [i, j, k] = body.moments;
        if self.dimension == 2 { [0.0, 0.0, k * z] } else { [i * x, j * y, k * z] }
    }

    /// The tree at rest, which no force moves along what follows a schedule.
    pub(crate) fn motion(&self) -> Result<TreeMotion, TreeError> {
        let mut motion = TreeMotion::new(self.tree.clone());
        motion.hold(&self.drives)?;
        Ok(motion)
    }

    /// Writes the multipliers of full coordinates, of which those of rods are known: their tensions.
    pub(crate) fn write_tensions(&self, of_loops: &[f64], multipliers: &mut Vec<f64>) {
        multipliers.clear();
        multipliers.resize(self.rows_of_joints, 0.0);
        multipliers.extend(of_loops[of_loops.len() - self.rods..].iter().map(|force| -force));
    }

    /// Writes where the bodies are and how they move: those of a state of the scene.
    pub(crate) fn read(
        &self,
        motion: &TreeMotion,
        state: &mut State<Vec<f64>>,
    ) -> Result<(), TreeError> {
        let State { q, p, .. } = state;
        if self.dimension == 2 {
            self.read_turns(motion, q)?;
        }
        for (body, (&place, (mass, moments))) in self.places.iter().zip(&self.inertias).enumerate()
        {
            let BodyMotion { pose, velocity, angular_velocity } = motion.body(place)?;
            let (x, linear) = (pose.translation, velocity * *mass);
            if self.dimension == 2 {
                let [w, .., z] = pose.rotation.quaternion();
                let (q, p) = (&mut q[3 * body..][..3], &mut p.components_mut()[3 * body..][..3]);
                let turned = continued(2.0 * z.atan2(w), q[2]);
                q.copy_from_slice(&[x.x, x.y, turned]);
                p.copy_from_slice(&[linear.x, linear.y, moments.z * angular_velocity.z]);
                continue;
            }
            let (q, p) = (&mut q[7 * body..][..7], &mut p.components_mut()[6 * body..][..6]);
            let turned = pose.rotation.quaternion();
            let same = turned.iter().zip(&q[3..]).map(|(a, b)| a * b).sum::<f64>() >= 0.0;
            q[..3].copy_from_slice(x.as_slice());
            q[3..].iter_mut().zip(turned).for_each(|(q, c)| *q = if same { c } else { -c });
            p[..3].copy_from_slice(linear.as_slice());
            p[3..].copy_from_slice(moments.component_mul(&angular_velocity).as_slice());
        }
        Ok(())
    }

    /// Writes by how much bodies of the plane are turned, whole turns among it: by what the joints say, whatever
    /// was read before.
    fn read_turns(&self, motion: &TreeMotion, q: &mut [f64]) -> Result<(), TreeError> {
        for (place, &(body, start)) in self.order.iter().enumerate() {
            let (kind, parent) = self.tree.joint(place)?;
            let own = &motion.coordinates()[self.tree.coordinates_of(place)?];
            let turned = match kind {
                JointKind::Hinge { .. } | JointKind::Planar { .. } => own[own.len() - 1],
                _ => 0.0,
            };
            let of_parent = parent.map_or(0.0, |parent| {
                let (body, start) = self.order[parent];
                q[3 * body + 2] - start
            });
            q[3 * body + 2] = start + of_parent + turned;
        }
        Ok(())
    }

    /// Adds a covector of the scene's freedoms to the forces on the tree.
    pub(crate) fn add_forces(
        &self,
        motion: &TreeMotion,
        f: &Covector<Vec<f64>>,
        forces: &mut TreeForces,
    ) -> Result<(), TreeError> {
        let each = if self.dimension == 2 { 3 } else { 6 };
        for (&place, f) in self.places.iter().zip(f.0.chunks_exact(each)) {
            let (force, torque) = match *f {
                [x, y, turn] => (Vector3::new(x, y, 0.0), Vector3::z() * turn),
                _ => {
                    let turn = Vector3::from_column_slice(&f[3..]);
                    let rotation: Rotation = motion.pose(place)?.rotation;
                    (Vector3::from_column_slice(&f[..3]), rotation.rotate(&turn))
                }
            };
            forces.add_force(motion, place, &Vector3::zeros(), force)?;
            forces.add_torque(place, torque)?;
        }
        Ok(())
    }

    /// What an error of one means in each coordinate, then in each speed: a radian, or the scene's size; and
    /// those over the horizon, or the speeds of the start.
    pub(crate) fn scales(&self, size: f64, horizon: f64, v: &[f64]) -> Result<Vec<f64>, TreeError> {
        let (mut places, mut speeds) = (Vec::new(), Vec::new());
        let [mut shift, mut turn] = [size / horizon, 1.0 / horizon];
        for body in 0..self.tree.bodies() {
            let (kind, _) = self.tree.joint(body)?;
            let is_shift = shifts(kind);
            let own = self.tree.speeds_of(body)?;
            for (freedom, v) in own.clone().zip(&v[own.clone()]) {
                let fastest = if freedom - own.start < is_shift { &mut shift } else { &mut turn };
                *fastest = fastest.max(v.abs());
            }
        }
        for body in 0..self.tree.bodies() {
            let (kind, _) = self.tree.joint(body)?;
            let is_shift = shifts(kind);
            let coordinates = self.tree.coordinates_of(body)?.len();
            let freedoms = self.tree.speeds_of(body)?.len();
            places.extend((0..coordinates).map(|k| if k < is_shift { size } else { 1.0 }));
            speeds.extend((0..freedoms).map(|k| if k < is_shift { shift } else { turn }));
        }
        places.append(&mut speeds);
        Ok(places)
    }
}

/// How many freedoms of a joint of a scene are shifts: the first ones.
fn shifts(kind: &JointKind) -> usize {
    match kind {
        JointKind::Slider { .. } => 1,
        JointKind::Planar { .. } => 2,
        JointKind::Free => 3,
        _ => 0,
    }
}

/// The angle nearest to another that differs from this one by whole turns.
fn continued(angle: f64, near: f64) -> f64 {
    let turn = std::f64::consts::TAU;
    angle + turn * ((near - angle) / turn).round()
}
