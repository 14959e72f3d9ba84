//! The pieces of a mesh that share no vertex.

use crate::mesh::Mesh;

/// Which piece each simplex belongs to. Pieces are numbered in the order of their first simplices.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Components {
    /// The piece of each simplex.
    pub of_simplices: Vec<usize>,
    /// The first simplex of each piece.
    pub first_simplices: Vec<usize>,
}

impl<const D: usize, const K: usize> Mesh<D, K> {
    /// The connected components.
    pub fn components(&self) -> Components {
        let mut roots: Vec<usize> = (0..self.vertices().len()).collect();
        for simplex in self.simplices() {
            for &vertex in &simplex[1..] {
                let (a, b) = (root(&mut roots, simplex[0]), root(&mut roots, vertex));
                // The smaller number leads, whatever the order of the simplices.
                roots[a.max(b)] = a.min(b);
            }
        }
        let mut numbers = vec![usize::MAX; self.vertices().len()];
        let (mut of_simplices, mut first_simplices) = (Vec::new(), Vec::new());
        for (number, simplex) in self.simplices().iter().enumerate() {
            let root = root(&mut roots, simplex[0]);
            if numbers[root] == usize::MAX {
                numbers[root] = first_simplices.len();
                first_simplices.push(number);
            }
            of_simplices.push(numbers[root]);
        }
        Components { of_simplices, first_simplices }
    }
}

/// The leader of a vertex's set; the way to it is halved.
fn root(roots: &mut [usize], mut vertex: usize) -> usize {
    while roots[vertex] != vertex {
        roots[vertex] = roots[roots[vertex]];
        vertex = roots[vertex];
    }
    vertex
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector1;

    #[test]
    fn pieces_are_numbered_by_their_first_simplices() {
        let vertices = (0..7).map(|k| Vector1::new(f64::from(k))).collect();
        let segments = vec![[5, 6], [0, 1], [4, 5], [1, 2]];
        let mesh = Mesh::new(vertices, segments).unwrap();
        let components = mesh.components();
        assert_eq!(components.of_simplices, [0, 1, 0, 1]);
        assert_eq!(components.first_simplices, [0, 1]);
    }

    #[test]
    fn a_mesh_without_simplices_has_no_pieces() {
        let mesh = Mesh::<1, 2>::new(vec![Vector1::new(0.0)], vec![]).unwrap();
        assert!(mesh.components().first_simplices.is_empty());
    }
}
