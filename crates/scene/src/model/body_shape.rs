//! The shapes of rigid bodies.

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
}

impl BodyShape {
    /// Its corners, in body axes. A corner of a box tells by the bits of its number on which side it
    /// lies.
    pub(crate) fn corners(&self, dimension: usize) -> Vec<[f64; 3]> {
        match self {
            BodyShape::Moments | BodyShape::Ball(_) => Vec::new(),
            BodyShape::Box(sides) => {
                let side = |corner: usize, c: usize| {
                    if corner >> c & 1 == 1 { 0.5 * sides[c] } else { -0.5 * sides[c] }
                };
                let corners = 0..1_usize << dimension;
                corners.map(|corner| std::array::from_fn(|c| side(corner, c))).collect()
            }
            BodyShape::Polygon(corners) => corners.iter().map(|&[x, y]| [x, y, 0.0]).collect(),
        }
    }

    /// Which of its corners are joined by an edge: those of a box differ in one bit.
    pub(crate) fn edges(&self, dimension: usize) -> Vec<[usize; 2]> {
        match self {
            BodyShape::Moments | BodyShape::Ball(_) => Vec::new(),
            BodyShape::Box(_) => {
                let along = (0..1_usize << dimension)
                    .flat_map(|a| (0..dimension).map(move |c| [a, a | 1 << c]));
                along.filter(|[a, b]| a != b).collect()
            }
            BodyShape::Polygon(corners) => {
                let count = corners.len();
                (0..count).map(|corner| [corner, (corner + 1) % count]).collect()
            }
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
