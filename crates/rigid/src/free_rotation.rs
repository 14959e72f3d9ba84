//! A map that turns a body free of torque for a step: the heart of every integrator here.
//!
//! ```text
//! (R, m) -> (R S, S^T m),    S the turn of the step
//! R S S^T m = R m                     so spatial angular momentum is kept, whatever S is
//! ```
//! `R` the orientation, `m` the angular momentum in body axes. Each map chooses its `S` from `m`;
//! the same rounded `S` turns both, so that `R m` moves by rounding alone. Errors of length that
//! `S` keeps making would add up over many steps; quaternions are divided by their length, and a
//! vector is turned by its difference from itself, which is off by the rounding of the difference
//! only.

use nalgebra::Vector3;
use stationary_integrators::{Facts, StepError};

use crate::{Body, LieGroup, Rotation};

/// How a body's orientation and angular momentum are after a step without torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turned {
    /// The orientation.
    pub rotation: Rotation,
    /// The angular momentum, body axes.
    pub momentum: Vector3<f64>,
    /// Newton iterations it took.
    pub iterations: u32,
    /// What is left of the equation that it solved, relative to the momentum.
    pub residual: f64,
}

/// A map that turns a body free of torque.
pub trait FreeRotation {
    /// What is known of the integrator that kicks, turns and kicks with this map.
    const FACTS: Facts;

    /// Turns `body`, at `rotation` with angular momentum `momentum` (body axes), for `h` seconds.
    ///
    /// # Errors
    /// [`StepError::Newton`] where the map solves an equation and does not find the turn; of
    /// explicit maps none.
    fn turn(
        body: &Body,
        rotation: Rotation,
        momentum: Vector3<f64>,
        h: f64,
    ) -> Result<Turned, StepError>;
}

impl Turned {
    /// The turn `step` of the body.
    #[inline]
    pub(crate) fn by(step: Rotation, rotation: Rotation, momentum: Vector3<f64>) -> Self {
        Turned {
            rotation: rotation.compose(&step).normalized(),
            momentum: step.rotate_back(&momentum),
            iterations: 0,
            residual: 0.0,
        }
    }
}
