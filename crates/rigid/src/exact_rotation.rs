//! The free body in closed form, as the drift of a splitting.
//!
//! ```text
//! S = R(h)                       of a free top that starts at the identity
//! ```
//! `h` seconds; see [`FreeTop`]. A free body is then exact at any step, energy included; under a
//! potential the kicks alone err, which pays where a body spins fast in a weak field. Elliptic
//! functions and integrals make a step some ten times dearer than [`AxisRotations`].
//! Order 2, explicit, symmetric, symplectic. Source: Celledoni, Fasso, Saefstroem and Zanna 2008.
//!
//! [`AxisRotations`]: crate::AxisRotations

use nalgebra::Vector3;
use stationary_integrators::{Facts, StepError};

use crate::axis_rotations::AxisRotations;
use crate::free_rotation::{FreeRotation, Turned};
use crate::{Body, FreeTop, LieGroup, Rotation};

/// The free body in closed form.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExactRotation;

impl FreeRotation for ExactRotation {
    const FACTS: Facts = Facts { name: "exact-rotation", ..AxisRotations::FACTS };

    fn turn(
        body: &Body,
        rotation: Rotation,
        momentum: Vector3<f64>,
        h: f64,
    ) -> Result<Turned, StepError> {
        let top = FreeTop::from_momentum(*body, Rotation::identity(), momentum);
        let turn = top.orientation(h).map_err(|_| StepError::Step(h))?;
        // Of the two quaternions of a turn the closed form has either: the nearer one leads on from where the
        // body was, so that numbers of a motion do not jump.
        let turn = match turn.quaternion() {
            [w, x, y, z] if w < 0.0 => Rotation::unchecked([-w, -x, -y, -z]),
            _ => turn,
        };
        Ok(Turned::by(turn, rotation, momentum))
    }
}
