//! The search for the cheapest run that keeps to a tolerance, and for what it is judged by.
//!
//! ```text
//! a reference, by the family that fits best                                    (`reference.rs`)
//! the cheapest rung that meets it at twenty moments                            (`ladder_search.rs`)
//! over its whole way, by a reference that another kind of method confirms      (`verify.rs`)
//! ```
//! Where one of these says no, it begins anew: with a better reference, or with what is known now of the
//! rung. Work is counted; wall time stands beside it and decides nothing but whether the budget is over.

use stationary_integrators::Evaluation;

use crate::answer::{Answer, Verdict};
use crate::effort::Purpose;
use crate::error::QuestionError;
use crate::grid::{Grid, Within};
use crate::ladder::{At, Kind};
use crate::ladder_search::{LadderSearch, judge};
use crate::measured_runs::MeasuredRuns;
use crate::reference::{Reference, preferred};
use crate::refinement::mesh_error;
use crate::seen::Seen;
use crate::verify::{Doubt, Finding, verify};

/// How much better than the tolerance the reference must be before rungs are judged by it.
const ENOUGH: f64 = 0.25;
/// How much worse than that it may be where it gets no better.
pub(crate) const BARELY: f64 = 0.5;

/// How often a reference is made anew that is not trusted, and how much better.
const DOUBTS: u32 = 4;
const BETTER: f64 = 0.125;
/// References are not made better than that: it is rounding.
const LEAST: f64 = 1e-11;
/// Choices that may turn out to be wrong between the moments.
const CHOICES: u32 = 16;

/// The tightest tolerance that can be asked for: the reference must be better than it.
const TIGHTEST: f64 = 1e-12;

/// The cheapest rung that was run and keeps to the tolerance over its whole way.
///
/// # Errors
/// [`QuestionError::Tolerance`] unless that is at least 1e-12 and less than 1.
pub fn answer(runs: &mut MeasuredRuns<'_>, tolerance: f64) -> Result<Answer, QuestionError> {
    match (TIGHTEST..1.0).contains(&tolerance) {
        true => Ok(answered(runs, tolerance)),
        false => Err(QuestionError::Tolerance(tolerance)),
    }
}

fn answered(runs: &mut MeasuredRuns<'_>, tolerance: f64) -> Answer {
    let mut enough = ENOUGH * tolerance;
    let mut last: Option<(Reference, Doubt)> = None;
    for _ in 0..DOUBTS {
        runs.turn_to(Purpose::Reference);
        let families = preferred(runs, enough);
        let made = refer(runs, &families, enough);
        let Some(reference) =
            made.filter(|made| made.uncertainty <= BARELY * tolerance || last.is_none())
        else {
            break;
        };
        if reference.course.is_still && hardly_moves(runs, &reference) {
            return Answer::of(runs, reference, tolerance, Verdict::Still);
        }
        if reference.uncertainty > BARELY * tolerance {
            return Answer::of(runs, reference, tolerance, Verdict::Uncertain);
        }
        let same = |(before, _): &(Reference, Doubt)| {
            (before.family, before.finest) == (reference.family, reference.finest)
        };
        enough = BETTER * enough.min(reference.uncertainty.max(LEAST));
        if last.as_ref().is_some_and(same) {
            continue;
        }
        runs.forget_ways();
        match settled(runs, reference, tolerance, &families) {
            Ok(answer) => return *answer,
            Err(doubtful) => {
                // Nothing better can be seen than what cannot be seen.
                let unseen = doubtful.1 == Doubt::Unseen;
                last = Some(*doubtful);
                if unseen {
                    break;
                }
            }
        }
    }
    match last {
        Some((reference, doubt)) => {
            Answer::of(runs, reference, tolerance, Verdict::Doubtful(doubt))
        }
        None => Answer::without_reference(runs, tolerance),
    }
}

/// Whether an observable does not move between the moments either.
fn hardly_moves(runs: &mut MeasuredRuns<'_>, reference: &Reference) -> bool {
    let at = At { family: reference.family, rung: reference.finest };
    let scale = runs.ladder().scale;
    let look = runs.look(at, &Grid::Equal { halvings: STILL }, Within::Parts);
    let most = reference.course.scale.max(reference.course.rounding);
    look.is_some_and(|look| look.scale(scale) <= 10.0 * most)
}

/// Halvings of the grid that shows whether something moves between the moments.
const STILL: u32 = 4;

/// The answer by a reference, or why it is not trusted.
fn settled(
    runs: &mut MeasuredRuns<'_>,
    mut reference: Reference,
    tolerance: f64,
    families: &[usize],
) -> Result<Box<Answer>, Box<(Reference, Doubt)>> {
    for _ in 0..CHOICES {
        let mut search = LadderSearch::new(runs, reference, tolerance);
        search.runs.turn_to(Purpose::Search);
        let chosen = search.search();
        reference = search.reference.clone();
        let Some(at) = chosen else {
            return Ok(Box::new(Answer::of(runs, reference, tolerance, Verdict::NoneMeets)));
        };
        match verify(runs, &reference, at, tolerance, families) {
            Finding::Holds(seen) => {
                let (at, seen) = cheaper(runs, &reference, (at, seen), tolerance, families)
                    .unwrap_or((at, seen));
                reference.is_confirmed = true;
                let chosen = Verdict::Chosen(at);
                return Ok(Box::new(beside(runs, reference, tolerance, (at, chosen), seen)));
            }
            Finding::Unconfirmed(seen) => {
                let chosen = Verdict::Unconfirmed(at);
                return Ok(Box::new(beside(runs, reference, tolerance, (at, chosen), seen)));
            }
            Finding::Beyond(error) => runs.overrule(at, error),
            Finding::Larger(scale) => {
                reference.uncertainty *= reference.course.scale / scale;
                reference.course.scale = scale;
                runs.forget_ways();
            }
            Finding::Doubtful(doubt) => return Err(Box::new((reference, doubt))),
        }
    }
    Err(Box::new((reference, Doubt::Restless)))
}

/// A run that was made to confirm the reference, or a coarser one of its family, that turned out to be
/// cheaper than the choice and to hold as well.
fn cheaper(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    (chosen, _): (At, Seen),
    tolerance: f64,
    families: &[usize],
) -> Option<(At, Seen)> {
    runs.turn_to(Purpose::Search);
    let mut at = LadderSearch::new(runs, reference.clone(), tolerance).settle()?;
    if runs.seen(at)?.work >= runs.seen(chosen)?.work {
        return None;
    }
    at = LadderSearch::new(runs, reference.clone(), tolerance).settle_below(at)?;
    for _ in 0..COARSER {
        match verify(runs, reference, at, tolerance, families) {
            Finding::Holds(seen) => return Some((at, seen)),
            Finding::Beyond(error) => runs.overrule(at, error),
            _ => return None,
        }
        at = LadderSearch::new(runs, reference.clone(), tolerance).settle()?;
        if runs.seen(at)?.work >= runs.seen(chosen)?.work {
            return None;
        }
    }
    None
}

/// Cheaper runs than the choice that are looked at.
const COARSER: usize = 2;

/// A choice with what was seen of it, and the mesh's own error.
fn beside(
    runs: &mut MeasuredRuns<'_>,
    reference: Reference,
    tolerance: f64,
    (at, verdict): (At, Verdict),
    seen: Seen,
) -> Answer {
    let said = |runs: &MeasuredRuns<'_>, at: At| judge(runs, &reference, tolerance, at);
    runs.turn_to(Purpose::Mesh);
    let mesh = mesh_error(runs, &reference, at, &said);
    Answer { mesh, ..Answer::of(runs, reference, tolerance, verdict).seen(seen) }
}

/// A reference in closed form where there is one; else by the family that fits best, beside one that
/// chooses its own steps and the cheapest
/// there are; by what else there is where they come to none.
pub fn refer(runs: &mut MeasuredRuns<'_>, families: &[usize], enough: f64) -> Option<Reference> {
    if let Some(&closed) = families.iter().find(|&&family| runs.family(family).is_closed) {
        let at = At { family: closed, rung: runs.family(closed).rungs.len() - 1 };
        if runs.affords(at)
            && let Some(made) = Reference::at(runs, closed, at.rung)
        {
            return Some(made);
        }
    }
    let explicit = |family: &usize, kind: Kind| {
        let family = runs.family(*family);
        family.kind == kind && family.evaluation == Evaluation::Explicit
    };
    let mut best = families[..1].to_vec();
    best.extend(families.iter().find(|family| explicit(family, Kind::Adaptive)));
    let steps = families.iter().filter(|family| explicit(family, Kind::EqualSteps));
    let mut cheap: Vec<usize> =
        steps.copied().filter(|&family| runs.family(family).order == CHEAP_ORDER).collect();
    cheap.sort_by_key(|&family| (runs.family(family).rungs[0].least_work, family));
    best.extend(cheap.into_iter().take(CHEAP));
    best.sort_unstable();
    best.dedup();
    let made = Reference::make(runs, &best, enough);
    let does = |made: &Reference| made.uncertainty <= enough / ENOUGH * BARELY;
    if made.as_ref().is_some_and(|made| does(made) || made.course.is_still) {
        return made;
    }
    let others = families.iter().filter(|family| !best.contains(family));
    let others: Vec<usize> = others.take(TRIED).copied().collect();
    let made = made.into_iter().chain(Reference::make(runs, &others, enough));
    made.reduce(|best, other| if best.is_better(&other) { best } else { other })
}

/// The order of the cheap families that references are tried with, and how many of them.
const CHEAP_ORDER: u32 = 2;
const CHEAP: usize = 2;

/// Families that are tried where the best come to no reference.
const TRIED: usize = 2;
