//! A four-bar linkage in the plane: crank, coupler and rocker between two hooks, under gravity.
//!
//! ```text
//! (0, 0) --1-- crank pin --2-- rocker pin --2-- (2, 0)        a Grashof crank-rocker
//! ```
//! A closed loop of three rods; its one freedom is the crank's angle. Unit masses at the pins.

use super::{RodProblem, hanging};
use crate::{ConstraintError, Rod, Rods};

/// A four-bar linkage.
pub type FourBar = RodProblem<[f64; 4]>;

/// The angle of the rocker pin seen from the crank pin and where the pins are, for a crank angle.
fn pins(angle: f64) -> [f64; 4] {
    let (s, c) = angle.sin_cos();
    // The rocker pin is as far from the crank pin as from (2, 0): two rods of length 2 upward.
    let (dx, dy) = (2.0 - c, -s);
    let half = 0.5 * dx.hypot(dy);
    let rise = ((2.0 - half) * (2.0 + half)).sqrt() / (2.0 * half);
    [c, s, c + 0.5 * dx - rise * dy, s + 0.5 * dy + rise * dx]
}

/// The linkage with its crank at an angle, radians, turning at a rate, radians a second.
pub fn four_bar(angle: f64, rate: f64) -> Result<FourBar, ConstraintError> {
    let rods = vec![Rod::new([2, 0], 1.0), Rod::new([0, 1], 2.0), Rod::new([1, 3], 2.0)];
    let rods = Rods::new(2, vec![[0.0, 0.0], [2.0, 0.0]], rods)?;
    let [x, y, z, w] = pins(angle);
    // The rocker pin's velocity u solves <d, u - v> = 0 and <e, u> = 0 for the rods d and e.
    let v = [-rate * y, rate * x];
    let (d, e) = ([z - x, w - y], [z - 2.0, w]);
    let along = d[0] * v[0] + d[1] * v[1];
    let turn = along / (d[1] * e[0] - d[0] * e[1]);
    hanging([x, y, z, w], [v[0], v[1], -turn * e[1], turn * e[0]], 1.0, rods)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Constraint;

    #[test]
    fn the_loop_is_closed_for_every_angle_of_the_crank() {
        for i in 0..100 {
            let linkage = four_bar(0.0628 * f64::from(i), 1.3).unwrap();
            let mut g = [0.0; 3];
            linkage.rods.value(0.0, &linkage.initial.q, &mut g);
            assert!(g.iter().all(|g| g.abs() < 1e-14), "{g:?}");
        }
    }
}
