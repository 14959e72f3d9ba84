//! A rigid square of rods that flies freely and spins: four unit masses, four sides, its diagonals.
//!
//! One diagonal makes it rigid; the second adds nothing but a redundant equation.

use super::{RodProblem, hanging};
use crate::{ConstraintError, Rod, Rods};

/// A square with its five or six rods.
pub type Square = RodProblem<[f64; 8]>;

/// A square of unit side about the origin, with one or two diagonals, spinning at the rate `spin`,
/// radians a second, and drifting with the velocity `drift`.
///
/// # Errors
/// None: of the diagonals asked for at most two are there, and other numbers are not looked at.
pub fn square(diagonals: usize, spin: f64, drift: [f64; 2]) -> Result<Square, ConstraintError> {
    let q: [f64; 8] = [-0.5, -0.5, 0.5, -0.5, 0.5, 0.5, -0.5, 0.5];
    let p = std::array::from_fn(|i| {
        let (x, y) = (q[i - i % 2], q[i - i % 2 + 1]);
        drift[i % 2] + spin * [-y, x][i % 2]
    });
    let sides = (0..4).map(|i| Rod::new([i, (i + 1) % 4], 1.0));
    let across = (0..2).map(|i| Rod::new([i, i + 2], 2.0_f64.sqrt()));
    let rods = sides.chain(across.take(diagonals)).collect();
    hanging(q, p, 0.0, Rods::new(4, Vec::new(), rods)?)
}
