//! A mesh: vertices, and the simplices that name them.
//!
//! ```text
//! x_a in R^D, a = 0 ... V-1          s = (a_1 ... a_K), K = 2 segments, 3 triangles, 4 tetrahedra
//! ```
//! `x_a` a vertex (m), `K` the corners of a simplex, one more than its dimension, which is at
//! most D. A mesh is checked when it is made: coordinates finite and at most 1e50 in size,
//! vertices that exist, no vertex twice in a simplex. It may still be open, folded, badly shaped
//! or in pieces: those are questions, and their functions are in the files that follow.

use nalgebra::SVector;

use crate::{MeshError, Places};

/// Segments (`K` = 2), triangles (3) or tetrahedra (4) with vertices in `D` dimensions.
#[derive(Clone, Debug, PartialEq)]
pub struct Mesh<const D: usize, const K: usize> {
    vertices: Vec<SVector<f64, D>>,
    simplices: Vec<[usize; K]>,
}

/// A mesh cut out of another one.
#[derive(Clone, Debug, PartialEq)]
pub struct Part<const D: usize, const K: usize> {
    /// The piece, with vertices numbered anew in their old order.
    pub mesh: Mesh<D, K>,
    /// The old number of each of its vertices.
    pub vertices: Vec<usize>,
}

/// Coordinates beyond this have volumes that leave the range of f64.
pub(crate) const FARTHEST: f64 = 1e50;

impl<const D: usize, const K: usize> Mesh<D, K> {
    /// A mesh of these vertices and simplices.
    ///
    /// # Errors
    /// [`MeshError::NonFinite`], [`MeshError::TooFar`], [`MeshError::NoSuchVertex`] and
    /// [`MeshError::RepeatedVertex`].
    pub fn new(
        vertices: Vec<SVector<f64, D>>,
        simplices: Vec<[usize; K]>,
    ) -> Result<Self, MeshError> {
        const { assert!(1 <= D && D <= 3 && 2 <= K && K <= D + 1, "no such simplices") };
        check_vertices(&vertices)?;
        check_corners(&simplices, vertices.len())?;
        Ok(Mesh { vertices, simplices })
    }

    /// What is known to be right: images of valid meshes under maps that keep them so.
    pub(crate) fn known(vertices: Vec<SVector<f64, D>>, simplices: Vec<[usize; K]>) -> Self {
        Mesh { vertices, simplices }
    }

    /// The vertices.
    pub fn vertices(&self) -> &[SVector<f64, D>] {
        &self.vertices
    }

    /// The simplices, each by the numbers of its vertices.
    pub fn simplices(&self) -> &[[usize; K]] {
        &self.simplices
    }

    /// The corners of a simplex of this mesh.
    ///
    /// # Panics
    /// For a simplex of another mesh that names a vertex that this one has not: it is an index.
    #[inline]
    pub fn corners(&self, simplex: &[usize; K]) -> [SVector<f64, D>; K] {
        std::array::from_fn(|k| self.vertices[simplex[k]])
    }

    /// The mesh with each vertex moved by a map, simplices as they are.
    ///
    /// # Errors
    /// [`MeshError::NonFinite`] and [`MeshError::TooFar`], where the map sends a vertex astray.
    pub fn mapped<const E: usize>(
        &self,
        map: impl FnMut(&SVector<f64, D>) -> SVector<f64, E>,
    ) -> Result<Mesh<E, K>, MeshError> {
        const { assert!(1 <= E && E <= 3 && K <= E + 1, "no such simplices") };
        let vertices: Vec<_> = self.vertices.iter().map(map).collect();
        check_vertices(&vertices)?;
        Ok(Mesh { vertices, simplices: self.simplices.clone() })
    }

    /// Both meshes side by side, the other's vertices numbered after these; none are merged.
    #[must_use]
    pub fn beside(&self, other: &Self) -> Self {
        let offset = self.vertices.len();
        let moved = other.simplices.iter().map(|simplex| simplex.map(|vertex| vertex + offset));
        Mesh {
            vertices: [&self.vertices[..], &other.vertices[..]].concat(),
            simplices: self.simplices.iter().copied().chain(moved).collect(),
        }
    }

    /// Every simplex turned over.
    #[must_use]
    pub fn reversed(&self) -> Self {
        let turned = self.simplices.iter().map(|&simplex| {
            let mut simplex = simplex;
            simplex.swap(0, 1);
            simplex
        });
        Mesh { vertices: self.vertices.clone(), simplices: turned.collect() }
    }

    /// Numbers of the vertices that no simplex names.
    pub fn unreferenced(&self) -> Vec<usize> {
        let used = used(self.vertices.len(), &self.simplices);
        (0..self.vertices.len()).filter(|&vertex| !used[vertex]).collect()
    }

    /// An error that lists the vertices that no simplex names.
    ///
    /// # Errors
    /// [`MeshError::Unreferenced`].
    pub fn check_referenced(&self) -> Result<(), MeshError> {
        Places::refuse(self.unreferenced(), MeshError::Unreferenced)
    }

    /// The mesh without the vertices that no simplex names.
    pub fn referenced(&self) -> Part<D, K> {
        part(&self.vertices, &self.simplices)
    }
}

/// These simplices with only the vertices that they name.
pub(crate) fn part<const D: usize, const K: usize>(
    vertices: &[SVector<f64, D>],
    simplices: &[[usize; K]],
) -> Part<D, K> {
    let used = used(vertices.len(), simplices);
    let kept: Vec<usize> = (0..vertices.len()).filter(|&vertex| used[vertex]).collect();
    let mut renumbered = vec![0; vertices.len()];
    for (new, &old) in kept.iter().enumerate() {
        renumbered[old] = new;
    }
    let simplices = simplices.iter().map(|simplex| simplex.map(|vertex| renumbered[vertex]));
    let mesh = Mesh {
        vertices: kept.iter().map(|&old| vertices[old]).collect(),
        simplices: simplices.collect(),
    };
    Part { mesh, vertices: kept }
}

fn used<const K: usize>(vertices: usize, simplices: &[[usize; K]]) -> Vec<bool> {
    let mut used = vec![false; vertices];
    for &vertex in simplices.iter().flatten() {
        used[vertex] = true;
    }
    used
}

/// An error at the first coordinate that is not a number or out of range.
pub(crate) fn check_vertices<const D: usize>(
    vertices: &[SVector<f64, D>],
) -> Result<(), MeshError> {
    for (vertex, place) in vertices.iter().enumerate() {
        for (component, &value) in place.iter().enumerate() {
            if !value.is_finite() {
                return Err(MeshError::NonFinite { vertex, component, value });
            }
            if value.abs() > FARTHEST {
                return Err(MeshError::TooFar { vertex, component, value, limit: FARTHEST });
            }
        }
    }
    Ok(())
}

/// An error at the first vertex that does not exist, or at all simplices that name one twice.
pub(crate) fn check_corners<const K: usize>(
    simplices: &[[usize; K]],
    vertices: usize,
) -> Result<(), MeshError> {
    for (simplex, corners) in simplices.iter().enumerate() {
        if let Some(&vertex) = corners.iter().find(|&&vertex| vertex >= vertices) {
            return Err(MeshError::NoSuchVertex { simplex, vertex, vertices });
        }
    }
    let repeats = |corners: &[usize; K]| (1..K).any(|k| corners[..k].contains(&corners[k]));
    let numbered = simplices.iter().enumerate();
    let bad = numbered.filter(|(_, corners)| repeats(corners)).map(|(simplex, _)| simplex);
    Places::refuse(bad.collect(), MeshError::RepeatedVertex)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn corner() -> Vec<Vector2<f64>> {
        vec![Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0), Vector2::new(0.0, 1.0)]
    }

    #[test]
    fn bad_input_is_named() {
        let mut vertices = corner();
        vertices[2].y = f64::NAN;
        let error = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap_err();
        assert!(matches!(error, MeshError::NonFinite { vertex: 2, component: 1, .. }));
        let mut vertices = corner();
        vertices[1].x = -1e51;
        let error = Mesh::new(vertices, vec![[0, 1, 2]]).unwrap_err();
        assert!(matches!(error, MeshError::TooFar { vertex: 1, component: 0, .. }));
        let error = Mesh::new(corner(), vec![[0, 1, 2], [0, 1, 3]]).unwrap_err();
        assert_eq!(error, MeshError::NoSuchVertex { simplex: 1, vertex: 3, vertices: 3 });
        let error = Mesh::new(corner(), vec![[0, 1, 0], [0, 1, 2], [2, 1, 1]]).unwrap_err();
        assert_eq!(error, MeshError::RepeatedVertex(Places(vec![0, 2])));
    }

    #[test]
    fn unreferenced_vertices_are_listed_and_dropped_on_request() {
        let mut vertices = corner();
        vertices.insert(1, Vector2::new(9.0, 9.0));
        let mesh = Mesh::new(vertices, vec![[0, 2, 3]]).unwrap();
        assert_eq!(mesh.check_referenced(), Err(MeshError::Unreferenced(Places(vec![1]))));
        let part = mesh.referenced();
        assert_eq!(part.vertices, [0, 2, 3]);
        assert_eq!(part.mesh, Mesh::new(corner(), vec![[0, 1, 2]]).unwrap());
        assert_eq!(part.mesh.check_referenced(), Ok(()));
    }

    #[test]
    fn meshes_stand_beside_each_other_without_sharing() {
        let mesh = Mesh::new(corner(), vec![[0, 1, 2]]).unwrap();
        let two = mesh.beside(&mesh.reversed());
        assert_eq!(two.vertices().len(), 6);
        assert_eq!(two.simplices(), [[0, 1, 2], [4, 3, 5]]);
    }
}
