//! A four-bar linkage in the plane: crank, coupler and rocker between two hooks, under gravity.
//!
//! ```text
//! (0, 0) --1-- crank pin --2-- rocker pin --2-- (2, 0)        a Grashof crank-rocker
//! ```
//! A closed loop of three rods; its one freedom is the crank's angle. Unit masses at the pins.

use stationary_calculus::{Number, Vector, directional_derivative};

use super::{RodProblem, check_finite, hanging, revolution};
use crate::{ConstraintError, Embedding, Rod, Rods};

/// A four-bar linkage.
#[derive(Clone, Debug)]
pub struct FourBar {
    /// Its system, rods and initial data.
    pub problem: RodProblem<[f64; 4]>,
    /// The time in which the crank goes round, where it does and its energy leaves no doubt.
    pub revolution: Option<f64>,
}

/// The linkage's pins as functions of its crank's angle from the first axis, radians.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crank;

impl Embedding<1, 4> for Crank {
    fn places<R: Number>(&self, [angle]: [R; 1]) -> [R; 4] {
        let (s, c) = angle.sin_cos();
        // The rocker pin is as far from the crank pin as from (2, 0): two rods of length 2, upward.
        let (dx, dy) = (-c + 2.0, -s);
        let square = dx * dx + dy * dy;
        let rise = ((-square * 0.25 + 4.0) / square).sqrt();
        [c, s, c + dx * 0.5 - rise * dy, s + dy * 0.5 + rise * dx]
    }
}

/// The linkage with its crank at an angle, radians, turning at a rate, radians a second.
///
/// # Errors
/// [`ConstraintError::Parameter`] for an angle or a rate that is not finite;
/// [`ConstraintError::NonFinite`] where a point's speed overflows.
pub fn four_bar(angle: f64, rate: f64) -> Result<FourBar, ConstraintError> {
    check_finite("angle", angle)?;
    check_finite("rate", rate)?;
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0), Rod::new([1, 3], 2.0)];
    let rods = Rods::new(2, vec![[0.0, 0.0], [2.0, 0.0]], rods)?;
    let places = Crank.places([angle]);
    let along = directional_derivative(|a| Crank.places(a), [angle], Vector([rate]));
    let problem = hanging(places, along, 1.0, rods)?;
    Ok(FourBar { problem, revolution: revolution(&Crank, angle, rate) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Constraint;

    #[test]
    fn the_loop_is_closed_for_every_angle_of_the_crank() {
        for i in 0..100 {
            let linkage = four_bar(0.0628 * f64::from(i), 1.3).unwrap().problem;
            let mut g = [0.0; 3];
            linkage.rods.value(0.0, &linkage.initial.q, &mut g).unwrap();
            assert!(g.iter().all(|g| g.abs() < 1e-14), "{g:?}");
        }
    }

    #[test]
    fn a_crank_without_the_energy_to_go_round_has_no_revolution() {
        assert!(four_bar(0.0, 0.1).unwrap().revolution.is_none());
        // Fast, it hardly feels its weight.
        let fast = four_bar(0.0, 1000.0).unwrap().revolution.unwrap();
        assert!(
            (2000.0 * fast - 1000.0 * four_bar(0.0, 500.0).unwrap().revolution.unwrap()).abs()
                < 1e-4
        );
    }
}
