//! Edges, numbered once, and which simplices meet at a vertex.
//!
//! ```text
//! e = (a, b), a < b, in rising order      simplex -> its edges      vertex -> its simplices
//! ```
//! `a b` vertex numbers. All orders are those of the numbers, so that the same mesh gives the same
//! lists on every machine.

use crate::buckets::sorted_by_bucket;
use crate::mesh::Mesh;
use crate::simplex::Simplex;

/// The edges of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Edges<E> {
    /// The ends of each edge, the smaller number first, in rising order.
    pub ends: Vec<[usize; 2]>,
    /// For each simplex the numbers of its edges, in the order of [`Simplex::EDGES`].
    pub of_simplices: Vec<E>,
}

/// For each of a number of things, a list of others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency {
    starts: Vec<usize>,
    others: Vec<usize>,
}

impl Adjacency {
    /// The others that belong to a thing, in rising order; `None` where there is no such thing.
    pub fn get(&self, thing: usize) -> Option<&[usize]> {
        (thing < self.len()).then(|| self.of(thing))
    }

    /// The others that belong to a thing that there is.
    pub(crate) fn of(&self, thing: usize) -> &[usize] {
        &self.others[self.starts[thing]..self.starts[thing + 1]]
    }

    /// How many things there are.
    pub fn len(&self) -> usize {
        self.starts.len() - 1
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Things below `count`, each with the seconds of its pairs in rising order, none twice.
    fn of_pairs(count: usize, pairs: &[(usize, usize)]) -> Self {
        let mut pairs = sorted_by_bucket(count, pairs, |pair| pair.0);
        pairs.dedup();
        let mut starts = vec![0; count + 1];
        for &(thing, _) in &pairs {
            starts[thing + 1] += 1;
        }
        for thing in 0..count {
            starts[thing + 1] += starts[thing];
        }
        Adjacency { starts, others: pairs.into_iter().map(|(_, other)| other).collect() }
    }
}

impl<const D: usize, const K: usize> Mesh<D, K>
where
    [usize; K]: Simplex,
{
    /// The edges of the mesh, each once.
    pub fn edges(&self) -> Edges<<[usize; K] as Simplex>::Edges> {
        let mut uses: Vec<([usize; 2], usize, usize)> = Vec::new();
        for (number, simplex) in self.simplices().iter().enumerate() {
            for (edge, &[i, j]) in <[usize; K]>::EDGES.iter().enumerate() {
                let (a, b) = (simplex[i], simplex[j]);
                uses.push(([a.min(b), a.max(b)], number, edge));
            }
        }
        let uses = sorted_by_bucket(self.vertices().len(), &uses, |edge| edge.0[0]);
        let mut ends = Vec::new();
        let mut of_simplices = vec![Default::default(); self.simplices().len()];
        for shared in uses.chunk_by(|a, b| a.0 == b.0) {
            for &(_, simplex, edge) in shared {
                let edges: &mut <[usize; K] as Simplex>::Edges = &mut of_simplices[simplex];
                edges.as_mut()[edge] = ends.len();
            }
            ends.push(shared[0].0);
        }
        Edges { ends, of_simplices }
    }

    /// For each vertex, the simplices that name it.
    pub fn simplices_at_vertices(&self) -> Adjacency {
        let numbered = self.simplices().iter().enumerate();
        let pairs = numbered.flat_map(|(s, corners)| corners.map(|vertex| (vertex, s)));
        Adjacency::of_pairs(self.vertices().len(), &pairs.collect::<Vec<_>>())
    }

    /// Faces of every dimension counted with alternating sign, `V - E + F - T`. Vertices that no
    /// simplex names are not counted. A sphere has 2, a torus 0, a disc or a ball 1.
    pub fn euler_characteristic(&self) -> i64 {
        let vertices = self.vertices().len() - self.unreferenced().len();
        let edges = self.edges().ends.len();
        let facets = self.facet_uses().chunk_by(|a, b| a.facet == b.facet).count();
        let simplices = self.simplices().len();
        let counts: &[usize] = match K {
            2 => &[vertices, simplices],
            3 => &[vertices, edges, simplices],
            _ => &[vertices, edges, facets, simplices],
        };
        let signed = counts.iter().enumerate();
        signed.map(|(k, &count)| if k % 2 == 0 { count as i64 } else { -(count as i64) }).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Vector2, Vector3};

    fn square() -> Mesh<2, 3> {
        let vertices = vec![Vector2::zeros(), Vector2::x(), Vector2::new(1.0, 1.0), Vector2::y()];
        Mesh::new(vertices, vec![[2, 3, 0], [0, 1, 2]]).unwrap()
    }

    #[test]
    fn edges_are_listed_once_and_simplices_know_theirs() {
        let edges = square().edges();
        assert_eq!(edges.ends, [[0, 1], [0, 2], [0, 3], [1, 2], [2, 3]]);
        assert_eq!(edges.of_simplices, [[4, 2, 1], [0, 3, 1]]);
    }

    #[test]
    fn simplices_at_a_vertex_are_in_rising_order() {
        let simplices = square().simplices_at_vertices();
        assert_eq!((simplices.len(), simplices.is_empty()), (4, false));
        assert_eq!([simplices.of(0), simplices.of(1), simplices.of(3)], [&[0, 1][..], &[1], &[0]]);
    }

    #[test]
    fn discs_and_balls_have_characteristic_one() {
        assert_eq!(square().euler_characteristic(), 1);
        let vertices = vec![Vector3::zeros(), Vector3::x(), Vector3::y(), Vector3::z()];
        let ball = Mesh::new(vertices, vec![[0, 1, 2, 3]]).unwrap();
        assert_eq!(ball.euler_characteristic(), 1);
        assert_eq!(ball.boundary().mesh.euler_characteristic(), 2);
    }
}
