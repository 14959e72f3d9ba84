//! Loops: joints between bodies of a tree, beside those from which they hang.
//!
//! ```text
//! g = 0,     J V = 0                                rows of joints, V the twists of two bodies
//! M v. = tau - C + J^T lambda,    (J M^-1 J^T) lambda = -J v._0 - V d2g V
//! q <- q - M^-1 J^T (J M^-1 J^T)^-1 g,    v <- v - M^-1 J^T (J M^-1 J^T)^-1 J v
//! ```
//! `v._0` the accelerations of the open tree, `lambda` minus what the joint's first end exerts along
//! each row (N, or N m). Each row is one more pass over the tree, so that a few rows cost little;
//! their matrix is full. What the accelerations still miss of the rows is solved for again: the matrix
//! squares the angle between rows, and would lose what rows that nearly depend on each other ask for.
//! Rows that the tree or other rows hold already are refused, or set aside where
//! [`TreeLoops::keep_independent`] asks for it: of a hinge that closes a loop of parallel hinges three
//! rows of five.
//!
//! A field with multipliers keeps `g` to the tolerance of the run only, and it drifts: the second
//! line brings a state back along the shortest way in the metric. Call it after a step, or as often
//! as the drift matters. Source: Featherstone 2008, 8; notes 6.3, 6.4.

mod path;
mod rank;
mod row;

use std::rc::Rc;

use nalgebra::Vector3;
use stationary_calculus::{DenseLu, SizeError};

use super::builder::Tree;
use super::error::{TreeError, check_numbers};
use super::forces::TreeForces;
use super::motion::TreeMotion;
use super::spatial::Twist;
use crate::joint::Row;
use crate::{JointEnd, JointFault, JointKind, JointName};
use path::{EndNow, EndPath};
pub(super) use rank::Rank;
pub(super) use row::LoopRow;

/// Joints that close loops, and the memory to hold them so.
#[derive(Clone, Debug)]
pub struct TreeLoops {
    bodies: usize,
    pub(super) rows: Vec<LoopRow>,
    /// Rows that others hold.
    aside: Vec<LoopRow>,
    /// How ends in the world move.
    paths: Vec<EndPath>,
    /// `M^-1 J^T`, row after row.
    responses: Vec<f64>,
    matrix: DenseLu,
    rank: Rank,
    multipliers: Vec<f64>,
    /// What is added to them.
    parts: Vec<f64>,
    change: Vec<f64>,
    idle: Vec<f64>,
}

/// Most corrections of a configuration: it takes three or four.
const ITERATIONS: u32 = 30;
/// A gap that is left is rounding, against the distance of its points from the origin or the size of the tree.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// So is one that corrections no longer halve: coordinates of many turns are rounded by more.
const STALLED: f64 = 1e-9;

/// Most solves for multipliers, each of what the last has left: rows that barely differ leave 1e-5 of it.
const REFINEMENTS: u32 = 8;
/// Nothing is left of the multipliers below this part of them.
const ROUNDED: f64 = 256.0 * f64::EPSILON;

/// A gap of a row that was set aside, as a part of the same, beyond which nothing else held it.
const OPENED: f64 = 1e-6;

impl TreeLoops {
    /// No loops yet.
    pub fn new(tree: &Tree) -> Self {
        TreeLoops {
            bodies: tree.bodies(),
            rows: Vec::new(),
            aside: Vec::new(),
            paths: Vec::new(),
            responses: Vec::new(),
            matrix: DenseLu::new(0),
            rank: Rank::default(),
            multipliers: Vec::new(),
            parts: Vec::new(),
            change: vec![0.0; tree.speeds()],
            idle: vec![0.0; tree.speeds()],
        }
    }

    /// A joint between two bodies, or a body and the world.
    ///
    /// # Errors
    /// [`TreeError::Loop`] names the joint and what is wrong with it.
    pub fn join(
        &mut self,
        tree: &Tree,
        kind: JointKind,
        ends: [JointEnd; 2],
    ) -> Result<(), TreeError> {
        self.join_led(tree, kind, ends, None)
    }

    /// The same where the end in the world moves along a path, as a function of time (s): how far it is from where the
    /// joint has it (m), its velocity and its acceleration, world axes. [`TreeLoops::set_time`] takes it there.
    ///
    /// # Errors
    /// [`TreeError::Loop`] as of [`TreeLoops::join`], also where no end is in the world.
    pub fn join_moving(
        &mut self,
        tree: &Tree,
        kind: JointKind,
        ends: [JointEnd; 2],
        path: impl Fn(f64) -> [Vector3<f64>; 3] + 'static,
    ) -> Result<(), TreeError> {
        if ends.iter().all(|end| end.body.is_some()) {
            let joint = JointName { kind: kind.name(), bodies: ends.map(|end| end.body) };
            return Err(TreeError::Loop { joint, fault: JointFault::NoEndInWorld });
        }
        self.join_led(tree, kind, ends, Some(EndPath(Rc::new(path))))
    }

    /// A joint whose end in the world moves along a path, where there is one.
    fn join_led(
        &mut self,
        tree: &Tree,
        kind: JointKind,
        ends: [JointEnd; 2],
        path: Option<EndPath>,
    ) -> Result<(), TreeError> {
        self.check_tree(tree)?;
        let joint = JointName { kind: kind.name(), bodies: ends.map(|end| end.body) };
        let fault = |fault| TreeError::Loop { joint, fault };
        ends.iter().try_for_each(|end| end.check(self.bodies)).map_err(fault)?;
        if ends[0].body == ends[1].body {
            return Err(fault(JointFault::ToItself));
        }
        let kind = kind.checked().map_err(fault)?;
        let now = path.as_ref().map_or(EndNow::still(), |path| path.at(0.0));
        let number = path.as_ref().map(|_| self.paths.len());
        let row = |row| LoopRow { ends, row, path: number, now };
        self.rows.extend(Row::all(&kind, &ends).into_iter().map(row));
        self.paths.extend(path);
        self.resize();
        Ok(())
    }

    /// Takes ends in the world that move to where they are at a time: zero where nothing is said.
    pub fn set_time(&mut self, t: f64) {
        let TreeLoops { rows, aside, paths, .. } = self;
        if paths.is_empty() {
            return;
        }
        for row in rows.iter_mut().chain(aside) {
            if let Some(path) = row.path.and_then(|path| paths.get(path)) {
                row.now = path.at(t);
            }
        }
    }

    /// The power (W) of ends in the world that move, with the multipliers of the last
    /// [`TreeLoops::forward_dynamics`].
    ///
    /// # Errors
    /// A motion of another tree.
    pub fn power_of_ends(&self, motion: &TreeMotion) -> Result<f64, TreeError> {
        self.check(motion)?;
        let powers = self.rows.iter().zip(&self.multipliers);
        Ok(powers.map(|(row, lambda)| -lambda * row.led(motion)).sum())
    }

    /// Sets the rows aside that the tree or earlier rows hold where the motion is placed: no step asks for them,
    /// and where nothing holds them any more [`TreeLoops::close`] and steps say so.
    ///
    /// # Errors
    /// A motion of another tree; [`TreeError::Singular`].
    pub fn keep_independent(&mut self, motion: &mut TreeMotion) -> Result<(), TreeError> {
        self.check(motion)?;
        self.respond(motion)?;
        let mut held = vec![false; self.rows.len()];
        let TreeLoops { rows, rank, matrix, aside, .. } = self;
        rank.examine(motion, rows, matrix.matrix(), |row| held[row] = true);
        for (row, held) in std::mem::take(rows).into_iter().zip(held) {
            if held { aside.push(row) } else { rows.push(row) }
        }
        self.resize();
        Ok(())
    }

    fn resize(&mut self) {
        let m = self.rows.len();
        self.responses.resize(m * self.idle.len(), 0.0);
        self.multipliers.resize(m, 0.0);
        self.parts.resize(m, 0.0);
        self.matrix = DenseLu::new(m);
        self.rank.resize(m);
    }

    /// How many rows hold the loops closed.
    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// The forces and torques along the rows (N, N m) at the last [`TreeLoops::forward_dynamics`].
    pub fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// The largest gap (m, or the cosine of an angle) and the largest rate of one.
    ///
    /// # Errors
    /// A motion of another tree.
    pub fn violation(&self, motion: &TreeMotion) -> Result<[f64; 2], TreeError> {
        self.check(motion)?;
        let worst = |of: &dyn Fn(&LoopRow) -> f64| {
            self.rows.iter().chain(&self.aside).map(|row| of(row).abs()).fold(0.0, f64::max)
        };
        Ok([worst(&|row| row.gap(motion)), worst(&|row| row.speed(motion))])
    }

    /// Writes the acceleration of each speed, m/s^2 or rad/s^2, under these forces and those that
    /// hold the loops closed.
    ///
    /// # Errors
    /// Those of [`TreeMotion::forward_dynamics`]; [`TreeError::DependentLoops`].
    pub fn forward_dynamics(
        &mut self,
        motion: &mut TreeMotion,
        forces: &TreeForces,
        acceleration: &mut [f64],
    ) -> Result<(), TreeError> {
        self.check(motion)?;
        motion.forward_dynamics(forces, acceleration)?;
        self.respond_alone(motion)?;
        let write = |loops: &Self, _: &TreeMotion, change: &mut [f64]| loops.write_response(change);
        let rates = (TreeMotion::accelerate_free, LoopRow::acceleration);
        self.meet(motion, acceleration, rates, write)?;
        check_numbers("the acceleration", self.idle.len(), acceleration)
    }

    /// Adds what the rows do to rates of the speeds until the rates meet them: `at` sets the motion to rates, `write`
    /// says what a part of the multipliers changes of them.
    fn meet(
        &mut self,
        motion: &mut TreeMotion,
        rates: &mut [f64],
        (at, missed): (impl Fn(&mut TreeMotion, &[f64]), impl Fn(&LoopRow, &TreeMotion) -> f64),
        write: impl Fn(&Self, &TreeMotion, &mut [f64]),
    ) -> Result<(), TreeError> {
        self.factor()?;
        self.multipliers.fill(0.0);
        let mut last = f64::INFINITY;
        let mut change = std::mem::take(&mut self.change);
        for _ in 0..REFINEMENTS {
            at(motion, rates);
            for (part, row) in self.parts.iter_mut().zip(&self.rows) {
                *part = -missed(row, motion);
            }
            self.matrix.solve(&mut self.parts);
            let part = self.rank.largest(&self.parts);
            if part > 0.5 * last {
                // What is left is rounding of the rates.
                break;
            }
            last = part;
            self.multipliers.iter_mut().zip(&self.parts).for_each(|(sum, part)| *sum += part);
            write(self, motion, &mut change);
            rates.iter_mut().zip(&change).for_each(|(rate, change)| *rate += change);
            if part <= ROUNDED * self.rank.largest(&self.multipliers) {
                break;
            }
        }
        self.change = change;
        at(motion, rates);
        Ok(())
    }

    /// Brings coordinates and speeds to where the loops are closed, and stay so; the motion is then
    /// placed there. What the motion [holds](TreeMotion::hold) stays.
    ///
    /// # Errors
    /// [`TreeError::NotClosed`] where no closed place is found near; [`TreeError::DependentLoops`];
    /// those of [`TreeMotion::place`].
    pub fn close(
        &mut self,
        motion: &mut TreeMotion,
        q: &mut [f64],
        v: &mut [f64],
    ) -> Result<(), TreeError> {
        self.check(motion)?;
        motion.place(q, v)?;
        let mut last = f64::INFINITY;
        for _ in 0..ITERATIONS {
            let (extent, mut gap) = (motion.extent(), 0.0_f64);
            for (part, row) in self.parts.iter_mut().zip(&self.rows) {
                *part = -row.gap(motion);
                gap = gap.max(part.abs() / row.size(motion, extent));
            }
            if gap <= ROUNDING || (gap >= 0.5 * last && gap <= STALLED) {
                self.check_aside(motion)?;
                motion.set_moving(q, v);
                self.respond_alone(motion)?;
                let at = |motion: &mut TreeMotion, v: &[f64]| motion.set_moving(q, v);
                return self.meet(motion, v, (at, LoopRow::speed), Self::write_change);
            }
            last = gap;
            self.respond_alone(motion)?;
            self.factor()?;
            self.matrix.solve(&mut self.parts);
            let mut change = std::mem::take(&mut self.change);
            self.write_change(motion, &mut change);
            motion.tree.move_along(q, &change);
            self.change = change;
            self.check_finite(q)?;
            motion.put(q);
        }
        Err(TreeError::NotClosed { gap: last })
    }

    /// What a part of the multipliers moves, but for what the motion holds.
    fn write_change(&self, motion: &TreeMotion, change: &mut [f64]) {
        self.write_response(change);
        motion.held.iter().for_each(|&speed| change[speed] = 0.0);
    }

    /// What a part of the multipliers moves, and of what is held the force.
    fn write_response(&self, change: &mut [f64]) {
        change.fill(0.0);
        let n = self.idle.len();
        for (part, response) in self.parts.iter().zip(self.responses.chunks_exact(n.max(1))) {
            change
                .iter_mut()
                .zip(response)
                .for_each(|(change, response)| *change += part * response);
        }
    }

    /// An error where a row that others held is held no longer.
    pub(super) fn check_aside(&self, motion: &TreeMotion) -> Result<(), TreeError> {
        let extent = motion.extent();
        let part = |row: &LoopRow| row.gap(motion).abs() / row.size(motion, extent);
        let gap = self.aside.iter().map(part).fold(0.0, f64::max);
        if gap <= OPENED { Ok(()) } else { Err(TreeError::NotClosed { gap }) }
    }

    fn check(&self, motion: &TreeMotion) -> Result<(), TreeError> {
        self.check_tree(&motion.tree)
    }

    pub(super) fn check_tree(&self, tree: &Tree) -> Result<(), TreeError> {
        SizeError::check("the tree's bodies", self.bodies, tree.bodies())?;
        Ok(SizeError::check("the tree's speeds", self.idle.len(), tree.speeds())?)
    }

    fn check_finite(&self, q: &[f64]) -> Result<(), TreeError> {
        check_numbers("the coordinates", q.len(), q)
    }

    /// `M^-1 J^T` and `J M^-1 J^T`.
    fn respond(&mut self, motion: &mut TreeMotion) -> Result<(), TreeError> {
        motion.factor()?;
        let n = self.idle.len();
        for (r, row) in self.rows.iter().enumerate() {
            row.push(motion);
            let response = &mut self.responses[n * r..][..n];
            motion.solve(&self.idle, |_| Twist::zero(), response);
            let m = self.rows.len();
            let column = &mut self.matrix.matrix()[m * r..][..m];
            for (entry, felt) in column.iter_mut().zip(&self.rows) {
                *entry = felt.rate(motion, |body| motion.accelerations[body]);
            }
        }
        Ok(())
    }

    /// The same, of full rank.
    fn respond_alone(&mut self, motion: &mut TreeMotion) -> Result<(), TreeError> {
        self.respond(motion)?;
        let TreeLoops { rows, rank, matrix, .. } = self;
        let mut alone = true;
        rank.examine(motion, rows, matrix.matrix(), |_| alone = false);
        if alone { Ok(()) } else { Err(self.dependent()) }
    }

    fn factor(&mut self) -> Result<(), TreeError> {
        self.matrix.factor().map_err(|_| self.dependent())
    }

    fn dependent(&self) -> TreeError {
        TreeError::DependentLoops { rows: self.rows.len() }
    }
}
