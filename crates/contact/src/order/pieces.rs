//! The pieces of which a step is made, for the state at any moment inside of it.

use stationary_integrators::State;

use crate::ContactError;
use crate::order::flight::Flies;

/// How a piece moves from its start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Motion {
    /// In flight, which is followed again.
    Flight,
    /// Straight and turning evenly to the start of the next, with its momentum.
    Straight,
    /// The same, with a momentum that changes evenly.
    Even,
}

/// A piece, from one state to the next.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Piece<'a> {
    pub(crate) start: &'a State<Vec<f64>>,
    pub(crate) motion: Motion,
    pub(crate) end: &'a State<Vec<f64>>,
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

    /// The piece in which a time lies.
    pub(crate) fn at(&self, t: f64) -> Option<Piece<'_>> {
        let starts = &self.starts[..self.used];
        if !(starts.first()?.0.t <= t && t <= self.end.t) {
            return None;
        }
        let piece = starts.partition_point(|(start, _)| start.t <= t) - 1;
        let (start, motion) = &starts[piece];
        let end = starts.get(piece + 1).map_or(&self.end, |(start, _)| start);
        Some(Piece { start, motion: *motion, end })
    }
}

/// The state at a time of a piece that moves straight and turns evenly.
pub(crate) fn between<G: Flies>(
    Piece { start, motion, end }: Piece<'_>,
    t: f64,
) -> Result<State<Vec<f64>>, ContactError> {
    let part = ((t - start.t) / (end.t - start.t).max(f64::MIN_POSITIVE)).min(1.0);
    let mut state = end.clone();
    state.t = t;
    for body in 0..end.p.0.len() / G::FREEDOMS {
        G::place_on_chord([&start.q, &end.q], body, part, &mut state.q)?;
    }
    if motion == Motion::Even {
        let ends = start.p.0.iter().zip(&end.p.0);
        state.p.0.iter_mut().zip(ends).for_each(|(p, (a, b))| *p = a + part * (b - a));
    }
    Ok(state)
}
