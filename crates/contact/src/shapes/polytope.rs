//! A convex solid with flat faces: its corners, the polygons of its faces and their edges.
//!
//! ```text
//! |n.(x - a)| <= 1e-12 size        triangles of a hull that share an edge and a plane are one face
//! ```
//! A face has any number of corners, counterclockwise as seen from outside. `n` the unit normal of
//! a face, `a` one of its corners, `size` the distance from the corners' middle to the farthest.

use std::collections::BTreeMap;

use nalgebra::Vector3;

/// One polygon: its normal and where its corners stand among those of all faces.
#[derive(Clone, Debug)]
pub(crate) struct Face {
    pub(crate) normal: Vector3<f64>,
    /// The corner that reaches farthest along the normal: one of its own, but for rounding.
    pub(crate) highest: usize,
    pub(crate) first: usize,
    pub(crate) count: usize,
}

/// Where two faces meet.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge {
    pub(crate) corners: [usize; 2],
    pub(crate) faces: [usize; 2],
}

/// A convex solid with flat faces.
#[derive(Clone, Debug)]
pub(crate) struct Polytope {
    pub(crate) corners: Vec<Vector3<f64>>,
    pub(crate) faces: Vec<Face>,
    /// The corners of all faces, face by face.
    pub(crate) loops: Vec<usize>,
    pub(crate) edges: Vec<Edge>,
    pub(crate) size: f64,
}

/// A distance from a plane relative to the size below which a corner is in it: rounding.
const COPLANAR: f64 = 1e-12;

impl Polytope {
    pub(crate) fn cuboid(half: [f64; 3]) -> Option<Self> {
        let corners = (0..8_u32)
            .map(|k| Vector3::from_fn(|i, _| if k >> i & 1 == 0 { -half[i] } else { half[i] }));
        let triangles = [
            [0, 2, 3],
            [0, 3, 1],
            [4, 5, 7],
            [4, 7, 6],
            [0, 1, 5],
            [0, 5, 4],
            [2, 6, 7],
            [2, 7, 3],
            [0, 4, 6],
            [0, 6, 2],
            [1, 3, 7],
            [1, 7, 5],
        ];
        Self::new(corners.collect(), &triangles)
    }

    /// The faces of a closed convex surface of triangles, counterclockwise as seen from outside;
    /// none where the triangles do not close.
    pub(crate) fn new(corners: Vec<Vector3<f64>>, triangles: &[[usize; 3]]) -> Option<Self> {
        let middle = corners.iter().sum::<Vector3<f64>>() / corners.len() as f64;
        let size = corners.iter().map(|c| (c - middle).norm()).fold(0.0, f64::max);
        let mut across = BTreeMap::new();
        for (t, &[a, b, c]) in triangles.iter().enumerate() {
            for side in [[a, b], [b, c], [c, a]] {
                across.insert(side, t);
            }
        }
        let area = |t: usize| {
            let [a, b, c] = triangles[t].map(|k| corners[k] / size);
            (b - a).cross(&(c - a))
        };
        // The largest triangles know their planes best.
        let mut order: Vec<usize> = (0..triangles.len()).collect();
        order.sort_by(|&s, &t| area(t).norm().total_cmp(&area(s).norm()).then(s.cmp(&t)));
        let mut owner = vec![usize::MAX; triangles.len()];
        let (mut faces, mut loops) = (Vec::new(), Vec::new());
        for &seed in &order {
            if owner[seed] != usize::MAX {
                continue;
            }
            let face = faces.len();
            let normal = area(seed).try_normalize(0.0)?;
            let in_plane = |t: usize| {
                let off = |&k: &usize| normal.dot(&(corners[k] - corners[triangles[seed][0]]));
                triangles[t].iter().all(|k| off(k).abs() <= COPLANAR * size)
            };
            owner[seed] = face;
            let mut open = vec![seed];
            let mut sides = BTreeMap::new();
            while let Some(t) = open.pop() {
                let [a, b, c] = triangles[t];
                for [from, to] in [[a, b], [b, c], [c, a]] {
                    let &other = across.get(&[to, from])?;
                    if owner[other] == usize::MAX && in_plane(other) {
                        owner[other] = face;
                        open.push(other);
                    }
                    if owner[other] != face && sides.insert(from, to).is_some() {
                        return None;
                    }
                }
            }
            // Sides that a triangle taken later lies across are inside of the face.
            sides.retain(|&from, to| owner[across[&[*to, from]]] != face);
            let (first, &start) = (loops.len(), sides.keys().next()?);
            let mut at = start;
            for _ in 0..sides.len() {
                loops.push(at);
                at = *sides.get(&at)?;
            }
            if at != start {
                return None;
            }
            let along = |k: &usize| normal.dot(&corners[*k]);
            let highest = (0..corners.len()).max_by(|j, k| along(j).total_cmp(&along(k)))?;
            faces.push(Face { normal, highest, first, count: loops.len() - first });
        }
        let side_of: BTreeMap<[usize; 2], usize> = (0..faces.len())
            .flat_map(|f| {
                let face: &Face = &faces[f];
                let of = &loops[face.first..][..face.count];
                (0..face.count).map(move |k| ([of[k], of[(k + 1) % of.len()]], f))
            })
            .collect();
        let mut edges = Vec::new();
        for (&[from, to], &face) in &side_of {
            if from < to {
                edges.push(Edge { corners: [from, to], faces: [face, *side_of.get(&[to, from])?] });
            }
        }
        Some(Polytope { corners, faces, loops, edges, size })
    }

    /// An edge on its own, of no size yet.
    pub(crate) fn segment() -> Self {
        Polytope {
            corners: vec![Vector3::zeros(); 2],
            faces: Vec::new(),
            loops: Vec::new(),
            edges: vec![Edge { corners: [0, 1], faces: [0, 0] }],
            size: 0.0,
        }
    }

    /// A triangle: two faces that look away from each other.
    pub(crate) fn triangle() -> Self {
        let face = |k: usize| Face { normal: Vector3::zeros(), highest: 0, first: 3 * k, count: 3 };
        let edge = |corners: [usize; 2]| Edge { corners, faces: [0, 1] };
        Polytope {
            corners: vec![Vector3::zeros(); 3],
            faces: vec![face(0), face(1)],
            loops: vec![0, 1, 2, 0, 2, 1],
            edges: vec![edge([0, 1]), edge([1, 2]), edge([0, 2])],
            size: 0.0,
        }
    }

    /// Moves the corners of a triangle.
    pub(crate) fn set_triangle(&mut self, corners: [Vector3<f64>; 3]) {
        let [a, b, c] = corners;
        let middle = (a + b + c) / 3.0;
        self.corners.copy_from_slice(&corners);
        self.size = corners.map(|corner| (corner - middle).norm()).into_iter().fold(0.0, f64::max);
        let normal = ((b - a) / self.size).cross(&((c - a) / self.size)).normalize();
        (self.faces[0].normal, self.faces[1].normal) = (normal, -normal);
    }

    /// The corners of a face.
    pub(crate) fn around(&self, face: usize) -> &[usize] {
        let Face { first, count, .. } = self.faces[face];
        &self.loops[first..][..count]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_six_faces_of_four_corners_that_look_outwards() {
        for scale in [1e-6, 1.0, 1e6] {
            let solid = Polytope::cuboid([scale, 2.0 * scale, 3.0 * scale]).unwrap();
            assert_eq!((solid.faces.len(), solid.edges.len()), (6, 12));
            for (f, face) in solid.faces.iter().enumerate() {
                assert_eq!(face.count, 4);
                let corner = solid.corners[solid.around(f)[0]];
                assert!(face.normal.dot(&corner) > 0.0);
            }
        }
    }
}
