//! Shapes of quadratic elements: nodes at the corners and in the middle of each edge.
//!
//! ```text
//! share of a node = sum over its elements  |element| int N_a^2 / sum_b int N_b^2
//! ```
//! `N` the shape functions, so that every node of a body has a mass. A picture draws an edge as two
//! lines and a triangle as four, between nodes.

use std::collections::BTreeMap;

use stationary_elasticity::{
    ElasticityError, Freedoms, QuadraticSegment, QuadraticTetrahedron, QuadraticTriangle,
    Reference, lumped_mass,
};
use stationary_mesh::{
    Mesh, MeshError, Quadratic, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, Simplex,
};

use crate::shape::{Shape, block, outlined, sheet};

/// The node in the middle of each edge, by the edge's ends, the smaller number first; none where
/// elements are linear.
pub type Middles = BTreeMap<[usize; 2], usize>;

/// The node in the middle of the edge between two corners.
pub(crate) fn middle(middles: &Middles, [a, b]: [usize; 2]) -> Option<usize> {
    middles.get(&[a.min(b), a.max(b)]).copied()
}

/// A bar of quadratic segments.
pub(crate) fn curve(elements: &QuadraticSegments<1>) -> Result<Shape, ElasticityError> {
    elevated(elements, QuadraticSegment, |mesh| Ok(outlined(mesh)))
}

/// A sheet of quadratic triangles.
pub(crate) fn curved_sheet<const D: usize>(
    elements: &QuadraticTriangles<D>,
) -> Result<Shape, ElasticityError> {
    let mut shape = elevated(elements, QuadraticTriangle, sheet)?;
    for ends in with_corners(elements)?.boundary_facets() {
        if let Some(node) = middle(&shape.middles, ends) {
            shape.rim[node] = true;
        }
    }
    Ok(shape)
}

/// A block of quadratic tetrahedra.
pub(crate) fn curved_block(elements: &QuadraticTetrahedra<3>) -> Result<Shape, ElasticityError> {
    elevated(elements, QuadraticTetrahedron, block)
}

/// The straight elements between the corners, among all nodes.
fn with_corners<const D: usize, const K: usize, const N: usize>(
    elements: &Quadratic<D, K, N>,
) -> Result<Mesh<D, K>, MeshError>
where
    [usize; K]: Simplex,
{
    let corners = |element: &[usize; N]| std::array::from_fn(|k| element[k]);
    Mesh::new(elements.nodes().to_vec(), elements.elements().iter().map(corners).collect())
}

fn elevated<F, const D: usize, const K: usize, const N: usize, const R: usize, const Q: usize>(
    elements: &Quadratic<D, K, N>,
    family: F,
    of_corners: fn(&Mesh<D, K>) -> Result<Shape, MeshError>,
) -> Result<Shape, ElasticityError>
where
    F: Reference<N, R, Q>,
    [usize; K]: Simplex,
{
    let mut shape = of_corners(&with_corners(elements)?)?;
    let freedoms = Freedoms::<1>::free(elements.nodes().len())?;
    shape.shares = lumped_mass(family, elements, [1.0, 1.0], &freedoms)?.masses().to_vec();
    for element in elements.elements() {
        for (edge, ends) in <[usize; K]>::EDGES.iter().enumerate() {
            let [a, b] = ends.map(|end| element[end]);
            shape.middles.insert([a.min(b), a.max(b)], element[K + edge]);
        }
    }
    shape.edges = halves(&shape.edges, &shape.middles);
    shape.faces = quarters(&shape.faces, &shape.middles);
    Ok(shape)
}

fn halves(edges: &[[usize; 2]], middles: &Middles) -> Vec<[usize; 2]> {
    let half = |&[a, b]: &[usize; 2]| match middle(middles, [a, b]) {
        Some(node) => vec![[a, node], [node, b]],
        None => vec![[a, b]],
    };
    edges.iter().flat_map(half).collect()
}

fn quarters(faces: &[[usize; 3]], middles: &Middles) -> Vec<[usize; 3]> {
    let quarter = |&[a, b, c]: &[usize; 3]| {
        let [ab, bc, ca] = [[a, b], [b, c], [c, a]].map(|ends| middle(middles, ends));
        match (ab, bc, ca) {
            (Some(d), Some(e), Some(f)) => vec![[a, d, f], [d, b, e], [f, e, c], [d, e, f]],
            _ => vec![[a, b, c]],
        }
    };
    faces.iter().flat_map(quarter).collect()
}
