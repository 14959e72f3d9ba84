//! What of a body belongs to each node of its quadratic elements.
//!
//! ```text
//! share of a node = sum over its elements  |element| int N_a^2 / sum_b int N_b^2
//! ```
//! `N` the shape functions: every node of a body has a mass.

use stationary_elasticity::{
    ElasticityError, Freedoms, QuadraticSegment, QuadraticTetrahedron, QuadraticTriangle,
    Reference, lumped_mass,
};
use stationary_mesh::{Quadratic, Simplex};

use crate::model::simplices::{Simplices, with_middles};
use crate::text::fault::Fault;
use crate::words::laid_shape::Shape;

/// The length, area or volume that belongs to each vertex of a shape of quadratic elements.
pub(crate) fn node_shares(shape: &Shape) -> Result<Vec<f64>, Fault> {
    let shares = match &shape.simplices {
        Simplices::Segments(segments) => lumped(QuadraticSegment, shape, segments),
        Simplices::Triangles(triangles) => lumped(QuadraticTriangle, shape, triangles),
        Simplices::Tetrahedra(tetrahedra) => lumped(QuadraticTetrahedron, shape, tetrahedra),
    };
    shares.map_err(|error| Fault::Shape(error.to_string()))
}

fn lumped<F, const K: usize, const N: usize, const R: usize, const Q: usize>(
    family: F,
    shape: &Shape,
    simplices: &[[usize; K]],
) -> Result<Vec<f64>, ElasticityError>
where
    F: Reference<N, R, Q>,
    [usize; K]: Simplex,
{
    let nodes = shape.places.iter().map(|&x| x.into()).collect();
    let elements = Quadratic::<3, K, N>::new(nodes, with_middles(simplices, &shape.middles))?;
    let freedoms = Freedoms::<1>::free(shape.places.len())?;
    Ok(lumped_mass(family, &elements, [1.0, 1.0], &freedoms)?.masses().to_vec())
}
