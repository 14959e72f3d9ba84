//! A Hessian checked as a quadratic form: what remains where configurations do not add.
//!
//! ```text
//! Q(w) = w^T H w = d/dh dV(q_h) w at h = 0                    q_h = q moved by h along w
//! H_ij = 1/2 (Q(e_i + e_j) - Q(e_i) - Q(e_j))                 polarization
//! ```
//! On a curved space the derivative of one component of dV along another motion is not symmetric: it
//! contains dV of the commutator of the two motions. Along a single motion the commutator vanishes,
//! so Q is compared, and Q determines the symmetric H. Of few freedoms every pair is examined; of
//! many, random directions, and where Q disagrees the freedoms are halved until a pair is left.

use super::blocks::Entries;
use super::differences::Differences;
use super::examine::{DIRECTIONS, Finding, Suspect, direction, unit};
use super::ladder::{Estimate, Ladder, Scale};
use crate::SplitMix64;

/// Up to this many freedoms every pair of them is examined.
const FEW: usize = 12;

/// A quadratic form with the function whose derivative along w it claims to be.
pub(super) struct QuadraticClaim<'a> {
    /// The Hessian H.
    pub hessian: &'a Entries,
    /// `dV(q_h) w`, at the configuration moved by h along w.
    pub value: &'a dyn Fn(&[f64], f64) -> f64,
    /// The steps.
    pub scale: &'a Scale,
}

/// From one index to before another.
type Range = (usize, usize);

impl QuadraticClaim<'_> {
    /// Compares the claim with differences; `tolerance` is relative to each row's largest entry.
    pub fn examine(&self, tolerance: f64, random: &mut SplitMix64) -> Finding {
        let n = self.hessian.freedoms;
        let largest = self.hessian.largest();
        let mut finding = Finding { suspect: None, unseen: vec![0.0; n] };
        if n <= FEW {
            let mut wrong = 0;
            for (j, i) in (0..n).flat_map(|j| (0..=j).map(move |i| (j, i))) {
                let (suspect, allowed) = self.pair(i, j, &largest, tolerance);
                finding.unseen[i] = finding.unseen[i].max(2.0 * allowed);
                finding.unseen[j] = finding.unseen[j].max(2.0 * allowed);
                wrong += usize::from(suspect.excess > 1.0);
                if suspect.excess > finding.suspect.as_ref().map_or(1.0, |worst| worst.excess) {
                    finding.suspect = Some(suspect);
                }
            }
            if let Some(suspect) = &mut finding.suspect {
                suspect.others = wrong - 1;
            }
            return finding;
        }
        let smallest = largest.iter().copied().filter(|&x| x > 0.0).reduce(f64::min);
        for _ in 0..DIRECTIONS {
            let w = direction(n, random);
            let (claimed, measured) = self.along(&w);
            let allowed = 0.25 * tolerance * smallest.unwrap_or(0.0) + measured.bar;
            finding.unseen.iter_mut().for_each(|unseen| *unseen = unseen.max(4.0 * allowed));
            if excess(claimed - measured.value, allowed) > 1.0 {
                let (i, j) = self.halve(&w);
                let (suspect, _) = self.pair(i, j, &largest, tolerance);
                if suspect.excess > 1.0 {
                    finding.suspect = Some(suspect);
                    break;
                }
            }
        }
        finding
    }

    /// The entry (i, j) by polarization, and what it is allowed to be off.
    fn pair(&self, i: usize, j: usize, largest: &[f64], tolerance: f64) -> (Suspect, f64) {
        let unit = |k: usize| {
            let mut w = vec![0.0; largest.len()];
            w[k] = 1.0;
            w
        };
        let (w, scale) = if i == j { (unit(i), 1.0) } else { (sum(&unit(i), &unit(j)), 0.5) };
        let (mut claimed, mut measured) = self.along(&w);
        if i != j {
            for (c, m) in [self.along(&unit(i)), self.along(&unit(j))] {
                (claimed, measured.value) = (claimed - c, measured.value - m.value);
                measured.bar += m.bar;
            }
        }
        (claimed, measured.value) = (scale * claimed, scale * measured.value);
        measured.bar *= scale;
        let row_largest = largest[i].min(largest[j]);
        let allowed = 0.5 * tolerance * row_largest + measured.bar;
        let differences =
            self.climb(&w).differences(0, self.hessian.quadratic(&w), largest[i].max(largest[j]));
        let excess = excess(claimed - measured.value, allowed);
        (Suspect { row: i, column: j, claimed, measured, excess, others: 0, differences }, allowed)
    }

    /// The entry where most of the disagreement along `w` comes from.
    fn halve(&self, w: &[f64]) -> (usize, usize) {
        let part = |(from, to): Range| -> Vec<f64> {
            (0..w.len()).map(|k| if (from..to).contains(&k) { w[k] } else { 0.0 }).collect()
        };
        let off = |w: &[f64]| {
            let (claimed, measured) = self.along(w);
            claimed - measured.value
        };
        let shared = |&(a, b): &(Range, Range)| match a == b {
            true => off(&part(a)).abs(),
            false => {
                let (a, b) = (part(a), part(b));
                (off(&sum(&a, &b)) - off(&a) - off(&b)).abs()
            }
        };
        let halves = |(from, to): Range| {
            let middle = usize::midpoint(from, to);
            [(from, middle), (middle, to)]
        };
        let mut pair = ((0, w.len()), (0, w.len()));
        loop {
            let (a, b) = pair;
            let [length_a, length_b] = [a, b].map(|(from, to)| to - from);
            if length_a.max(length_b) == 1 {
                return (a.0, b.0);
            }
            let choices = if a == b {
                let [low, high] = halves(a);
                vec![(low, low), (high, high), (low, high)]
            } else if length_a >= length_b {
                halves(a).map(|half| (half, b)).to_vec()
            } else {
                halves(b).map(|half| (a, half)).to_vec()
            };
            let most = choices.into_iter().max_by(|x, y| shared(x).total_cmp(&shared(y)));
            pair = most.unwrap_or(((a.0, a.0 + 1), (b.0, b.0 + 1)));
        }
    }

    /// Claimed and measured value of the form.
    fn along(&self, w: &[f64]) -> (f64, Estimate) {
        (self.hessian.quadratic(w), self.climb(w).estimate(0))
    }

    /// The error of differences along freedom `k` against the claim for it.
    pub fn differences(&self, k: usize) -> Differences {
        let mut w = vec![0.0; self.hessian.freedoms];
        w[k] = 1.0;
        self.climb(&w).differences(0, self.hessian.quadratic(&w), self.hessian.largest()[k])
    }

    fn climb(&self, w: &[f64]) -> Ladder<'_> {
        Ladder::climb(self.scale, |h| vec![(self.value)(w, h)])
    }
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}
