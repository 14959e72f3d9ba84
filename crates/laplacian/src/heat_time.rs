//! How long to let heat flow before distances are read from it.
//!
//! ```text
//! t = max(h^2, (d / 600)^2)
//! ```
//! `h` mean edge length and `d` how far apart vertices of one piece are along edges, metres; `t` in
//! m^2. Heat falls like `exp(-distance / sqrt t)`: with the square of the mean edge alone, the usual
//! choice, it is no number any more where a surface is longer than some 690 edges. The longest way
//! is measured from the vertex of each piece that is farthest from its first one: never less than
//! half of the longest, and on long surfaces all of it. Beyond Crane, Weischedel and Wardetzky 2013.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use stationary_mesh::IntrinsicSurface;

/// Heat is a number up to this many times `sqrt t` away, and some more.
const REACH: f64 = 600.0;

/// The heat time that suits a surface, m^2.
pub(crate) fn advised(surface: &IntrinsicSurface) -> f64 {
    let count = (3 * surface.lengths().len()).max(1) as f64;
    let mean = surface.lengths().as_flattened().iter().sum::<f64>() / count;
    (mean * mean).max(reaching(longest_way(surface)))
}

/// The heat time in which a number arrives this far away.
pub(crate) fn reaching(distance: f64) -> f64 {
    (distance / REACH).powi(2)
}

/// How far two vertices of one piece are apart along edges, about the most.
fn longest_way(surface: &IntrinsicSurface) -> f64 {
    let edges = edges(surface);
    let mut ways = vec![f64::INFINITY; surface.vertices()];
    let mut longest = 0.0_f64;
    for vertex in 0..surface.vertices() {
        if ways[vertex].is_finite() {
            continue;
        }
        let reached = reach(&edges, vertex, &mut ways);
        let end = reached.last().copied().unwrap_or(vertex);
        reached.into_iter().for_each(|vertex| ways[vertex] = f64::INFINITY);
        let last = reach(&edges, end, &mut ways).last().copied().unwrap_or(end);
        longest = longest.max(ways[last]);
    }
    longest
}

/// For each vertex its neighbours along edges and how far they are.
fn edges(surface: &IntrinsicSurface) -> Vec<Vec<(usize, f64)>> {
    let mut edges = vec![Vec::new(); surface.vertices()];
    for (corners, lengths) in surface.triangles().iter().zip(surface.lengths()) {
        for (k, &length) in lengths.iter().enumerate() {
            let [a, b] = [corners[k], corners[(k + 1) % 3]];
            edges[a].push((b, length));
            edges[b].push((a, length));
        }
    }
    edges
}

/// Writes the shortest way along edges from one vertex to each of its piece (Dijkstra), where the
/// ways were infinite; the vertices of the piece, the farthest last.
fn reach(edges: &[Vec<(usize, f64)>], from: usize, ways: &mut [f64]) -> Vec<usize> {
    let mut reached = Vec::new();
    ways[from] = 0.0;
    // The bits of numbers that are not negative are in the order of the numbers.
    let mut queue = BinaryHeap::from([Reverse((0_u64, from))]);
    while let Some(Reverse((bits, vertex))) = queue.pop() {
        let way = f64::from_bits(bits);
        if way > ways[vertex] {
            continue;
        }
        reached.push(vertex);
        for &(next, length) in &edges[vertex] {
            if way + length < ways[next] {
                ways[next] = way + length;
                queue.push(Reverse((ways[next].to_bits(), next)));
            }
        }
    }
    reached
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GeodesicDistance, LaplacianError};
    use stationary_mesh::{Diagonals, icosphere, rectangle};

    #[test]
    fn on_a_surface_of_few_edges_the_square_of_their_mean_is_advised() {
        let surface = IntrinsicSurface::of(&icosphere(2.0, 2).unwrap()).unwrap();
        let lengths = surface.lengths().as_flattened();
        let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
        assert_eq!(advised(&surface), mean * mean);
    }

    #[test]
    fn along_a_thousand_and_a_half_edges_the_advised_time_arrives_and_a_shorter_one_does_not() {
        let cells = 1500;
        let strip = rectangle([cells as f64, 2.0], [cells, 2], Diagonals::Alternating).unwrap();
        let surface = IntrinsicSurface::of(&strip).unwrap();
        let time = advised(&surface);
        assert!((time.sqrt() * REACH / cells as f64 - 1.0).abs() < 0.01, "{time}");
        // From one end, and from the middle on.
        for source in [0, cells / 2] {
            let found = GeodesicDistance::new(&surface, time).unwrap().from(&[source]).unwrap();
            let far = found.distance[cells];
            assert!((far / (cells - source) as f64 - 1.0).abs() < 0.02, "{source}: {far}");
        }
        let short = GeodesicDistance::new(&surface, 1.0).unwrap().from(&[0]);
        assert!(matches!(short, Err(LaplacianError::Underflow { .. })));
    }

    #[test]
    fn pieces_are_measured_each_by_itself() {
        let near = rectangle([3.0, 1.0], [3, 1], Diagonals::Same).unwrap();
        let far = near.mapped(|x| x.add_scalar(1e6)).unwrap();
        let two = IntrinsicSurface::of(&near.beside(&far)).unwrap();
        let one = IntrinsicSurface::of(&near).unwrap();
        assert_eq!(longest_way(&two), longest_way(&one));
        assert!(longest_way(&one) >= 2.0 + 2.0_f64.sqrt());
    }
}
