//! Where a convex solid with flat faces is closest to a point.
//!
//! ```text
//! s_f = n_f.(x - a_f)              height of the point x above face f, a_f the corner that reaches farthest along n_f
//! inside: the face of the largest s_f;   outside: the least distance from any face, edge or corner
//! ```
//! Metres. A triangle has two faces and no inside.

use nalgebra::Vector3;
use parry3d_f64::shape::PackedFeatureId;

use crate::shapes::polytope::{Edge, Polytope};

type V = Vector3<f64>;

/// The place of a solid that is closest to a point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest {
    pub(crate) place: V,
    /// Out of the solid, of length 1.
    pub(crate) normal: V,
    /// Of the point from the place along the normal; negative inside, m.
    pub(crate) distance: f64,
    /// The name of what the place is on.
    pub(crate) feature: u32,
}

/// The place of a solid that is closest to a point; lengths below `rounding` have no direction.
pub(crate) fn nearest(solid: &Polytope, point: &V, rounding: f64) -> Nearest {
    let height = |face: usize| {
        let face = &solid.faces[face];
        face.normal.dot(&(point - solid.corners[face.highest]))
    };
    let mut highest = (0, height(0));
    for face in 1..solid.faces.len() {
        let there = height(face);
        if there > highest.1 {
            highest = (face, there);
        }
    }
    let (face, distance) = highest;
    let below = on_face(solid, face, distance, point);
    if solid.faces.len() > 2 && distance < 0.0 {
        return below;
    }
    // No direction says more than the distance: where a face says it, nothing is closer.
    let as_high = (0..solid.faces.len()).map(|face| (face, height(face)));
    let as_high = as_high.filter(|(_, there)| *there >= distance - rounding);
    let mut faces = as_high.map(|(face, there)| (face, on_face(solid, face, there, point)));
    if let Some((_, near)) = faces.find(|(face, near)| is_on(solid, *face, &near.place)) {
        return near;
    }
    let edges = solid.edges.iter().enumerate().map(|(k, edge)| on_edge(solid, k, edge, point));
    let closest = edges.min_by(|a, b| a.distance.total_cmp(&b.distance));
    // The way to an edge that is so near is rounding.
    closest.filter(|near| near.distance > rounding).unwrap_or(below)
}

fn on_face(solid: &Polytope, face: usize, distance: f64, point: &V) -> Nearest {
    let normal = solid.faces[face].normal;
    let feature = PackedFeatureId::face(face as u32).0;
    Nearest { place: point - normal * distance, normal, distance, feature }
}

/// Whether a point of the plane of a face is on the face.
fn is_on(solid: &Polytope, face: usize, place: &V) -> bool {
    let (around, normal) = (solid.around(face), &solid.faces[face].normal);
    (0..around.len()).all(|k| {
        let [from, to] = [k, (k + 1) % around.len()].map(|k| solid.corners[around[k]]);
        (to - from).cross(&(place - from)).dot(normal) >= 0.0
    })
}

fn on_edge(solid: &Polytope, number: usize, edge: &Edge, point: &V) -> Nearest {
    let [from, to] = edge.corners.map(|corner| solid.corners[corner]);
    let (along, way) = (to - from, point - from);
    let t = way.dot(&along) / along.norm_squared();
    let corner = |k: usize| PackedFeatureId::vertex(edge.corners[k] as u32).0;
    let (place, feature) = match t {
        ..=0.0 => (from, corner(0)),
        1.0.. => (to, corner(1)),
        _ => (from + along * t, PackedFeatureId::edge(number as u32).0),
    };
    let way = point - place;
    let distance = way.norm();
    // Of a short way rounding along the edge is a part that leans.
    let across = match t > 0.0 && t < 1.0 {
        true => way - along * (way.dot(&along) / along.norm_squared()),
        false => way,
    };
    // On the edge any direction is as good.
    let normal = across.try_normalize(0.0).unwrap_or(solid.faces[edge.faces[0]].normal);
    Nearest { place, normal, distance, feature }
}
