//! The bodies of a scene, read from coordinates and speeds of joints.
//!
//! Loops are closed where the bodies are read; the method's own numbers are brought back where what opened of loops is a
//! part of its tolerance, and where the speed of a motor jumps.

use stationary_integrators::State;
use stationary_rigid::tree::{TreeError, TreeField, TreeForces, TreeLoops, TreeMotion};

use crate::assemble::joint_tree::JointTree;
use crate::model::strength::Strength;
use crate::run::adaptive::Reader;
use crate::run::error::StepFailure;

/// The part of what the method's error may be beyond which numbers are brought back.
const OPENED: f64 = 0.1;

/// What reads them.
pub(super) struct JointReader<D> {
    joints: JointTree,
    field: TreeField<D>,
    motion: TreeMotion,
    loops: TreeLoops,
    /// What an error may be in each number.
    allowed: Vec<f64>,
    /// The numbers, with loops closed, and how much the motors' speeds jump.
    y: Vec<f64>,
    jumps: Vec<f64>,
    forces: Vec<f64>,
    of_loops: Vec<f64>,
    multipliers: Vec<f64>,
    /// The time up to which motors have jumped.
    jumped: f64,
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> JointReader<D> {
    pub(super) fn new(
        joints: JointTree,
        field: TreeField<D>,
        allowed: Vec<f64>,
    ) -> Result<Self, TreeError> {
        let motion = joints.motion()?;
        let (drives, loops) = (joints.drives.len(), joints.loops.clone());
        Ok(JointReader {
            motion,
            y: vec![0.0; allowed.len()],
            jumps: vec![0.0; drives],
            forces: vec![0.0; drives],
            of_loops: vec![0.0; loops.rows()],
            multipliers: Vec::new(),
            jumped: 0.0,
            joints,
            field,
            loops,
            allowed,
        })
    }

    /// Sets the numbers where what is held is held, and the motion there; whether a motor's speed jumps.
    fn hold(&mut self, t: f64, y: &[f64]) -> Result<bool, TreeError> {
        let JointReader { joints, motion, loops, y: own, jumps, jumped, .. } = self;
        own.copy_from_slice(y);
        let (q, v) = own.split_at_mut(joints.tree.coordinates());
        let ahead = t > *jumped;
        for (jump, speed) in jumps.iter_mut().zip(&joints.speeds) {
            *jump = if ahead { speed.jump(t) } else { 0.0 };
        }
        let jumps_here = jumps.iter().any(|&jump| jump != 0.0);
        if jumps_here {
            motion.change_held(q, v, jumps)?;
        }
        for drive in &joints.drives {
            let ([place, speed, _], [coordinate, number]) = (drive.motion(t), drive.places());
            (q[coordinate], v[number]) = (place, speed);
        }
        if loops.rows() > 0 {
            loops.close(motion, q, v)?;
        } else {
            motion.place(q, v)?;
        }
        Ok(jumps_here)
    }
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> Reader for JointReader<D> {
    fn read(&mut self, t: f64, y: &[f64], state: &mut State<Vec<f64>>) -> Result<(), StepFailure> {
        self.hold(t, y)?;
        let JointReader { joints, field, motion, y, of_loops, multipliers, .. } = self;
        if joints.rods > 0 {
            field.loop_forces(t, y, of_loops)?;
            joints.write_tensions(of_loops, multipliers);
        }
        Ok(joints.read(motion, state)?)
    }

    fn restore(&mut self, t: f64, y: &mut [f64]) -> Result<bool, StepFailure> {
        if self.loops.rows() == 0 && self.joints.speeds.is_empty() {
            return Ok(false);
        }
        let jumps = self.hold(t, y)?;
        self.jumped = t;
        let off = self.y.iter().zip(&*y).map(|(held, y)| (held - y).abs());
        let opened = off.zip(&self.allowed).any(|(off, allowed)| off > OPENED * allowed);
        if opened || jumps {
            y.copy_from_slice(&self.y);
        }
        Ok(opened || jumps)
    }

    fn go_on_from(&mut self, t: f64) {
        self.jumped = t;
    }

    fn next_corner(&self, t: f64) -> Option<f64> {
        let corners = self.joints.speeds.iter().filter_map(|speed: &Strength| speed.next_corner(t));
        corners.min_by(f64::total_cmp)
    }

    fn driven_power(&mut self, t: f64, y: &[f64]) -> Result<f64, StepFailure> {
        let JointReader { joints, field, forces, .. } = self;
        if joints.drives.is_empty() {
            return Ok(0.0);
        }
        field.drive_forces(t, y, forces)?;
        let powers = joints.drives.iter().zip(forces).map(|(drive, f)| *f * drive.motion(t)[1]);
        Ok(powers.sum())
    }

    fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }
}
