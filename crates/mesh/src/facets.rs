//! Who shares which facet: the one table that orientation, boundary and neighbours are read from.
//!
//! ```text
//! (facet in rising order, simplex, opposite corner, sign), sorted
//! ```
//! Equal facets stand together. One use of a facet is boundary; two with different signs are
//! neighbours that agree; two with equal signs are oriented against each other; more are not a
//! manifold.

use crate::buckets::sorted_by_bucket;
use crate::mesh::{Mesh, Part, part};
use crate::simplex::{Simplex, signed_facet};
use crate::{MeshError, Places};

/// A simplex's side of a facet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FacetUse<F> {
    /// The facet's vertices in rising order.
    pub facet: F,
    /// The simplex.
    pub simplex: usize,
    /// The corner of the simplex that is not on the facet.
    pub opposite: usize,
    /// Whether the rising order is an even permutation of the order seen from outside.
    pub even: bool,
}

/// A face named by its vertices.
pub(crate) fn named<F: AsRef<[usize]>>(face: F) -> Vec<usize> {
    face.as_ref().to_vec()
}

impl<const D: usize, const K: usize> Mesh<D, K>
where
    [usize; K]: Simplex,
{
    /// All uses of all facets, those of the same facet next to each other.
    pub fn facet_uses(&self) -> Vec<FacetUse<<[usize; K] as Simplex>::Facet>> {
        let mut uses = Vec::with_capacity(K * self.simplices().len());
        for (number, simplex) in self.simplices().iter().enumerate() {
            for opposite in 0..K {
                let (facet, even) = signed_facet(simplex, opposite);
                uses.push(FacetUse { facet, simplex: number, opposite, even });
            }
        }
        sorted_by_bucket(self.vertices().len(), &uses, |side| side.facet.as_ref()[0])
    }

    /// For each simplex and each of its corners, the neighbour across the facet opposite to it.
    ///
    /// # Errors
    /// [`MeshError::NonManifold`] where a facet has more than two simplices.
    pub fn neighbours(&self) -> Result<Vec<[Option<usize>; K]>, MeshError> {
        let uses = self.facet_uses();
        refuse_more_than_two(&uses)?;
        let mut neighbours = vec![[None; K]; self.simplices().len()];
        for shared in uses.chunk_by(|a, b| a.facet == b.facet) {
            if let [a, b] = shared {
                neighbours[a.simplex][a.opposite] = Some(b.simplex);
                neighbours[b.simplex][b.opposite] = Some(a.simplex);
            }
        }
        Ok(neighbours)
    }

    /// The facets with a simplex on one side only, seen from outside, in rising order of vertices.
    pub fn boundary_facets(&self) -> Vec<<[usize; K] as Simplex>::Facet> {
        let uses = self.facet_uses();
        let lonely = uses.chunk_by(|a, b| a.facet == b.facet).filter(|shared| shared.len() == 1);
        lonely.map(|shared| outward(self, &shared[0])).collect()
    }

    /// An error that lists the facets with a simplex on one side only.
    ///
    /// # Errors
    /// [`MeshError::Open`].
    pub fn check_closed(&self) -> Result<(), MeshError> {
        let open = self.boundary_facets().into_iter().map(named);
        Places::refuse(open.collect(), MeshError::Open)
    }
}

/// A facet with its vertices in the order seen from outside its simplex.
fn outward<const D: usize, const K: usize>(
    mesh: &Mesh<D, K>,
    side: &FacetUse<<[usize; K] as Simplex>::Facet>,
) -> <[usize; K] as Simplex>::Facet
where
    [usize; K]: Simplex,
{
    let mut facet = mesh.simplices()[side.simplex].facet(side.opposite);
    let vertices = facet.as_mut();
    if side.opposite % 2 == 1 && vertices.len() > 1 {
        vertices.swap(0, 1);
    }
    facet
}

/// An error that lists the facets of more than two simplices.
pub(crate) fn refuse_more_than_two<F: Copy + PartialEq + AsRef<[usize]>>(
    uses: &[FacetUse<F>],
) -> Result<(), MeshError> {
    let shared = uses.chunk_by(|a, b| a.facet == b.facet).filter(|shared| shared.len() > 2);
    Places::refuse(shared.map(|uses| named(uses[0].facet)).collect(), MeshError::NonManifold)
}

impl<const D: usize> Mesh<D, 3> {
    /// The boundary of a surface: segments that have the surface on their left.
    pub fn boundary(&self) -> Part<D, 2> {
        part(self.vertices(), &self.boundary_facets())
    }
}

impl<const D: usize> Mesh<D, 4> {
    /// The boundary of a solid: triangles, counterclockwise from outside.
    pub fn boundary(&self) -> Part<D, 3> {
        part(self.vertices(), &self.boundary_facets())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::measure;
    use nalgebra::{Vector2, Vector3};

    #[test]
    fn the_boundary_of_a_square_runs_around_it_counterclockwise() {
        let vertices = vec![Vector2::zeros(), Vector2::x(), Vector2::new(1.0, 1.0), Vector2::y()];
        let square = Mesh::new(vertices, vec![[0, 1, 2], [0, 2, 3]]).unwrap();
        let mut boundary = square.boundary_facets();
        boundary.sort();
        assert_eq!(boundary, [[0, 1], [1, 2], [2, 3], [3, 0]]);
        assert_eq!(square.neighbours().unwrap(), [[None, Some(1), None], [None, None, Some(0)]]);
        let error = square.check_closed().unwrap_err();
        assert!(matches!(error, MeshError::Open(places) if places.0.len() == 4));
    }

    #[test]
    fn the_boundary_of_a_tetrahedron_faces_outward() {
        let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let tetrahedron = Mesh::new(vertices, vec![[0, 1, 2, 3]]).unwrap();
        let boundary = tetrahedron.boundary().mesh;
        boundary.check_closed().unwrap();
        for triangle in boundary.simplices() {
            let [a, b, c] = boundary.corners(triangle);
            let inside = Vector3::repeat(0.25);
            assert!(measure(&[a, b, c, inside]) < 0.0, "seen from inside it runs clockwise");
        }
    }

    #[test]
    fn a_facet_of_three_simplices_is_named() {
        let vertices =
            vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z(), -Vector3::y()];
        let book = Mesh::new(vertices, vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap();
        let error = book.neighbours().unwrap_err();
        assert_eq!(error, MeshError::NonManifold(Places(vec![vec![0, 1]])));
    }
}
