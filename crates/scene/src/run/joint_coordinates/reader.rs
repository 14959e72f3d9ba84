//! The bodies of a scene, read from coordinates and speeds of joints.
//!
//! Loops are closed where the bodies are read; the method's own numbers are brought back where what opened of loops is a
//! part of its tolerance, and where the speed of a motor or of a pin that moves a rod jumps.

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

    /// Sets the numbers where what is held is held, and the motion there; the work of motors whose speed jumps, where
    /// one does.
    fn hold(&mut self, t: f64, y: &[f64]) -> Result<Option<f64>, TreeError> {
        let ahead = t > self.jumped;
        self.loops.set_time(t);
        for (jump, speed) in self.jumps.iter_mut().zip(&self.joints.speeds) {
            *jump = if ahead { speed.jump(t) } else { 0.0 };
        }
        self.y.copy_from_slice(y);
        let turns = self.jumps.iter().any(|&jump| jump != 0.0);
        let pulls = ahead && self.joints.pins.iter().any(|pin| pin.strength.jump_of_rate(t) != 0.0);
        if !turns && !pulls {
            self.close(t, false)?;
            return Ok(None);
        }
        // Pins move on as before the jump, places as they do at it.
        self.loops.set_time(if pulls { t.next_down() } else { t });
        self.close(t, true)?;
        self.loops.set_time(t);
        let before = self.motion.kinetic_energy();
        let (q, v) = self.y.split_at_mut(self.joints.tree.coordinates());
        if turns {
            self.motion.change_held(q, v, &self.jumps)?;
        }
        self.close(t, false)?;
        // What loops do besides is none, but by pins.
        Ok(Some(self.motion.kinetic_energy() - before))
    }

    /// Leads what follows motors, at the speed before a jump or after it, and closes loops.
    fn close(&mut self, t: f64, before: bool) -> Result<(), TreeError> {
        let JointReader { joints, motion, loops, y, jumps, .. } = self;
        let (q, v) = y.split_at_mut(joints.tree.coordinates());
        for (drive, jump) in joints.drives.iter().zip(jumps) {
            let ([place, speed, _], [coordinate, number]) = (drive.motion(t), drive.places());
            (q[coordinate], v[number]) = (place, if before { speed - *jump } else { speed });
        }
        if loops.rows() > 0 { loops.close(motion, q, v) } else { motion.place(q, v) }
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

    fn restore(&mut self, t: f64, y: &mut [f64]) -> Result<Option<f64>, StepFailure> {
        if self.loops.rows() == 0 && self.joints.speeds.is_empty() {
            return Ok(None);
        }
        let work = self.hold(t, y)?;
        self.jumped = t;
        let off = self.y.iter().zip(&*y).map(|(held, y)| (held - y).abs());
        let opened = off.zip(&self.allowed).any(|(off, allowed)| off > OPENED * allowed);
        if !opened && work.is_none() {
            return Ok(None);
        }
        y.copy_from_slice(&self.y);
        Ok(Some(work.unwrap_or(0.0)))
    }

    fn go_on_from(&mut self, t: f64) {
        self.jumped = t;
    }

    fn next_corner(&self, t: f64) -> Option<f64> {
        let of_pins = self.joints.pins.iter().map(|pin| &pin.strength);
        let all = self.joints.speeds.iter().chain(of_pins);
        all.filter_map(|speed: &Strength| speed.next_corner(t)).min_by(f64::total_cmp)
    }

    fn driven_power(&mut self, t: f64, y: &[f64]) -> Result<f64, StepFailure> {
        let JointReader { joints, field, forces, .. } = self;
        let of_pins = if joints.pins.is_empty() { 0.0 } else { field.power_of_ends(t, y)? };
        if joints.drives.is_empty() {
            return Ok(of_pins);
        }
        field.drive_forces(t, y, forces)?;
        let powers = joints.drives.iter().zip(forces).map(|(drive, f)| *f * drive.motion(t)[1]);
        Ok(powers.sum::<f64>() + of_pins)
    }

    fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }
}
