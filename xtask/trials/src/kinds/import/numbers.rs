//! One number, one turn, in several spellings.

use nalgebra::UnitQuaternion;

use crate::Draw;

/// Numbers with all their digits.
pub(super) fn numbers(draw: &mut Draw, numbers: &[f64]) -> String {
    let gap = draw.one_of(&[" ", "  ", "\n  ", "\t"]);
    let written: Vec<_> = numbers.iter().map(|&x| number(draw, x)).collect();
    written.join(gap)
}

pub(super) fn number(draw: &mut Draw, x: f64) -> String {
    match draw.below(3) {
        0 => format!("{x:?}"),
        1 => format!("{x:e}"),
        _ => format!("{x:E}"),
    }
}

/// Angles about x, y and z, each of the frame that does not turn; none near where they are not determined.
pub(super) fn about_fixed_axes(turn: &UnitQuaternion<f64>) -> Option<[f64; 3]> {
    let (x, y, z) = turn.euler_angles();
    (y.abs() < 1.3).then_some([x, y, z])
}

/// The same, each of the frame as it was turned by those before.
pub(super) fn about_own_axes(turn: &UnitQuaternion<f64>) -> Option<[f64; 3]> {
    about_fixed_axes(&turn.inverse()).map(|angles| angles.map(|angle| -angle))
}
