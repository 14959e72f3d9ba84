//! Shapes: meshes from a word and some numbers, or from a file, laid into the scene.
//!
//! ```text
//! x = origin + X across + Y up + Z (across x up)         X Y Z the shape's own coordinates
//! ```
//! A bar, a rectangle and a box begin at their own origin and reach into the positive; a disc, a
//! ball, a sphere and a torus lie about it. A bar fits into a scene of any dimension, a rectangle and
//! a disc into the plane and into space, the others into space alone. Sides are named by the extreme
//! own coordinates: `left` and `right` (X), `bottom` and `top` (Y of a flat shape, Z of others),
//! `front` and `back` (Y), what is in several of them by hyphens between, as `top-left`; `rim` is the
//! boundary of a sheet.

use std::path::Path;

use nalgebra::Vector3;
use toml::Spanned;

use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::{Components, Count};
use crate::words::laid_shape::{Element, Shape};
use crate::words::mesh_file::loaded;
use crate::words::shape_kinds::generated;
use crate::words::table::{Kind, table};

table! {
    /// A mesh: a kind with its size and cells, or a file.
    pub(crate) struct ShapeDeclaration = "a shape" {
        /// What is made.
        kind: Option<Spanned<String>> = Kind::OneOf(&["bar", "rectangle", "disc", "box", "ball", "sphere", "torus"]),
        /// Its length, sides or radii.
        size: Option<Components> = Kind::Vector,
        /// Cells along each side, rings, or refinements.
        cells: Option<Spanned<Vec<Spanned<Count>>>> = Kind::List(&Kind::Count(0)),
        /// An OBJ or MSH file beside the scene's.
        file: Option<Spanned<String>> = Kind::Text,
        /// Where its own origin is.
        origin: Option<Components> = Kind::Vector,
        /// The direction of its first axis.
        across: Option<Components> = Kind::Vector,
        /// The direction of its second axis.
        up: Option<Components> = Kind::Vector,
    }
}

/// The shape that is declared, in elements of this sort. `folder` is that of the scene's file.
pub(crate) fn declare(
    dimension: usize,
    element: Element,
    folder: Option<&Path>,
    declared: &Spanned<ShapeDeclaration>,
) -> Checked<Shape> {
    let ShapeDeclaration { kind, size, cells, file, origin, .. } = declared.get_ref();
    let mut shape = match (kind, size, cells, file) {
        (Some(kind), Some(size), Some(cells), None) => {
            generated(dimension, element, kind, size, cells)?
        }
        (None, None, None, Some(file)) => loaded(dimension, element, folder, file)?,
        _ => return Err(at(declared.span(), Fault::ShapeOrFile)),
    };
    let origin = match origin {
        Some(origin) => check::vector("the origin", dimension, origin)?,
        None => [0.0; 3],
    };
    let [across, up] = axes(dimension, declared)?;
    let third = across.cross(&up);
    let mirrored = match dimension {
        1 => across.x < 0.0,
        2 => third.z < 0.0,
        _ => false,
    };
    if mirrored {
        shape.turn_around(dimension);
    }
    let place = |x: &Vector3<f64>| -> [f64; 3] {
        (Vector3::from(origin) + across * x.x + up * x.y + third * x.z).into()
    };
    shape.places = shape.own.iter().map(place).collect();
    match shape.places.as_flattened().iter().find(|x| !x.is_finite()) {
        Some(&value) => {
            Err(at(declared.span(), Fault::NotFinite { what: "a vertex of the shape", value }))
        }
        None => Ok(shape),
    }
}

/// The directions of the shape's first two axes. Where only the first is given, the second is a
/// quarter turn from it in the plane, and in space what is left of the usual one.
fn axes(dimension: usize, declared: &Spanned<ShapeDeclaration>) -> Checked<[Vector3<f64>; 2]> {
    let ShapeDeclaration { across, up, .. } = declared.get_ref();
    let usual = match across {
        Some(given) => {
            let x = Vector3::from(check::direction("`across`", dimension, given)?);
            let left = match dimension {
                3 if x.y.abs() < 0.999 => Vector3::y() - x * x.y,
                3 => Vector3::z() - x * x.z,
                _ => Vector3::z().cross(&x),
            };
            left.normalize().into()
        }
        None => [0.0, 1.0, 0.0],
    };
    let both = [("`across`", across, [1.0, 0.0, 0.0]), ("`up`", up, usual)];
    Ok(check::right_angle(dimension, declared.span(), both)?.map(Vector3::from))
}
