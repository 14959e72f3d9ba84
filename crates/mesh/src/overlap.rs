//! Does a surface pass through itself?
//!
//! ```text
//! pq passes through abc:  |abcp| and |abcq| differ in sign, |pqab|, |pqbc| and |pqca| do not
//! ```
//! Every edge against every triangle that shares no corner with it. The ends of an edge that is
//! reported lie on both sides of the triangle beyond doubt; where it meets the triangle's rim,
//! within rounding, it counts as passing. What touches with a corner, or lies flat upon itself,
//! is not reported. Triangles are swept along the longest side of the surface's box; the worst
//! case (all of them above each other) looks at all pairs.

use std::cmp::Ordering;

use nalgebra::Vector3;

use crate::mesh::Mesh;
use crate::side::side_of_plane;

/// Pairs beyond this are not listed.
const LISTED: usize = 1000;

/// The pairs of triangles that pass through each other, the first thousand in the sweep's order.
pub(crate) fn overlaps(mesh: &Mesh<3, 3>) -> Vec<(usize, usize)> {
    let boxes: Vec<_> = mesh.simplices().iter().map(|t| bounds(&mesh.corners(t))).collect();
    let axis = longest_axis(&boxes);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[a].0[axis].total_cmp(&boxes[b].0[axis]).then(a.cmp(&b)));
    let (mut found, mut open) = (Vec::new(), Vec::<usize>::new());
    for triangle in order {
        open.retain(|&other| boxes[other].1[axis] >= boxes[triangle].0[axis]);
        for &other in &open {
            if meet(&boxes[triangle], &boxes[other]) && pass(mesh, triangle, other) {
                found.push((triangle.min(other), triangle.max(other)));
                if found.len() == LISTED {
                    return found;
                }
            }
        }
        open.push(triangle);
    }
    found.sort_unstable();
    found
}

type Box3 = (Vector3<f64>, Vector3<f64>);

fn bounds([a, b, c]: &[Vector3<f64>; 3]) -> Box3 {
    (a.inf(b).inf(c), a.sup(b).sup(c))
}

fn longest_axis(boxes: &[Box3]) -> usize {
    let Some(&first) = boxes.first() else { return 0 };
    let (low, high) = boxes.iter().fold(first, |(l, h), b| (l.inf(&b.0), h.sup(&b.1)));
    (high - low).imax()
}

fn meet(a: &Box3, b: &Box3) -> bool {
    (0..3).all(|c| a.0[c] <= b.1[c] && b.0[c] <= a.1[c])
}

/// Whether an edge of one triangle passes through the other.
fn pass(mesh: &Mesh<3, 3>, one: usize, other: usize) -> bool {
    let (s, t) = (mesh.simplices()[one], mesh.simplices()[other]);
    edge_passes(mesh, &s, &t) || edge_passes(mesh, &t, &s)
}

fn edge_passes(mesh: &Mesh<3, 3>, edges: &[usize; 3], triangle: &[usize; 3]) -> bool {
    let [a, b, c] = mesh.corners(triangle);
    (0..3).any(|k| {
        let ends = [edges[k], edges[(k + 1) % 3]];
        if ends.iter().any(|end| triangle.contains(end)) {
            return false;
        }
        let [p, q] = ends.map(|end| mesh.vertices()[end]);
        let (above, below) = (side_of_plane(&a, &b, &c, &p), side_of_plane(&a, &b, &c, &q));
        if above == Ordering::Equal || below != above.reverse() {
            return false;
        }
        let turns = [(a, b), (b, c), (c, a)].map(|(from, to)| side_of_plane(&p, &q, &from, &to));
        !(turns.contains(&Ordering::Greater) && turns.contains(&Ordering::Less))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::icosphere;

    #[test]
    fn two_spheres_overlap_until_they_are_apart() {
        let sphere = icosphere(1.0, 2).unwrap();
        for (distance, apart) in [(0.5, false), (1.9, false), (2.001, true), (5.0, true)] {
            let moved = sphere.mapped(|x| x + Vector3::x() * distance).unwrap();
            assert_eq!(overlaps(&sphere.beside(&moved)).is_empty(), apart, "{distance}");
        }
    }

    #[test]
    fn a_sphere_within_a_sphere_does_not_overlap_it() {
        let sphere = icosphere(1.0, 2).unwrap();
        let inner = sphere.mapped(|x| x * 0.5).unwrap();
        assert_eq!(overlaps(&sphere.beside(&inner)), []);
    }

    #[test]
    fn a_fold_through_itself_is_found_where_it_is() {
        let mut vertices = icosphere(1.0, 1).unwrap().vertices().to_vec();
        let triangles = icosphere(1.0, 1).unwrap().simplices().to_vec();
        vertices[0] *= -1.5;
        let folded = Mesh::new(vertices, triangles.clone()).unwrap();
        let found = overlaps(&folded);
        assert!(!found.is_empty());
        assert!(found.iter().all(|&(a, b)| triangles[a].contains(&0) || triangles[b].contains(&0)));
    }

    #[test]
    fn a_flat_cube_face_cut_in_two_raises_no_alarm_far_from_the_origin() {
        for shift in [0.0, 0.1, 1e6 + 0.3] {
            let cube = crate::cuboid([1.0, 1.0, 1.0], [3, 3, 3]).unwrap().boundary().mesh;
            let moved = cube.mapped(|x| x + Vector3::repeat(shift)).unwrap();
            assert_eq!(overlaps(&moved), []);
        }
    }
}
