//! Every rung that could be cheaper than a choice, run: what the search is measured against.

use super::lab::{At, Lab};
use super::ladder::Kind;
use super::reference::Reference;

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
/// every family rungs are run from the coarsest to the first that is dearer.
pub fn exhaustive(lab: &mut Lab, truth: &Reference, tolerance: f64, most: u64) -> Option<Found> {
    let mut best: Option<Found> = None;
    for family in 0..lab.ladder().families.len() {
        for rung in 0..lab.family(family).rungs.len() {
            let at = At { family, rung };
            // Half of what a rung likely takes is less than any run of equal steps took.
            let own = lab.family(family);
            if own.kind == Kind::EqualSteps && own.rungs[rung].least_work / 2 > most {
                break;
            }
            let run = lab.measure(at);
            let work = run.work;
            let course = run.outcome.clone();
            if work > most && course.is_ok() {
                break;
            }
            let Ok(Ok(error)) = course.map(|course| truth.error(&course)) else { continue };
            if error <= tolerance && best.is_none_or(|best| work < best.work) {
                best = Some(Found { at, work, error });
            }
        }
    }
    best
}
