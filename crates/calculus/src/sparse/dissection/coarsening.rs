//! Coarsening: pairs of nodes that heavy edges join become one node.

use super::graph::Graph;
use stationary_measure::SplitMix64;

/// Below this many nodes a graph is small enough to be separated directly.
const SMALL: usize = 80;

/// A step that keeps more than this share of the nodes is not worth taking.
const LEAST_GAIN: f64 = 0.95;

/// The graph at half its size or a little more, and which coarse node each node is part of; `None`
/// where it is small, or does not shrink.
pub(super) fn coarsened(graph: &Graph, random: &mut SplitMix64) -> Option<(Graph, Vec<u32>)> {
    if graph.len() <= SMALL {
        return None;
    }
    const UNMATCHED: u32 = u32::MAX;
    let heaviest = (3 * graph.weight() / (2 * SMALL as u64)).max(2);
    let mut class_of = vec![UNMATCHED; graph.len()];
    let mut classes = 0_u32;
    for v in visiting_order(graph, random) {
        let v = v as usize;
        if class_of[v] != UNMATCHED {
            continue;
        }
        let fits = |u: usize| u64::from(graph.weights[v]) + u64::from(graph.weights[u]) <= heaviest;
        let partner = graph
            .edges_of(v)
            .filter(|&(u, _)| class_of[u] == UNMATCHED && fits(u))
            .max_by_key(|&(u, weight)| (weight, std::cmp::Reverse(graph.weights[u])));
        class_of[v] = classes;
        if let Some((u, _)) = partner {
            class_of[u] = classes;
        }
        classes += 1;
    }
    let shrinks = f64::from(classes) <= LEAST_GAIN * graph.len() as f64;
    shrinks.then(|| (graph.contracted(&class_of, classes as usize), class_of))
}

/// Nodes of few neighbours first, else at random.
fn visiting_order(graph: &Graph, random: &mut SplitMix64) -> Vec<u32> {
    let degree = |v: usize| graph.starts[v + 1] - graph.starts[v];
    let mut order: Vec<(u32, u64, u32)> =
        (0..graph.len()).map(|v| ((degree(v) + 1).ilog2(), random.bits(), v as u32)).collect();
    order.sort_unstable();
    order.into_iter().map(|(_, _, v)| v).collect()
}
