//! Shortest paths on a surface by a graph with many points on each edge.

use std::cmp::Reverse;
use std::collections::{BTreeMap, BinaryHeap};

use nalgebra::Vector3;

use super::shapes::Shape;

/// A point of the graph: a vertex, or part of the way along an edge.
#[derive(Clone, Copy)]
struct Node {
    ends: [usize; 2],
    part: f64,
}

/// Shortest paths whose bends are among this many points on each edge (Dijkstra), and the same once
/// their bends have slid along their edges to where the path is straight. Never too short.
pub fn through_edges(
    shape: &Shape<3>,
    points: usize,
    sources: &[usize],
) -> (Vec<f64>, Vec<(f64, bool)>) {
    let mut nodes: Vec<Node> =
        (0..shape.vertices.len()).map(|v| Node { ends: [v, v], part: 0.0 }).collect();
    let mut on_edges = BTreeMap::<[usize; 2], Vec<usize>>::new();
    let mut in_triangles: Vec<Vec<usize>> = Vec::new();
    for &[a, b, c] in &shape.simplices {
        let mut inside = vec![a, b, c];
        for [u, v] in [[a, b], [b, c], [c, a]] {
            let ends = [u.min(v), u.max(v)];
            let inner = on_edges.entry(ends).or_insert_with(|| {
                let first = nodes.len();
                let part = |k: usize| k as f64 / (points + 1) as f64;
                nodes.extend((1..=points).map(|k| Node { ends, part: part(k) }));
                (first..first + points).collect()
            });
            inside.extend(inner.iter());
        }
        in_triangles.push(inside);
    }
    let mut at_nodes = vec![Vec::new(); nodes.len()];
    for (triangle, inside) in in_triangles.iter().enumerate() {
        inside.iter().for_each(|&node| at_nodes[node].push(triangle));
    }
    let place = |node: &Node| {
        let [x, y] = node.ends.map(|v| shape.vertices[v]);
        x + (y - x) * node.part
    };
    let places: Vec<Vector3<f64>> = nodes.iter().map(place).collect();
    let mut ways = vec![(f64::INFINITY, usize::MAX); nodes.len()];
    let mut queue = BinaryHeap::new();
    for &source in sources {
        ways[source].0 = 0.0;
        queue.push(Reverse((0_u64, source)));
    }
    while let Some(Reverse((bits, node))) = queue.pop() {
        if f64::from_bits(bits) > ways[node].0 {
            continue;
        }
        for &triangle in &at_nodes[node] {
            for &next in &in_triangles[triangle] {
                let way = ways[node].0 + (places[next] - places[node]).norm();
                if way < ways[next].0 {
                    ways[next] = (way, node);
                    queue.push(Reverse((way.to_bits(), next)));
                }
            }
        }
    }
    let straight = |vertex: usize| {
        let mut path = vec![nodes[vertex]];
        let mut at = ways[vertex].1;
        while at != usize::MAX {
            path.push(nodes[at]);
            at = ways[at].1;
        }
        straightened(shape, path)
    };
    let count = shape.vertices.len();
    let rough = ways[..count].iter().map(|way| way.0).collect();
    (rough, (0..count).map(straight).collect())
}

/// The length of a path whose bends slide along their edges, one after the other, and whether one of
/// them came near a vertex.
fn straightened(shape: &Shape<3>, mut path: Vec<Node>) -> (f64, bool) {
    let place = |node: &Node| {
        let [x, y] = node.ends.map(|v| shape.vertices[v]);
        x + (y - x) * node.part
    };
    for _ in 0..400 {
        for k in 1..path.len().saturating_sub(1) {
            let [x, y] = path[k].ends.map(|v| shape.vertices[v]);
            let length = (y - x).norm();
            if length == 0.0 {
                continue;
            }
            let along = (y - x) / length;
            // How far along the edge and how far from it the neighbours are.
            let [(s, g), (t, h)] = [&path[k - 1], &path[k + 1]].map(|node| {
                let off = place(node) - x;
                let part = off.dot(&along);
                (part, (off - along * part).norm())
            });
            if g + h > 0.0 {
                path[k].part = ((s + (t - s) * g / (g + h)) / length).clamp(0.0, 1.0);
            }
        }
    }
    let inner = path.get(1..path.len() - 1).unwrap_or(&[]);
    let near = |part: f64| !(0.05..=0.95).contains(&part);
    let caught = inner.iter().any(|node| near(node.part));
    (path.windows(2).map(|pair| (place(&pair[0]) - place(&pair[1])).norm()).sum(), caught)
}
