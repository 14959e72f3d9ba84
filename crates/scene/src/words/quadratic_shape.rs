//! Shapes of quadratic elements: nodes at the corners and in the middle of each edge.
//!
//! A picture draws an edge as two lines and a triangle as four, between nodes.

use stationary_calculus::array;
use stationary_mesh::{
    Mesh, MeshError, Quadratic, QuadraticSegments, QuadraticTetrahedra, QuadraticTriangles, Simplex,
};

use crate::model::simplices::{Middles, middle};
use crate::words::laid_shape::{Shape, block, outlined, sheet};

/// A bar of quadratic segments.
pub(crate) fn curve(elements: &QuadraticSegments<1>) -> Result<Shape, MeshError> {
    elevated(elements, |mesh| Ok(outlined(mesh)))
}

/// A sheet of quadratic triangles.
pub(crate) fn curved_sheet<const D: usize>(
    elements: &QuadraticTriangles<D>,
) -> Result<Shape, MeshError> {
    let mut shape = elevated(elements, sheet)?;
    for ends in with_corners(elements)?.boundary_facets() {
        if let Some(node) = middle(&shape.middles, ends) {
            shape.rim[node] = true;
        }
    }
    Ok(shape)
}

/// A block of quadratic tetrahedra.
pub(crate) fn curved_block(elements: &QuadraticTetrahedra<3>) -> Result<Shape, MeshError> {
    elevated(elements, block)
}

/// The straight elements between the corners, among all nodes.
fn with_corners<const D: usize, const K: usize, const N: usize>(
    elements: &Quadratic<D, K, N>,
) -> Result<Mesh<D, K>, MeshError>
where
    [usize; K]: Simplex,
{
    let corners = |element: &[usize; N]| array(|k| element[k]);
    Mesh::new(elements.nodes().to_vec(), elements.elements().iter().map(corners).collect())
}

fn elevated<const D: usize, const K: usize, const N: usize>(
    elements: &Quadratic<D, K, N>,
    of_corners: fn(&Mesh<D, K>) -> Result<Shape, MeshError>,
) -> Result<Shape, MeshError>
where
    [usize; K]: Simplex,
{
    let mut shape = of_corners(&with_corners(elements)?)?;
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
