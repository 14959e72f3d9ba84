//! A convex outline in the plane: a polygon, a segment, which has two sides, or a point, which has none.
//!
//! ```text
//! normal of side k = -Z (x_{k+1} - x_k)/|x_{k+1} - x_k|,     Z a quarter turn to the left
//! ```
//! Corners counterclockwise, metres. A capsule is all points within its radius of a segment, a disc
//! of a point.

use parry2d_f64::math::Vector;
use parry2d_f64::shape::ConvexPolygon;

/// Corners and the normals of the sides that leave them.
#[derive(Clone, Debug)]
pub(crate) struct Outline {
    points: Vec<Vector>,
    normals: Vec<Vector>,
}

impl Outline {
    pub(crate) fn of(polygon: &ConvexPolygon) -> Self {
        Outline { points: polygon.points().to_vec(), normals: polygon.normals().to_vec() }
    }

    /// The origin.
    pub(crate) fn point() -> Self {
        Outline { points: vec![Vector::ZERO], normals: Vec::new() }
    }

    /// From (-half, 0) to (half, 0).
    pub(crate) fn segment(half: f64) -> Self {
        let points = vec![Vector::new(-half, 0.0), Vector::new(half, 0.0)];
        Outline { points, normals: vec![Vector::new(0.0, -1.0), Vector::new(0.0, 1.0)] }
    }

    pub(crate) fn points(&self) -> &[Vector] {
        &self.points
    }

    pub(crate) fn normals(&self) -> &[Vector] {
        &self.normals
    }
}
