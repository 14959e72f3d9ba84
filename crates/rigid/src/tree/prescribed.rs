//! Prescribed motion of a joint: a coordinate that follows a schedule, and the force that it takes.
//!
//! ```text
//! q_k = s(t),   v_k = s.(t),   v._k = s..(t)
//! I  <- I  (held: it gives no way),    f_k = s_k^T (I A + b) - tau_k
//! ```
//! `A` what the body accelerates with, `I` and `b` the inertia and the force of the branch, `f_k` the force of the drive
//! beyond the joint's other ones: N of a shift, N m of a turn. The other joints move as the
//! equations of motion say, under what the drive's motion does to them: hybrid dynamics, in one pass
//! each way. A motor of given speed is a [`Steady`](crate::Steady) schedule. Its power is `f_k s.`.
//! In full coordinates it is [`Drive`](crate::Drive). Source: Featherstone 2008, 9.2.

use std::fmt;
use std::rc::Rc;

use nalgebra::Vector3;
use stationary_calculus::{SizeError, Vector, directional_derivative, second_differential};

use super::builder::Tree;
use super::error::{TreeError, check_numbers};
use super::motion::TreeMotion;
use super::spatial::{SpatialForce, Twist};
use crate::{JointFault, Schedule};

impl TreeMotion {
    /// Holds what follows these schedules: no force moves it, and no loop does that is
    /// [closed](super::TreeLoops::close).
    ///
    /// # Errors
    /// Drives of another tree, or two of one speed: [`TreeError::DrivenTwice`].
    pub fn hold(&mut self, drives: &[TreeDrive]) -> Result<(), TreeError> {
        self.held = TreeDrive::check_all(drives, &self.tree)?;
        Ok(())
    }

    /// Changes the speeds as impulses do that change those that are held by so much. The motion is placed there, and
    /// moves as they say afterwards.
    ///
    /// # Errors
    /// Sizes that do not fit, numbers that are not finite; [`TreeError::Singular`].
    pub fn change_held(
        &mut self,
        q: &[f64],
        v: &mut [f64],
        changes: &[f64],
    ) -> Result<(), TreeError> {
        check_numbers("the changes", self.held.len(), changes)?;
        self.place(q, v)?;
        self.factor()?;
        self.moving.iter_mut().for_each(|moving| moving.bias = Twist::zero());
        let held = std::mem::take(&mut self.held);
        for (&speed, &change) in held.iter().zip(changes) {
            self.accelerate_along(speed, change);
        }
        self.forces.fill(SpatialForce::zero());
        let mut answer = vec![0.0; v.len()];
        self.solve(&vec![0.0; v.len()], |moving| moving.bias, &mut answer);
        for (&speed, &change) in held.iter().zip(changes) {
            answer[speed] = change;
        }
        self.held = held;
        v.iter_mut().zip(&answer).for_each(|(v, change)| *v += change);
        self.place(q, v)
    }

    /// Adds the acceleration of a held speed to what its body accelerates by itself, until the tree is placed
    /// again.
    pub(super) fn accelerate_along(&mut self, speed: usize, acceleration: f64) {
        let column = self.columns[speed];
        let body = self.tree.links.iter().position(|link| link.speeds.contains(&speed));
        if let Some(body) = body {
            self.moving[body].bias += column * acceleration;
        }
    }
}

/// A coordinate of a tree's joint that follows a schedule.
#[derive(Clone)]
pub struct TreeDrive {
    pub(super) coordinate: usize,
    pub(super) speed: usize,
    /// What its coordinate is measured by where that is nearly zero: a radian, or the size of a body, metres.
    unit: f64,
    /// Coordinate, speed and acceleration at a time.
    moves: Rc<dyn Fn(f64) -> [f64; 3]>,
}

impl fmt::Debug for TreeDrive {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let TreeDrive { coordinate, speed, .. } = self;
        f.debug_struct("TreeDrive")
            .field("coordinate", coordinate)
            .field("speed", speed)
            .finish_non_exhaustive()
    }
}

impl TreeDrive {
    /// The drive of a freedom, counted from 0, of the joint by which a body hangs.
    ///
    /// # Errors
    /// [`TreeError::NoSuchBody`]; [`TreeError::Joint`] for a freedom that the joint does not have, or one of
    /// a ball or a free joint, whose coordinates are none of its own.
    pub fn new(
        tree: &Tree,
        body: usize,
        freedom: usize,
        schedule: impl Schedule + 'static,
    ) -> Result<Self, TreeError> {
        let (coordinates, speeds) = (tree.coordinates_of(body)?, tree.speeds_of(body)?);
        let own = if coordinates.len() == speeds.len() { speeds.len() } else { 0 };
        if freedom >= own {
            let fault = JointFault::NotDriven { freedom, freedoms: own };
            return Err(TreeError::Joint { joining: tree.joining(body), fault });
        }
        let link = tree.link(body)?;
        let (rest, mut columns) = (vec![0.0; own], [Twist::zero(); 6]);
        link.joint.columns(&rest, &link.joint.motion(&rest), &mut columns);
        let turns = columns[freedom].angular != Vector3::zeros();
        let moves = move |t: f64| {
            let one = Vector([1.0]);
            [
                schedule.at(t),
                directional_derivative(|[t]| schedule.at(t), [t], one),
                second_differential(|[t]| schedule.at(t), [t], one, one),
            ]
        };
        Ok(TreeDrive {
            coordinate: coordinates.start + freedom,
            speed: speeds.start + freedom,
            unit: if turns { 1.0 } else { tree.radius() },
            moves: Rc::new(moves),
        })
    }

    /// Their speeds, which belong to the tree and are driven once each.
    pub(super) fn check_all(drives: &[TreeDrive], tree: &Tree) -> Result<Vec<usize>, TreeError> {
        let (coordinates, speeds) = (tree.coordinates(), tree.speeds());
        let mut held = Vec::with_capacity(drives.len());
        for drive in drives {
            SizeError::check("the tree's speeds", speeds, speeds.max(drive.speed + 1))?;
            let least = coordinates.max(drive.coordinate + 1);
            SizeError::check("the tree's coordinates", coordinates, least)?;
            if held.contains(&drive.speed) {
                return Err(TreeError::DrivenTwice { speed: drive.speed });
            }
            held.push(drive.speed);
        }
        Ok(held)
    }

    /// The coordinate, its speed and its acceleration at a time: of a turn radians, of a shift metres.
    pub fn motion(&self, t: f64) -> [f64; 3] {
        (self.moves)(t)
    }

    /// What a distance from a place of its coordinate is measured by.
    pub(super) fn size(&self, place: f64) -> f64 {
        place.abs().max(self.unit)
    }

    /// Where its coordinate and its speed stand among those of the tree.
    pub fn places(&self) -> [usize; 2] {
        [self.coordinate, self.speed]
    }
}
