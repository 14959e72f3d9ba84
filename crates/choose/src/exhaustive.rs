//! Every rung that could be cheaper than a choice, run: what the search is measured against.
//!
//! A run ends where it misses, or costs more than the choice: neither can be the cheapest.

use crate::ladder::At;
use crate::measured::{End, Foresight, StopRule};
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;
use crate::verify::way_error;

/// A rung, its work and its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Its place.
    pub at: At,
    /// Counted work.
    pub work: u64,
    /// Its error by the truth.
    pub error: f64,
}

/// The cheapest rung of at most so much work whose error by the truth is within the tolerance. In
/// each of these families rungs are run from the coarsest to the first that is dearer.
pub fn exhaustive(
    runs: &mut MeasuredRuns<'_>,
    families: &[usize],
    truth: &Reference,
    tolerance: f64,
    most: u64,
) -> Option<Found> {
    let mut best: Option<Found> = None;
    for &family in families {
        for rung in 0..runs.family(family).rungs.len() {
            let at = At { family, rung };
            // Half of what a rung likely takes is less than any run of equal steps took.
            let own = runs.family(family);
            if own.rungs[rung].least_work / 2 > most {
                break;
            }
            let trial = StopRule {
                reference: Some(truth),
                most_error: tolerance,
                most_work: most,
                foresight: Foresight::None,
            };
            let run = runs.attempt(at, &trial);
            let work = run.work;
            if work > most && !matches!(run.end, End::Failed(_)) {
                break;
            }
            let Some(Ok(error)) = run.whole().map(|course| truth.error(course)) else { continue };
            if error > tolerance || best.is_some_and(|best| work >= best.work) {
                continue;
            }
            match way_error(runs, truth, at, tolerance) {
                Some(error) if error <= tolerance => best = Some(Found { at, work, error }),
                _ => {}
            }
        }
    }
    best
}
