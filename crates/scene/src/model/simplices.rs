//! Simplices of a mesh by the numbers of their vertices, and the nodes in the middle of their edges.

use stationary_calculus::array;
use std::collections::BTreeMap;

use serde::Serialize;
use stationary_mesh::Simplex;

/// The simplices of a shape, by the numbers of their vertices.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub enum Simplices {
    /// Of a bar.
    Segments(Vec<[usize; 2]>),
    /// Of a sheet or a surface.
    Triangles(Vec<[usize; 3]>),
    /// Of a block.
    Tetrahedra(Vec<[usize; 4]>),
}

impl Simplices {
    /// How many there are.
    pub fn len(&self) -> usize {
        match self {
            Simplices::Segments(all) => all.len(),
            Simplices::Triangles(all) => all.len(),
            Simplices::Tetrahedra(all) => all.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Those of them whose corners and middles of edges are as asked.
    #[cfg(feature = "elasticity")]
    pub(crate) fn kept(&self, middles: &Middles, keeps: impl Fn(&[usize]) -> bool) -> Self {
        fn keep<const K: usize, const N: usize>(
            all: &[[usize; K]],
            middles: &Middles,
            keeps: impl Fn(&[usize]) -> bool,
        ) -> Vec<[usize; K]>
        where
            [usize; K]: Simplex,
        {
            let nodes = with_middles::<K, N>(all, middles);
            let kept = all.iter().zip(nodes).filter(|(_, nodes)| keeps(nodes));
            kept.map(|(corners, _)| *corners).collect()
        }
        match self {
            Simplices::Segments(all) => Simplices::Segments(keep::<2, 3>(all, middles, keeps)),
            Simplices::Triangles(all) => Simplices::Triangles(keep::<3, 6>(all, middles, keeps)),
            Simplices::Tetrahedra(all) => Simplices::Tetrahedra(keep::<4, 10>(all, middles, keeps)),
        }
    }

    /// The same simplices of vertices that are numbered from `first`.
    pub(crate) fn shifted(&self, first: usize) -> Self {
        fn shift<const K: usize>(all: &[[usize; K]], first: usize) -> Vec<[usize; K]> {
            all.iter().map(|corners| corners.map(|vertex| first + vertex)).collect()
        }
        match self {
            Simplices::Segments(all) => Simplices::Segments(shift(all, first)),
            Simplices::Triangles(all) => Simplices::Triangles(shift(all, first)),
            Simplices::Tetrahedra(all) => Simplices::Tetrahedra(shift(all, first)),
        }
    }
}

/// The node in the middle of each edge, by the edge's ends, the smaller number first; none where
/// elements are linear.
pub type Middles = BTreeMap<[usize; 2], usize>;

/// The node in the middle of the edge between two corners.
pub(crate) fn middle(middles: &Middles, [a, b]: [usize; 2]) -> Option<usize> {
    middles.get(&[a.min(b), a.max(b)]).copied()
}

/// The corners of simplices and the nodes in the middle of their edges; a node that is not there has
/// the largest number there is.
pub(crate) fn with_middles<const K: usize, const N: usize>(
    simplices: &[[usize; K]],
    middles: &Middles,
) -> Vec<[usize; N]>
where
    [usize; K]: Simplex,
{
    let node = |corners: &[usize; K], number: usize| match number.checked_sub(K) {
        None => corners[number],
        Some(edge) => {
            let ends = <[usize; K]>::EDGES[edge].map(|end| corners[end]);
            middle(middles, ends).unwrap_or(usize::MAX)
        }
    };
    simplices.iter().map(|corners| array(|k| node(corners, k))).collect()
}
