//! A slider-crank in the plane: a piston on a line, driven to and fro by a crank, under gravity.
//!
//! ```text
//! (0, 0) --1-- crank pin --3-- piston on y = 0
//! ```
//! Two rods and a line; its one freedom is the crank's angle. Unit masses at the pin and the
//! piston.

use stationary_calculus::{Number, Vector, directional_derivative};
use stationary_integrators::State;

use super::{Hanging, check_finite, hanging, revolution};
use crate::{ConstraintError, Embedding, Linear, Rod, Rods};

/// A slider-crank.
#[derive(Clone, Debug)]
pub struct SliderCrank {
    /// Its masses and its weight.
    pub system: Hanging<[f64; 4]>,
    /// Its rods, and the piston's line.
    pub constraint: (Rods<2>, Linear),
    /// Where it starts; feasible.
    pub initial: State<[f64; 4]>,
    /// The time in which the crank goes round, where it does and its energy leaves no doubt.
    pub revolution: Option<f64>,
}

/// Pin and piston as functions of the crank's angle from the piston's line, radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Piston;

impl Embedding<1, 4> for Piston {
    fn places<R: Number>(&self, [angle]: [R; 1]) -> [R; 4] {
        let (s, c) = angle.sin_cos();
        [c, s, c + (-s * s + 9.0).sqrt(), R::from(0.0)]
    }
}

/// The machine with its crank at an angle, radians, turning at a rate, radians a second.
///
/// # Errors
/// [`ConstraintError::Parameter`] for an angle or a rate that is not finite;
/// [`ConstraintError::NonFinite`] where a point's speed overflows.
pub fn slider_crank(angle: f64, rate: f64) -> Result<SliderCrank, ConstraintError> {
    check_finite("angle", angle)?;
    check_finite("rate", rate)?;
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 3.0)];
    let rods = Rods::new(2, vec![[0.0, 0.0]], rods)?;
    let places = Piston.places([angle]);
    let along = directional_derivative(|a| Piston.places(a), [angle], Vector([rate]));
    let problem = hanging(places, along, 1.0, rods)?;
    let line = Linear::new(vec![(vec![(3, 1.0)], 0.0)])?;
    Ok(SliderCrank {
        system: problem.system,
        constraint: (problem.rods, line),
        initial: problem.initial,
        revolution: revolution(&Piston, angle, rate),
    })
}
