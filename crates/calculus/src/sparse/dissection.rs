//! Nested dissection: an order of elimination that needs only the graph of the matrix.
//!
//! ```text
//! order(G) = order(A), order(B), S        S a small set of nodes that separates A from B
//! ```
//! Eliminating A fills nothing in B. On bodies in space the factor that follows has less fill than that
//! of minimum degree and takes less time; on chains and small systems there is nothing to win.
//!
//! Freedoms with the same neighbours, as those of one vertex, are one node. The graph is coarsened by
//! matching along heavy edges, separated where it is small, and the separator is refined while the
//! graph grows again; pieces of few nodes are ordered by minimum degree. The same matrix always gets
//! the same order.
//! Source: Karypis and Kumar, "A fast and high quality multilevel scheme for partitioning irregular
//! graphs" (SIAM J. Sci. Comput. 20, 1998); Hendrickson and Rothberg, "Improving the run time and
//! quality of nested dissection ordering" (the same volume).

mod coarsening;
mod graph;
mod leaf;
mod separator;

use graph::Graph;
use separator::{Side, separate};

use crate::sparse::SparseError;
use stationary_measure::SplitMix64;

/// Pieces of at most this many nodes are not separated further.
const LEAF: usize = 120;

/// A separated piece may hold at most this share of the whole, or it is ordered as a leaf: the depth
/// of the recursion is bounded.
const LARGEST_SHARE: f64 = 0.9;

/// The freedoms in an order of elimination, from the columns of a matrix's lower triangle.
pub(crate) fn nested_dissection(starts: &[u32], rows: &[u32]) -> Result<Vec<u32>, SparseError> {
    let whole = Graph::of_lower_triangle(starts, rows);
    let (compressed, members) = whole.compressed();
    let mut order = Vec::with_capacity(members.len());
    let all = (0..compressed.len() as u32).collect();
    dissect(compressed, all, &mut SplitMix64::new(1), &mut order)?;
    Ok(order.into_iter().flat_map(|node| members[node as usize].iter().copied()).collect())
}

/// Appends the nodes of a graph, called `names`, in an order of elimination.
fn dissect(
    graph: Graph,
    names: Vec<u32>,
    random: &mut SplitMix64,
    order: &mut Vec<u32>,
) -> Result<(), SparseError> {
    let sides = if graph.len() <= LEAF { None } else { separate(&graph, random) };
    let share = |sides: &[Side], side| {
        let on_side = sides.iter().zip(&graph.weights).filter(|(s, _)| **s == side);
        on_side.map(|(_, &w)| f64::from(w)).sum::<f64>() / graph.weight() as f64
    };
    let useful = |sides: &Vec<Side>| {
        [Side::A, Side::B].into_iter().all(|side| share(sides, side) <= LARGEST_SHARE)
    };
    let Some(sides) = sides.filter(useful) else {
        let places = leaf::minimum_degree(&graph)?;
        order.extend(places.into_iter().map(|place| names[place as usize]));
        return Ok(());
    };
    let parts = [Side::A, Side::B].map(|side| graph.part(&sides, side));
    let separator = (0..graph.len()).filter(|&v| sides[v] == Side::Separator);
    let last: Vec<u32> = separator.map(|v| names[v]).collect();
    drop(graph);
    for (part, places) in parts {
        let part_names = places.into_iter().map(|place| names[place as usize]).collect();
        dissect(part, part_names, random, order)?;
    }
    order.extend(last);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The lower triangle of a grid of `side`^3 nodes with `freedoms` freedoms each.
    fn grid(side: usize, freedoms: usize) -> (Vec<u32>, Vec<u32>) {
        let node = |x: usize, y: usize, z: usize| x + side * (y + side * z);
        let (mut starts, mut rows) = (vec![0], Vec::new());
        for column in 0..side.pow(3) * freedoms {
            let v = column / freedoms;
            let (x, y, z) = (v % side, v / side % side, v / side / side);
            let mut neighbours = vec![v];
            neighbours.extend((x + 1 < side).then(|| node(x + 1, y, z)));
            neighbours.extend((y + 1 < side).then(|| node(x, y + 1, z)));
            neighbours.extend((z + 1 < side).then(|| node(x, y, z + 1)));
            let entries = neighbours.into_iter().flat_map(|u| u * freedoms..(u + 1) * freedoms);
            rows.extend(entries.filter(|&row| row >= column).map(|row| row as u32));
            starts.push(rows.len() as u32);
        }
        (starts, rows)
    }

    #[test]
    fn every_freedom_is_eliminated_once_and_the_order_is_the_same_every_time() {
        for (side, freedoms) in [(1, 1), (3, 3), (9, 3), (12, 1)] {
            let (starts, rows) = grid(side, freedoms);
            let order = nested_dissection(&starts, &rows).unwrap();
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.into_iter().eq(0..(side.pow(3) * freedoms) as u32));
            assert_eq!(order, nested_dissection(&starts, &rows).unwrap());
        }
    }

    #[test]
    fn the_freedoms_of_a_vertex_stay_together() {
        let (starts, rows) = grid(6, 3);
        let order = nested_dissection(&starts, &rows).unwrap();
        for vertex in order.chunks_exact(3) {
            assert!(vertex.iter().all(|freedom| freedom / 3 == vertex[0] / 3), "{vertex:?}");
        }
    }

    #[test]
    fn what_is_eliminated_last_separates_the_rest() {
        let side = 12;
        let (starts, rows) = grid(side, 1);
        let graph = Graph::of_lower_triangle(&starts, &rows);
        let sides = separate(&graph, &mut SplitMix64::new(1)).unwrap();
        for v in 0..graph.len() {
            for u in graph.neighbours(v) {
                let (a, b) = (sides[v], sides[u]);
                assert!(a == b || a == Side::Separator || b == Side::Separator);
            }
        }
        // The smallest separator of a cube into halves is a plane.
        let size = sides.iter().filter(|&&side| side == Side::Separator).count();
        assert!(size <= side * side * 5 / 4, "{size}");
    }

    #[test]
    fn matrices_that_cannot_be_separated_are_ordered_all_the_same() {
        let n = 300_u32;
        let full: Vec<u32> = (0..n).flat_map(|j| j..n).collect();
        let starts: Vec<u32> = (0..=n)
            .scan(0, |sum, j| {
                let start = *sum;
                *sum += n - j.min(n);
                Some(start)
            })
            .collect();
        assert_eq!(nested_dissection(&starts, &full).unwrap().len(), n as usize);
        let diagonal: Vec<u32> = (0..n).collect();
        let starts: Vec<u32> = (0..=n).collect();
        assert_eq!(nested_dissection(&starts, &diagonal).unwrap().len(), n as usize);
    }
}
