//! A simplex as a list of vertex numbers: its facets with their signs, its edges, its children.
//!
//! ```text
//! d [v0 ... vn] = sum_i (-1)^i [v0 ... vi-1 vi+1 ... vn]        its facets, each seen from outside
//! ```
//! `vi` vertex numbers; an odd permutation turns a simplex over. A sign is `+1` where the facet's
//! vertices in rising order are an even permutation of the outward ones, so that two neighbours
//! agree where their signs of the shared facet differ. The edges of a triangle are 01, 12, 20,
//! those of a tetrahedron 01, 12, 20, 03, 13, 23 (VTK's order; Gmsh swaps the last two). The
//! children are those of red refinement, a tetrahedron's octahedron cut along the diagonal 02-13
//! (Bey 1995), each with the orientation of its parent.

use std::fmt::Debug;

/// Vertex numbers of a segment, a triangle or a tetrahedron. Implemented for two, three and four of
/// them, and for nothing else.
pub trait Simplex:
    Copy + Ord + Debug + AsRef<[usize]> + AsMut<[usize]> + sealed::Sealed + 'static
{
    /// The vertex numbers of a facet.
    type Facet: Copy + Ord + Debug + AsRef<[usize]> + AsMut<[usize]>;
    /// A number for each edge.
    type Edges: Copy + Debug + PartialEq + AsRef<[usize]> + AsMut<[usize]> + Default;
    /// The corners at the ends of each edge.
    const EDGES: &'static [[usize; 2]];
    /// The children of a uniform refinement: corners first, then the midpoints of `EDGES`.
    const CHILDREN: &'static [Self];

    /// The facet opposite to a corner, its vertices in their order within the simplex.
    fn facet(&self, opposite: usize) -> Self::Facet;

    /// The same simplex turned over: its first two vertices change places.
    #[must_use]
    fn reversed(mut self) -> Self {
        self.as_mut().swap(0, 1);
        self
    }
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for [usize; 2] {}
    impl Sealed for [usize; 3] {}
    impl Sealed for [usize; 4] {}
}

impl Simplex for [usize; 2] {
    type Facet = [usize; 1];
    type Edges = [usize; 1];
    const EDGES: &'static [[usize; 2]] = &[[0, 1]];
    const CHILDREN: &'static [Self] = &[[0, 2], [2, 1]];

    fn facet(&self, opposite: usize) -> [usize; 1] {
        without(self, opposite)
    }
}

impl Simplex for [usize; 3] {
    type Facet = [usize; 2];
    type Edges = [usize; 3];
    const EDGES: &'static [[usize; 2]] = &[[0, 1], [1, 2], [2, 0]];
    const CHILDREN: &'static [Self] = &[[0, 3, 5], [3, 1, 4], [5, 4, 2], [3, 4, 5]];

    fn facet(&self, opposite: usize) -> [usize; 2] {
        without(self, opposite)
    }
}

impl Simplex for [usize; 4] {
    type Facet = [usize; 3];
    type Edges = [usize; 6];
    const EDGES: &'static [[usize; 2]] = &[[0, 1], [1, 2], [2, 0], [0, 3], [1, 3], [2, 3]];
    const CHILDREN: &'static [Self] = &[
        [0, 4, 6, 7],
        [4, 1, 5, 8],
        [6, 5, 2, 9],
        [7, 8, 9, 3],
        [4, 6, 7, 8],
        [5, 6, 4, 8],
        [6, 7, 8, 9],
        [8, 5, 6, 9],
    ];

    fn facet(&self, opposite: usize) -> [usize; 3] {
        without(self, opposite)
    }
}

fn without<const K: usize, const F: usize>(corners: &[usize; K], opposite: usize) -> [usize; F] {
    std::array::from_fn(|k| corners[if k < opposite { k } else { k + 1 }])
}

/// Whether a facet's rising order is an even permutation of its outward order, and that rising
/// order.
pub(crate) fn signed_facet<S: Simplex>(simplex: &S, opposite: usize) -> (S::Facet, bool) {
    let mut facet = simplex.facet(opposite);
    let swaps = sort_counting_swaps(facet.as_mut());
    (facet, (swaps + opposite).is_multiple_of(2))
}

/// Sorts a handful of numbers, and tells how many swaps of neighbours that took.
fn sort_counting_swaps(numbers: &mut [usize]) -> usize {
    let mut swaps = 0;
    for end in 1..numbers.len() {
        for k in (0..end).rev() {
            if numbers[k] > numbers[k + 1] {
                numbers.swap(k, k + 1);
                swaps += 1;
            }
        }
    }
    swaps
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facets<S: Simplex>(simplex: S) -> Vec<(S::Facet, bool)> {
        let corners = simplex.as_ref().len();
        (0..corners).map(|opposite| signed_facet(&simplex, opposite)).collect()
    }

    #[test]
    fn the_boundary_of_a_boundary_is_nothing() {
        let mut sum = std::collections::BTreeMap::new();
        for (facet, sign) in facets([7, 2, 9, 4]) {
            for (edge, inner) in facets(facet) {
                *sum.entry(edge).or_insert(0) += if sign == inner { 1 } else { -1 };
            }
        }
        assert_eq!(sum.len(), 6);
        assert!(sum.values().all(|&s| s == 0));
    }

    #[test]
    fn turning_a_simplex_over_turns_every_facet_over() {
        let tetrahedron = [3, 1, 8, 5];
        let mut turned = facets(tetrahedron.reversed());
        let mut facets = facets(tetrahedron);
        facets.sort();
        turned.sort();
        for (a, b) in facets.iter().zip(&turned) {
            assert!(a.0 == b.0 && a.1 != b.1);
        }
    }

    #[test]
    fn a_segment_points_from_its_tail_to_its_head() {
        assert_eq!(facets([4, 6]), [([6], true), ([4], false)]);
    }
}
