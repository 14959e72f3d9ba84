//! Pairs of solids whose separation is known, for whoever compares ways to find it.

use nalgebra::Vector3;
use stationary_contact::Shape;
use stationary_rigid::RigidMotion;

use super::points::{Pair, Referee, SolidKind, form, placed, shape};
use super::solids::Form;
use crate::Draw;

/// Two solids of about one metre, and who knows how far they are apart.
pub struct JudgedPair {
    pair: Pair,
    referee: Referee,
    /// The solids as contact has them.
    pub shapes: [Shape; 2],
}

impl JudgedPair {
    /// What the solids are, each in its own axes.
    pub fn forms(&self) -> &[Form; 2] {
        &self.pair.forms
    }

    /// Where they are.
    pub fn poses(&self) -> &[RigidMotion; 2] {
        &self.pair.poses
    }

    /// The larger of both sizes together and the largest coordinate, m.
    pub fn scale(&self) -> f64 {
        self.referee.scale
    }

    /// The largest separation along the directions that were searched and these, in 32 digits, m.
    pub fn separation(&self, directions: impl IntoIterator<Item = Vector3<f64>>) -> f64 {
        let along = directions.into_iter().filter_map(|n| self.referee.separation_along(&n));
        along.fold(self.referee.best, f64::max)
    }
}

/// So many pairs of these kinds: a quarter of them thin, many edge on, touching or rounding apart.
pub fn judged_pairs(kinds: [SolidKind; 2], count: usize, seed: u64) -> Vec<JudgedPair> {
    let mut draw = Draw::new(seed);
    let mut pairs = Vec::with_capacity(count);
    while pairs.len() < count {
        let forms = kinds.map(|kind| form(&mut draw, 1.0, &[kind]));
        // A hull may be too thin to be one.
        let [Ok(first), Ok(second)] = [shape(&forms[0]), shape(&forms[1])] else { continue };
        let pair = placed(&mut draw, forms, 1.0);
        let referee = Referee::of(&pair, [draw.word(), draw.word()]);
        pairs.push(JudgedPair { pair, referee, shapes: [first, second] });
    }
    pairs
}
