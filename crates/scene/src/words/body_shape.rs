//! What a rigid body looks like: its shape, and the moments and the centre of mass that follow from it.
//!
//! ```text
//! I = m/12 (b^2 + c^2, c^2 + a^2, a^2 + b^2)        a solid box of sides a, b, c
//! I = m/12 (a^2 + b^2)                              a plate in the plane
//! I = 2/5 m r^2,    I = 1/2 m r^2                   a ball, a disc in the plane
//! I = m (J/A)                                       a polygon of area A and polar moment J (7.1)
//! I = m_s (4 a^2 + 4 r^2)/12 + m_d (r^2/2 + a^2 + 8/(3 pi) a r)      a capsule in the plane
//! ```
//! The last is a strip of half length `a` and two half discs, with masses as their areas. A polygon may be
//! turned in on itself, but not cross itself. A polygon and a hull are laid with their centre of mass at the
//! body's position, or stay where their corners are. Round solids are those of
//! [`Body`](stationary_rigid::Body).

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{Matrix3, Vector2, Vector3};
use stationary_mesh::{Moments, Polygon, convex_hull};
use stationary_rigid::{Body, LieGroup, RigidError, Rotation, SpatialMass};
use toml::Spanned;

use crate::model::body_shape::BodyShape;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::{BodyFault, Fault};
use crate::text::number::{Components, Number};
use crate::text::turn::Turn;
use crate::text::{check, limits};
use crate::words::body_tables::{ConeDeclaration, LongDeclaration};

/// A shape and what follows from it.
#[derive(Debug)]
pub(crate) struct Shaped {
    pub(crate) shape: BodyShape,
    pub(crate) moments: [f64; 3],
    /// Where its centre of mass is drawn, of what has corners in places of its own.
    pub(crate) centre: Option<[f64; 3]>,
    /// Turns its principal axes into those in which it is drawn.
    pub(crate) axes: Rotation,
    /// Where the text says so.
    pub(crate) place: Range<usize>,
}

/// What a body or a part says of its shape.
#[derive(Clone, Copy)]
pub(crate) struct ShapeWords<'a> {
    pub(crate) sides: Option<&'a Components>,
    pub(crate) ball: Option<&'a Spanned<Number>>,
    pub(crate) polygon: Option<&'a Spanned<Vec<Components>>>,
    pub(crate) capsule: Option<&'a LongDeclaration>,
    pub(crate) cylinder: Option<&'a LongDeclaration>,
    pub(crate) cone: Option<&'a ConeDeclaration>,
    pub(crate) ellipsoid: Option<&'a Components>,
    pub(crate) hull: Option<&'a Spanned<Vec<Components>>>,
    pub(crate) moments: Option<&'a Turn>,
}

impl ShapeWords<'_> {
    /// Whether it says any.
    pub(crate) fn any(&self) -> bool {
        let lists = self.polygon.is_some() || self.hull.is_some();
        let vectors = self.sides.is_some() || self.ellipsoid.is_some();
        let long = self.capsule.is_some() || self.cylinder.is_some() || self.cone.is_some();
        lists || vectors || long || self.ball.is_some() || self.moments.is_some()
    }
}

/// A shape about its own centre and axes.
fn centred(shape: BodyShape, moments: [f64; 3], place: Range<usize>) -> Shaped {
    Shaped { shape, moments, centre: None, axes: Rotation::identity(), place }
}

/// The shape that is declared, of this mass; `None` where there is not one of them.
pub(crate) fn declare(
    dimension: usize,
    mass: f64,
    words: ShapeWords<'_>,
) -> Checked<Option<Shaped>> {
    let ShapeWords { sides, ball, polygon, capsule, cylinder, cone, ellipsoid, hull, moments } =
        words;
    let mut found = [
        sides.map(|sides| cuboid(dimension, sides, mass)),
        ball.map(|radius| self::ball(dimension, radius, mass)),
        polygon.map(|corners| self::polygon(dimension, corners, mass)),
        capsule.map(|long| self::capsule(dimension, long, mass)),
        cylinder.map(|long| self::cylinder(dimension, long, mass)),
        cone.map(|cone| self::cone(dimension, cone, mass)),
        ellipsoid.map(|halves| self::ellipsoid(dimension, halves, mass)),
        hull.map(|points| self::hull(dimension, points, mass)),
        moments.map(|moments| self::moments(dimension, moments)),
    ]
    .into_iter()
    .flatten();
    match (found.next(), found.next()) {
        (Some(shaped), None) => shaped.map(Some),
        _ => Ok(None),
    }
}

fn cuboid(dimension: usize, sides: &Components, mass: f64) -> Checked<Shaped> {
    let x = check::vector("the box", dimension, sides)?;
    for side in sides.get_ref() {
        check::positive("the side of a box", side)?;
    }
    let square = x.map(|x| x * x);
    let sum = |a: usize, b: usize| mass / 12.0 * (square[a] + square[b]);
    Ok(centred(BodyShape::Box(x), [sum(1, 2), sum(2, 0), sum(0, 1)], sides.span()))
}

fn ball(dimension: usize, declared: &Spanned<Number>, mass: f64) -> Checked<Shaped> {
    let radius = check::positive("the radius", declared)?;
    let part = if dimension == 2 { 0.5 } else { 0.4 };
    let moments = [part * mass * radius * radius; 3];
    Ok(centred(BodyShape::Ball(radius), moments, declared.span()))
}

fn moments(dimension: usize, declared: &Turn) -> Checked<Shaped> {
    let (moments, place) = match declared {
        Turn::Number(moment) if dimension == 2 => {
            ([0.0, 0.0, check::positive("the moment", moment)?], moment.span())
        }
        Turn::Vector(moments) if dimension == 3 => {
            (check::vector("`moments`", 3, moments)?, moments.span())
        }
        other => return Err(other.wrong_kind("`moments`", dimension)),
    };
    Ok(centred(BodyShape::Moments, moments, place))
}

/// A polygon about its centre of mass.
fn polygon(dimension: usize, declared: &Spanned<Vec<Components>>, mass: f64) -> Checked<Shaped> {
    if dimension != 2 {
        return Err(at(declared.span(), BodyFault::PolygonDimension));
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
            Ok(Shaped { centre: Some(centre), ..centred(shape, moments, place) })
        }
        None => Err(at(place, BodyFault::NoPolygon)),
    }
}

/// A length and a radius.
fn long(declared: &LongDeclaration) -> Checked<[f64; 2]> {
    let length = check::positive("the length", &declared.length)?;
    Ok([length, check::positive("the radius", &declared.radius)?])
}

fn capsule(dimension: usize, declared: &LongDeclaration, mass: f64) -> Checked<Shaped> {
    let ([length, radius], place) = (long(declared)?, declared.length.span());
    let shape = BodyShape::Capsule { length, radius };
    let (a, r) = (0.5 * length, radius);
    if dimension == 3 {
        return solid(shape, Body::solid_capsule(mass, a, r), place);
    }
    let ends = mass * PI * r / (4.0 * a + PI * r);
    let strip = (mass - ends) * (a * a + r * r) / 3.0;
    let moment = strip + ends * (0.5 * r * r + a * a + 8.0 / (3.0 * PI) * a * r);
    Ok(centred(shape, [0.0, 0.0, moment], place))
}

fn cylinder(dimension: usize, declared: &LongDeclaration, mass: f64) -> Checked<Shaped> {
    let place = declared.length.span();
    in_space("cylinder", dimension, &place)?;
    let [length, radius] = long(declared)?;
    let body = Body::solid_cylinder(mass, 0.5 * length, radius);
    solid(BodyShape::Cylinder { length, radius }, body, place)
}

fn cone(dimension: usize, declared: &ConeDeclaration, mass: f64) -> Checked<Shaped> {
    let place = declared.height.span();
    in_space("cone", dimension, &place)?;
    let height = check::positive("the height", &declared.height)?;
    let radius = check::positive("the radius", &declared.radius)?;
    solid(BodyShape::Cone { height, radius }, Body::solid_cone(mass, height, radius), place)
}

fn ellipsoid(dimension: usize, declared: &Components, mass: f64) -> Checked<Shaped> {
    in_space("ellipsoid", dimension, &declared.span())?;
    let halves = check::vector("the ellipsoid", 3, declared)?;
    for half in declared.get_ref() {
        check::positive("the half axis of an ellipsoid", half)?;
    }
    solid(BodyShape::Ellipsoid(halves), Body::solid_ellipsoid(mass, halves), declared.span())
}

/// A hull about its centre of mass and its principal axes.
fn hull(dimension: usize, declared: &Spanned<Vec<Components>>, mass: f64) -> Checked<Shaped> {
    let place = declared.span();
    in_space("hull", dimension, &place)?;
    let count = declared.get_ref().len() as u64;
    if count > limits::HULL_POINTS {
        let fault = Fault::TooMany { what: "points of a hull", count, limit: limits::HULL_POINTS };
        return Err(at(place, fault));
    }
    let points = declared.get_ref().iter();
    let points = points.map(|point| Ok(check::vector("a point", 3, point)?.into()));
    let points = points.collect::<Checked<Vec<Vector3<f64>>>>()?;
    let Some(triangles) = convex_hull(&points) else { return Err(at(place, BodyFault::FlatHull)) };
    let middle = points.iter().sum::<Vector3<f64>>() / points.len() as f64;
    // Seen from the middle all its tetrahedra add up.
    let tetrahedra = triangles
        .iter()
        .map(|&[a, b, c]| Moments::of_simplex(&[middle, points[a], points[b], points[c]]));
    let moments = tetrahedra.fold(Moments::zero(middle), |sum, part| sum.with(&part));
    let solid = SpatialMass::of(mass / moments.measure, &moments);
    let solid = solid.and_then(|solid| Ok((solid, principal(&solid)?)));
    let (solid, (moments, axes)) = solid.map_err(|_| at(place.clone(), BodyFault::FlatHull))?;
    let corner = |point: &Vector3<f64>| axes.rotate_back(&(point - solid.centre)).into();
    let shape = BodyShape::Hull { corners: points.iter().map(corner).collect(), triangles };
    Ok(Shaped { shape, moments, centre: Some(solid.centre.into()), axes, place })
}

/// Entries beside the diagonal of a tensor, relative to the largest, that are rounding.
const DIAGONAL: f64 = 1e-12;

/// The principal moments, and what turns the principal axes into the tensor's: those themselves where it is
/// diagonal, so that what is drawn along its axes keeps them.
pub(crate) fn principal(solid: &SpatialMass) -> Result<([f64; 3], Rotation), RigidError> {
    let tensor = solid.inertia;
    let beside = tensor - Matrix3::from_diagonal(&tensor.diagonal());
    if beside.amax() <= DIAGONAL * tensor.amax() {
        return Ok((tensor.diagonal().into(), Rotation::identity()));
    }
    let (body, pose) = solid.body()?;
    Ok((body.moments().into(), pose.rotation))
}

fn in_space(word: &'static str, dimension: usize, place: &Range<usize>) -> Checked<()> {
    match dimension {
        3 => Ok(()),
        _ => Err(at(place.clone(), BodyFault::SolidInThePlane(word))),
    }
}

fn solid(shape: BodyShape, body: Result<Body, RigidError>, place: Range<usize>) -> Checked<Shaped> {
    match body {
        Ok(body) => Ok(centred(shape, body.moments().into(), place)),
        Err(error) => Err(at(place, BodyFault::Body(error.to_string()))),
    }
}
