//! A mesh in a scene: its vertices, simplices, outside and parts.

use nalgebra::{SVector, Vector3};
use stationary_calculus::array;
use stationary_mesh::{Mesh, MeshError, Simplex};
use toml::Spanned;

use crate::model::elastic_body::ElasticBody;
use crate::model::simplices::{Middles, Simplices};
use crate::text::check;
use crate::text::diagnostic::{Checked, at};
use crate::text::fault::Fault;
use crate::text::number::Marks;
use crate::words::particle_table::ParticleTable;

/// Where elements have nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Element {
    /// At their corners.
    Linear,
    /// And in the middle of their edges.
    Quadratic,
}

/// A mesh in a scene.
#[derive(Clone, Debug)]
pub(crate) struct Shape {
    /// Its vertices in the shape's own coordinates.
    pub(super) own: Vec<Vector3<f64>>,
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
        let least: [f64; 3] = array(|c| axis(c).fold(f64::INFINITY, f64::min));
        let largest: [f64; 3] = array(|c| axis(c).fold(f64::NEG_INFINITY, f64::max));
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
    pub(super) fn turn_around(&mut self, dimension: usize) {
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

/// Which vertices belong to one of the parts that the words name.
pub(crate) fn within(shape: &Shape, words: &[Spanned<String>]) -> Checked<Vec<bool>> {
    let parts = words.iter().map(|word| shape.part(word)).collect::<Checked<Vec<_>>>()?;
    Ok(shape.within(&parts))
}

/// Gives the vertices nearest to the marks the names of these.
pub(crate) fn mark(
    table: &mut ParticleTable,
    dimension: usize,
    first: usize,
    solid: &str,
    shape: &Shape,
    marks: Option<&Marks>,
) -> Checked<()> {
    for (mark, place) in marks.into_iter().flatten() {
        let name = check::name(mark)?;
        let vertex = first + shape.nearest(check::vector("the mark", dimension, place)?);
        let name = format!("{solid}.{name}");
        if table.rename(vertex, name.clone()).is_none() {
            return Err(at(mark.span(), Fault::DuplicateName(name)));
        }
    }
    Ok(())
}

/// What all elastic bodies of a scene come to.
#[derive(Debug, Default)]
pub(crate) struct Solids {
    pub(crate) bodies: Vec<ElasticBody>,
    /// The edges that a picture draws.
    pub(crate) edges: Vec<[usize; 2]>,
    /// The triangles on the outside.
    pub(crate) faces: Vec<[usize; 3]>,
    /// The particles that are held until the start.
    pub(crate) hung: Vec<usize>,
}
