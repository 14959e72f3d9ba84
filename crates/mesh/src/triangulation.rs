//! A polygon in space as triangles with its corners, each turned as it is.
//!
//! ```text
//! n = sum_i (x_i - x_0) x (x_(i+1) - x_0)          twice its area, normal to it (Newell)
//! ```
//! Where all corners are seen from the first in rising order the polygon is a fan about it; else ears
//! are cut: corners whose triangle with both neighbours holds no other corner. An outline that crosses
//! itself may have ears too, as a band that passes over itself has: they lie upon each other. The signs are
//! exact ones in the plane of the two axes that `n` is farthest from: a plane polygon keeps its sides there.
//! Source: Meisters, "Polygons have ears" (1975).

use std::cmp::Ordering;

use nalgebra::{Vector2, Vector3};

use crate::side::side_of_line;

/// Ears of polygons with more corners are not looked for: the search takes the square of their number.
pub(crate) const MOST_CORNERS: usize = 2048;

/// Why a polygon has no triangles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum NoTriangles {
    /// It is not simple, or has no area.
    NotSimple,
    /// Its ears would take too long.
    TooManyCorners,
}

/// The n - 2 triangles of a polygon, by the numbers of its corners.
pub(crate) fn triangulated(corners: &[Vector3<f64>]) -> Result<Vec<[usize; 3]>, NoTriangles> {
    let n = corners.len();
    if n == 3 {
        return Ok(vec![[0, 1, 2]]);
    }
    let flat = flattened(corners).ok_or(NoTriangles::NotSimple)?;
    let is_left = |a: usize, b: usize, c: usize| {
        side_of_line(&flat[a], &flat[b], &flat[c]) == Ordering::Greater
    };
    let is_fan = (2..n).all(|k| is_left(0, 1, k)) && (1..n - 1).all(|k| is_left(0, k, k + 1));
    if is_fan {
        return Ok((1..n - 1).map(|k| [0, k, k + 1]).collect());
    }
    if n > MOST_CORNERS {
        return Err(NoTriangles::TooManyCorners);
    }
    let triangles = cut(&flat).filter(|triangles| !overlap(&flat, triangles));
    triangles.ok_or(NoTriangles::NotSimple)
}

/// The corners in the plane, counterclockwise; `None` where they enclose nothing.
fn flattened(corners: &[Vector3<f64>]) -> Option<Vec<Vector2<f64>>> {
    let from_first = |k: usize| corners[k] - corners[0];
    let normal: Vector3<f64> =
        (1..corners.len() - 1).map(|k| from_first(k).cross(&from_first(k + 1))).sum();
    let axis = normal.iamax();
    let height = normal[axis];
    if height == 0.0 || !height.is_finite() {
        return None;
    }
    let (x, y) = match height > 0.0 {
        true => ((axis + 1) % 3, (axis + 2) % 3),
        false => ((axis + 2) % 3, (axis + 1) % 3),
    };
    Some(corners.iter().map(|corner| Vector2::new(corner[x], corner[y])).collect())
}

/// Cuts ears until three corners are left.
fn cut(flat: &[Vector2<f64>]) -> Option<Vec<[usize; 3]>> {
    let mut left: Vec<usize> = (0..flat.len()).collect();
    let mut triangles = Vec::with_capacity(flat.len() - 2);
    let mut start = 0;
    while left.len() > 3 {
        let count = left.len();
        let blunt: Vec<usize> = (0..count).filter(|&k| !is_convex(flat, &left, k)).collect();
        let ear =
            (0..count).map(|k| (start + k) % count).find(|&k| is_ear(flat, &left, &blunt, k))?;
        triangles.push(around(&left, ear));
        left.remove(ear);
        start = ear % left.len();
    }
    let last = [left[0], left[1], left[2]];
    triangles.push(last);
    (side_of_line(&flat[last[0]], &flat[last[1]], &flat[last[2]]) == Ordering::Greater)
        .then_some(triangles)
}

/// A corner between its neighbours.
fn around(left: &[usize], k: usize) -> [usize; 3] {
    let count = left.len();
    [left[(k + count - 1) % count], left[k], left[(k + 1) % count]]
}

fn is_convex(flat: &[Vector2<f64>], left: &[usize], k: usize) -> bool {
    let [a, b, c] = around(left, k).map(|corner| &flat[corner]);
    side_of_line(a, b, c) == Ordering::Greater
}

/// Whether a corner sticks out and its triangle holds none of the corners that do not; one in the
/// place of the triangle's own is no hindrance.
fn is_ear(flat: &[Vector2<f64>], left: &[usize], blunt: &[usize], k: usize) -> bool {
    let [a, b, c] = around(left, k).map(|corner| &flat[corner]);
    if side_of_line(a, b, c) != Ordering::Greater {
        return false;
    }
    let holds = |p: &Vector2<f64>| {
        let is_own = p == a || p == b || p == c;
        let sides = [(a, b), (b, c), (c, a)];
        !is_own && sides.iter().all(|(from, to)| side_of_line(from, to, p) != Ordering::Less)
    };
    !blunt.iter().any(|&other| holds(&flat[left[other]]))
}

/// Whether two of the triangles, all counterclockwise, share more than their rims.
fn overlap(flat: &[Vector2<f64>], triangles: &[[usize; 3]]) -> bool {
    let bounds = triangles.iter().map(|triangle| {
        let [a, b, c] = triangle.map(|corner| flat[corner]);
        (a.inf(&b).inf(&c), a.sup(&b).sup(&c))
    });
    let bounds: Vec<_> = bounds.collect();
    let meet = |one: usize, other: usize| {
        let ((low, high), (from, to)) = (&bounds[one], &bounds[other]);
        (0..2).all(|c| low[c] < to[c] && from[c] < high[c])
    };
    // Two convex shapes are apart where a side of one has the other on its right.
    let is_beside = |one: usize, other: usize| {
        let ([a, b, c], others) = (triangles[one], triangles[other]);
        [(a, b), (b, c), (c, a)].iter().any(|&(from, to)| {
            let side = |p: usize| side_of_line(&flat[from], &flat[to], &flat[p]);
            others.iter().all(|&p| side(p) != Ordering::Greater)
        })
    };
    (1..triangles.len()).any(|one| {
        (0..one).any(|other| meet(one, other) && !is_beside(one, other) && !is_beside(other, one))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vector3<f64>]) -> f64 {
        triangulated(corners)
            .unwrap()
            .iter()
            .map(|&[a, b, c]| {
                let piece = (corners[b] - corners[a]).cross(&(corners[c] - corners[a]));
                assert!(piece.z > 0.0, "no triangle is turned over or flat");
                0.5 * piece.z
            })
            .sum()
    }

    fn flat(corners: &[[f64; 2]]) -> Vec<Vector3<f64>> {
        corners.iter().map(|&[x, y]| Vector3::new(x, y, 0.0)).collect()
    }

    #[test]
    fn a_concave_polygon_has_triangles_of_its_own_area_whichever_corner_is_first() {
        let l = [[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 4.0], [0.0, 4.0]];
        let arrow = [[0.0, 0.0], [2.0, 1.0], [4.0, 0.0], [2.0, 4.0]];
        for (corners, exact) in [(&l[..], 6.0), (&arrow[..], 6.0)] {
            let mut corners = flat(corners);
            for _ in 0..corners.len() {
                corners.rotate_left(1);
                assert!((area(&corners) - exact).abs() < 1e-14);
            }
        }
    }

    #[test]
    fn corners_on_an_edge_are_corners_of_triangles_that_have_a_size() {
        let square = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 2.0], [0.0, 2.0]];
        let mut corners = flat(&square);
        for _ in 0..corners.len() {
            corners.rotate_left(1);
            assert!((area(&corners) - 4.0).abs() < 1e-14);
        }
    }

    #[test]
    fn a_band_that_passes_over_itself_has_ears_and_is_refused() {
        let band = [[2.0, 5.0], [7.0, 3.0], [2.0, 2.0], [2.0, 7.0], [3.0, 3.0]];
        let mut corners = flat(&band);
        for _ in 0..corners.len() {
            corners.rotate_left(1);
            assert_eq!(triangulated(&corners), Err(NoTriangles::NotSimple));
        }
        // A ring cut open along a bridge touches itself and crosses nowhere.
        let ring = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let hole = [[1.0, 1.0], [1.0, 2.0], [2.0, 2.0], [2.0, 1.0], [1.0, 1.0]];
        assert!((area(&flat(&[ring, hole].concat())) - 15.0).abs() < 1e-14);
    }

    #[test]
    fn what_crosses_itself_or_has_no_area_has_no_triangles() {
        let bow = flat(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0]]);
        assert_eq!(triangulated(&bow), Err(NoTriangles::NotSimple));
        let line = flat(&[[0.0, 0.0], [1.0, 1.0], [2.0, 2.0], [3.0, 3.0]]);
        assert_eq!(triangulated(&line), Err(NoTriangles::NotSimple));
    }
}
