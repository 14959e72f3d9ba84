//! A function against its claimed derivative: every entry, or random directions and then the entry.
//!
//! ```text
//! few freedoms      column j:     [df] e_j    against the differences along e_j
//! many freedoms     direction w:  [df] w      against the differences along w, w_j = +-(8..15)/16
//! ```
//! A wrong entry among many shows in its row along every such direction, with at least half its
//! error. The columns of that row are then halved, the half with the larger disagreement kept, until
//! one is left: log2(n) times two ladders more.
//! An entry is wrong when it is off by more than half the tolerance times the row's largest entry and
//! the bar of the differences. Knows nothing of potentials.

use super::differences::Differences;
use super::finding::{Finding, Suspect};
use super::ladder::{Ladder, Scale};
use stationary_measure::SplitMix64;

/// Up to this many freedoms every entry is examined.
const FEW: usize = 32;

/// Directions examined where the freedoms are many.
pub(super) const DIRECTIONS: usize = 3;

/// Rows, the most suspicious first, in which a wrong entry is looked for.
const SUSPICIOUS: usize = 4;

/// m functions of a configuration, with a claimed derivative at it.
pub(super) struct Claim<'a> {
    /// The number of freedoms n.
    pub freedoms: usize,
    /// The largest entry of each of the m rows.
    pub largest: &'a [f64],
    /// What rounding of the arguments does to each entry, however small the row.
    pub floor: f64,
    /// The steps.
    pub scale: &'a Scale,
    /// The functions, at the configuration moved by h along w.
    pub value: &'a dyn Fn(&[f64], f64) -> Vec<f64>,
    /// The claimed derivative along w.
    pub product: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

impl Claim<'_> {
    /// Compares the claim with differences; `tolerance` is relative to each row's largest entry.
    pub fn examine(&self, tolerance: f64, random: &mut SplitMix64) -> Finding {
        if self.freedoms <= FEW {
            self.columns(tolerance)
        } else {
            self.directions(tolerance, random)
        }
    }

    /// The error of differences along freedom `column` against the claim in `row`.
    pub fn differences(&self, row: usize, column: usize) -> Differences {
        let w = unit(self.freedoms, column);
        self.climb(&w).differences(row, (self.product)(&w)[row], self.largest[row])
    }

    /// Examines every entry.
    fn columns(&self, tolerance: f64) -> Finding {
        let mut finding = Finding::new(self.largest.len());
        for column in 0..self.freedoms {
            let w = unit(self.freedoms, column);
            let (ladder, claimed) = (self.climb(&w), (self.product)(&w));
            for (row, &claimed) in claimed.iter().enumerate() {
                let suspect = self.entry(&ladder, row, column, claimed, tolerance);
                let margin = 0.5 * tolerance * self.largest[row] + self.floor;
                finding.hides(row, 2.0 * (margin + suspect.measured.bar), self.largest[row]);
                finding.blame(suspect);
            }
        }
        finding
    }

    /// Examines random directions, and where a row disagrees looks for the entry.
    fn directions(&self, tolerance: f64, random: &mut SplitMix64) -> Finding {
        let mut finding = Finding::new(self.largest.len());
        for _ in 0..DIRECTIONS {
            let w = direction(self.freedoms, random);
            let (ladder, claimed) = (self.climb(&w), (self.product)(&w));
            let mut suspicious = Vec::new();
            for (row, &claimed) in claimed.iter().enumerate() {
                let margin = 0.25 * tolerance * self.largest[row] + self.floor * norm(&w);
                let (measured, excess) = ladder.judge(row, claimed, margin);
                finding.hides(row, 4.0 * (margin + measured.bar), self.largest[row]);
                if excess > 0.0 {
                    suspicious.push((excess, row));
                }
            }
            suspicious.sort_by(|a, b| b.0.total_cmp(&a.0));
            for &(_, row) in suspicious.iter().take(SUSPICIOUS) {
                let column = self.halve(row, &w);
                let w = unit(self.freedoms, column);
                let claimed = (self.product)(&w)[row];
                finding.blame(self.entry(&self.climb(&w), row, column, claimed, tolerance));
            }
            if finding.worst.is_some() {
                finding.wrong = suspicious.len();
                break;
            }
        }
        finding
    }

    /// One entry, from the ladder along its freedom.
    fn entry(
        &self,
        ladder: &Ladder<'_>,
        row: usize,
        column: usize,
        claimed: f64,
        tolerance: f64,
    ) -> Suspect {
        let largest = self.largest[row];
        let margin = 0.5 * tolerance * largest + self.floor;
        let (measured, excess) = ladder.judge(row, claimed, margin);
        let differences = if excess > 0.0 {
            ladder.differences(row, claimed, largest)
        } else {
            Differences::default()
        };
        Suspect { row, column, claimed, measured, excess, differences, along: None }
    }

    /// The column of `row` where most of the disagreement along `w` comes from.
    fn halve(&self, row: usize, w: &[f64]) -> usize {
        let disagreement = |from: usize, to: usize| {
            let w = part(w, from, to);
            ((self.product)(&w)[row] - self.climb(&w).estimate(row).value).abs()
        };
        let (mut from, mut to) = (0, w.len());
        while to - from > 1 {
            let middle = usize::midpoint(from, to);
            if disagreement(from, middle) < disagreement(middle, to) {
                from = middle;
            } else {
                to = middle;
            }
        }
        from
    }

    fn climb(&self, w: &[f64]) -> Ladder<'_> {
        Ladder::climb(self.scale, w, |h| (self.value)(w, h))
    }
}

fn norm(w: &[f64]) -> f64 {
    w.iter().map(|w| w * w).sum::<f64>().sqrt()
}

/// Freedom k alone.
pub(super) fn unit(freedoms: usize, k: usize) -> Vec<f64> {
    (0..freedoms).map(|j| if j == k { 1.0 } else { 0.0 }).collect()
}

/// The freedoms from `from` to before `to` of a direction.
pub(super) fn part(w: &[f64], from: usize, to: usize) -> Vec<f64> {
    w.iter().enumerate().map(|(j, &w)| if (from..to).contains(&j) { w } else { 0.0 }).collect()
}

/// Components of either sign and of magnitude 8/16 to 15/16, exact in few bits.
pub(super) fn direction(freedoms: usize, random: &mut SplitMix64) -> Vec<f64> {
    let component = |bits: u64| {
        let magnitude = (8 + bits % 8) as f64 / 16.0;
        if bits & 8 == 0 { magnitude } else { -magnitude }
    };
    (0..freedoms).map(|_| component(random.bits() >> 32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_component_of_a_direction_is_at_least_a_half_and_less_than_one() {
        let w = direction(10_000, &mut SplitMix64::new(1));
        assert!(w.iter().all(|w| (0.5..1.0).contains(&w.abs())));
        let positive = w.iter().filter(|w| **w > 0.0).count();
        assert!((4_500..5_500).contains(&positive), "{positive}");
    }
}
