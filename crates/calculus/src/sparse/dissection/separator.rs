//! Separators: few nodes whose removal leaves two parts without an edge between them.
//!
//! ```text
//! gain of moving v from S to A = weight(v) - weight of v's neighbours in B, which enter S
//! ```
//! Found on the coarsest graph by growing a region from a random node until it holds half; improved
//! on every finer one by moves of the largest gain, each node at most once in a pass, and back to the
//! best state that was seen (Fiduccia and Mattheyses, on nodes).

use std::collections::BinaryHeap;

use super::coarsening::coarsened;
use super::graph::Graph;
use stationary_measure::SplitMix64;

/// Where a node is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    A,
    B,
    Separator,
}

/// Neither part may be heavier than this share of the whole.
const BALANCE: f64 = 0.6;
/// Regions that are grown on the coarsest graph.
const TRIES: u32 = 8;
/// Passes of refinement on one graph.
const PASSES: u32 = 8;
/// Moves without improvement after which a pass ends.
const PATIENCE: u32 = 150;

/// The side of every node, or `None` where no separator leaves two parts.
pub(super) fn separate(graph: &Graph, random: &mut SplitMix64) -> Option<Vec<Side>> {
    let mut finer = Vec::new();
    let mut coarsest = None;
    while let Some((coarse, class_of)) = coarsened(coarsest.as_ref().unwrap_or(graph), random) {
        finer.push((coarsest.replace(coarse), class_of));
    }
    let mut sides = initial(coarsest.as_ref().unwrap_or(graph), random)?;
    while let Some((fine, class_of)) = finer.pop() {
        sides = class_of.iter().map(|&class| sides[class as usize]).collect();
        Refinement::new(fine.as_ref().unwrap_or(graph), &mut sides).run();
    }
    Some(sides)
}

/// The best separator around regions grown from random nodes.
fn initial(graph: &Graph, random: &mut SplitMix64) -> Option<Vec<Side>> {
    let mut best: Option<((u64, u64), Vec<Side>)> = None;
    for _ in 0..TRIES {
        let mut sides = grown(graph, (random.bits() % graph.len() as u64) as usize);
        let score = Refinement::new(graph, &mut sides).run();
        let parts = [Side::A, Side::B].into_iter().all(|side| sides.contains(&side));
        if parts && best.as_ref().is_none_or(|(least, _)| score < *least) {
            best = Some((score, sides));
        }
    }
    best.map(|(_, sides)| sides)
}

/// A region about a node with half of the weight, and its border as separator.
fn grown(graph: &Graph, start: usize) -> Vec<Side> {
    let mut sides = vec![Side::B; graph.len()];
    let mut reached = vec![false; graph.len()];
    let (mut queue, mut weight) = (std::collections::VecDeque::new(), 0);
    // A region that has no more neighbours goes on elsewhere: the graph may fall into pieces.
    let mut elsewhere = (0..graph.len()).map(|v| (start + v) % graph.len());
    while 2 * weight < graph.weight() {
        let next = queue.pop_front().or_else(|| elsewhere.by_ref().find(|&v: &usize| !reached[v]));
        let Some(v) = next else { break };
        reached[v] = true;
        sides[v] = Side::A;
        weight += u64::from(graph.weights[v]);
        for u in graph.neighbours(v).filter(|&u| !std::mem::replace(&mut reached[u], true)) {
            queue.push_back(u);
        }
    }
    for v in 0..graph.len() {
        if sides[v] == Side::B && graph.neighbours(v).any(|u| sides[u] == Side::A) {
            sides[v] = Side::Separator;
        }
    }
    sides
}

/// A separator being improved.
struct Refinement<'a> {
    graph: &'a Graph,
    sides: &'a mut Vec<Side>,
    /// Weights of A, B and the separator.
    weights: [u64; 3],
    heaviest: u64,
    /// Of the separator's nodes the gain of moving to A, and to B.
    gains: [Vec<i64>; 2],
    /// The same nodes by their gains; old entries are skipped.
    queues: [BinaryHeap<(i64, u32)>; 2],
    locked: Vec<bool>,
}

const PARTS: [Side; 2] = [Side::A, Side::B];

impl<'a> Refinement<'a> {
    fn new(graph: &'a Graph, sides: &'a mut Vec<Side>) -> Self {
        let mut weights = [0; 3];
        for (side, &weight) in sides.iter().zip(&graph.weights) {
            weights[*side as usize] += u64::from(weight);
        }
        let heaviest = (BALANCE * graph.weight() as f64) as u64;
        let (locked, gains) = (vec![false; graph.len()], [0, 1].map(|_| vec![0; graph.len()]));
        Refinement { graph, sides, weights, heaviest, gains, queues: Default::default(), locked }
    }

    /// Improves until a pass does not, and returns what is to be small: the separator's weight, then
    /// the difference of the parts.
    fn run(&mut self) -> (u64, u64) {
        let mut score = self.score();
        for _ in 0..PASSES {
            let improved = self.pass();
            if improved >= score {
                break;
            }
            score = improved;
        }
        score
    }

    fn score(&self) -> (u64, u64) {
        let [a, b, separator] = self.weights;
        // A part that is too heavy counts as so much more separator.
        (separator + 2 * a.max(b).saturating_sub(self.heaviest), a.abs_diff(b))
    }

    fn gain(&self, v: usize, to: usize) -> i64 {
        let other = PARTS[1 - to];
        let pulled = self.graph.neighbours(v).filter(|&u| self.sides[u] == other);
        i64::from(self.graph.weights[v])
            - pulled.map(|u| i64::from(self.graph.weights[u])).sum::<i64>()
    }

    /// Works out the gains of a node that is new in the separator.
    fn enter(&mut self, v: usize) {
        for to in [0, 1] {
            self.gains[to][v] = self.gain(v, to);
            self.offer(v, to);
        }
    }

    fn offer(&mut self, v: usize, to: usize) {
        if !self.locked[v] {
            self.queues[to].push((self.gains[to][v], v as u32));
        }
    }

    /// Adds to a gain of a node, if it is in the separator.
    fn change(&mut self, v: usize, to: usize, by: i64) {
        if self.sides[v] == Side::Separator {
            self.gains[to][v] += by;
            self.offer(v, to);
        }
    }

    /// The separator node with the largest gain of moving to a part.
    fn top(&mut self, to: usize) -> Option<(i64, usize)> {
        loop {
            let &(gain, v) = self.queues[to].peek()?;
            let v = v as usize;
            let stale = self.sides[v] != Side::Separator || self.locked[v];
            if !stale && self.gains[to][v] == gain {
                return Some((gain, v));
            }
            self.queues[to].pop();
        }
    }

    /// The next move: the larger gain, towards the lighter part where both are equal.
    fn next_move(&mut self) -> Option<(usize, usize)> {
        let moves = [0, 1].map(|to| {
            let (gain, v) = self.top(to)?;
            let grown = self.weights[to] + u64::from(self.graph.weights[v]);
            let allowed = grown <= self.heaviest || self.weights[to] < self.weights[1 - to];
            allowed.then_some(((gain, std::cmp::Reverse(self.weights[to])), v))
        });
        match moves {
            [Some(a), Some(b)] if a.0 < b.0 => Some((b.1, 1)),
            [Some(a), _] => Some((a.1, 0)),
            [None, Some(b)] => Some((b.1, 1)),
            [None, None] => None,
        }
    }

    fn put(&mut self, v: usize, side: Side) {
        let weight = u64::from(self.graph.weights[v]);
        self.weights[self.sides[v] as usize] -= weight;
        self.weights[side as usize] += weight;
        self.sides[v] = side;
    }

    fn pass(&mut self) -> (u64, u64) {
        let graph = self.graph;
        self.locked.fill(false);
        self.queues.iter_mut().for_each(BinaryHeap::clear);
        for v in 0..graph.len() {
            if self.sides[v] == Side::Separator {
                self.enter(v);
            }
        }
        let (mut best, mut log, mut kept, mut idle) = (self.score(), Vec::new(), 0, 0);
        while idle < PATIENCE {
            let Some((v, to)) = self.next_move() else { break };
            self.locked[v] = true;
            log.push((v, Side::Separator));
            self.put(v, PARTS[to]);
            let weight = i64::from(graph.weights[v]);
            for u in graph.neighbours(v) {
                if self.sides[u] == PARTS[1 - to] {
                    log.push((u, PARTS[1 - to]));
                    self.put(u, Side::Separator);
                    // Those that would have pulled u gain by its having come.
                    let gained = i64::from(graph.weights[u]);
                    graph.neighbours(u).for_each(|w| self.change(w, to, gained));
                    self.enter(u);
                } else {
                    // From the other part they would pull v back.
                    self.change(u, 1 - to, -weight);
                }
            }
            idle += 1;
            if self.score() < best {
                (best, kept, idle) = (self.score(), log.len(), 0);
            }
        }
        for (v, side) in log.drain(kept..).rev() {
            self.put(v, side);
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_all_regions_the_one_with_the_best_separator_is_kept() {
        // A ladder of 40 rungs with a hub at one end, so that regions end differently.
        let edges = (0..40_u32).flat_map(|k| {
            let along = [(2 * k, 2 * k + 2), (2 * k + 1, 2 * k + 3)];
            let hub = (k < 12).then_some((0, 82 + k));
            [(2 * k, 2 * k + 1)].into_iter().chain(along).chain(hub)
        });
        let mut columns = vec![Vec::new(); 94];
        edges.for_each(|(j, i)| columns[j as usize].push(i));
        let starts: Vec<u32> = std::iter::once(0)
            .chain(columns.iter().scan(0, |sum, column| {
                *sum += column.len() as u32;
                Some(*sum)
            }))
            .collect();
        let graph = Graph::of_lower_triangle(&starts, &columns.concat());
        let mut seen = Vec::new();
        for seed in 0..20 {
            let mut random = SplitMix64::new(seed);
            let score = |sides: &mut Vec<Side>| Refinement::new(&graph, sides).score();
            let mut found = initial(&graph, &mut random.clone()).unwrap();
            let tries = (0..TRIES).map(|_| {
                let mut sides = grown(&graph, (random.bits() % graph.len() as u64) as usize);
                Refinement::new(&graph, &mut sides).run()
            });
            let scores: Vec<(u64, u64)> = tries.collect();
            assert_eq!(Some(&score(&mut found)), scores.iter().min());
            seen.extend(scores);
        }
        assert!(seen.iter().min() < seen.iter().max(), "the regions are all alike");
    }
}
