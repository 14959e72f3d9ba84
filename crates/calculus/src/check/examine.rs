//! A function against its claimed derivative: every entry, or random directions and then the entry.
//!
//! ```text
//! few freedoms      column j:     [df] e_j    against the differences along e_j
//! many freedoms     direction w:  [df] w      against the differences along w, w_j = +-(8..15)/16
//! ```
//! A wrong entry among many shows in its row along every such direction, with at least half its
//! error. The columns of that row are then halved, the half with the larger disagreement kept, until
//! one is left: log2(N) ladders more.
//! An entry is wrong when it is off by more than half the tolerance times the row's largest entry and
//! the bar of the differences. Knows nothing of potentials.

use std::cmp::Ordering;

use super::differences::Differences;
use super::ladder::{Estimate, Ladder, Scale};
use crate::SplitMix64;

/// Up to this many freedoms every entry is examined.
const FEW: usize = 32;

/// Directions examined where the freedoms are many.
const DIRECTIONS: usize = 3;

/// Rows, the most suspicious first, in which a wrong entry is looked for.
const SUSPICIOUS: usize = 4;

/// m functions of a configuration, with a claimed derivative at it.
pub(super) struct Claim<'a> {
    /// The number of freedoms n.
    pub freedoms: usize,
    /// The largest entry of each of the m rows.
    pub largest: &'a [f64],
    /// What rounding of the arguments does to a claim, whatever its entries: see `check`.
    pub floor: f64,
    /// The functions, at the configuration moved by h along w.
    pub value: &'a dyn Fn(&[f64], f64) -> Vec<f64>,
    /// The claimed derivative along w.
    pub product: &'a dyn Fn(&[f64]) -> Vec<f64>,
}

/// An entry that disagrees with the differences.
#[derive(Clone, Debug)]
pub(super) struct Suspect {
    pub row: usize,
    pub column: usize,
    pub claimed: f64,
    pub measured: Estimate,
    /// The disagreement over what would have been allowed.
    pub excess: f64,
    /// Other entries, or rows, that disagree as well.
    pub others: usize,
    pub differences: Differences,
}

/// What an examination found.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    pub suspect: Option<Suspect>,
    /// For each row, the error that may have stayed unseen.
    pub unseen: Vec<f64>,
}

impl Claim<'_> {
    /// Compares the claim with differences; `tolerance` is relative to each row's largest entry.
    pub fn examine(&self, scale: &Scale, tolerance: f64, random: &mut SplitMix64) -> Finding {
        let examiner = Examiner { claim: self, scale, tolerance };
        if self.freedoms <= FEW { examiner.columns() } else { examiner.directions(random) }
    }

    /// The error of differences along freedom `column` against the claim in `row`.
    pub fn differences(&self, scale: &Scale, row: usize, column: usize) -> Differences {
        let examiner = Examiner { claim: self, scale, tolerance: 0.0 };
        let w = examiner.unit(column);
        examiner.climb(&w).differences(row, (self.product)(&w)[row], self.largest[row])
    }
}

/// A claim at one configuration, with what stays the same from direction to direction.
struct Examiner<'a> {
    claim: &'a Claim<'a>,
    scale: &'a Scale,
    tolerance: f64,
}

impl Examiner<'_> {
    /// Examines every entry, column by column.
    fn columns(&self) -> Finding {
        let mut finding = Finding { suspect: None, unseen: vec![0.0; self.claim.largest.len()] };
        let mut wrong = 0;
        for column in 0..self.claim.freedoms {
            let w = self.unit(column);
            let (ladder, claimed) = (self.climb(&w), (self.claim.product)(&w));
            for (row, &claimed) in claimed.iter().enumerate() {
                let margin = self.margin(0.5, row, &w);
                let (measured, excess) = ladder.judge(row, claimed, margin);
                finding.unseen[row] = finding.unseen[row].max(2.0 * (margin + measured.bar));
                wrong += usize::from(excess > 1.0);
                if excess > finding.suspect.as_ref().map_or(1.0, |worst| worst.excess) {
                    let differences = ladder.differences(row, claimed, self.claim.largest[row]);
                    finding.suspect = Some(Suspect {
                        row,
                        column,
                        claimed,
                        measured,
                        excess,
                        others: 0,
                        differences,
                    });
                }
            }
        }
        if let Some(suspect) = &mut finding.suspect {
            suspect.others = wrong - 1;
        }
        finding
    }

    /// Examines random directions, and where a row disagrees looks for the entry.
    fn directions(&self, random: &mut SplitMix64) -> Finding {
        let mut finding = Finding { suspect: None, unseen: vec![0.0; self.claim.largest.len()] };
        for _ in 0..DIRECTIONS {
            let w = direction(self.claim.freedoms, random);
            let (ladder, claimed) = (self.climb(&w), (self.claim.product)(&w));
            let mut suspicious = Vec::new();
            for (row, &claimed) in claimed.iter().enumerate() {
                let margin = self.margin(0.25, row, &w);
                let (measured, excess) = ladder.judge(row, claimed, margin);
                finding.unseen[row] = finding.unseen[row].max(4.0 * (margin + measured.bar));
                if excess > 1.0 {
                    suspicious.push((excess, row));
                }
            }
            suspicious.sort_by(|a, b| b.0.total_cmp(&a.0));
            let found = |&(_, row): &(f64, usize)| self.entry(row, self.halve(row, &w));
            finding.suspect = suspicious.iter().take(SUSPICIOUS).find_map(found);
            if let Some(suspect) = &mut finding.suspect {
                suspect.others = suspicious.len() - 1;
                break;
            }
        }
        finding
    }

    /// The column of `row` where most of the disagreement along `w` comes from.
    fn halve(&self, row: usize, w: &[f64]) -> usize {
        let disagreement = |(from, to): (usize, usize)| {
            let part: Vec<f64> =
                (0..w.len()).map(|j| if (from..to).contains(&j) { w[j] } else { 0.0 }).collect();
            ((self.claim.product)(&part)[row] - self.climb(&part).estimate(row).value).abs()
        };
        let (mut from, mut to) = (0, w.len());
        while to - from > 1 {
            let middle = from.midpoint(to);
            match disagreement((from, middle)).total_cmp(&disagreement((middle, to))) {
                Ordering::Less => from = middle,
                _ => to = middle,
            }
        }
        from
    }

    /// Whether one entry disagrees.
    fn entry(&self, row: usize, column: usize) -> Option<Suspect> {
        let w = self.unit(column);
        let (ladder, claimed) = (self.climb(&w), (self.claim.product)(&w)[row]);
        let largest = self.claim.largest[row];
        let (measured, excess) = ladder.judge(row, claimed, self.margin(0.5, row, &w));
        let differences = ladder.differences(row, claimed, largest);
        (excess > 1.0).then_some(Suspect {
            row,
            column,
            claimed,
            measured,
            excess,
            others: 0,
            differences,
        })
    }

    /// The error in `row` along `w` that is let pass: a part of the tolerance, and rounding.
    fn margin(&self, part: f64, row: usize, w: &[f64]) -> f64 {
        let norm = w.iter().map(|w| w * w).sum::<f64>().sqrt();
        part * self.tolerance * self.claim.largest[row] + self.claim.floor * norm
    }

    fn climb(&self, w: &[f64]) -> Ladder<'_> {
        Ladder::climb(self.scale, |h| (self.claim.value)(w, h))
    }

    fn unit(&self, column: usize) -> Vec<f64> {
        let mut w = vec![0.0; self.claim.freedoms];
        w[column] = 1.0;
        w
    }
}

/// Components of either sign and of magnitude 8/16 to 15/16, exact in few bits.
pub(super) fn direction(freedoms: usize, random: &mut SplitMix64) -> Vec<f64> {
    let component = |bits: u64| {
        let magnitude = (8 + bits % 8) as f64 / 16.0;
        if bits & 8 == 0 { magnitude } else { -magnitude }
    };
    (0..freedoms).map(|_| component(random.bits() >> 32)).collect()
}

/// How many times `off` exceeds what is allowed.
pub(super) fn excess(off: f64, allowed: f64) -> f64 {
    if off.abs() <= allowed { 0.0 } else { off.abs() / allowed }
}
