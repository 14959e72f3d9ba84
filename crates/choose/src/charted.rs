//! Every method on a chart: the long form of an answer, for whoever wants to see them all.

use crate::answer::Answer;
use crate::lab::Lab;
use crate::ladder::At;
use crate::ladder_search::{Judgement, judge};

/// Runs are charted up to so many times the work of the choice, or of the reference where that is more.
const BEYOND: u64 = 4;
/// Errors that are nearer to the reference's own say nothing more.
const NEAR: f64 = 2.0;

/// The same answer with every method of what was asked about itself, from its coarsest setting to where
/// its error is that of the reference, or its cost beyond all that was run before.
pub fn charted(lab: &mut Lab<'_>, answer: Answer) -> Answer {
    let Some(reference) = answer.reference.clone() else { return answer };
    let made = At { family: reference.family, rung: reference.finest };
    let made = lab.seen(made).map_or(0, |run| run.work);
    let most = BEYOND * answer.choice().map_or(made, |row| row.work.max(made));
    for family in 0..lab.ladder().families.len() {
        if lab.family(family).model != 0 {
            continue;
        }
        for rung in 0..lab.family(family).rungs.len() {
            let at = At { family, rung };
            if lab.late() || !lab.affords(at) || lab.predicted(at) > most {
                break;
            }
            lab.measure(at);
            let error = match judge(lab, &reference, answer.tolerance, at) {
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
    let all = Answer::of(lab, reference, answer.tolerance, answer.verdict);
    Answer { seen: answer.seen, mesh: answer.mesh, ..all }
}
