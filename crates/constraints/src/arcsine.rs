//! The pendulum in its angle: the notes' explicit step with an arcsine.
//!
//! ```text
//! theta' = theta + arcsin(h s / L)
//! s'     = s - h g sin theta'                                                              (6.1)
//! p = m L s
//! ```
//! `theta` the angle from hanging, radians, counterclockwise; `s` the speed of the chord from one
//! place to the next, m/s; `p` the momentum that belongs to theta, kg m^2/s; `L` the rod, `g`
//! gravity. It is the variational integrator of the discrete Lagrangian with the chord's kinetic
//! energy, so that the constraint holds exactly and nothing is solved. Order 1, symplectic. Exists
//! while the bob moves by at most a rod's length a step. Source: notes 6.1; errata 0.1 and 6.1
//! (angle from hanging, hence the minus; `omega` there is a speed), 6 (the condition on h).

use stationary_integrators::State;

use crate::ConstraintError;
use crate::checks::{check_step, check_time};

/// A pendulum stepped in its angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArcsinePendulum {
    mass: f64,
    length: f64,
    gravity: f64,
}

impl ArcsinePendulum {
    /// A mass (kg) on a rod (m) under gravity (m/s^2, any sign).
    ///
    /// # Errors
    /// A mass or a length that is not positive and finite, or whose product, which makes a speed of a
    /// momentum, leaves the range of normal numbers; a gravity that is not finite.
    pub fn new(mass: f64, length: f64, gravity: f64) -> Result<Self, ConstraintError> {
        for (what, value) in [("mass", mass), ("length", length)] {
            if !(value > 0.0 && value.is_finite()) {
                let range = "positive and finite";
                return Err(ConstraintError::Parameter { what, value, range });
            }
        }
        if !(mass * length).is_normal() {
            let (what, range) = ("mass times length", "between 2.3e-308 and 1.7e308");
            return Err(ConstraintError::Parameter { what, value: mass * length, range });
        }
        if !gravity.is_finite() {
            let (what, range) = ("gravity", "finite");
            return Err(ConstraintError::Parameter { what, value: gravity, range });
        }
        Ok(ArcsinePendulum { mass, length, gravity })
    }

    /// Moves angle and momentum forward by `h` seconds. On an error the state is as it was.
    ///
    /// # Errors
    /// [`ConstraintError::TooFast`] where the bob would move more than a rod's length;
    /// [`ConstraintError::NonFinite`] where angle, speed or momentum would not be finite, as those that
    /// are given.
    pub fn step(&self, state: &mut State<[f64; 1]>, h: f64) -> Result<(), ConstraintError> {
        check_step(h)?;
        check_time(state.t + h)?;
        let speed = state.p.0[0] / (self.mass * self.length);
        let ratio = h * speed / self.length;
        if ratio.abs() > 1.0 {
            return Err(ConstraintError::TooFast { ratio: ratio.abs() });
        }
        let angle = state.q[0] + ratio.asin();
        let speed = speed - h * self.gravity * angle.sin();
        let momentum = self.mass * self.length * speed;
        if !(angle.is_finite() && momentum.is_finite()) {
            return Err(ConstraintError::NonFinite { what: "angle or momentum", index: 0 });
        }
        state.t += h;
        state.q[0] = angle;
        state.p.0[0] = momentum;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stationary_calculus::Covector;

    #[test]
    fn a_momentum_that_no_number_holds_is_refused_and_leaves_the_state() {
        for (mass, length) in [(1e260, 1e204), (1e-200, 1e-200)] {
            assert!(ArcsinePendulum::new(mass, length, 1.0).is_err());
        }
        let pendulum = ArcsinePendulum::new(1e-7, 1e200, -1e200).unwrap();
        let mut state = State::new([0.3], Covector([f64::MAX]));
        let before = state.clone();
        assert!(pendulum.step(&mut state, 1e3).is_err());
        assert_eq!(state, before);
    }
}
