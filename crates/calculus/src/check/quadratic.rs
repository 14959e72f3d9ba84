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
use super::examine::{DIRECTIONS, direction, part, unit};
use super::finding::{Finding, Suspect, excess};
use super::ladder::{Estimate, Ladder, Scale};
use stationary_measure::SplitMix64;

/// Up to this many freedoms every pair of them is examined.
const FEW: usize = 12;

/// A quadratic form with the function whose derivative along w it claims to be.
pub(super) struct QuadraticClaim<'a> {
    /// The Hessian H.
    pub hessian: &'a Entries,
    /// The largest entry of each row.
    pub largest: &'a [f64],
    /// The steps.
    pub scale: &'a Scale,
    /// `dV(q_h) w`, at the configuration moved by h along w.
    pub value: &'a dyn Fn(&[f64], f64) -> f64,
}

impl QuadraticClaim<'_> {
    /// Compares the claim with differences; `tolerance` is relative to each row's largest entry.
    pub fn examine(&self, tolerance: f64, random: &mut SplitMix64) -> Finding {
        if self.largest.len() <= FEW {
            self.pairs(tolerance)
        } else {
            self.directions(tolerance, random)
        }
    }

    /// The error of differences along freedom `k` against the claim for it.
    pub fn differences(&self, k: usize) -> Differences {
        self.differences_along(&unit(self.largest.len(), k), self.largest[k])
    }

    /// Examines every pair of freedoms.
    fn pairs(&self, tolerance: f64) -> Finding {
        let n = self.largest.len();
        let mut finding = Finding::new(n);
        for (i, j) in (0..n).flat_map(|j| (0..=j).map(move |i| (i, j))) {
            let suspect = self.pair(i, j, tolerance);
            for row in [i, j] {
                let margin = 0.5 * tolerance * self.largest[row];
                finding.hides(row, 2.0 * (margin + suspect.measured.bar), self.largest[row]);
            }
            finding.blame(suspect);
        }
        finding
    }

    /// Examines random directions, and where the form disagrees looks for the pair.
    fn directions(&self, tolerance: f64, random: &mut SplitMix64) -> Finding {
        let n = self.largest.len();
        let mut finding = Finding::new(n);
        let present = self.largest.iter().copied().filter(|&entry| entry > 0.0);
        let smallest = present.reduce(f64::min).unwrap_or(0.0);
        // An entry off the diagonal counts twice, so few directions see it; one on it counts a
        // quarter of its error at least.
        for _ in 0..2 * DIRECTIONS {
            let w = direction(n, random);
            let (claimed, measured) = self.along(&w);
            let allowed = 0.125 * tolerance * smallest + measured.bar;
            for (row, &largest) in self.largest.iter().enumerate() {
                finding.hides(row, 8.0 * (0.125 * tolerance * largest + measured.bar), largest);
            }
            if excess(claimed - measured.value, allowed) > 0.0 {
                let (i, j) = self.halve(&w);
                finding.blame(self.pair(i, j, tolerance));
            }
            if finding.worst.is_some() {
                break;
            }
        }
        finding
    }

    /// The entry (i, j) by polarization.
    fn pair(&self, i: usize, j: usize, tolerance: f64) -> Suspect {
        let n = self.largest.len();
        let (claimed, measured, w) = if i == j {
            let w = unit(n, i);
            let (claimed, measured) = self.along(&w);
            (claimed, measured, w)
        } else {
            let w = sum(&unit(n, i), &unit(n, j));
            let [both, one, other] = [&w, &unit(n, i), &unit(n, j)].map(|w| self.along(w));
            let value = 0.5 * (both.1.value - one.1.value - other.1.value);
            let bar = 0.5 * (both.1.bar + one.1.bar + other.1.bar);
            (0.5 * (both.0 - one.0 - other.0), Estimate { value, bar }, w)
        };
        let allowed = 0.5 * tolerance * self.largest[i].min(self.largest[j]) + measured.bar;
        let excess = excess(claimed - measured.value, allowed);
        let differences = if excess > 0.0 {
            self.differences_along(&w, self.largest[i].max(self.largest[j]))
        } else {
            Differences::default()
        };
        Suspect { row: i, column: j, claimed, measured, excess, differences, along: None }
    }

    /// The pair of freedoms where most of the disagreement along `w` comes from.
    fn halve(&self, w: &[f64]) -> (usize, usize) {
        let off = |w: &[f64]| {
            let (claimed, measured) = self.along(w);
            claimed - measured.value
        };
        let shared = |&(a, b): &(Range, Range)| {
            let [x, y] = [a, b].map(|(from, to)| part(w, from, to));
            let off = if a == b { off(&x) } else { off(&sum(&x, &y)) - off(&x) - off(&y) };
            off.abs()
        };
        let mut pair = ((0, w.len()), (0, w.len()));
        while length(pair.0).max(length(pair.1)) > 1 {
            let (a, b) = pair;
            let choices = if a == b {
                let [low, high] = halves(a);
                vec![(low, low), (high, high), (low, high)]
            } else if length(a) >= length(b) {
                halves(a).map(|half| (half, b)).to_vec()
            } else {
                halves(b).map(|half| (a, half)).to_vec()
            };
            let most = choices.into_iter().max_by(|x, y| shared(x).total_cmp(&shared(y)));
            pair = most.unwrap_or(((a.0, a.0 + 1), (b.0, b.0 + 1)));
        }
        (pair.0.0, pair.1.0)
    }

    /// Claimed and measured value of the form.
    fn along(&self, w: &[f64]) -> (f64, Estimate) {
        (self.hessian.quadratic(w), self.climb(w).estimate(0))
    }

    fn differences_along(&self, w: &[f64], largest: f64) -> Differences {
        self.climb(w).differences(0, self.hessian.quadratic(w), largest)
    }

    fn climb(&self, w: &[f64]) -> Ladder<'_> {
        Ladder::climb(self.scale, w, |h| vec![(self.value)(w, h)])
    }
}

/// From one index to before another.
type Range = (usize, usize);

fn length((from, to): Range) -> usize {
    to - from
}

fn halves((from, to): Range) -> [Range; 2] {
    let middle = usize::midpoint(from, to);
    [(from, middle), (middle, to)]
}

fn sum(a: &[f64], b: &[f64]) -> Vec<f64> {
    a.iter().zip(b).map(|(a, b)| a + b).collect()
}
