//! The first two edges that meet, if any do, in n log n comparisons for outlines of any shape.
//!
//! ```text
//! events     corners by x, then by y: a line that is all but upright sweeps over them
//! state      edges under the line, from below: those that meet first are neighbours before
//! ```
//! Where no two neighbours have met so far the order of the edges does not depend on where along
//! them they are compared, so that a balanced tree keeps it; each edge is tested against its
//! neighbours when it comes and they against each other when it goes. How the outline lies makes no
//! difference. Source: Shamos and Hoey, "Geometric intersection problems" (FOCS 1976).

use std::cell::Cell;
use std::cmp::Ordering;
use std::collections::BTreeSet;
use std::ops::Bound::{Excluded, Unbounded};

use nalgebra::Vector2;

use crate::crossing::{Edge, ends, meet};
use crate::side::side_of_line;

/// A pair of edges that cross or touch, the lesser edge first; `None` where all are apart.
pub(crate) fn first_crossing(
    outlines: &[Vec<Vector2<f64>>],
    comparisons: &Cell<u64>,
) -> Option<(Edge, Edge)> {
    let numbered = outlines.iter().enumerate();
    let mut events: Vec<Edge> =
        numbered.flat_map(|(k, corners)| (0..corners.len()).map(move |c| (k, c))).collect();
    let place = |event: &Edge| &outlines[event.0][event.1];
    events.sort_by(|a, b| along(place(a), place(b)).then(a.cmp(b)));
    let together = events.windows(2).find(|pair| place(&pair[0]) == place(&pair[1]));
    if let Some(pair) = together {
        return Some((pair[0].min(pair[1]), pair[0].max(pair[1])));
    }
    let mut sweep = Sweep { outlines, open: BTreeSet::new() };
    for event in events {
        let count = outlines[event.0].len();
        let edges = [(event.1 + count - 1) % count, event.1].map(|corner| {
            let edge = (event.0, corner);
            let [a, b] = ends(outlines, edge);
            let (left, right) = if along(&a, &b) == Ordering::Less { (a, b) } else { (b, a) };
            Sweeping { edge, left, right, comparisons }
        });
        let (ending, starting): (Vec<_>, Vec<_>) =
            edges.into_iter().partition(|edge| edge.right == *place(&event));
        let met = ending.iter().find_map(|edge| sweep.close(edge));
        let met = met.or_else(|| starting.into_iter().find_map(|edge| sweep.open(edge)));
        if met.is_some() {
            return met;
        }
    }
    None
}

/// By x, then by y.
fn along(a: &Vector2<f64>, b: &Vector2<f64>) -> Ordering {
    // Zeros of either sign are one place.
    (a.x + 0.0).total_cmp(&(b.x + 0.0)).then((a.y + 0.0).total_cmp(&(b.y + 0.0)))
}

/// An edge under the line, in the order from below.
#[derive(Clone, Copy)]
struct Sweeping<'a> {
    edge: Edge,
    left: Vector2<f64>,
    right: Vector2<f64>,
    comparisons: &'a Cell<u64>,
}

impl Sweeping<'_> {
    /// Where this edge lies from another that begins no later.
    fn side_of(&self, earlier: &Self) -> Ordering {
        side_of_line(&earlier.left, &earlier.right, &self.left)
            .then_with(|| side_of_line(&earlier.left, &earlier.right, &self.right))
    }
}

impl Ord for Sweeping<'_> {
    fn cmp(&self, other: &Self) -> Ordering {
        if self.edge == other.edge {
            return Ordering::Equal;
        }
        self.comparisons.set(self.comparisons.get() + 1);
        let side = if along(&self.left, &other.left) == Ordering::Less {
            other.side_of(self).reverse()
        } else {
            self.side_of(other)
        };
        side.then(self.edge.cmp(&other.edge))
    }
}

impl PartialOrd for Sweeping<'_> {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for Sweeping<'_> {
    fn eq(&self, other: &Self) -> bool {
        self.edge == other.edge
    }
}

impl Eq for Sweeping<'_> {}

/// The edges under the line.
struct Sweep<'a> {
    outlines: &'a [Vec<Vector2<f64>>],
    open: BTreeSet<Sweeping<'a>>,
}

impl<'a> Sweep<'a> {
    fn neighbours(&self, edge: &Sweeping<'a>) -> [Option<Edge>; 2] {
        let below = self.open.range((Unbounded, Excluded(edge))).next_back();
        let above = self.open.range((Excluded(edge), Unbounded)).next();
        [below, above].map(|neighbour| neighbour.map(|neighbour| neighbour.edge))
    }

    /// An edge begins: whether it meets one of its neighbours.
    fn open(&mut self, edge: Sweeping<'a>) -> Option<(Edge, Edge)> {
        let neighbours = self.neighbours(&edge);
        self.open.insert(edge);
        neighbours.into_iter().flatten().find_map(|other| self.tested(edge.edge, other))
    }

    /// An edge ends: whether those meet that it kept apart.
    fn close(&mut self, edge: &Sweeping<'a>) -> Option<(Edge, Edge)> {
        self.open.remove(edge);
        match self.neighbours(edge) {
            [Some(below), Some(above)] => self.tested(below, above),
            _ => None,
        }
    }

    fn tested(&self, one: Edge, other: Edge) -> Option<(Edge, Edge)> {
        let (first, second) = (one.min(other), one.max(other));
        meet(self.outlines, first, second).then_some((first, second))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation2;
    use std::f64::consts::FRAC_PI_2;

    /// Teeth of this height on a bar, turned.
    fn comb(teeth: usize, height: f64, angle: f64) -> Vec<Vector2<f64>> {
        let width = 2.0 * teeth as f64;
        let mut corners = vec![[width, 0.0], [width, -1.0], [0.0, -1.0]];
        for tooth in 0..teeth {
            let x = 2.0 * tooth as f64;
            corners.extend([[x, height], [x + 1.0, height], [x + 1.0, 0.0], [x + 2.0, 0.0]]);
        }
        corners.pop();
        let turn = Rotation2::new(angle);
        corners.into_iter().map(|corner| turn * Vector2::from(corner)).collect()
    }

    #[test]
    fn a_comb_costs_the_same_however_it_lies() {
        let cost = |teeth: usize, height: f64, angle: f64| {
            let comparisons = Cell::new(0);
            let outlines = [comb(teeth, height, angle)];
            assert_eq!(first_crossing(&outlines, &comparisons), None, "{angle}");
            comparisons.get() as f64
        };
        for height in [1.0, 5000.0] {
            for angle in [0.0, 0.3, 0.8, FRAC_PI_2, 2.5, -1.1] {
                let edges = 4.0 * 2000.0;
                let bound = 20.0 * edges * f64::log2(edges);
                assert!(cost(2000, height, angle) < bound, "{height} {angle}");
            }
        }
    }

    #[test]
    fn one_tooth_through_its_neighbour_is_found_however_the_comb_lies() {
        for angle in [0.0, 0.3, 0.8, FRAC_PI_2, 2.5, -1.1] {
            let mut corners = comb(300, 50.0, 0.0);
            corners[603].x -= 1.5;
            let turn = Rotation2::new(angle);
            let corners: Vec<_> = corners.into_iter().map(|corner| turn * corner).collect();
            assert!(first_crossing(&[corners], &Cell::new(0)).is_some(), "{angle}");
        }
    }
}
