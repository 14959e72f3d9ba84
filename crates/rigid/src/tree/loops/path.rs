//! Ends of loops in the world that move as they are told.
//!
//! ```text
//! x(t) = x_0 + d(t),    dg/dt = J_x d.,    what accelerates the row: J_x d.. beside that of the bodies
//! ```
//! `x_0` where the joint has its end, `J_x` how the row changes with it.

use std::fmt;
use std::rc::Rc;

use nalgebra::Vector3;

/// A shift (m) with its velocity and its acceleration as functions of time.
#[derive(Clone)]
pub(super) struct EndPath(pub(super) Rc<dyn Fn(f64) -> [Vector3<f64>; 3]>);

impl fmt::Debug for EndPath {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("EndPath")
    }
}

/// Where an end in the world is at a moment, from where its joint has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct EndNow {
    pub(super) shift: Vector3<f64>,
    pub(super) velocity: Vector3<f64>,
    pub(super) acceleration: Vector3<f64>,
}

impl EndNow {
    /// It stays.
    pub(super) fn still() -> Self {
        let none = Vector3::zeros();
        EndNow { shift: none, velocity: none, acceleration: none }
    }
}

impl EndPath {
    pub(super) fn at(&self, t: f64) -> EndNow {
        let [shift, velocity, acceleration] = (self.0)(t);
        EndNow { shift, velocity, acceleration }
    }
}
