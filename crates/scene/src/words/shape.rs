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

use nalgebra::{SVector, Vector3};
use stationary_mesh::{Mesh, MeshError, Simplex};
use toml::Spanned;

use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::words::declaration::ShapeDeclaration;
use crate::words::mesh_file::loaded;
use crate::words::quadratic_shape::Middles;
use crate::words::shape_kinds::generated;

/// Where elements have nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    /// At their corners.
    Linear,
    /// And in the middle of their edges.
    Quadratic,
}

/// The simplices of a shape, by the numbers of their vertices.
#[derive(Clone, Debug, PartialEq)]
pub enum Simplices {
    /// Of a bar.
    Segments(Vec<[usize; 2]>),
    /// Of a sheet or a surface.
    Triangles(Vec<[usize; 3]>),
    /// Of a block.
    Tetrahedra(Vec<[usize; 4]>),
}

impl Simplices {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Simplices::Segments(all) => all.len(),
            Simplices::Triangles(all) => all.len(),
            Simplices::Tetrahedra(all) => all.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The same simplices of vertices that are numbered from `first`.
    pub(crate) fn shifted(&self, first: usize) -> Self {
        fn shift<const K: usize>(all: &[[usize; K]], first: usize) -> Vec<[usize; K]> {
            all.iter().map(|corners| corners.map(|vertex| first + vertex)).collect()
        }
        match self {
            Simplices::Segments(all) => Simplices::Segments(shift(all, first)),
            Simplices::Triangles(all) => Simplices::Triangles(shift(all, first)),
            Simplices::Tetrahedra(all) => Simplices::Tetrahedra(shift(all, first)),
        }
    }
}

/// A mesh in a scene.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    /// Its vertices in the shape's own coordinates.
    own: Vec<Vector3<f64>>,
    /// Its vertices in the scene.
    pub(crate) places: Vec<[f64; 3]>,
    pub(crate) simplices: Simplices,
    /// The nodes in the middle of edges, where there are some: then these are vertices too.
    pub(crate) middles: Middles,
    /// The length, area or volume that belongs to each corner: equal parts of each simplex.
    pub(crate) shares: Vec<f64>,
    /// The edges that a picture draws: those on the outside.
    pub(crate) edges: Vec<[usize; 2]>,
    /// The triangles on the outside.
    pub(crate) faces: Vec<[usize; 3]>,
    /// Which vertices are on the boundary of a sheet; none of other shapes are.
    pub(crate) rim: Vec<bool>,
    /// How many own coordinates it has.
    dimension: usize,
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

/// A vertex of a mesh as a point in space.
fn in_space<const D: usize>(x: &SVector<f64, D>) -> Vector3<f64> {
    Vector3::from_fn(|c, _| x.as_slice().get(c).copied().unwrap_or(0.0))
}

/// A mesh without anything to draw.
fn bare<const D: usize, const K: usize>(mesh: &Mesh<D, K>, simplices: Simplices) -> Shape
where
    [usize; K]: Simplex,
{
    let mut shares = vec![0.0; mesh.vertices().len()];
    for (corners, measure) in mesh.simplices().iter().zip(mesh.measures()) {
        corners.iter().for_each(|&vertex| shares[vertex] += measure.abs() / K as f64);
    }
    Shape {
        own: mesh.vertices().iter().map(in_space).collect(),
        places: Vec::new(),
        simplices,
        middles: Middles::new(),
        shares,
        edges: Vec::new(),
        faces: Vec::new(),
        rim: vec![false; mesh.vertices().len()],
        dimension: D,
    }
}

pub(crate) fn outlined(mesh: &Mesh<1, 2>) -> Shape {
    let segments = mesh.simplices().to_vec();
    Shape { edges: segments.clone(), ..bare(mesh, Simplices::Segments(segments)) }
}

pub(crate) fn sheet<const D: usize>(mesh: &Mesh<D, 3>) -> Result<Shape, MeshError> {
    let triangles = mesh.simplices().to_vec();
    let mut shape = bare(mesh, Simplices::Triangles(triangles.clone()));
    shape.edges = mesh.edges().ends;
    shape.faces = triangles;
    for vertex in mesh.boundary_facets().into_iter().flatten() {
        shape.rim[vertex] = true;
    }
    Ok(shape)
}

pub(crate) fn block(mesh: &Mesh<3, 4>) -> Result<Shape, MeshError> {
    let faces = mesh.boundary_facets();
    let skin = Mesh::new(mesh.vertices().to_vec(), faces.clone())?;
    let bare = bare(mesh, Simplices::Tetrahedra(mesh.simplices().to_vec()));
    Ok(Shape { edges: skin.edges().ends, faces, ..bare })
}

/// A part of a shape: what lies at all of these ends of its own axes.
#[derive(Clone, Debug)]
pub(crate) struct Part(Vec<End>);

#[derive(Clone, Copy, Debug)]
enum End {
    Least(Axis),
    Largest(Axis),
    Rim,
    Everywhere,
}

#[derive(Clone, Copy, Debug)]
enum Axis {
    Across,
    Deep,
    Up,
}

const ENDS: [(&str, End); 8] = [
    ("left", End::Least(Axis::Across)),
    ("right", End::Largest(Axis::Across)),
    ("bottom", End::Least(Axis::Up)),
    ("top", End::Largest(Axis::Up)),
    ("front", End::Least(Axis::Deep)),
    ("back", End::Largest(Axis::Deep)),
    ("rim", End::Rim),
    ("all", End::Everywhere),
];

impl Shape {
    /// The part that a word such as `top-left` names.
    pub(crate) fn part(&self, word: &Spanned<String>) -> Checked<Part> {
        let ends = word.get_ref().split('-').map(|end| {
            let end = check::word("side", end, word.span(), &ENDS)?;
            match end {
                End::Least(axis) | End::Largest(axis) if self.axis(axis).is_none() => {
                    Err(at(word.span(), Fault::NoSuchSide(word.get_ref().clone())))
                }
                _ => Ok(end),
            }
        });
        ends.collect::<Checked<_>>().map(Part)
    }

    /// The own coordinate that runs along an axis.
    fn axis(&self, axis: Axis) -> Option<usize> {
        match (axis, self.dimension) {
            (Axis::Across, _) => Some(0),
            (Axis::Up, 2) | (Axis::Deep, 3) => Some(1),
            (Axis::Up, 3) => Some(2),
            _ => None,
        }
    }

    /// Which vertices belong to one of the parts.
    pub(crate) fn within(&self, parts: &[Part]) -> Vec<bool> {
        /// The part of a shape's size by which rounding may move a vertex off its side.
        const OFF: f64 = 1e-9;
        let axis = |c: usize| self.own.iter().map(move |x| x[c]);
        let least: [f64; 3] = std::array::from_fn(|c| axis(c).fold(f64::INFINITY, f64::min));
        let largest: [f64; 3] = std::array::from_fn(|c| axis(c).fold(f64::NEG_INFINITY, f64::max));
        let size = (0..3).fold(0.0_f64, |size, c| size.max(largest[c] - least[c]));
        let near = |vertex: usize, along: Axis, ends: &[f64; 3]| {
            let c = self.axis(along);
            c.is_some_and(|c| (self.own[vertex][c] - ends[c]).abs() <= OFF * size)
        };
        let at_end = |vertex: usize, end: &End| match *end {
            End::Least(axis) => near(vertex, axis, &least),
            End::Largest(axis) => near(vertex, axis, &largest),
            End::Rim => self.rim[vertex],
            End::Everywhere => true,
        };
        let in_part = |vertex: usize, part: &Part| part.0.iter().all(|end| at_end(vertex, end));
        (0..self.own.len()).map(|v| parts.iter().any(|part| in_part(v, part))).collect()
    }

    /// Turns the simplices that fill their space around, for a mirror image of the shape.
    fn turn_around(&mut self, dimension: usize) {
        match &mut self.simplices {
            Simplices::Segments(all) if dimension == 1 => all.iter_mut().for_each(|s| s.swap(0, 1)),
            Simplices::Triangles(all) if dimension == 2 => {
                all.iter_mut().for_each(|s| s.swap(1, 2))
            }
            _ => {}
        }
    }

    /// How far each vertex is from a place in the scene.
    pub(crate) fn distances(&self, place: [f64; 3]) -> impl Iterator<Item = f64> {
        self.places.iter().map(move |x| (Vector3::from(*x) - Vector3::from(place)).norm())
    }

    /// The vertex nearest to a place in the scene.
    pub(crate) fn nearest(&self, place: [f64; 3]) -> usize {
        let closer = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
        self.distances(place).enumerate().min_by(closer).map_or(0, |(vertex, _)| vertex)
    }
}
