//! A body of several parts: mass, centre and principal axes of all of them.
//!
//! ```text
//! m = sum m_k,   c = sum m_k c_k / m,   I = sum of the parts' about c        (the parallel-axis rule)
//! ```
//! Parts may overlap: where they do there is the mass of both, as of a ball with a weight in it. They are
//! drawn in the axes of the body as the text has them, and kept about the centre of mass in principal axes.

use nalgebra::{Matrix3, Vector2, Vector3};
use stationary_rigid::{LieGroup, PlanarMass, PlanarMotion, RigidMotion, Rotation, SpatialMass};
use toml::Spanned;

use crate::model::body_shape::{BodyPart, BodyShape};
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::{BodyFault, Fault};
use crate::text::{check, limits};
use crate::words::body_shape::{self, Shaped, principal};
use crate::words::body_tables::PartDeclaration;

/// The mass of all parts, and the shape that they make.
pub(crate) fn declare(
    dimension: usize,
    declared: &Spanned<Vec<PartDeclaration>>,
) -> Checked<(f64, Shaped)> {
    let (place, count) = (declared.span(), declared.get_ref().len() as u64);
    if count == 0 {
        return Err(at(place, BodyFault::NoParts));
    }
    if count > limits::PARTS {
        let fault = Fault::TooMany { what: "parts of a body", count, limit: limits::PARTS };
        return Err(at(place, fault));
    }
    let parts = declared.get_ref().iter().map(|part| Part::declared(dimension, part));
    let parts = parts.collect::<Checked<Vec<_>>>()?;
    let mass = parts.iter().map(|part| part.mass).sum();
    let whole = if dimension == 2 { in_the_plane(&parts) } else { in_space(&parts) };
    let (moments, frame) =
        whole.map_err(|error| at(place.clone(), BodyFault::Body(error.to_string())))?;
    let to_axes = frame.inverse();
    let kept = parts.into_iter().map(|part| {
        let RigidMotion { translation, rotation } = to_axes.compose(&part.pose);
        BodyPart {
            shape: part.shape,
            position: translation.into(),
            rotation: rotation.log().into(),
        }
    });
    let shape = BodyShape::Parts(kept.collect());
    let centre = Some(frame.translation.into());
    Ok((mass, Shaped { shape, moments, centre, axes: frame.rotation, place }))
}

/// A part where it is drawn.
struct Part {
    shape: BodyShape,
    mass: f64,
    moments: [f64; 3],
    pose: RigidMotion,
}

impl Part {
    fn declared(dimension: usize, declared: &PartDeclaration) -> Checked<Self> {
        let mass = check::positive("the mass", &declared.mass)?;
        let shaped = body_shape::declare(dimension, mass, declared.shape())?;
        let Some(Shaped { shape, moments, centre, axes, .. }) = shaped else {
            return Err(at(declared.mass.span(), BodyFault::PartShape));
        };
        let position = match &declared.at {
            Some(place) => check::vector("the place of a part", dimension, place)?,
            None => centre.unwrap_or_default(),
        };
        let rotation = match &declared.rotation {
            Some(turn) => turn.components("the rotation", dimension)?,
            None => [0.0; 3],
        };
        let rotation = Rotation::exp(rotation.into()).compose(&axes);
        Ok(Part {
            shape,
            mass,
            moments,
            pose: RigidMotion { translation: position.into(), rotation },
        })
    }
}

type Whole = Result<([f64; 3], RigidMotion), stationary_rigid::RigidError>;

/// The moments of all, and where their centre and principal axes are drawn.
fn in_space(parts: &[Part]) -> Whole {
    let masses = parts.iter().map(|part| {
        let inertia = Matrix3::from_diagonal(&part.moments.into());
        SpatialMass { mass: part.mass, centre: Vector3::zeros(), inertia }.moved(&part.pose)
    });
    let all = SpatialMass::composite(&masses.collect::<Vec<_>>())?;
    let (moments, rotation) = principal(&all)?;
    Ok((moments, RigidMotion { translation: all.centre, rotation }))
}

fn in_the_plane(parts: &[Part]) -> Whole {
    let masses = parts.iter().map(|part| {
        let (own, place) = (part.moments[2], part.pose.translation.xy());
        let there = PlanarMotion { translation: place, ..PlanarMotion::identity() };
        PlanarMass { mass: part.mass, centre: Vector2::zeros(), inertia: own }.moved(&there)
    });
    let all = PlanarMass::composite(&masses.collect::<Vec<_>>())?;
    let translation = Vector3::new(all.centre.x, all.centre.y, 0.0);
    Ok(([0.0, 0.0, all.inertia], RigidMotion { translation, ..RigidMotion::identity() }))
}
