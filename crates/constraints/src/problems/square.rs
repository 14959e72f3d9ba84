//! A rigid square of rods that flies freely and spins: four unit masses, four sides, its diagonals.
//!
//! One diagonal makes it rigid; the second adds nothing but a redundant equation.

use super::{RodProblem, check_finite, hanging};
use crate::{ConstraintError, Rod, Rods};
use stationary_calculus::array;

/// A square with its five or six rods.
pub type Square = RodProblem<[f64; 8]>;

/// A square of unit side about the origin, with one or two diagonals, spinning at the rate `spin`,
/// radians a second, and drifting with the velocity `drift`.
///
/// # Errors
/// [`ConstraintError::Parameter`] for another number of diagonals, and for a spin or a drift that is
/// not finite; [`ConstraintError::NonFinite`] where a mass's speed overflows.
pub fn square(diagonals: usize, spin: f64, drift: [f64; 2]) -> Result<Square, ConstraintError> {
    if !(1..=2).contains(&diagonals) {
        let (what, value) = ("the number of diagonals", diagonals as f64);
        return Err(ConstraintError::Parameter { what, value, range: "1 or 2" });
    }
    check_finite("spin", spin)?;
    drift.into_iter().try_for_each(|component| check_finite("drift", component))?;
    let q: [f64; 8] = [-0.5, -0.5, 0.5, -0.5, 0.5, 0.5, -0.5, 0.5];
    let p = array(|i| {
        let (x, y) = (q[i - i % 2], q[i - i % 2 + 1]);
        drift[i % 2] + spin * [-y, x][i % 2]
    });
    let sides = (0..4).map(|i| Rod::new([i, (i + 1) % 4], 1.0));
    let across = (0..2).map(|i| Rod::new([i, i + 2], 2.0_f64.sqrt()));
    let rods = sides.chain(across.take(diagonals)).collect();
    hanging(q, p, 0.0, Rods::new(4, Vec::new(), rods)?)
}
