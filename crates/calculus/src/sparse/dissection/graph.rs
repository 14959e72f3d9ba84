//! A graph with weights, and the operations on it that dissection needs.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use super::separator::Side;

/// Nodes with weights, and for each its neighbours with the weights of the edges.
#[derive(Clone, Debug)]
pub(super) struct Graph {
    pub(super) starts: Vec<u32>,
    pub(super) ends: Vec<u32>,
    pub(super) edges: Vec<u32>,
    pub(super) weights: Vec<u32>,
}

impl Graph {
    /// The graph of a symmetric matrix, from the columns of its lower triangle.
    pub(super) fn of_lower_triangle(starts: &[u32], rows: &[u32]) -> Self {
        let n = starts.len() - 1;
        let entries = || {
            (0..n).flat_map(|j| {
                let column = &rows[starts[j] as usize..starts[j + 1] as usize];
                column.iter().map(move |&i| (i as usize, j)).filter(|(i, j)| i != j)
            })
        };
        let mut degrees = vec![0; n];
        for (i, j) in entries() {
            degrees[i] += 1;
            degrees[j] += 1;
        }
        let starts = sums(&degrees);
        let mut next = starts.clone();
        let mut ends = vec![0; *starts.last().unwrap_or(&0) as usize];
        for (i, j) in entries() {
            for (from, to) in [(i, j), (j, i)] {
                ends[next[from] as usize] = to as u32;
                next[from] += 1;
            }
        }
        Graph { edges: vec![1; ends.len()], weights: vec![1; n], starts, ends }
    }

    pub(super) fn len(&self) -> usize {
        self.weights.len()
    }

    /// The weight of all nodes.
    pub(super) fn weight(&self) -> u64 {
        self.weights.iter().map(|&w| u64::from(w)).sum()
    }

    fn range(&self, v: usize) -> std::ops::Range<usize> {
        self.starts[v] as usize..self.starts[v + 1] as usize
    }

    pub(super) fn neighbours(&self, v: usize) -> impl Iterator<Item = usize> {
        self.ends[self.range(v)].iter().map(|&u| u as usize)
    }

    /// The neighbours of a node with the weights of the edges to them.
    pub(super) fn edges_of(&self, v: usize) -> impl Iterator<Item = (usize, u32)> {
        self.neighbours(v).zip(self.edges[self.range(v)].iter().copied())
    }

    /// Nodes that share all neighbours and are neighbours themselves become one; and which nodes
    /// each of the new ones consists of.
    pub(super) fn compressed(&self) -> (Graph, Vec<Vec<u32>>) {
        let mut classes: HashMap<Vec<u32>, u32> = HashMap::new();
        let mut class_of = Vec::with_capacity(self.len());
        let mut members: Vec<Vec<u32>> = Vec::new();
        for v in 0..self.len() {
            let mut closed = self.ends[self.range(v)].to_vec();
            closed.push(v as u32);
            closed.sort_unstable();
            let class = match classes.entry(closed) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => {
                    members.push(Vec::new());
                    *entry.insert(members.len() as u32 - 1)
                }
            };
            members[class as usize].push(v as u32);
            class_of.push(class);
        }
        (self.contracted(&class_of, members.len()), members)
    }

    /// The graph in which node v is part of node `class_of[v]` of `classes`.
    pub(super) fn contracted(&self, class_of: &[u32], classes: usize) -> Graph {
        let mut members = vec![Vec::new(); classes];
        for (v, &class) in class_of.iter().enumerate() {
            members[class as usize].push(v);
        }
        let mut graph = Graph {
            starts: vec![0],
            ends: Vec::new(),
            edges: Vec::new(),
            weights: Vec::with_capacity(classes),
        };
        // Where the edge to each class was put for the class under way.
        let mut place = vec![usize::MAX; classes];
        for (class, members) in members.iter().enumerate() {
            let first = graph.ends.len();
            for &v in members {
                for (u, weight) in self.edges_of(v) {
                    let to = class_of[u] as usize;
                    if to == class {
                        continue;
                    }
                    if place[to] == usize::MAX || place[to] < first {
                        place[to] = graph.ends.len();
                        graph.ends.push(to as u32);
                        graph.edges.push(weight);
                    } else {
                        graph.edges[place[to]] += weight;
                    }
                }
            }
            graph.starts.push(graph.ends.len() as u32);
            graph.weights.push(members.iter().map(|&v| self.weights[v]).sum());
        }
        graph
    }

    /// The graph of one side, and where its nodes were.
    pub(super) fn part(&self, sides: &[Side], side: Side) -> (Graph, Vec<u32>) {
        let mut new_place = vec![u32::MAX; self.len()];
        let mut places = Vec::new();
        for (v, _) in sides.iter().enumerate().filter(|(_, s)| **s == side) {
            new_place[v] = places.len() as u32;
            places.push(v as u32);
        }
        let mut part = Graph {
            starts: vec![0],
            ends: Vec::new(),
            edges: Vec::new(),
            weights: places.iter().map(|&v| self.weights[v as usize]).collect(),
        };
        for &v in &places {
            for (u, weight) in self.edges_of(v as usize) {
                if new_place[u] != u32::MAX {
                    part.ends.push(new_place[u]);
                    part.edges.push(weight);
                }
            }
            part.starts.push(part.ends.len() as u32);
        }
        (part, places)
    }
}

/// 0, and the sums of the first 1, 2, ... numbers.
fn sums(numbers: &[u32]) -> Vec<u32> {
    let running = numbers.iter().scan(0, |sum, x| {
        *sum += x;
        Some(*sum)
    });
    std::iter::once(0).chain(running).collect()
}
