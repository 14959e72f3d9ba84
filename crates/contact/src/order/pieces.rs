//! The pieces of which a step is made, for the state at any moment inside of it.

use stationary_integrators::State;

/// How a piece moves from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// In flight, which is followed again.
    Flight,
    /// Straight and turning evenly to the start of the next, with its momentum.
    Straight,
}

/// Consecutive pieces; their memory is kept from step to step.
#[derive(Debug, Default)]
pub(crate) struct Pieces {
    starts: Vec<(State<Vec<f64>>, Motion)>,
    used: usize,
    end: State<Vec<f64>>,
}

impl Pieces {
    pub(crate) fn clear(&mut self) {
        self.used = 0;
    }

    pub(crate) fn push(&mut self, start: &State<Vec<f64>>, motion: Motion) {
        match self.starts.get_mut(self.used) {
            Some(piece) => {
                piece.0.clone_from(start);
                piece.1 = motion;
            }
            None => self.starts.push((start.clone(), motion)),
        }
        self.used += 1;
    }

    pub(crate) fn finish(&mut self, end: &State<Vec<f64>>) {
        self.end.clone_from(end);
    }

    /// The piece in which a time lies: its start, how it moves, and where it ends.
    pub(crate) fn at(&self, t: f64) -> Option<(&State<Vec<f64>>, Motion, &State<Vec<f64>>)> {
        let starts = &self.starts[..self.used];
        if !(starts.first()?.0.t <= t && t <= self.end.t) {
            return None;
        }
        let piece = starts.partition_point(|(start, _)| start.t <= t) - 1;
        let (start, motion) = &starts[piece];
        let end = starts.get(piece + 1).map_or(&self.end, |(start, _)| start);
        Some((start, *motion, end))
    }
}
