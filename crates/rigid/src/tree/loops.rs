//! Loops: points of two bodies of a tree that stay together.
//!
//! ```text
//! g = n.(x_a - x_b) = 0,     J v = n.(v_a - v_b) = 0            rows, n a direction of the world
//! M v. = tau - C + J^T lambda,    (J M^-1 J^T) lambda = -J v._0 - J. v
//! q <- q - M^-1 J^T (J M^-1 J^T)^-1 g,    v <- v - M^-1 J^T (J M^-1 J^T)^-1 J v
//! ```
//! `x_a x_b` the points (m), `v._0` the accelerations of the open tree, `lambda` the force (N) of the
//! point b on the point a along n. Each row is one more pass over the tree, so that a few rows cost
//! little; their matrix is full. Two rows close a loop in the plane, three a ball joint in space;
//! joints that hold directions too are not told here.
//!
//! A field with multipliers keeps `g` to the tolerance of the run only, and it drifts: the second
//! line brings a state back along the shortest way in the metric. Call it after a step, or as often
//! as the drift matters. Source: Featherstone 2008, 8; notes 6.3, 6.4.

use nalgebra::Vector3;
use stationary_calculus::{DenseLu, SizeError};

use super::builder::Tree;
use super::error::{TreeError, check_numbers};
use super::forces::TreeForces;
use super::motion::{Placed, TreeMotion};
use super::spatial::{SpatialForce, Twist};

/// A point of a body, or of the world, metres, in the axes of its body.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopEnd {
    /// The body; `None` is the world.
    pub body: Option<usize>,
    /// The point.
    pub point: Vector3<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Row {
    ends: [LoopEnd; 2],
    direction: Vector3<f64>,
}

/// Points that stay together, and the memory to hold them so.
#[derive(Clone, Debug)]
pub struct TreeLoops {
    bodies: usize,
    rows: Vec<Row>,
    /// `M^-1 J^T`, row after row.
    responses: Vec<f64>,
    matrix: DenseLu,
    multipliers: Vec<f64>,
    change: Vec<f64>,
    idle: Vec<f64>,
}

/// Most corrections of a configuration: it takes three or four.
const ITERATIONS: u32 = 30;
/// A gap that is left is rounding, against the distance of its points from the origin.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// So is one that corrections no longer halve: coordinates of many turns are rounded by more.
const STALLED: f64 = 1e-9;

impl TreeLoops {
    /// No loops yet.
    pub fn new(tree: &Tree) -> Self {
        TreeLoops {
            bodies: tree.bodies(),
            rows: Vec::new(),
            responses: Vec::new(),
            matrix: DenseLu::new(0),
            multipliers: Vec::new(),
            change: vec![0.0; tree.speeds()],
            idle: vec![0.0; tree.speeds()],
        }
    }

    /// Two points that stay together along these directions of the world.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`]; numbers that are not finite.
    pub fn join(
        &mut self,
        tree: &Tree,
        ends: [LoopEnd; 2],
        directions: &[Vector3<f64>],
    ) -> Result<(), TreeError> {
        self.check_tree(tree)?;
        for end in &ends {
            check_numbers("the loop's point", 3, end.point.as_slice())?;
            if let Some(body) = end.body {
                tree.link(body)?;
            }
        }
        for direction in directions {
            check_numbers("the loop's direction", 3, direction.as_slice())?;
            self.rows.push(Row { ends, direction: *direction });
        }
        let m = self.rows.len();
        self.responses.resize(m * self.idle.len(), 0.0);
        self.multipliers.resize(m, 0.0);
        self.matrix = DenseLu::new(m);
        Ok(())
    }

    /// The forces along the rows, N, at the last [`TreeLoops::forward_dynamics`].
    pub fn multipliers(&self) -> &[f64] {
        &self.multipliers
    }

    /// The largest gap (m) and the largest velocity of a gap (m/s) along the directions.
    ///
    /// # Errors
    /// A motion of another tree.
    pub fn violation(&self, motion: &TreeMotion) -> Result<[f64; 2], TreeError> {
        self.check(motion)?;
        let worst = |of: &dyn Fn(&Row) -> f64| {
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
        for (lambda, row) in self.multipliers.iter_mut().zip(&self.rows) {
            *lambda = -row.acceleration(motion);
        }
        self.respond(motion)?;
        self.solve()?;
        self.add_responses(acceleration);
        check_numbers("the acceleration", self.idle.len(), acceleration)
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
            let (mut gap, mut reach) = (0.0_f64, 0.0_f64);
            for (lambda, row) in self.multipliers.iter_mut().zip(&self.rows) {
                *lambda = -row.gap(motion);
                gap = gap.max(lambda.abs());
                reach = reach.max(row.reach(motion));
            }
            if gap <= ROUNDING * reach || (gap >= 0.5 * last && gap <= STALLED * reach) {
                return self.close_speeds(motion, q, v);
            }
            last = gap;
            self.respond(motion)?;
            self.solve()?;
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

    fn close_speeds(
        &mut self,
        motion: &mut TreeMotion,
        q: &[f64],
        v: &mut [f64],
    ) -> Result<(), TreeError> {
        motion.set_moving(q, v);
        for (lambda, row) in self.multipliers.iter_mut().zip(&self.rows) {
            *lambda = -row.speed(motion);
        }
        self.respond(motion)?;
        self.solve()?;
        self.add_responses(v);
        motion.set_moving(q, v);
        Ok(())
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
                *entry = felt.difference(|end| end.moved(motion));
            }
        }
        Ok(())
    }

    fn solve(&mut self) -> Result<(), TreeError> {
        let rows = self.rows.len();
        self.matrix.factor().map_err(|_| TreeError::DependentLoops { rows })?;
        self.matrix.solve(&mut self.multipliers);
        Ok(())
    }

    fn add_responses(&self, to: &mut [f64]) {
        let n = self.idle.len();
        for (lambda, response) in self.multipliers.iter().zip(self.responses.chunks_exact(n.max(1)))
        {
            to.iter_mut().zip(response).for_each(|(to, response)| *to += lambda * response);
        }
    }
}

impl LoopEnd {
    fn placed<'m>(&self, motion: &'m TreeMotion) -> Option<(&'m Placed, Vector3<f64>)> {
        let placed = &motion.placed[self.body?];
        Some((placed, placed.matrix * self.point))
    }

    fn place(&self, motion: &TreeMotion) -> Vector3<f64> {
        self.placed(motion).map_or(self.point, |(placed, arm)| placed.centre + arm)
    }

    fn velocity(&self, motion: &TreeMotion) -> Vector3<f64> {
        self.placed(motion)
            .map_or(Vector3::zeros(), |(placed, arm)| placed.twist.outward(&arm).linear)
    }

    /// Its velocity under the motions that the tree solved for last.
    fn moved(&self, motion: &TreeMotion) -> Vector3<f64> {
        let (Some((_, arm)), Some(body)) = (self.placed(motion), self.body) else {
            return Vector3::zeros();
        };
        motion.accelerations[body].outward(&arm).linear
    }

    fn acceleration(&self, motion: &TreeMotion) -> Vector3<f64> {
        let circling = self.placed(motion).map_or(Vector3::zeros(), |(placed, arm)| {
            let w = placed.twist.angular;
            w.cross(&w.cross(&arm))
        });
        self.moved(motion) + circling
    }
}

impl Row {
    fn difference(&self, of: impl Fn(&LoopEnd) -> Vector3<f64>) -> f64 {
        self.direction.dot(&(of(&self.ends[0]) - of(&self.ends[1])))
    }

    fn gap(&self, motion: &TreeMotion) -> f64 {
        self.difference(|end| end.place(motion))
    }

    fn speed(&self, motion: &TreeMotion) -> f64 {
        self.difference(|end| end.velocity(motion))
    }

    fn acceleration(&self, motion: &TreeMotion) -> f64 {
        self.difference(|end| end.acceleration(motion))
    }

    /// The length that the gap is rounded against.
    fn reach(&self, motion: &TreeMotion) -> f64 {
        let far = self.ends.iter().map(|end| end.place(motion).norm().max(end.point.norm()));
        self.direction.norm() * far.fold(0.0, f64::max)
    }

    /// Sets the tree's bias forces to a unit of this row's force.
    fn push(&self, motion: &mut TreeMotion) {
        motion.forces.fill(SpatialForce::zero());
        for (end, sign) in self.ends.iter().zip([-1.0, 1.0]) {
            let (Some((_, arm)), Some(body)) = (end.placed(motion), end.body) else { continue };
            let force = SpatialForce { force: self.direction * sign, torque: Vector3::zeros() };
            motion.forces[body] += force.inward(&arm);
        }
    }
}
