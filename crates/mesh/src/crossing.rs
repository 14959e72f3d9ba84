//! Which edges of outlines cross or touch, decided by exact signs.
//!
//! ```text
//! ab meets cd where c, d are not on one side of ab, a, b not on one side of cd, and boxes meet
//! ```
//! Two edges in a row share a corner, and meet only if the second turns back on the first. Whether
//! any pair meets is found in n log n comparisons; only where one does, all are listed, by looking at
//! the pairs that lie above each other, and the list ends
//! where those become too many.

use std::cell::Cell;
use std::cmp::Ordering;

use nalgebra::Vector2;

use crate::side::side_of_line;
use crate::sweep::first_crossing;

/// An outline and the corner at which an edge begins.
pub(crate) type Edge = (usize, usize);

/// Pairs beyond this are not listed.
const LISTED: usize = 1000;

/// Pairs beyond this are not looked at.
const LOOKED_AT: usize = 1 << 24;

/// The pairs of edges that cross or touch, the first thousand from left to right.
pub(crate) fn crossings(outlines: &[Vec<Vector2<f64>>]) -> Vec<(Edge, Edge)> {
    match first_crossing(outlines, &Cell::new(0)) {
        None => Vec::new(),
        Some(pair) => {
            let found = listed(outlines);
            if found.is_empty() { vec![pair] } else { found }
        }
    }
}

/// The ends of an edge.
pub(crate) fn ends(outlines: &[Vec<Vector2<f64>>], (outline, corner): Edge) -> [Vector2<f64>; 2] {
    let corners = &outlines[outline];
    [corners[corner], corners[(corner + 1) % corners.len()]]
}

fn listed(outlines: &[Vec<Vector2<f64>>]) -> Vec<(Edge, Edge)> {
    let numbered = outlines.iter().enumerate();
    let mut edges: Vec<Edge> =
        numbered.flat_map(|(k, corners)| (0..corners.len()).map(move |c| (k, c))).collect();
    let left =
        |edge: Edge| ends(outlines, edge).map(|end| end.x).into_iter().fold(f64::MAX, f64::min);
    let right =
        |edge: Edge| ends(outlines, edge).map(|end| end.x).into_iter().fold(f64::MIN, f64::max);
    edges.sort_by(|&a, &b| left(a).total_cmp(&left(b)).then(a.cmp(&b)));
    let (mut found, mut open) = (Vec::new(), Vec::<Edge>::new());
    let mut looked_at = 0;
    for edge in edges {
        open.retain(|&other| right(other) >= left(edge));
        looked_at += open.len();
        if looked_at > LOOKED_AT {
            break;
        }
        for &other in &open {
            let (first, second) = (edge.min(other), edge.max(other));
            if meet(outlines, first, second) {
                found.push((first, second));
                if found.len() == LISTED {
                    return found;
                }
            }
        }
        open.push(edge);
    }
    found
}

/// Whether two edges meet elsewhere than at the corner that joins them.
pub(crate) fn meet(outlines: &[Vec<Vector2<f64>>], first: Edge, second: Edge) -> bool {
    let ([a, b], [c, d]) = (ends(outlines, first), ends(outlines, second));
    let count = outlines[first.0].len();
    if first.0 != second.0 {
        segments_meet(&a, &b, &c, &d)
    } else if second.1 == first.1 + 1 {
        turns_back(&a, &b, &d)
    } else if first.1 == 0 && second.1 + 1 == count {
        turns_back(&c, &d, &b)
    } else {
        segments_meet(&a, &b, &c, &d)
    }
}

/// Whether the way from `a` to `b` and on to `c` returns along itself.
fn turns_back(a: &Vector2<f64>, b: &Vector2<f64>, c: &Vector2<f64>) -> bool {
    side_of_line(a, b, c) == Ordering::Equal && (b - a).dot(&(c - b)) < 0.0
}

fn segments_meet(a: &Vector2<f64>, b: &Vector2<f64>, c: &Vector2<f64>, d: &Vector2<f64>) -> bool {
    let apart = |k: usize| a[k].max(b[k]) < c[k].min(d[k]) || c[k].max(d[k]) < a[k].min(b[k]);
    if apart(0) || apart(1) {
        return false;
    }
    let one_side = |side: Ordering, other: Ordering| side == other && side != Ordering::Equal;
    !one_side(side_of_line(a, b, c), side_of_line(a, b, d))
        && !one_side(side_of_line(c, d, a), side_of_line(c, d, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn outline(corners: &[[f64; 2]]) -> Vec<Vector2<f64>> {
        corners.iter().map(|&corner| corner.into()).collect()
    }

    #[test]
    fn a_bow_tie_crosses_itself() {
        let bow = outline(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
        assert_eq!(crossings(&[bow]), [((0, 0), (0, 2))]);
    }

    #[test]
    fn a_bow_tie_with_a_corner_at_its_knot_touches_itself() {
        let bow = [[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [2.0, 0.0], [1.0, 1.0], [0.0, 2.0]];
        assert_eq!(crossings(&[outline(&bow)]).len(), 4);
    }

    #[test]
    fn a_spike_returns_along_itself() {
        let spike = [[0.0, 0.0], [3.0, 0.0], [2.0, 0.0], [2.0, 1.0]];
        assert_eq!(crossings(&[outline(&spike)])[0], ((0, 0), (0, 1)));
        let closing = [[2.0, 0.0], [2.0, 1.0], [0.0, 0.0], [3.0, 0.0]];
        assert!(crossings(&[outline(&closing)]).contains(&((0, 2), (0, 3))));
    }

    #[test]
    fn corners_in_a_row_on_a_line_are_fine() {
        let square = [[0.0, 0.0], [0.1, 0.0], [0.3, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        assert!(crossings(&[outline(&square)]).is_empty());
    }

    #[test]
    fn outlines_that_touch_at_a_point_are_found_and_those_a_bit_apart_are_not() {
        let square = outline(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        let beside =
            |x: f64| vec![Vector2::new(x, 0.5), Vector2::new(2.0, 0.0), Vector2::new(2.0, 1.0)];
        assert_eq!(crossings(&[square.clone(), beside(1.0)]).len(), 2);
        assert!(crossings(&[square, beside(1.0_f64.next_up())]).is_empty());
    }

    #[test]
    fn at_most_a_thousand_pairs_are_listed() {
        let zigzag = |swap: bool| {
            let tooth = |k: usize| match (k.is_multiple_of(2), swap) {
                (even, false) => Vector2::new(k as f64, if even { 0.0 } else { 1.0 }),
                (even, true) => Vector2::new(if even { 0.0 } else { 99.0 }, k as f64 / 99.0),
            };
            (0..100).map(tooth).collect::<Vec<_>>()
        };
        assert_eq!(crossings(&[zigzag(false), zigzag(true)]).len(), LISTED);
    }
}
