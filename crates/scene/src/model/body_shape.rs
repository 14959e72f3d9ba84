//! The shapes of rigid bodies, about their centres of mass and in their principal axes.
//!
//! Lengths are whole: `length` of a capsule is that of its segment, of a cylinder from end to end.

use stationary_calculus::array;
use std::collections::BTreeMap;

use nalgebra::Vector3;
use serde::Serialize;

/// The shape of a rigid body.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum BodyShape {
    /// Moments alone: nothing that could touch.
    Moments,
    /// A box of these sides; the third is zero in the plane.
    Box([f64; 3]),
    /// A ball, or a disc in the plane, of this radius.
    Ball(f64),
    /// A polygon in the plane, its corners counterclockwise about its centre of mass.
    Polygon(Vec<[f64; 2]>),
    /// All points within a radius of a segment along the third axis, in the plane along the first.
    Capsule {
        /// That of the segment.
        length: f64,
        /// How far it reaches from the segment.
        radius: f64,
    },
    /// A cylinder about the third axis.
    Cylinder {
        /// From end to end.
        length: f64,
        /// That of its circles.
        radius: f64,
    },
    /// A cone about the third axis, its apex up: the base is a quarter of the height below the centre.
    Cone {
        /// From the base to the apex.
        height: f64,
        /// That of the base.
        radius: f64,
    },
    /// An ellipsoid of these half axes.
    Ellipsoid([f64; 3]),
    /// The convex hull of points.
    Hull {
        /// The points, of which some may be inside.
        corners: Vec<[f64; 3]>,
        /// Triangles of the hull, counterclockwise from outside.
        triangles: Vec<[usize; 3]>,
    },
    /// Several shapes that are one body.
    Parts(Vec<BodyPart>),
}

/// A shape that is part of a body, in the body's axes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BodyPart {
    /// Its shape, which has no parts.
    pub shape: BodyShape,
    /// Where its centre of mass is.
    pub position: [f64; 3],
    /// How it is turned: axis times angle.
    pub rotation: [f64; 3],
}

/// How far faces of a hull may be from one plane for the edge between them to be none: a sine.
const FLAT: f64 = 1e-9;

impl BodyShape {
    /// Its corners, in body axes. A corner of a box tells by the bits of its number on which side it
    /// lies.
    pub(crate) fn corners(&self, dimension: usize) -> Vec<[f64; 3]> {
        match self {
            BodyShape::Box(sides) => {
                let side = |corner: usize, c: usize| {
                    if corner >> c & 1 == 1 { 0.5 * sides[c] } else { -0.5 * sides[c] }
                };
                let corners = 0..1_usize << dimension;
                corners.map(|corner| array(|c| side(corner, c))).collect()
            }
            BodyShape::Polygon(corners) => corners.iter().map(|&[x, y]| [x, y, 0.0]).collect(),
            BodyShape::Hull { corners, .. } => corners.clone(),
            _ => Vec::new(),
        }
    }

    /// Which of its corners are joined by an edge: those of a box differ in one bit.
    pub(crate) fn edges(&self, dimension: usize) -> Vec<[usize; 2]> {
        match self {
            BodyShape::Box(_) => {
                let along = (0..1_usize << dimension)
                    .flat_map(|a| (0..dimension).map(move |c| [a, a | 1 << c]));
                along.filter(|[a, b]| a != b).collect()
            }
            BodyShape::Polygon(corners) => {
                let count = corners.len();
                (0..count).map(|corner| [corner, (corner + 1) % count]).collect()
            }
            BodyShape::Hull { corners, triangles } => edges_of_hull(corners, triangles),
            _ => Vec::new(),
        }
    }

    /// Its radius, of a ball.
    pub(crate) fn radius(&self) -> f64 {
        match self {
            BodyShape::Ball(radius) => *radius,
            _ => 0.0,
        }
    }
}

/// Where two triangles meet that are not in one plane.
fn edges_of_hull(corners: &[[f64; 3]], triangles: &[[usize; 3]]) -> Vec<[usize; 2]> {
    let mut normals: BTreeMap<[usize; 2], Vec<Vector3<f64>>> = BTreeMap::new();
    for &[a, b, c] in triangles {
        let [p, q, r] = [a, b, c].map(|corner| Vector3::from(corners[corner]));
        let normal = (q - p).cross(&(r - p)).try_normalize(0.0).unwrap_or_default();
        for [a, b] in [[a, b], [b, c], [c, a]] {
            normals.entry([a.min(b), a.max(b)]).or_default().push(normal);
        }
    }
    let bent = |sides: &[Vector3<f64>]| match sides {
        [one, other] => one.cross(other).norm() > FLAT || one.dot(other) < 0.0,
        _ => true,
    };
    normals.into_iter().filter(|(_, sides)| bent(sides)).map(|(edge, _)| edge).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hull_has_no_edge_across_a_flat_face() {
        let corners = BodyShape::Box([1.0, 2.0, 3.0]).corners(3);
        let places: Vec<_> = corners.iter().map(|&corner| corner.into()).collect();
        let triangles = stationary_mesh::convex_hull(&places).unwrap();
        assert_eq!(triangles.len(), 12);
        let mut edges = BodyShape::Hull { corners, triangles }.edges(3);
        let mut of_box: Vec<_> = BodyShape::Box([1.0; 3]).edges(3);
        edges.sort_unstable();
        of_box.sort_unstable();
        assert_eq!(edges, of_box);
    }
}
