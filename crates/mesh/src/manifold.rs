//! Does a mesh look like a line, a plane or a space everywhere?
//!
//! ```text
//! facets: at most two simplices          lower faces: their simplices hang together by facets
//! vertices of solids: the link's V - E + F is 2, or 1 on the boundary
//! ```
//! The link of a vertex is made of the facets opposite to it. Facets and connected stars are enough
//! for curves and surfaces; in solids a link may also be a closed surface that is no sphere, which
//! its Euler characteristic tells.

use crate::edges::Adjacency;
use crate::fans::all_are_fans;
use crate::mesh::Mesh;
use crate::simplex::Simplex;
use crate::{MeshError, Places};

impl<const D: usize, const K: usize> Mesh<D, K>
where
    [usize; K]: Simplex,
{
    /// An error that lists where the mesh is not a manifold with boundary.
    ///
    /// # Errors
    /// [`MeshError::NonManifold`] and [`MeshError::Pinched`].
    pub fn check_manifold(&self) -> Result<(), MeshError> {
        if all_are_fans(self.vertices().len(), self.simplices()) {
            return Ok(());
        }
        self.check_manifold_slowly()
    }

    /// The same for meshes of any kind, with a list of all that is wrong.
    pub(crate) fn check_manifold_slowly(&self) -> Result<(), MeshError> {
        let neighbours = self.neighbours()?;
        if K == 2 {
            return Ok(());
        }
        let stars = self.simplices_at_vertices();
        let torn = |face: &[usize]| !self.hangs_together(face, &stars, &neighbours);
        let vertices = (0..self.vertices().len()).map(|vertex| [vertex]);
        let mut pinched: Vec<Vec<usize>> =
            vertices.filter(|vertex| torn(vertex)).map(Vec::from).collect();
        if K == 4 {
            let edges = self.edges().ends.into_iter();
            pinched.extend(edges.filter(|ends| torn(ends)).map(Vec::from));
        }
        Places::refuse(pinched, MeshError::Pinched)?;
        let all = 0..self.vertices().len();
        let knotted = all.filter(|&vertex| K == 4 && !self.has_round_link(vertex, &stars));
        Places::refuse(knotted.map(|vertex| vec![vertex]).collect(), MeshError::Pinched)
    }

    /// Whether the simplices around a face can be walked through across facets that contain it.
    fn hangs_together(
        &self,
        face: &[usize],
        stars: &Adjacency,
        neighbours: &[[Option<usize>; K]],
    ) -> bool {
        let within = |s: &usize| face[1..].iter().all(|v| self.simplices()[*s].contains(v));
        let star: Vec<usize> = stars.of(face[0]).iter().copied().filter(within).collect();
        let mut seen = vec![false; star.len()];
        let mut next: Vec<usize> = star.first().map(|_| 0).into_iter().collect();
        let mut reached = 0;
        while let Some(place) = next.pop() {
            if std::mem::replace(&mut seen[place], true) {
                continue;
            }
            reached += 1;
            let simplex = star[place];
            for (corner, neighbour) in neighbours[simplex].iter().enumerate() {
                let across =
                    neighbour.filter(|_| !face.contains(&self.simplices()[simplex][corner]));
                next.extend(across.and_then(|other| star.binary_search(&other).ok()));
            }
        }
        reached == star.len()
    }

    /// Whether the triangles opposite to a vertex of a solid form a sphere or a disc.
    fn has_round_link(&self, vertex: usize, stars: &Adjacency) -> bool {
        let mut link = Vec::new();
        for &simplex in stars.of(vertex) {
            let others = self.simplices()[simplex].iter().filter(|&&v| v != vertex);
            let corners: Vec<usize> = others.copied().collect();
            link.push([corners[0], corners[1], corners[2]]);
        }
        if link.is_empty() {
            return true;
        }
        let mut corners: Vec<usize> = link.iter().flatten().copied().collect();
        corners.sort_unstable();
        corners.dedup();
        let mut sides: Vec<[usize; 2]> = link
            .iter()
            .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
            .map(|[a, b]| [a.min(b), a.max(b)])
            .collect();
        sides.sort_unstable();
        let closed = sides.chunk_by(|a, b| a == b).all(|shared| shared.len() == 2);
        sides.dedup();
        corners.len() + link.len() == sides.len() + if closed { 2 } else { 1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::icosphere;
    use nalgebra::Vector3;

    fn points(count: usize) -> Vec<Vector3<f64>> {
        (0..count).map(|k| Vector3::new(k as f64, (k * k) as f64, (k * k * k) as f64)).collect()
    }

    #[test]
    fn three_sheets_at_an_edge_are_no_surface() {
        let book = Mesh::new(points(5), vec![[0, 1, 2], [1, 0, 3], [0, 1, 4]]).unwrap();
        assert_eq!(book.check_manifold(), Err(MeshError::NonManifold(Places(vec![vec![0, 1]]))));
    }

    #[test]
    fn two_sheets_at_a_point_are_no_surface() {
        let bow = Mesh::new(points(5), vec![[0, 1, 2], [0, 3, 4]]).unwrap();
        assert_eq!(bow.check_manifold(), Err(MeshError::Pinched(Places(vec![vec![0]]))));
    }

    #[test]
    fn two_solids_at_an_edge_are_no_solid() {
        let hinge = Mesh::new(points(6), vec![[0, 1, 2, 3], [0, 1, 4, 5]]).unwrap();
        assert_eq!(
            hinge.check_manifold(),
            Err(MeshError::Pinched(Places(vec![vec![0], vec![1], vec![0, 1]])))
        );
    }

    #[test]
    fn a_cone_over_a_torus_is_no_solid_and_a_cone_over_a_sphere_is() {
        let cone = |surface: Mesh<3, 3>| {
            let mut vertices = surface.vertices().to_vec();
            let apex = vertices.len();
            vertices.push(Vector3::new(0.1, 0.2, 7.0));
            let solids = surface.simplices().iter().map(|&[a, b, c]| [a, b, c, apex]);
            (Mesh::new(vertices, solids.collect()).unwrap(), apex)
        };
        let (ball, _) = cone(icosphere(1.0, 1).unwrap());
        assert_eq!(ball.check_manifold(), Ok(()));
        let (pinched, apex) = cone(crate::torus([2.0, 1.0], [5, 4]).unwrap());
        assert_eq!(pinched.check_manifold(), Err(MeshError::Pinched(Places(vec![vec![apex]]))));
    }

    #[test]
    fn lines_branch_nowhere() {
        let path = Mesh::new(points(3), vec![[0, 1], [1, 2]]).unwrap();
        assert_eq!(path.check_manifold(), Ok(()));
        let star = Mesh::new(points(4), vec![[0, 1], [0, 2], [0, 3]]).unwrap();
        assert_eq!(star.check_manifold(), Err(MeshError::NonManifold(Places(vec![vec![0]]))));
    }
}
