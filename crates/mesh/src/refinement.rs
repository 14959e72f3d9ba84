//! Each simplex cut into 2, 4 or 8 of half its size, without spoiling shapes.
//!
//! ```text
//! vertex V + e of the fine mesh = middle of edge e of the coarse one        h -> h/2
//! ```
//! `V` the number of coarse vertices, `e` the number of an edge in [`Mesh::edges`]. Segments and
//! triangles get children of the parent's shape. A tetrahedron's inner octahedron is cut along
//! one diagonal, named by the order of the corners, so that over all levels at most three shapes
//! (up to mirror images) come of each tetrahedron (Bey 1995).

use nalgebra::SVector;

use crate::MeshError;
use crate::mesh::Mesh;
use crate::simplex::Simplex;

/// The most simplices that a mesh made here may have: about 67 million.
pub const MOST_SIMPLICES: usize = 1 << 26;

impl<const D: usize, const K: usize> Mesh<D, K>
where
    [usize; K]: Simplex,
{
    /// The mesh with every simplex cut into children of half its size.
    ///
    /// # Errors
    /// [`MeshError::TooMany`].
    pub fn refined(&self) -> Result<Self, MeshError> {
        let children = <[usize; K]>::CHILDREN;
        check_count("the refinement", [self.simplices().len(), children.len()])?;
        let edges = self.edges();
        let mut vertices: Vec<SVector<f64, D>> = self.vertices().to_vec();
        vertices.extend(edges.ends.iter().map(|&[a, b]| {
            let (a, b) = (self.vertices()[a], self.vertices()[b]);
            a + (b - a) * 0.5
        }));
        let first_middle = self.vertices().len();
        let mut simplices = Vec::with_capacity(self.simplices().len() * children.len());
        for (corners, edges) in self.simplices().iter().zip(&edges.of_simplices) {
            let vertex = |k: usize| {
                if k < K { corners[k] } else { first_middle + edges.as_ref()[k - K] }
            };
            simplices.extend(children.iter().map(|child| child.map(vertex)));
        }
        Ok(Mesh::known(vertices, simplices))
    }
}

/// An error if the product of these counts is more than a mesh may have.
pub(crate) fn check_count<const N: usize>(
    what: &'static str,
    factors: [usize; N],
) -> Result<usize, MeshError> {
    factors
        .into_iter()
        .try_fold(1_usize, usize::checked_mul)
        .filter(|&count| count <= MOST_SIMPLICES)
        .ok_or(MeshError::TooMany { what, limit: MOST_SIMPLICES })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Diagonals, Quality, bar, cuboid, rectangle};
    use nalgebra::Vector3;
    use proptest::prelude::*;

    #[test]
    fn measure_orientation_and_topology_stay_and_sizes_halve() {
        let square = rectangle([2.0, 1.0], [3, 2], Diagonals::Alternating).unwrap();
        let fine = square.refined().unwrap();
        assert_eq!(fine.simplices().len(), 4 * square.simplices().len());
        assert!((fine.measure() - 2.0).abs() < 1e-14);
        fine.check_manifold().and(fine.check_oriented()).and(fine.check_referenced()).unwrap();
        assert_eq!(fine.euler_characteristic(), 1);
        assert_eq!(fine.boundary_facets().len(), 2 * square.boundary_facets().len());
        let solid = cuboid([1.0, 2.0, 3.0], [1, 2, 1]).unwrap();
        let fine = solid.refined().unwrap();
        assert_eq!(fine.simplices().len(), 8 * solid.simplices().len());
        assert!((fine.measure() - 6.0).abs() < 1e-14);
        fine.check_manifold().and(fine.check_oriented()).and(fine.check_positive()).unwrap();
        assert_eq!(fine.euler_characteristic(), 1);
        assert_eq!(bar(1.0, 3).unwrap().refined().unwrap().simplices().len(), 6);
    }

    #[test]
    fn a_new_vertex_is_the_middle_of_its_edge() {
        let mesh = rectangle([1.0, 1.0], [2, 2], Diagonals::Same).unwrap();
        let fine = mesh.refined().unwrap();
        for (edge, [a, b]) in mesh.edges().ends.into_iter().enumerate() {
            let middle = (mesh.vertices()[a] + mesh.vertices()[b]) / 2.0;
            assert_eq!(fine.vertices()[mesh.vertices().len() + edge], middle);
        }
    }

    #[test]
    fn more_simplices_than_fit_are_an_error() {
        let error = check_count("it", [usize::MAX, 2]).unwrap_err();
        assert_eq!(error, MeshError::TooMany { what: "it", limit: MOST_SIMPLICES });
    }

    proptest! {
        #[test]
        fn a_tetrahedron_has_offspring_of_at_most_three_shapes(
            n in proptest::array::uniform12(-1.0..1.0_f64),
        ) {
            let corners: [Vector3<f64>; 4] = std::array::from_fn(|k| {
                Vector3::new(n[3 * k], n[3 * k + 1], n[3 * k + 2])
            });
            prop_assume!(Quality::MeanRatio.of(&corners) > 0.05);
            let mut mesh = Mesh::new(corners.to_vec(), vec![[0, 1, 2, 3]]).unwrap();
            for _ in 0..4 {
                mesh = mesh.refined().unwrap();
                prop_assert!(mesh.check_positive().is_ok());
                let mut shapes = mesh.quality(Quality::RadiusRatio);
                shapes.sort_by(f64::total_cmp);
                shapes.dedup_by(|a, b| (*a - *b).abs() < 1e-9);
                prop_assert!(shapes.len() <= 3, "{} shapes", shapes.len());
            }
        }
    }
}
