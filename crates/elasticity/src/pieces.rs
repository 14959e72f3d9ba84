//! The pieces of a body: vertices that elements join, however many elements away.
//!
//! ```text
//! leader[v] <= v,   a leader leads itself;   an element gives its nodes one leader, the lowest
//! ```
//! A body of several pieces needs supports for each. Source: union-find, Tarjan (1975).

use crate::{Material, Solid};

impl<M: Material<D, R>, const N: usize, const D: usize, const R: usize, const Q: usize>
    Solid<M, N, D, R, Q>
{
    /// Which of the body's pieces each vertex belongs to, from 0 in the order of their first
    /// vertices: elements join what they share, and a vertex without elements is a piece of its
    /// own.
    pub(crate) fn pieces(&self) -> Vec<usize> {
        let starts: Vec<u32> =
            (0..self.freedoms().vertices()).map(|vertex| self.freedoms().start(vertex)).collect();
        let most = starts.iter().max().map_or(0, |&most| most as usize + 1);
        let mut leader: Vec<u32> = (0..most as u32).collect();
        for nodes in self.groups.iter().flat_map(|group| &group.nodes) {
            for &node in &nodes[1..] {
                let (a, b) = (leading(&mut leader, nodes[0]), leading(&mut leader, node));
                leader[a.max(b) as usize] = a.min(b);
            }
        }
        let (mut numbers, mut count) = (vec![usize::MAX; most], 0);
        let number = |start: &u32| {
            let number = &mut numbers[leading(&mut leader, *start) as usize];
            if *number == usize::MAX {
                *number = count;
                count += 1;
            }
            *number
        };
        starts.iter().map(number).collect()
    }
}

/// The leader of a node's piece; the way to it is shortened.
fn leading(leader: &mut [u32], mut node: u32) -> u32 {
    while leader[node as usize] != node {
        leader[node as usize] = leader[leader[node as usize] as usize];
        node = leader[node as usize];
    }
    node
}
