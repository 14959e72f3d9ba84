//! Path data that several charts and their legends draw: hatching and arrows.

use std::fmt::Write;

use super::canvas::{number, polyline};

/// Strokes that tell an outcome apart without its colour: none, one diagonal, a dot, the other
/// diagonal, a cross.
pub(super) fn hatch(place: usize, (left, top): (f64, f64), (right, bottom): (f64, f64)) -> String {
    let (inset_x, inset_y) = (0.25 * (right - left), 0.25 * (bottom - top));
    let (left, right) = (left + inset_x, right - inset_x);
    let (top, bottom) = (top + inset_y, bottom - inset_y);
    let rising = polyline(&[(left, bottom), (right, top)]);
    let falling = polyline(&[(left, top), (right, bottom)]);
    match place {
        0 => String::new(),
        _ => match (place - 1) % 4 {
            0 => rising,
            1 => {
                let mut dot = String::new();
                let (x, y) = (0.5 * (left + right), 0.5 * (top + bottom));
                // Writing to a String cannot fail.
                let _ = write!(dot, "M{} {}h1", number(x - 0.5), number(y));
                dot
            }
            2 => falling,
            _ => rising + &falling,
        },
    }
}

/// Path data of an arrow whose head grows with it, up to a size.
pub(super) fn arrow(from: (f64, f64), to: (f64, f64)) -> String {
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    let length = dx.hypot(dy);
    if length.is_nan() || length == 0.0 {
        return String::new();
    }
    let head = (0.32 * length).clamp(3.0, 9.0);
    let (ux, uy) = (head * dx / length, head * dy / length);
    let barb = |side: f64| (to.0 - ux - side * 0.55 * uy, to.1 - uy + side * 0.55 * ux);
    polyline(&[from, to]) + &polyline(&[barb(1.0), to, barb(-1.0)])
}
