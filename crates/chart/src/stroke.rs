//! Path data that several charts and their legends draw: hatching and arrows.

use crate::canvas::number;
use crate::path::polyline;
use crate::place::Rect;

/// Distance between the strokes of a hatching.
const LATTICE: f64 = 11.0;
/// Half the length of a stroke, to the right and upward.
const STROKE: (f64, f64) = (3.0, 3.0);

/// Strokes that tell an outcome apart without its colour: none, one diagonal, a dot, the other
/// diagonal, a cross. They stand on one lattice of the page, so that an outcome looks the same whatever
/// the size of its cells.
pub(crate) fn hatching(place: usize, areas: &[Rect]) -> String {
    let mut d = String::new();
    if place == 0 {
        return d;
    }
    for &Rect { left, top, right, bottom } in areas {
        let rows = whole(top)..whole(bottom);
        for (row, column) in rows.flat_map(|row| (whole(left)..whole(right)).map(move |c| (row, c)))
        {
            d += &stroke(place, (f64::from(column) * LATTICE, f64::from(row) * LATTICE));
        }
    }
    d
}

/// The first place of the lattice from here on.
fn whole(pixel: f64) -> i32 {
    (pixel / LATTICE).ceil() as i32
}

fn stroke(place: usize, (x, y): (f64, f64)) -> String {
    let (w, h) = STROKE;
    let rising = polyline(&[(x - w, y + h), (x + w, y - h)]);
    let falling = polyline(&[(x - w, y - h), (x + w, y + h)]);
    match (place - 1) % 4 {
        0 => rising,
        1 => format!("M{} {}h1", number(x - 0.5), number(y)),
        2 => falling,
        _ => rising + &falling,
    }
}

/// Path data of an arrow whose head grows with it, up to a size.
pub(crate) fn arrow(from: (f64, f64), to: (f64, f64)) -> String {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hatching_is_as_dense_in_many_cells_as_in_one() {
        let column = |left: f64, right: f64| Rect { left, top: 0.0, right, bottom: 110.0 };
        let whole = [column(0.0, 220.0)];
        let cells: Vec<Rect> =
            (0..220).map(f64::from).map(|left| column(left, left + 1.0)).collect();
        for place in 1..5 {
            let strokes = |areas: &[_]| hatching(place, areas).matches('M').count();
            assert_eq!(strokes(&whole), strokes(&cells));
            assert!(strokes(&whole) >= 200);
        }
        assert!(hatching(0, &whole).is_empty());
    }
}
