//! The motion of a tree as a first-order system, for the methods that choose their own steps.
//!
//! ```text
//! y = (q, v),     q. = K(q) v,     v. = M^-1 (tau - C)
//! ```
//! `q` the coordinates, then `v` the speeds; `K` is 1 but for quaternions, `q. = 1/2 q w`. The field
//! keeps their length, and accelerations do not depend on it, so that they need no projection: a run
//! leaves the length to the method's tolerance, and reads the direction only. Where the motion has no
//! finite acceleration the field is not a number, which every method refuses. Energy and momenta are
//! kept to the tolerance, and drift over long times: [`TreeVariational`](super::TreeVariational) does
//! not let them.

use std::cell::RefCell;
use std::fmt;

use stationary_calculus::SizeError;
use stationary_integrators::VectorField;

use super::builder::Tree;
use super::error::TreeError;
use super::forces::TreeForces;
use super::loops::TreeLoops;
use super::motion::TreeMotion;
use super::prescribed::TreeDrive;

/// What adds to the forces at a time and a motion: nothing.
pub(super) type Idle = fn(f64, &TreeMotion, &mut TreeForces);

#[derive(Clone, Debug)]
struct Room {
    motion: TreeMotion,
    forces: TreeForces,
    loops: Option<TreeLoops>,
    /// Where the drives lead, and the force of each.
    prescribed: [Vec<f64>; 2],
    holding: Vec<f64>,
    /// Of a state that is looked at.
    rates: Vec<f64>,
}

/// A tree under forces, as a field of its coordinates and speeds.
pub struct TreeField<D = Idle> {
    tree: Tree,
    constant: TreeForces,
    drive: Option<D>,
    schedules: Vec<TreeDrive>,
    room: RefCell<Room>,
}

impl<D> fmt::Debug for TreeField<D> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("TreeField").field("tree", &self.tree).finish_non_exhaustive()
    }
}

impl TreeField {
    /// A tree under constant forces, such as its weight.
    ///
    /// # Errors
    /// Forces of another tree.
    pub fn new(tree: Tree, forces: TreeForces) -> Result<Self, TreeError> {
        Self::with(tree, forces, None)
    }
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> TreeField<D> {
    /// A tree under constant forces, to which `drive` adds others at each time (s) and motion:
    /// motors, dampers, springs.
    ///
    /// # Errors
    /// Forces of another tree.
    pub fn driven(tree: Tree, forces: TreeForces, drive: D) -> Result<Self, TreeError> {
        Self::with(tree, forces, Some(drive))
    }

    fn accelerate(&self, t: f64, y: &[f64], f: &mut [f64]) -> Result<(), TreeError> {
        let (q, v) = y.split_at(self.tree.coordinates());
        let (rates, accelerations) = f.split_at_mut(self.tree.coordinates());
        let Room { motion, forces, loops, prescribed, holding, .. } = &mut *self.room.borrow_mut();
        let [own_q, own_v] = prescribed;
        let (q, v) = if self.schedules.is_empty() {
            (q, v)
        } else {
            own_q.copy_from_slice(q);
            own_v.copy_from_slice(v);
            for drive in &self.schedules {
                [own_q[drive.coordinate], own_v[drive.speed], _] = drive.motion(t);
            }
            (&own_q[..], &own_v[..])
        };
        motion.place(q, v)?;
        self.tree.write_rates(q, v, rates);
        if let Some(drive) = &self.drive {
            forces.clone_from(&self.constant);
            drive(t, motion, forces);
        }
        for drive in &self.schedules {
            motion.accelerate_along(drive.speed, drive.motion(t)[2]);
        }
        match loops {
            None => motion.forward_dynamics(forces, accelerations),
            Some(loops) => {
                loops.set_time(t);
                loops.forward_dynamics(motion, forces, accelerations)
            }
        }?;
        for (force, drive) in holding.iter_mut().zip(&self.schedules) {
            *force = std::mem::replace(&mut accelerations[drive.speed], drive.motion(t)[2]);
        }
        Ok(())
    }

    /// Writes the force of each prescribed motion at a time and a state: N, or N m.
    ///
    /// # Errors
    /// Room for another number of forces; a state without a finite acceleration.
    pub fn drive_forces(&self, t: f64, y: &[f64], forces: &mut [f64]) -> Result<(), TreeError> {
        SizeError::check("the drives' forces", self.schedules.len(), forces.len())?;
        self.look(t, y)?;
        forces.copy_from_slice(&self.room.borrow().holding);
        Ok(())
    }

    /// Writes the force along each row of the loops, as [`TreeLoops::multipliers`] has it.
    ///
    /// # Errors
    /// Room for another number of forces; a state without a finite acceleration.
    pub fn loop_forces(&self, t: f64, y: &[f64], forces: &mut [f64]) -> Result<(), TreeError> {
        self.look(t, y)?;
        let room = self.room.borrow();
        let multipliers = room.loops.as_ref().map_or(&[][..], TreeLoops::multipliers);
        SizeError::check("the loops' forces", multipliers.len(), forces.len())?;
        forces.copy_from_slice(multipliers);
        Ok(())
    }

    /// The power (W) of ends of loops in the world that move, at a time and a state.
    ///
    /// # Errors
    /// A state without a finite acceleration.
    pub fn power_of_ends(&self, t: f64, y: &[f64]) -> Result<f64, TreeError> {
        self.look(t, y)?;
        let room = self.room.borrow();
        room.loops.as_ref().map_or(Ok(0.0), |loops| loops.power_of_ends(&room.motion))
    }

    /// Accelerates at a time and a state, for what holds it there.
    fn look(&self, t: f64, y: &[f64]) -> Result<(), TreeError> {
        SizeError::check("the state's numbers", self.dim(), y.len())?;
        let mut rates = std::mem::take(&mut self.room.borrow_mut().rates);
        let looked = self.accelerate(t, y, &mut rates);
        self.room.borrow_mut().rates = rates;
        looked
    }
}

impl<D> TreeField<D> {
    fn with(tree: Tree, constant: TreeForces, drive: Option<D>) -> Result<Self, TreeError> {
        constant.check(&tree)?;
        let (motion, forces) = (TreeMotion::new(tree.clone()), constant.clone());
        let prescribed = [vec![0.0; tree.coordinates()], vec![0.0; tree.speeds()]];
        let rates = vec![0.0; tree.coordinates() + tree.speeds()];
        let holding = Vec::new();
        let room = Room { motion, forces, loops: None, prescribed, holding, rates };
        Ok(TreeField { tree, constant, drive, schedules: Vec::new(), room: RefCell::new(room) })
    }

    /// The same tree with its loops held closed, as far as accelerations do: see [`TreeLoops::close`].
    pub fn closed(self, loops: TreeLoops) -> Self {
        self.room.borrow_mut().loops = Some(loops);
        self
    }

    /// The same tree where joints follow schedules, whatever force it takes. Of their coordinates and speeds in a
    /// state only the rates are used: they are where the schedules are.
    ///
    /// # Errors
    /// Drives of another tree, or two of one speed: [`TreeError::DrivenTwice`].
    pub fn prescribed(mut self, drives: Vec<TreeDrive>) -> Result<Self, TreeError> {
        let room = self.room.get_mut();
        room.motion.hold(&drives)?;
        room.holding = vec![0.0; drives.len()];
        self.schedules = drives;
        Ok(self)
    }

    /// The tree.
    pub fn tree(&self) -> &Tree {
        &self.tree
    }
}

impl<D: Fn(f64, &TreeMotion, &mut TreeForces)> VectorField for TreeField<D> {
    fn dim(&self) -> usize {
        self.tree.coordinates() + self.tree.speeds()
    }

    fn evaluate(&self, t: f64, y: &[f64], f: &mut [f64]) {
        if self.accelerate(t, y, f).is_err() {
            f.fill(f64::NAN);
        }
    }
}
