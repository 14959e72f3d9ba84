//! What a rigid body looks like: its moments, the points on it that are followed, and its edges.
//!
//! ```text
//! I = m/12 (b^2 + c^2, c^2 + a^2, a^2 + b^2)        a solid box of sides a, b, c
//! I = m/12 (a^2 + b^2)                              a plate in the plane
//! I = 2/5 m r^2,    I = 1/2 m r^2                   a ball, a disc in the plane
//! I = m (J/A)                                       a polygon of area A and polar moment J (7.1)
//! ```
//! A polygon may be turned in on itself, but not cross itself. It is laid with its centre of mass at
//! the body's position, or stays where its corners are.

use std::ops::Range;

use nalgebra::Vector2;
use stationary_mesh::Polygon;
use toml::Spanned;

use crate::model::body_shape::BodyShape;
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Number};
use crate::text::turn::Turn;

/// A shape and what follows from it.
#[derive(Debug)]
pub(crate) struct Shaped {
    pub(crate) shape: BodyShape,
    pub(crate) moments: [f64; 3],
    /// Where its centre of mass is drawn, of a polygon.
    pub(crate) centre: Option<[f64; 3]>,
    /// Where the text says so.
    pub(crate) place: Range<usize>,
}

/// What a body says of its shape.
pub(crate) struct ShapeWords<'a> {
    pub(crate) name: &'a Spanned<String>,
    pub(crate) sides: Option<&'a Components>,
    pub(crate) ball: Option<&'a Spanned<Number>>,
    pub(crate) polygon: Option<&'a Spanned<Vec<Components>>>,
    pub(crate) moments: Option<&'a Turn>,
}

/// The shape that is declared, of a body of this mass.
pub(crate) fn declare(dimension: usize, mass: f64, declared: &ShapeWords<'_>) -> Checked<Shaped> {
    let &ShapeWords { sides, ball, polygon, moments, .. } = declared;
    match (sides, ball, polygon, moments) {
        (Some(sides), None, None, None) => {
            let x = check::vector("the box", dimension, sides)?;
            for side in sides.get_ref() {
                check::positive("the side of a box", side)?;
            }
            let square = x.map(|x| x * x);
            let sum = |a: usize, b: usize| mass / 12.0 * (square[a] + square[b]);
            let moments = [sum(1, 2), sum(2, 0), sum(0, 1)];
            Ok(Shaped { shape: BodyShape::Box(x), moments, centre: None, place: sides.span() })
        }
        (None, Some(ball), None, None) => {
            let radius = check::positive("the radius", ball)?;
            let part = if dimension == 2 { 0.5 } else { 0.4 };
            let moments = [part * mass * radius * radius; 3];
            Ok(Shaped { shape: BodyShape::Ball(radius), moments, centre: None, place: ball.span() })
        }
        (None, None, Some(polygon), None) => self::polygon(dimension, polygon, mass),
        (None, None, None, Some(given)) => {
            let (moments, place) = match given {
                Turn::Number(moment) if dimension == 2 => {
                    ([0.0, 0.0, check::positive("the moment", moment)?], moment.span())
                }
                Turn::Vector(moments) if dimension == 3 => {
                    (check::vector("`moments`", 3, moments)?, moments.span())
                }
                other => return Err(other.wrong_kind("`moments`", dimension)),
            };
            Ok(Shaped { shape: BodyShape::Moments, moments, centre: None, place })
        }
        _ => Err(at(declared.name.span(), Fault::BodyShape(declared.name.get_ref().clone()))),
    }
}

/// A polygon about its centre of mass.
fn polygon(dimension: usize, declared: &Spanned<Vec<Components>>, mass: f64) -> Checked<Shaped> {
    if dimension != 2 {
        return Err(at(declared.span(), Fault::PolygonDimension));
    }
    let corners = declared.get_ref().iter().map(|corner| {
        let [x, y, _] = check::vector("a corner", 2, corner)?;
        Ok(Vector2::new(x, y))
    });
    let corners = corners.collect::<Checked<Vec<_>>>()?;
    let bounded = || -> Option<_> {
        let polygon = Polygon::new(vec![corners]).ok()?;
        let moments = polygon.moments();
        let (centre, central) = (moments.centroid()?, moments.central()?);
        let moment = mass * central.polar() / central.measure;
        let about = |corner: &Vector2<f64>| (corner - centre).into();
        let outline = polygon.outlines().first()?.iter().map(about).collect();
        Some((BodyShape::Polygon(outline), [0.0, 0.0, moment], [centre.x, centre.y, 0.0]))
    };
    let place = declared.span();
    match bounded() {
        Some((shape, moments, centre)) => {
            Ok(Shaped { shape, moments, centre: Some(centre), place })
        }
        None => Err(at(place, Fault::NoPolygon)),
    }
}
