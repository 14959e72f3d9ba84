//! `cargo xtask choose FILE --observable NAME --tolerance 1e-3`: the cheapest way to run a scene.
//!
//! - [`Ladder`]: every way to run it, as data.
//! - [`Reference`]: the answer that ways are judged by, and how far it can be trusted.
//! - [`Climb`]: which of them are tried, and in which order.
//! - [`Answer`]: the choice, the runners-up, what failed and how; never a way that was not run.
//!
//! Errors are relative to what [`relative_to`] says. The search compares runs at 20 moments of the
//! horizon; what it chooses is then looked at over its whole way (`way.rs`, `verify.rs`), and the reference
//! is trusted only where another kind of method agrees with it there. Work is counted; wall time stands
//! beside it and decides nothing but whether the budget is over.

mod answer;
mod candidate;
mod charted;
mod climb;
mod declaration;
mod effort;
mod emit;
mod error;
mod exhaustive;
mod grid;
mod json;
mod lab;
mod ladder;
mod look;
mod mesh_error;
mod model;
mod observable;
mod picture;
mod reference;
mod run;
mod surrogate;
mod time;
mod track;
mod verify;
mod way;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::time::{Duration, Instant};

use stationary_integrators::Evaluation;
use stationary_scene::Scene;

pub use answer::{Answer, Row, Verdict};
pub use charted::charted;
pub use climb::{Climb, Judgement, judge};
use climb::{rungs_to_go, sort};
pub use declaration::{Change, changed};
pub use effort::{Effort, Purpose};
pub use emit::{emit, emitted};
pub use error::ChooseError;
pub use exhaustive::{Found, exhaustive};
use grid::{Grid, Within};
pub use json::json;
pub use lab::{At, Lab};
pub use ladder::{Family, Kind, Ladder, MOMENTS, Rung};
use mesh_error::mesh_error;
pub use mesh_error::{MeshError, Refined};
pub use model::{Model, Sight};
pub use picture::{chart, picture};
pub use reference::{Extrapolated, Reference, preferred};
pub use run::{Course, End, Failure, Foresight, Measured, Trial, relative_to};
pub use time::time;
pub use verify::{Doubt, Seen, way_error};
use verify::{Finding, verify};

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub struct Question {
    /// A word such as `energy`, or a word with names: `position=bob`, `distance=sun,pluto`.
    pub observable: String,
    /// The error that may be made, relative to the observable's scale.
    pub tolerance: f64,
    /// The time that choosing may take.
    pub budget: Duration,
    /// Another horizon than the scene's.
    pub horizon: Option<f64>,
}

/// The tightest tolerance that can be asked for: the reference must be better than it.
const TIGHTEST: f64 = 1e-12;

impl Question {
    fn check(&self) -> Result<(), ChooseError> {
        if !(TIGHTEST..1.0).contains(&self.tolerance) {
            return Err(ChooseError::Tolerance(self.tolerance));
        }
        if self.budget.is_zero() {
            return Err(ChooseError::Budget(self.budget));
        }
        match self.horizon {
            Some(horizon) if !(horizon > 0.0 && horizon.is_finite()) => {
                Err(ChooseError::Horizon(horizon))
            }
            _ => Ok(()),
        }
    }
}

/// Answers the question for the scene in a file.
///
/// # Errors
/// [`ChooseError`], before anything is run.
pub fn choose(file: &Path, question: &Question) -> Result<(Answer, Lab), ChooseError> {
    question.check()?;
    Scene::read(file)?;
    let text = fs::read_to_string(file)
        .map_err(|source| ChooseError::Read { path: file.to_owned(), source })?;
    let mut lab = laboratory(&file.display().to_string(), &text, question)?;
    let answer = answer(&mut lab, question.tolerance);
    Ok((answer, lab))
}

/// The ladder of a scene for a question, with nothing measured.
///
/// # Errors
/// [`ChooseError`].
pub fn laboratory(name: &str, text: &str, question: &Question) -> Result<Lab, ChooseError> {
    question.check()?;
    Scene::parse_at(name, text)?;
    let text = observable::asked(name, text, &question.observable)?;
    let (text, scene) = match question.horizon {
        None => (text.clone(), Scene::parse_at(name, &text)?),
        Some(horizon) => {
            // A step that certainly divides the horizon; rungs bring their own.
            let changes = [
                Change::to("horizon", declaration::number(horizon)),
                Change::to("step", declaration::number(horizon / MOMENTS as f64)),
                Change::without("sample_every"),
            ];
            let text = changed(&text, &changes);
            (text.clone(), Scene::parse_at(name, &text)?)
        }
    };
    let ladder = Ladder::of(name, &text, &scene)?;
    let start = Instant::now();
    // A budget that reaches beyond the clock is none.
    let deadline = start.checked_add(question.budget);
    Ok(Lab::new(ladder, deadline.unwrap_or(start + Duration::from_secs(1 << 30))))
}

/// How much better than the tolerance the reference must be before rungs are judged by it.
const ENOUGH: f64 = 0.25;
/// How much worse than that it may be where it gets no better.
const BARELY: f64 = 0.5;

/// How often a reference is made anew that is not trusted, and how much better.
const DOUBTS: u32 = 4;
const BETTER: f64 = 0.125;
/// References are not made better than that: it is rounding.
const LEAST: f64 = 1e-11;
/// Choices that may turn out to be wrong between the moments.
const CHOICES: u32 = 16;

/// The cheapest rung that was run and keeps to the tolerance over its whole way.
pub fn answer(lab: &mut Lab, tolerance: f64) -> Answer {
    let mut enough = ENOUGH * tolerance;
    let mut last: Option<(Reference, Doubt)> = None;
    for _ in 0..DOUBTS {
        lab.turn_to(Purpose::Reference);
        let families = preferred(lab, enough);
        let made = refer(lab, &families, enough);
        let Some(reference) =
            made.filter(|made| made.uncertainty <= BARELY * tolerance || last.is_none())
        else {
            break;
        };
        if reference.course.is_still && hardly_moves(lab, &reference) {
            return Answer::of(lab, reference, tolerance, Verdict::Still);
        }
        if reference.uncertainty > BARELY * tolerance {
            return Answer::of(lab, reference, tolerance, Verdict::Uncertain);
        }
        let same = |(before, _): &(Reference, Doubt)| {
            (before.family, before.finest) == (reference.family, reference.finest)
        };
        enough = BETTER * enough.min(reference.uncertainty.max(LEAST));
        if last.as_ref().is_some_and(same) {
            continue;
        }
        lab.forget_ways();
        match settled(lab, reference, tolerance, &families) {
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
        Some((reference, doubt)) => Answer::of(lab, reference, tolerance, Verdict::Doubtful(doubt)),
        None => Answer::without_reference(lab, tolerance),
    }
}

/// Whether an observable does not move between the moments either.
fn hardly_moves(lab: &mut Lab, reference: &Reference) -> bool {
    let at = At { family: reference.family, rung: reference.finest };
    let scene = &lab.ladder().written().scene;
    let Some(observable) = scene.observables().first().copied() else { return false };
    let look = lab.look(at, &Grid::Equal { halvings: STILL }, Within::Parts);
    let most = reference.course.scale.max(reference.course.rounding);
    look.is_some_and(|look| look.scale(&observable) <= 10.0 * most)
}

/// Halvings of the grid that shows whether something moves between the moments.
const STILL: u32 = 4;

/// The answer by a reference, or why it is not trusted.
fn settled(
    lab: &mut Lab,
    mut reference: Reference,
    tolerance: f64,
    families: &[usize],
) -> Result<Box<Answer>, Box<(Reference, Doubt)>> {
    for _ in 0..CHOICES {
        let mut climb = Climb::new(lab, reference, tolerance);
        climb.lab.turn_to(Purpose::Search);
        let chosen = climb.search();
        reference = climb.reference.clone();
        let Some(at) = chosen else {
            return Ok(Box::new(Answer::of(lab, reference, tolerance, Verdict::NoneMeets)));
        };
        match verify(lab, &reference, at, tolerance, families) {
            Finding::Holds(seen) => {
                let (at, seen) =
                    cheaper(lab, &reference, (at, seen), tolerance, families).unwrap_or((at, seen));
                reference.is_confirmed = true;
                let chosen = Verdict::Chosen(at);
                return Ok(Box::new(beside(lab, reference, tolerance, (at, chosen), seen)));
            }
            Finding::Unconfirmed(seen) => {
                let chosen = Verdict::Unconfirmed(at);
                return Ok(Box::new(beside(lab, reference, tolerance, (at, chosen), seen)));
            }
            Finding::Beyond(error) => lab.overrule(at, error),
            Finding::Larger(scale) => {
                reference.uncertainty *= reference.course.scale / scale;
                reference.course.scale = scale;
                lab.forget_ways();
            }
            Finding::Doubtful(doubt) => return Err(Box::new((reference, doubt))),
        }
    }
    Err(Box::new((reference, Doubt::Restless)))
}

/// A run that was made to confirm the reference, or a coarser one of its family, that turned out to be
/// cheaper than the choice and to hold as well.
fn cheaper(
    lab: &mut Lab,
    reference: &Reference,
    (chosen, _): (At, Seen),
    tolerance: f64,
    families: &[usize],
) -> Option<(At, Seen)> {
    lab.turn_to(Purpose::Search);
    let mut at = Climb::new(lab, reference.clone(), tolerance).settle()?;
    if lab.seen(at)?.work >= lab.seen(chosen)?.work {
        return None;
    }
    at = Climb::new(lab, reference.clone(), tolerance).settle_below(at)?;
    for _ in 0..COARSER {
        match verify(lab, reference, at, tolerance, families) {
            Finding::Holds(seen) => return Some((at, seen)),
            Finding::Beyond(error) => lab.overrule(at, error),
            _ => return None,
        }
        at = Climb::new(lab, reference.clone(), tolerance).settle()?;
        if lab.seen(at)?.work >= lab.seen(chosen)?.work {
            return None;
        }
    }
    None
}

/// Cheaper runs than the choice that are looked at.
const COARSER: usize = 2;

/// A choice with what was seen of it, and the mesh's own error.
fn beside(
    lab: &mut Lab,
    reference: Reference,
    tolerance: f64,
    (at, verdict): (At, Verdict),
    seen: Seen,
) -> Answer {
    let said = |lab: &Lab, at: At| judge(lab, &reference, tolerance, at);
    lab.turn_to(Purpose::Mesh);
    let mesh = mesh_error(lab, &reference, at, &said);
    Answer { mesh, ..Answer::of(lab, reference, tolerance, verdict).seen(seen) }
}

/// A reference in closed form where there is one; else by the family that fits best, beside one that
/// chooses its own steps and the cheapest
/// there are; by what else there is where they come to none.
pub fn refer(lab: &mut Lab, families: &[usize], enough: f64) -> Option<Reference> {
    if let Some(&closed) = families.iter().find(|&&family| lab.family(family).is_closed) {
        let at = At { family: closed, rung: lab.family(closed).rungs.len() - 1 };
        if lab.affords(at)
            && let Some(made) = Reference::at(lab, closed, at.rung)
        {
            return Some(made);
        }
    }
    let explicit = |family: &usize, kind: Kind| {
        let family = lab.family(*family);
        family.kind == kind && family.evaluation == Evaluation::Explicit
    };
    let mut best = families[..1].to_vec();
    best.extend(families.iter().find(|family| explicit(family, Kind::OwnSteps)));
    let steps = families.iter().filter(|family| explicit(family, Kind::EqualSteps));
    let mut cheap: Vec<usize> =
        steps.copied().filter(|&family| lab.family(family).order == CHEAP_ORDER).collect();
    cheap.sort_by_key(|&family| (lab.family(family).rungs[0].least_work, family));
    best.extend(cheap.into_iter().take(CHEAP));
    best.sort_unstable();
    best.dedup();
    let made = Reference::make(lab, &best, enough);
    if made.as_ref().is_some_and(|made| made.uncertainty <= enough / ENOUGH * BARELY) {
        return made;
    }
    let others = families.iter().filter(|family| !best.contains(family));
    let others: Vec<usize> = others.take(TRIED).copied().collect();
    let made = made.into_iter().chain(Reference::make(lab, &others, enough));
    made.min_by(|a, b| a.uncertainty.total_cmp(&b.uncertainty))
}

/// The order of the cheap families that references are tried with, and how many of them.
const CHEAP_ORDER: u32 = 2;
const CHEAP: usize = 2;

/// Families that are tried where the best come to no reference.
const TRIED: usize = 2;

/// Whether another kind agrees with the reference at the moments.
enum Confirmed {
    /// This run does.
    By(At),
    /// What its runs lead to does.
    Led(Box<Reference>),
    /// None was found.
    No,
    /// The scene allows one kind only.
    Alone,
}

/// Work that is spent on another kind's agreement, in runs of all that was run before: of a run
/// that agrees, and of runs that lead to where it is.
const PATIENCE: u64 = 10;

/// A run that is unlikely to agree is tried before one that may where it is so many times cheaper.
const UNLIKELY: u64 = 4;

/// Looks for a run of another family near the reference, and makes one where there is none.
fn confirmed(
    lab: &mut Lab,
    reference: &Reference,
    tolerance: f64,
    families: &[usize],
) -> Confirmed {
    let agrees = |lab: &Lab, at: At| {
        let said = judge(lab, reference, tolerance, at);
        matches!(said, Some(Judgement::Meets(_)))
    };
    let run: Vec<At> = lab.used().map(|(at, _)| at).collect();
    let others = run.into_iter().filter(|at| {
        at.family != reference.family && lab.family(at.family).converges() && agrees(lab, *at)
    });
    // The nearest is the likeliest to be near between the moments too.
    let off = |at: &At| {
        lab.seen(*at).map_or(f64::NAN, |run| reference.error_until(&run.course, usize::MAX))
    };
    if let Some(at) = others.min_by(|a, b| off(a).total_cmp(&off(b))) {
        return Confirmed::By(at);
    }
    let most = PATIENCE * lab.spent();
    let others: Vec<usize> =
        families.iter().copied().filter(|&family| family != reference.family).collect();
    if others.is_empty() {
        return Confirmed::Alone;
    }
    // The cheapest run that may agree, again and again: each rules out a rung. Where a family of a
    // higher order does not agree, one of a lower order must be much cheaper. Where it is far to such a
    // run, what coarser ones lead to is cheaper.
    let mut led: Vec<At> = Vec::new();
    // What each sort of method has cost so far: none is tried long before another is.
    let mut spent: BTreeMap<(Kind, bool), u64> = BTreeMap::new();
    while !lab.late() {
        let begun = lab.spent();
        let so_far = |lab: &Lab, family: usize| {
            spent.get(&kind_of(lab.family(family))).copied().unwrap_or_default()
        };
        let next = others.iter().filter_map(|&family| next_rung(lab, reference, tolerance, family));
        let unlikely = |at: At| {
            let order = lab.family(at.family).order;
            let mut finer = lab.used().filter(|(run, _)| {
                let family = lab.family(run.family);
                let comparable = family.kind == Kind::EqualSteps && family.converges();
                comparable && family.order > order && run.rung >= at.rung
            });
            finer.any(|(run, _)| {
                matches!(judge(lab, reference, tolerance, run), Some(Judgement::Misses(_)))
            })
        };
        let dear = |at: At| lab.predicted(at) * if unlikely(at) { UNLIKELY } else { 1 };
        let cheapest = next.min_by_key(|&at| (dear(at) + so_far(lab, at.family), at));
        let leading = others.iter().filter_map(|&family| lead(lab, reference, tolerance, family));
        let tried = |family: usize| {
            let of = sort(lab.family(family));
            led.iter().filter(|at| sort(lab.family(at.family)) == of).count()
        };
        // Of one sort, the same rungs lead to the same.
        let new = |at: At| {
            let of = sort(lab.family(at.family));
            led.iter().all(|led| sort(lab.family(led.family)) != of || led.rung < at.rung)
        };
        let leading = leading.filter(|&(_, at)| new(at) && tried(at.family) < LEADS).min();
        if let Some((work, at)) = leading
            && cheapest.is_none_or(|direct| {
                work + so_far(lab, at.family) < dear(direct) + so_far(lab, direct.family)
            })
            && work <= most.min(lab.left())
        {
            led.push(at);
            if let Some(other) = extrapolation_agrees(lab, at, reference, tolerance) {
                return Confirmed::Led(Box::new(other));
            }
            *spent.entry(kind_of(lab.family(at.family))).or_default() += lab.spent() - begun;
            continue;
        }
        let Some(at) = cheapest.filter(|&at| lab.affords(at) && lab.predicted(at) <= most) else {
            break;
        };
        let most_error = tolerance + reference.uncertainty;
        let most_work = u64::MAX;
        let (reference, foresight) = (Some(reference), Foresight::None);
        lab.attempt(at, &Trial { reference, most_error, most_work, foresight });
        if agrees(lab, at) {
            return Confirmed::By(at);
        }
        *spent.entry(kind_of(lab.family(at.family))).or_default() += lab.spent() - begun;
    }
    for family in others {
        for rung in 1..lab.family(family).rungs.len() {
            let at = At { family, rung };
            if lab.late() || !lab.affords(at) || lab.predicted(at) > most {
                break;
            }
            if let Some(other) = extrapolation_agrees(lab, at, reference, tolerance) {
                return Confirmed::Led(Box::new(other));
            }
        }
    }
    Confirmed::No
}

/// Sorts of methods that do well and badly together: equal steps and own, with equations and without.
fn kind_of(family: &Family) -> (Kind, bool) {
    (family.kind, family.evaluation == Evaluation::Implicit)
}

/// The next rung of a family that may agree with the reference, finer than what others of its sort
/// were too coarse for.
fn next_rung(lab: &Lab, reference: &Reference, tolerance: f64, family: usize) -> Option<At> {
    let last = |of: usize| lab.used().map(|(at, _)| at).filter(|at| at.family == of).last();
    let own = match last(family) {
        None => 0,
        Some(at) => match judge(lab, reference, tolerance, at)? {
            Judgement::Misses(error) | Judgement::Unclear(error) => {
                let error = at_the_end(lab, at, error).min(SMALL);
                at.rung + rungs_to_go(lab.family(family), tolerance, error)
            }
            _ => at.rung + 1,
        },
    };
    let alike = |other: &usize| {
        *other != reference.family && sort(lab.family(*other)) == sort(lab.family(family))
    };
    // Which step is stable differs from one to the other.
    let stable = |at: &At| {
        let said = judge(lab, reference, tolerance, *at);
        !matches!(said, Some(Judgement::Failed(Failure::Unstable(_))))
    };
    let others = (0..lab.ladder().families.len()).filter(alike).filter_map(last).filter(stable);
    let rung = others.map(|at| at.rung + 1).fold(own, usize::max);
    (rung < lab.family(family).rungs.len()).then_some(At { family, rung })
}

/// The work of three runs of a family of equal steps that may lead to the reference, and the finest of
/// them: what is left of an error is about its square.
fn lead(lab: &Lab, reference: &Reference, tolerance: f64, family: usize) -> Option<(u64, At)> {
    let own = lab.family(family);
    let tried = lab.used().filter(|(at, _)| at.family == family);
    let errors = tried.filter_map(|(at, _)| match judge(lab, reference, tolerance, at)? {
        Judgement::Misses(error) => Some((at.rung, at_the_end(lab, at, error))),
        _ => None,
    });
    let is_low = own.kind == Kind::EqualSteps && LEADING.contains(&own.order);
    let (rung, error) = errors.last().filter(|(_, error)| is_low && *error < SMALL)?;
    let halvings = (error / tolerance.sqrt()).log2() / f64::from(own.order);
    let coarsest = rung + halvings.ceil().max(0.0) as usize;
    let at = |rung: usize| At { family, rung };
    let whole = |at: At| lab.seen(at).is_some_and(|run| run.whole().is_some());
    let three = (coarsest..coarsest + 3).map(at);
    let work = three.filter(|&at| at.rung < own.rungs.len() && !whole(at));
    let work = work.map(|at| lab.predicted(at)).sum();
    (coarsest + 2 < own.rungs.len()).then_some((work, at(coarsest + 2)))
}

/// An error above this says little of what finer steps lead to.
const SMALL: f64 = 0.3;
/// The orders of which coarse runs lead to what is far from them.
const LEADING: std::ops::RangeInclusive<u32> = 1..=2;
/// How often the runs of a sort of families may lead nowhere.
const LEADS: usize = 3;

/// The error that a run comes to which was stopped, where errors grow as they began.
fn at_the_end(lab: &Lab, at: At, error: f64) -> f64 {
    let moments = lab.seen(at).map_or(0, |run| run.course.values.len().saturating_sub(1));
    error * MOMENTS as f64 / moments.max(1) as f64
}

/// How uncertain what runs lead to may be by itself, in tolerances.
const VAGUE: f64 = 4.0;

/// What another family's rungs lead to, where that agrees with the reference though they themselves
/// are too coarse.
fn extrapolation_agrees(
    lab: &mut Lab,
    at: At,
    reference: &Reference,
    tolerance: f64,
) -> Option<Reference> {
    let other = Reference::at(lab, at.family, at.rung)?;
    let apart = reference.error(&other.course);
    // Of two answers that agree by luck, the less certain one would be elsewhere at most moments.
    let agrees =
        other.uncertainty <= VAGUE * tolerance && apart.is_ok_and(|apart| apart <= tolerance);
    agrees.then_some(other)
}

#[cfg(test)]
mod model_tests;
#[cfg(test)]
mod tests;
#[cfg(test)]
mod truth_tests;
