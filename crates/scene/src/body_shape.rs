//! What a rigid body looks like: its moments, the points on it that are followed, and its edges.
//!
//! ```text
//! I = m/12 (b^2 + c^2, c^2 + a^2, a^2 + b^2)        a solid box of sides a, b, c
//! I = m/12 (a^2 + b^2)                              a plate in the plane
//! I = 2/5 m r^2,    I = 1/2 m r^2                   a ball, a disc in the plane
//! I = m (J/A)                                       a polygon of area A and polar moment J (7.1)
//! ```
//! A polygon may be turned in on itself, but not cross itself; it is laid with its centre of mass at
//! the body's position.

use nalgebra::Vector2;
use stationary_mesh::Polygon;

use crate::declaration::{BodyDeclaration, Turn};
use crate::diagnostic::{Checked, at};
use crate::{Fault, check};

/// The shape of a rigid body.
#[derive(Clone, Debug, PartialEq)]
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

/// The shape that is declared, and the moments of a body of this mass.
pub(crate) fn declare(
    dimension: usize,
    declared: &BodyDeclaration,
    mass: f64,
) -> Checked<(BodyShape, [f64; 3], std::ops::Range<usize>)> {
    let BodyDeclaration { sides, ball, polygon, moments, .. } = declared;
    match (sides, ball, polygon, moments) {
        (Some(sides), None, None, None) => {
            let x = check::vector("the box", dimension, sides)?;
            for side in sides.get_ref() {
                check::positive("the side of a box", side)?;
            }
            let square = x.map(|x| x * x);
            let sum = |a: usize, b: usize| mass / 12.0 * (square[a] + square[b]);
            Ok((BodyShape::Box(x), [sum(1, 2), sum(2, 0), sum(0, 1)], sides.span()))
        }
        (None, Some(ball), None, None) => {
            let radius = check::positive("the radius", ball)?;
            let part = if dimension == 2 { 0.5 } else { 0.4 };
            Ok((BodyShape::Ball(radius), [part * mass * radius * radius; 3], ball.span()))
        }
        (None, None, Some(corners), None) => {
            if dimension != 2 {
                return Err(at(corners.span(), Fault::PolygonDimension));
            }
            let corners = corners.get_ref().iter().map(|corner| {
                let [x, y, _] = check::vector("a corner", 2, corner)?;
                Ok(Vector2::new(x, y))
            });
            let place = polygon.as_ref().map_or(declared.name.span(), |polygon| polygon.span());
            polygon_of(corners.collect::<Checked<_>>()?, mass)
                .map(|(shape, moments)| (shape, moments, place.clone()))
                .ok_or_else(|| at(place, Fault::NoPolygon))
        }
        (None, None, None, Some(Turn::Number(moment))) if dimension == 2 => {
            let moment_of = check::positive("the moment", moment)?;
            Ok((BodyShape::Moments, [0.0, 0.0, moment_of], moment.span()))
        }
        (None, None, None, Some(Turn::Vector(moments))) if dimension == 3 => {
            let of = check::vector("`moments`", 3, moments)?;
            Ok((BodyShape::Moments, of, moments.span()))
        }
        (None, None, None, Some(other)) => Err(other.wrong_kind("`moments`", dimension)),
        _ => Err(at(declared.name.span(), Fault::BodyShape(declared.name.get_ref().clone()))),
    }
}

/// A polygon about its centre of mass, and its moments.
fn polygon_of(corners: Vec<Vector2<f64>>, mass: f64) -> Option<(BodyShape, [f64; 3])> {
    let polygon = Polygon::new(vec![corners]).ok()?;
    let moments = polygon.moments();
    let (centre, central) = (moments.centroid()?, moments.central()?);
    let moment = mass * central.polar() / central.measure;
    let outline = polygon.outlines().first()?;
    let corners = outline.iter().map(|corner| (corner - centre).into()).collect();
    Some((BodyShape::Polygon(corners), [0.0, 0.0, moment]))
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
