//! How long a state moves freely: paths are judged by the smallest gap on them, parabolas on chords that are
//! halved until they tell, so that nothing is passed through.

use stationary_calculus::{Metric, Potential};
use stationary_integrators::{Integrator, State};

use crate::when::impacting::{Impacting, TOUCHING};
use crate::when::rest::Resting;
use crate::{ContactError, Swept};

/// By how much a path may leave its chord more than in the middle: gaps are no straight functions of places.
const BEYOND: f64 = 1.5;
/// Halvings of the time of an impact: all digits of it.
const HALVINGS: usize = 70;

/// A part of the way, and where it leads: at its begin, in its middle and at its end.
pub(super) struct Piece {
    from: f64,
    to: f64,
    places: [Vec<f64>; 3],
}

/// How far gaps may close.
pub(super) struct Bounds {
    /// The length that each gap is a difference of on the way, m.
    pub(super) sizes: Vec<f64>,
    least: Vec<f64>,
    /// Where each gap has closed, m: what comes from afar at zero.
    closed: Vec<f64>,
}

impl<M: Metric, P: Potential, K: Swept> Impacting<'_, M, P, K> {
    /// The whole way of a time.
    pub(super) fn way(
        &mut self,
        state: &State<Vec<f64>>,
        left: f64,
        resting: &Resting,
    ) -> Result<Piece, ContactError> {
        let mut place = |s| self.place(state, s, resting);
        let places = [state.q.clone(), place(0.5 * left)?, place(left)?];
        Ok(Piece { from: 0.0, to: left, places })
    }

    /// How far gaps may close on a way.
    pub(super) fn bounds(&self, state: &State<Vec<f64>>, way: &Piece) -> Bounds {
        let [start, middle, end] = &way.places;
        let sizes = self.gaps.sizes(&[start, middle, end]);
        let before = self.gaps.gaps(state.t, &state.q);
        let (mut least, mut closed) = (Vec::new(), Vec::new());
        for (gap, size) in before.iter().zip(&sizes) {
            let slack = TOUCHING * size;
            // What starts on the wrong side is free while it does not sink, and what touches and does not come on
            // sinks by rounding alone.
            let touches = *gap <= slack;
            least.push(gap.min(-slack) - if touches { slack } else { 0.0 });
            closed.push(if touches { least[least.len() - 1] } else { 0.0 });
        }
        Bounds { sizes, least, closed }
    }

    /// The first part of a way on which a gap closes, so short that its path is its chord.
    pub(super) fn closing(
        &mut self,
        state: &State<Vec<f64>>,
        way: Piece,
        bounds: &Bounds,
        resting: &Resting,
    ) -> Result<Option<Piece>, ContactError> {
        let Bounds { sizes, least, .. } = bounds;
        let mut pieces = vec![way];
        while let Some(piece) = pieces.pop() {
            let (from, to) = (piece.from, piece.to);
            let middle = 0.5 * (from + to);
            let [start, halfway, end] = &piece.places;
            let lowest = self.lowest(start, end);
            let chord: Vec<f64> = start.iter().zip(end).map(|(a, b)| 0.5 * (a + b)).collect();
            let [on_path, on_chord] =
                [halfway, &chord].map(|q| self.gaps.gaps(state.t + middle, q));
            // How far the path leaves its chord: most in the middle.
            let off = |i: usize| BEYOND * (on_path[i] - on_chord[i]).abs();
            // What rests is on its chord.
            let near = |i: &usize| lowest[*i] - off(*i) < least[*i] && !resting.gaps.contains(i);
            let overlaps = lowest.iter().zip(least).any(|(gap, least)| gap < least);
            if !overlaps && !(0..least.len()).any(|i| near(&i)) {
                continue;
            }
            let bends = |i: usize| off(i) > TOUCHING * sizes[i];
            if (0..least.len()).filter(near).any(bends) && from < middle && middle < to {
                let [first, last] = [0.5 * (from + middle), 0.5 * (middle + to)];
                let [first, last] =
                    [self.place(state, first, resting)?, self.place(state, last, resting)?];
                let [start, halfway, end] = piece.places;
                pieces.push(Piece { from: middle, to, places: [halfway.clone(), last, end] });
                pieces.push(Piece { from, to: middle, places: [start, first, halfway] });
                continue;
            }
            if overlaps {
                return Ok(Some(piece));
            }
        }
        Ok(None)
    }

    /// When it closes: no gap has closed then.
    pub(super) fn instant(
        &mut self,
        state: &State<Vec<f64>>,
        piece: &Piece,
        bounds: &Bounds,
        resting: &Resting,
    ) -> Result<f64, ContactError> {
        let (mut free, mut closed) = (piece.from, piece.to);
        for _ in 0..HALVINGS {
            let middle = 0.5 * (free + closed);
            let reached = self.place(state, middle, resting)?;
            let lowest = self.lowest(&piece.places[0], &reached);
            let overlaps = lowest.iter().zip(&bounds.closed).any(|(gap, closed)| gap < closed);
            *(if overlaps { &mut closed } else { &mut free }) = middle;
        }
        Ok(free)
    }

    /// Where a time of `s` seconds leads.
    fn place(
        &mut self,
        state: &State<Vec<f64>>,
        s: f64,
        resting: &Resting,
    ) -> Result<Vec<f64>, ContactError> {
        if s <= 0.0 {
            return Ok(state.q.clone());
        }
        if !resting.gaps.is_empty() {
            return Ok(self.held_place(state, s, resting)?.q);
        }
        let mut moved = state.clone();
        self.verlet.step(&mut moved, s)?;
        Ok(moved.q)
    }
}
