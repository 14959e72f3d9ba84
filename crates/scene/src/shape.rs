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
use stationary_mesh::{
    Diagonals, Mesh, MeshError, Simplex, ball, bar, cuboid, disc, icosphere, rectangle, torus,
};
use toml::Spanned;

use crate::declaration::{Components, ShapeDeclaration};
use crate::diagnostic::{Checked, at};
use crate::mesh_file::loaded;
use crate::{Fault, check, limits};

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
    /// The length, area or volume that belongs to each vertex: equal parts of each simplex.
    pub(crate) shares: Vec<f64>,
    /// The edges that a picture draws: those on the outside.
    pub(crate) edges: Vec<[usize; 2]>,
    /// The triangles on the outside.
    pub(crate) faces: Vec<[usize; 3]>,
    /// Which vertices are on the boundary of a sheet; none of other shapes are.
    rim: Vec<bool>,
    /// How many own coordinates it has.
    dimension: usize,
}

/// What a word of `kind` means.
#[derive(Clone, Copy)]
struct Kind {
    make: fn(&[f64], &[usize]) -> Result<Shape, MeshError>,
    /// How many vertices there will be, or a little more.
    count: fn(&[u64]) -> u64,
    /// The least dimension of a scene that it fits into.
    dimension: usize,
    /// How many numbers `size` and `cells` have.
    numbers: [usize; 2],
    /// What `size` is.
    size: &'static str,
}

const KINDS: [(&str, Kind); 7] = [
    (
        "bar",
        Kind {
            make: |size, cells| Ok(outlined(&bar(size[0], cells[0])?)),
            count: |cells| cells[0].saturating_add(1),
            dimension: 1,
            numbers: [1, 1],
            size: "its length",
        },
    ),
    (
        "rectangle",
        Kind {
            make: |size, cells| {
                let cells = [cells[0], cells[1]];
                sheet(&rectangle([size[0], size[1]], cells, Diagonals::Alternating)?)
            },
            count: |cells| cells[0].saturating_add(1).saturating_mul(cells[1].saturating_add(1)),
            dimension: 2,
            numbers: [2, 2],
            size: "its two sides",
        },
    ),
    (
        "disc",
        Kind {
            make: |size, cells| sheet(&disc(size[0], cells[0])?),
            count: |cells| cells[0].saturating_mul(cells[0].saturating_add(1)).saturating_mul(3),
            dimension: 2,
            numbers: [1, 1],
            size: "its radius",
        },
    ),
    (
        "box",
        Kind {
            make: |size, cells| {
                block(&cuboid([size[0], size[1], size[2]], [cells[0], cells[1], cells[2]])?)
            },
            count: |cells| cells.iter().fold(1, |n: u64, &k| n.saturating_mul(k.saturating_add(1))),
            dimension: 3,
            numbers: [3, 3],
            size: "its three sides",
        },
    ),
    (
        "ball",
        Kind {
            make: |size, cells| block(&ball(size[0], cells[0])?),
            count: |cells| 4_u64.saturating_mul(power(8, cells[0])),
            dimension: 3,
            numbers: [1, 1],
            size: "its radius",
        },
    ),
    (
        "sphere",
        Kind {
            make: |size, cells| sheet(&icosphere(size[0], cells[0])?),
            count: |cells| 10_u64.saturating_mul(power(4, cells[0])),
            dimension: 3,
            numbers: [1, 1],
            size: "its radius",
        },
    ),
    (
        "torus",
        Kind {
            make: |size, cells| sheet(&torus([size[0], size[1]], [cells[0], cells[1]])?),
            count: |cells| cells[0].saturating_mul(cells[1]),
            dimension: 3,
            numbers: [2, 2],
            size: "the radii of its circle and of its tube",
        },
    ),
];

fn power(base: u64, levels: u64) -> u64 {
    base.saturating_pow(u32::try_from(levels).unwrap_or(u32::MAX))
}

/// The shape that is declared. `folder` is that of the scene's file.
pub(crate) fn declare(
    dimension: usize,
    folder: Option<&Path>,
    declared: &Spanned<ShapeDeclaration>,
) -> Checked<Shape> {
    let ShapeDeclaration { kind, size, cells, file, origin, .. } = declared.get_ref();
    let mut shape = match (kind, size, cells, file) {
        (Some(kind), Some(size), Some(cells), None) => generated(dimension, kind, size, cells)?,
        (None, None, None, Some(file)) => loaded(dimension, folder, file)?,
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

fn generated(
    dimension: usize,
    kind: &Spanned<String>,
    size: &Components,
    cells: &Spanned<Vec<Spanned<crate::number::Count>>>,
) -> Checked<Shape> {
    let of = check::word("shape", kind.get_ref(), kind.span(), &KINDS)?;
    if dimension < of.dimension {
        let fault = Fault::ShapeDimension { kind: kind.get_ref().clone(), dimension };
        return Err(at(kind.span(), fault));
    }
    let what = of.size;
    let wrong = |key, expected, got| Fault::ShapeNumbers { key, expected, got, what };
    if size.get_ref().len() != of.numbers[0] {
        return Err(at(size.span(), wrong("size", of.numbers[0], size.get_ref().len())));
    }
    if cells.get_ref().len() != of.numbers[1] {
        return Err(at(cells.span(), wrong("cells", of.numbers[1], cells.get_ref().len())));
    }
    let lengths = size.get_ref().iter().map(|x| check::positive("a size of the shape", x));
    let lengths = lengths.collect::<Checked<Vec<f64>>>()?;
    let numbers: Vec<u64> = cells.get_ref().iter().map(|count| count.get_ref().0).collect();
    let count = (of.count)(&numbers);
    if count > limits::PARTICLES {
        let fault = Fault::TooMany { what: "particles", count, limit: limits::PARTICLES };
        return Err(at(cells.span(), fault));
    }
    let numbers: Vec<usize> = numbers.into_iter().map(|n| n as usize).collect();
    (of.make)(&lengths, &numbers).map_err(|error| at(cells.span(), Fault::Shape(error.to_string())))
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
        shares,
        edges: Vec::new(),
        faces: Vec::new(),
        rim: vec![false; mesh.vertices().len()],
        dimension: D,
    }
}

fn outlined(mesh: &Mesh<1, 2>) -> Shape {
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
