//! What an examination finds: the worst entry that disagrees, and what may have stayed unseen.

use super::differences::Differences;
use super::ladder::Estimate;

/// An entry, compared with differences.
#[derive(Clone, Debug)]
pub(super) struct Suspect {
    pub row: usize,
    pub column: usize,
    pub claimed: f64,
    pub measured: Estimate,
    /// The disagreement over what is let pass, or 0 where it passes.
    pub excess: f64,
    pub differences: Differences,
    /// Where the differential's slope gives it away, along which freedom.
    pub along: Option<usize>,
}

/// What an examination found.
#[derive(Clone, Debug)]
pub(super) struct Finding {
    /// The entry that disagrees most.
    pub worst: Option<Suspect>,
    /// How many entries, or of many freedoms rows, disagree.
    pub wrong: usize,
    /// For each row, the error that may have stayed unseen, relative to the row's largest entry; of
    /// a row of zeros nothing.
    pub unseen: Vec<Option<f64>>,
}

impl Finding {
    /// Nothing found yet in `rows` rows.
    pub fn new(rows: usize) -> Self {
        Finding { worst: None, wrong: 0, unseen: vec![None; rows] }
    }

    /// Errors of this size in `row`, of this largest entry, cannot be seen.
    pub fn hides(&mut self, row: usize, error: f64, largest: f64) {
        if largest > 0.0 {
            let unseen = self.unseen[row].unwrap_or(0.0).max(error / largest);
            self.unseen[row] = Some(unseen);
        }
    }

    /// Counts the entry and keeps it if it is the worst so far, unless it passes.
    pub fn blame(&mut self, suspect: Suspect) {
        self.wrong += usize::from(suspect.excess > 0.0);
        if suspect.excess > self.worst.as_ref().map_or(0.0, |worst| worst.excess) {
            self.worst = Some(suspect);
        }
    }
}

/// How many times `off` exceeds what is let pass, or 0 where it passes.
pub(super) fn excess(off: f64, allowed: f64) -> f64 {
    if off.abs() <= allowed { 0.0 } else { off.abs() / allowed }
}
