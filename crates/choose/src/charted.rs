//! Every method on a chart: the long form of an answer, for whoever wants to see them all.

use crate::answer::Answer;
use crate::ladder::At;
use crate::ladder_search::{Judgement, judge};
use crate::measured_runs::MeasuredRuns;

/// Runs are charted up to so many times the work of the choice, or of the reference where that is more.
const BEYOND: u64 = 4;
/// Errors that are nearer to the reference's own say nothing more.
const NEAR: f64 = 2.0;

/// The same answer with every method of what was asked about itself, from its coarsest setting to where
/// its error is that of the reference, or its cost beyond all that was run before.
pub fn charted(runs: &mut MeasuredRuns<'_>, answer: Answer) -> Answer {
    let Some(reference) = answer.reference.clone() else { return answer };
    let made = At { family: reference.family, rung: reference.finest };
    let made = runs.seen(made).map_or(0, |run| run.work);
    let most = BEYOND * answer.choice().map_or(made, |row| row.work.max(made));
    for family in 0..runs.ladder().families.len() {
        if runs.family(family).model != 0 {
            continue;
        }
        for rung in 0..runs.family(family).rungs.len() {
            let at = At { family, rung };
            if runs.late() || !runs.affords(at) || runs.predicted(at) > most {
                break;
            }
            runs.measure(at);
            let error = match judge(runs, &reference, answer.tolerance, at) {
                Some(
                    Judgement::Meets(error) | Judgement::Unclear(error) | Judgement::Misses(error),
                ) => error,
                _ => continue,
            };
            if error <= NEAR * reference.uncertainty {
                break;
            }
        }
    }
    let all = Answer::of(runs, reference, answer.tolerance, answer.verdict);
    Answer { seen: answer.seen, mesh: answer.mesh, ..all }
}
