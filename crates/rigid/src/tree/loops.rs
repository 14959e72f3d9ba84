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
//! squares the angle between rows, and would lose what rows that nearly depend on each other ask for. Rows that the tree holds already are refused: a loop of parallel hinges is
//! closed by a point on a line along them, which is two rows.
//!
//! A field with multipliers keeps `g` to the tolerance of the run only, and it drifts: the second
//! line brings a state back along the shortest way in the metric. Call it after a step, or as often
//! as the drift matters. Source: Featherstone 2008, 8; notes 6.3, 6.4.

use nalgebra::{SVector, Vector3};
use stationary_calculus::{DenseLu, SizeError};

use super::builder::Tree;
use super::error::{TreeError, check_numbers};
use super::forces::TreeForces;
use super::motion::TreeMotion;
use super::spatial::{SpatialForce, Twist};
use crate::joint::{Local, Placed, Row, along};
use crate::{JointEnd, JointFault, JointKind, JointName, Wrench};

#[derive(Clone, Copy, Debug, PartialEq)]
struct LoopRow {
    ends: [JointEnd; 2],
    row: Row,
}

/// Joints that close loops, and the memory to hold them so.
#[derive(Clone, Debug)]
pub struct TreeLoops {
    bodies: usize,
    rows: Vec<LoopRow>,
    /// `M^-1 J^T`, row after row.
    responses: Vec<f64>,
    matrix: DenseLu,
    /// A copy of it, and the roots of its diagonal, to examine its rank.
    scaled: Vec<f64>,
    sizes: Vec<f64>,
    multipliers: Vec<f64>,
    /// What is added to them.
    parts: Vec<f64>,
    change: Vec<f64>,
    idle: Vec<f64>,
}

/// Most corrections of a configuration: it takes three or four.
const ITERATIONS: u32 = 30;
/// A gap that is left is rounding, against the distance of its points from the origin.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// So is one that corrections no longer halve: coordinates of many turns are rounded by more.
const STALLED: f64 = 1e-9;

/// What a row moves that is this part of what it would move of all bodies as one, is held by the tree.
const HELD: f64 = 1e-11;
/// So is what is rounding of the motion of the lightest.
const ROUNDED: f64 = 256.0 * f64::EPSILON;
/// The square of the sine of the angle between rows, masses counted, below which they hold the same.
const DEPENDENT: f64 = 1e-11;
/// Most solves for multipliers, each of what the last has left: rows near that angle leave 1e-5 of it.
const REFINEMENTS: u32 = 8;
/// The part of the multipliers that the last of them may add.
const REFINED: f64 = 1e-7;

impl TreeLoops {
    /// No loops yet.
    pub fn new(tree: &Tree) -> Self {
        TreeLoops {
            bodies: tree.bodies(),
            rows: Vec::new(),
            responses: Vec::new(),
            matrix: DenseLu::new(0),
            scaled: Vec::new(),
            sizes: Vec::new(),
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
        self.check_tree(tree)?;
        let joint = JointName { kind: kind.name(), bodies: ends.map(|end| end.body) };
        let fault = |fault| TreeError::Loop { joint, fault };
        ends.iter().try_for_each(|end| end.check(self.bodies)).map_err(fault)?;
        if ends[0].body == ends[1].body {
            return Err(fault(JointFault::ToItself));
        }
        let kind = kind.checked().map_err(fault)?;
        self.rows.extend(Row::all(&kind, &ends).into_iter().map(|row| LoopRow { ends, row }));
        let m = self.rows.len();
        self.responses.resize(m * self.idle.len(), 0.0);
        self.multipliers.resize(m, 0.0);
        self.parts.resize(m, 0.0);
        self.matrix = DenseLu::new(m);
        self.scaled.resize(self.rows.len() * self.rows.len(), 0.0);
        self.sizes.resize(self.rows.len(), 0.0);
        Ok(())
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
            self.rows.iter().map(|row| of(row).abs()).fold(0.0, f64::max)
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
        self.respond(motion)?;
        self.hold(motion, acceleration, TreeMotion::accelerate, LoopRow::acceleration)?;
        check_numbers("the acceleration", self.idle.len(), acceleration)
    }

    /// Adds what the rows do to rates of the speeds until the rates meet them; `at` sets the motion to rates.
    fn hold(
        &mut self,
        motion: &mut TreeMotion,
        rates: &mut [f64],
        at: impl Fn(&mut TreeMotion, &[f64]),
        missed: impl Fn(&LoopRow, &TreeMotion) -> f64,
    ) -> Result<(), TreeError> {
        self.factor()?;
        self.multipliers.fill(0.0);
        let mut last = f64::INFINITY;
        for _ in 0..REFINEMENTS {
            at(motion, rates);
            for (part, row) in self.parts.iter_mut().zip(&self.rows) {
                *part = -missed(row, motion);
            }
            self.matrix.solve(&mut self.parts);
            let part = self.size(&self.parts);
            if part > 0.5 * last {
                break;
            }
            last = part;
            self.multipliers.iter_mut().zip(&self.parts).for_each(|(sum, part)| *sum += part);
            self.add_responses(rates);
            if part <= ROUNDED * self.size(&self.multipliers) {
                break;
            }
        }
        at(motion, rates);
        match last <= REFINED * self.size(&self.multipliers) {
            true => Ok(()),
            false => Err(self.dependent()),
        }
    }

    /// The largest of multipliers, each by what its row alone moves.
    fn size(&self, multipliers: &[f64]) -> f64 {
        let sizes = multipliers.iter().zip(&self.sizes);
        sizes.fold(0.0, |largest, (lambda, size)| largest.max(lambda.abs() * size))
    }

    /// Brings coordinates and speeds to where the loops are closed, and stay so; the motion is then
    /// placed there.
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
            let mut gap = 0.0_f64;
            for (part, row) in self.parts.iter_mut().zip(&self.rows) {
                *part = -row.gap(motion);
                gap = gap.max(part.abs() / row.size(motion));
            }
            if gap <= ROUNDING || (gap >= 0.5 * last && gap <= STALLED) {
                motion.set_moving(q, v);
                self.respond(motion)?;
                return self.hold(motion, v, |motion, v| motion.set_moving(q, v), LoopRow::speed);
            }
            last = gap;
            self.respond(motion)?;
            self.factor()?;
            self.matrix.solve(&mut self.parts);
            self.change.fill(0.0);
            let mut change = std::mem::take(&mut self.change);
            self.add_responses(&mut change);
            motion.tree.move_along(q, &change);
            self.change = change;
            self.check_finite(q)?;
            motion.put(q);
        }
        Err(TreeError::NotClosed { gap: last })
    }

    fn check(&self, motion: &TreeMotion) -> Result<(), TreeError> {
        self.check_tree(&motion.tree)
    }

    fn check_tree(&self, tree: &Tree) -> Result<(), TreeError> {
        SizeError::check("the tree's bodies", self.bodies, tree.bodies())?;
        Ok(SizeError::check("the tree's speeds", self.idle.len(), tree.speeds())?)
    }

    fn check_finite(&self, q: &[f64]) -> Result<(), TreeError> {
        check_numbers("the coordinates", q.len(), q)
    }

    /// `M^-1 J^T` and `J M^-1 J^T`, of full rank.
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
        self.check_rank(motion)
    }

    /// An error where a row pushes against what the tree holds already, or against other rows: what it
    /// meets is then rounding, and a number divided by it would be none.
    fn check_rank(&mut self, motion: &TreeMotion) -> Result<(), TreeError> {
        let m = self.rows.len();
        let dependent = Err(self.dependent());
        let [together, lightest] = Lump::of(motion);
        self.scaled.copy_from_slice(self.matrix.matrix());
        for (r, row) in self.rows.iter().enumerate() {
            let unit = row.differential(motion);
            let rounding = HELD * together.response(&unit) + ROUNDED * lightest.response(&unit);
            let response = self.scaled[(m + 1) * r];
            if response.is_nan() || response <= rounding {
                return dependent;
            }
            self.sizes[r] = response.sqrt();
        }
        // Cholesky's pivots, of rows that alone meet 1.
        for k in 0..m {
            for i in k..m {
                let taken: f64 =
                    (0..k).map(|j| self.scaled[m * j + i] * self.scaled[m * j + k]).sum();
                let entry = self.scaled[m * k + i] / (self.sizes[i] * self.sizes[k]) - taken;
                if i == k && (entry.is_nan() || entry <= DEPENDENT) {
                    return dependent;
                }
                let pivot = if i == k { entry.sqrt() } else { self.scaled[(m + 1) * k] };
                self.scaled[m * k + i] = if i == k { pivot } else { entry / pivot };
            }
        }
        Ok(())
    }

    fn factor(&mut self) -> Result<(), TreeError> {
        self.matrix.factor().map_err(|_| self.dependent())
    }

    fn dependent(&self) -> TreeError {
        TreeError::DependentLoops { rows: self.rows.len() }
    }

    fn add_responses(&self, to: &mut [f64]) {
        let n = self.idle.len();
        for (part, response) in self.parts.iter().zip(self.responses.chunks_exact(n.max(1))) {
            to.iter_mut().zip(response).for_each(|(to, response)| *to += part * response);
        }
    }
}

/// A mass and an inertia that a row could push, kg and kg m^2.
struct Lump {
    mass: f64,
    inertia: f64,
}

impl Lump {
    /// All bodies as one, and the lightest of each.
    fn of(motion: &TreeMotion) -> [Lump; 2] {
        let mut all = Lump { mass: 0.0, inertia: 0.0 };
        let mut least = Lump { mass: f64::INFINITY, inertia: f64::INFINITY };
        let origin = motion.placed[0].centre;
        for (link, placed) in motion.tree.links.iter().zip(&motion.placed) {
            if link.mass > 0.0 {
                all.mass += link.mass;
                all.inertia += link.moments.sum();
                all.inertia += link.mass * (placed.centre - origin).norm_squared();
                least.mass = least.mass.min(link.mass);
                least.inertia = least.inertia.min(link.moments.min());
            }
        }
        [all, least]
    }

    /// How a unit of a row's force moves it along the row.
    fn response(&self, unit: &[Wrench; 2]) -> f64 {
        let force = unit.iter().map(|wrench| wrench.force.norm_squared()).sum::<f64>();
        let torque = unit.iter().map(|wrench| wrench.torque.norm_squared()).sum::<f64>();
        force / self.mass + torque / self.inertia
    }
}

impl LoopRow {
    fn placed(&self, motion: &TreeMotion) -> [Placed; 2] {
        self.ends.each_ref().map(|end| match end.body {
            None => end.in_world(),
            Some(body) => {
                let at = &motion.placed[body];
                let arm = end.frame.translation;
                Placed { rotation: at.matrix, arm, place: at.centre + at.matrix * arm }
            }
        })
    }

    fn differential(&self, motion: &TreeMotion) -> [Wrench; 2] {
        self.row.differential(&self.placed(motion))
    }

    fn gap(&self, motion: &TreeMotion) -> f64 {
        self.row.value(&self.placed(motion))
    }

    /// What a gap is rounded against.
    fn size(&self, motion: &TreeMotion) -> f64 {
        let far = |at: Placed| at.place.norm().max(at.arm.norm());
        self.row.scale(self.placed(motion).map(far).into_iter().fold(0.0, f64::max)).length
    }

    /// Each body's motion in the row's axes: that of the centre in the world's, turns in the body's.
    fn local(&self, motion: &TreeMotion, of: impl Fn(usize) -> Twist) -> SVector<f64, 12> {
        along(&self.ends.each_ref().map(|end| match end.body {
            None => Wrench { force: Vector3::zeros(), torque: Vector3::zeros() },
            Some(body) => {
                let Twist { linear, angular } = of(body);
                Wrench { force: linear, torque: motion.placed[body].matrix.tr_mul(&angular) }
            }
        }))
    }

    fn rate(&self, motion: &TreeMotion, of: impl Fn(usize) -> Twist) -> f64 {
        along(&self.differential(motion)).dot(&self.local(motion, of))
    }

    fn speed(&self, motion: &TreeMotion) -> f64 {
        self.rate(motion, |body| motion.moving[body].twist)
    }

    fn acceleration(&self, motion: &TreeMotion) -> f64 {
        let mut bend = Local::zeros();
        self.row.add_hessian(&self.placed(motion), 1.0, &mut bend);
        let velocity = self.local(motion, |body| motion.moving[body].twist);
        self.rate(motion, |body| motion.accelerations[body]) + velocity.dot(&(bend * velocity))
    }

    /// Sets the tree's bias forces to a unit of this row's force.
    fn push(&self, motion: &mut TreeMotion) {
        motion.forces.fill(SpatialForce::zero());
        for (end, Wrench { force, torque }) in self.ends.iter().zip(self.differential(motion)) {
            let Some(body) = end.body else { continue };
            let torque = motion.placed[body].matrix * torque;
            motion.forces[body] += SpatialForce { force: -force, torque: -torque };
        }
    }
}
