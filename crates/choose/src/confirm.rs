//! Whether another kind of method agrees with a reference: a run that was made already, one that may, or
//! what coarse runs lead to.
//!
//! ```text
//! x(h), x(h/2), x(h/4)  ->  x*      of order 1 or 2, where runs that agree by themselves are dear
//! ```
//! Runs are tried from the cheapest on, those of no sort of method long before those of another.

use std::collections::{BTreeMap, BTreeSet};

use stationary_integrators::Evaluation;

use crate::ladder::{At, Family, Kind, MOMENTS};
use crate::ladder_search::{Judgement, family_class, judge, likely_rungs};
use crate::measured::{Failure, Foresight, StopRule};
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;

/// Whether another kind agrees with the reference at the moments.
pub enum Confirmed {
    /// This run does.
    By(At),
    /// What its runs lead to does.
    Led(Box<Reference>),
    /// None was found.
    No,
    /// There is one kind only.
    Alone,
}

/// Work that is spent on another kind's agreement, in runs of all that was run before: of a run
/// that agrees, and of runs that lead to where it is.
pub const PATIENCE: u64 = 10;

/// A run that is unlikely to agree is tried before one that may where it is so many times cheaper.
const UNLIKELY: u64 = 4;

/// How much dearer a run may be than was known of its like, before others are tried.
const OVERRUN: u64 = 4;

/// Looks for a run of another family near the reference, and makes one where there is none.
pub fn confirmed(
    runs: &mut MeasuredRuns<'_>,
    reference: &Reference,
    tolerance: f64,
    families: &[usize],
) -> Confirmed {
    let agrees = |runs: &MeasuredRuns<'_>, at: At| {
        let course = runs.seen(at).and_then(|run| run.whole());
        let off = course.and_then(|course| reference.error(course).ok());
        off.is_some_and(|off| off.max(runs.way(at).unwrap_or(0.0)) <= tolerance)
    };
    let run: Vec<At> = runs.used().map(|(at, _)| at).collect();
    let others = run.into_iter().filter(|at| {
        at.family != reference.family && runs.family(at.family).converges() && agrees(runs, *at)
    });
    // The nearest is the likeliest to be near between the moments too.
    let off = |at: &At| {
        runs.seen(*at).map_or(f64::NAN, |run| reference.error_until(&run.course, usize::MAX))
    };
    if let Some(at) = others.min_by(|a, b| off(a).total_cmp(&off(b))) {
        return Confirmed::By(at);
    }
    let most = PATIENCE * runs.spent();
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
    while !runs.late() {
        let begun = runs.spent();
        let so_far = |runs: &MeasuredRuns<'_>, family: usize| {
            spent.get(&kind_of(runs.family(family))).copied().unwrap_or_default()
        };
        let next =
            others.iter().filter_map(|&family| next_rung(runs, reference, tolerance, family));
        // What projects onto what is held errs by that, of order 1.
        let projects =
            |family: usize| runs.ladder().is_constrained && !runs.family(family).holds_constraints;
        let unlikely = |at: At| {
            if projects(at.family) {
                return true;
            }
            let order = runs.family(at.family).order;
            let mut finer = runs.used().filter(|(run, _)| {
                let family = runs.family(run.family);
                let comparable = family.kind == Kind::EqualSteps && family.converges();
                comparable && family.order > order && run.rung >= at.rung
            });
            finer.any(|(run, _)| {
                matches!(judge(runs, reference, tolerance, run), Some(Judgement::Misses(_)))
            })
        };
        let dear = |at: At| runs.predicted(at) * if unlikely(at) { UNLIKELY } else { 1 };
        let cheapest = next.min_by_key(|&at| (dear(at) + so_far(runs, at.family), at));
        let tried = |family: usize| {
            let of = family_class(runs.family(family));
            led.iter().filter(|at| family_class(runs.family(at.family)) == of).count()
        };
        // Of one sort, the same rungs lead to the same.
        let new = |at: At| {
            let of = family_class(runs.family(at.family));
            led.iter().all(|led| family_class(runs.family(led.family)) != of || led.rung < at.rung)
        };
        let leading = others.iter().filter_map(|&family| {
            let (work, at) = lead(runs, reference, tolerance, family)?;
            let is_worth = new(at) && tried(family) < LEADS && work <= most.min(runs.left());
            is_worth.then_some((work * if projects(family) { UNLIKELY } else { 1 }, at))
        });
        if let Some((dear_lead, at)) = leading.min()
            && cheapest.is_none_or(|direct| {
                dear_lead + so_far(runs, at.family) < dear(direct) + so_far(runs, direct.family)
            })
        {
            led.push(at);
            if let Some(other) = extrapolation_agrees(runs, at, reference, tolerance) {
                return Confirmed::Led(Box::new(other));
            }
            *spent.entry(kind_of(runs.family(at.family))).or_default() += runs.spent() - begun;
            continue;
        }
        let Some(at) = cheapest.filter(|&at| runs.affords(at) && runs.predicted(at) <= most) else {
            break;
        };
        let most_error = tolerance + reference.uncertainty;
        // What turns out to be far dearer than was known waits until a finer one is the cheapest.
        let most_work = OVERRUN * runs.predicted(at);
        let (reference, foresight) = (Some(reference), Foresight::None);
        runs.attempt(at, &StopRule { reference, most_error, most_work, foresight });
        if agrees(runs, at) {
            return Confirmed::By(at);
        }
        *spent.entry(kind_of(runs.family(at.family))).or_default() += runs.spent() - begun;
    }
    let begun = runs.spent();
    for family in of_each_sort(runs, others) {
        for rung in 1..runs.family(family).rungs.len() {
            let at = At { family, rung };
            if runs.late() || !runs.affords(at) || runs.spent() - begun + runs.predicted(at) > most
            {
                break;
            }
            if let Some(other) = extrapolation_agrees(runs, at, reference, tolerance) {
                return Confirmed::Led(Box::new(other));
            }
        }
    }
    Confirmed::No
}

/// The cheapest family of each sort, as the same rungs of one sort lead to the same; first those whose steps hold
/// what is held, as others err by what they project.
fn of_each_sort(runs: &MeasuredRuns<'_>, mut families: Vec<usize>) -> Vec<usize> {
    families.sort_by_key(|&family| {
        let own = runs.family(family);
        (!own.holds_constraints, own.rungs[0].least_work, family)
    });
    let mut sorts = BTreeSet::new();
    families.retain(|&family| sorts.insert(family_class(runs.family(family))));
    families
}

/// Sorts of methods that do well and badly together: equal steps and own, with equations and without.
fn kind_of(family: &Family) -> (Kind, bool) {
    (family.kind, family.evaluation == Evaluation::Implicit)
}

/// The next rung of a family that may agree with the reference, finer than what others of its sort
/// were too coarse for.
pub fn next_rung(
    runs: &MeasuredRuns<'_>,
    reference: &Reference,
    tolerance: f64,
    family: usize,
) -> Option<At> {
    let last = |of: usize| runs.used().map(|(at, _)| at).filter(|at| at.family == of).last();
    let own = match last(family) {
        None => 0,
        Some(at) => match judge(runs, reference, tolerance, at)? {
            Judgement::Misses(error) | Judgement::Unclear(error) => {
                let error = at_the_end(runs, at, error).min(SMALL);
                at.rung + likely_rungs(runs.family(family), tolerance, error)
            }
            _ => at.rung + 1,
        },
    };
    let alike = |other: &usize| {
        *other != reference.family
            && family_class(runs.family(*other)) == family_class(runs.family(family))
    };
    // Which step is stable differs from one to the other.
    let stable = |at: &At| {
        let said = judge(runs, reference, tolerance, *at);
        !matches!(said, Some(Judgement::Failed(Failure::Unstable(_))))
    };
    let others = (0..runs.ladder().families.len()).filter(alike).filter_map(last).filter(stable);
    let rung = others.map(|at| at.rung + 1).fold(own, usize::max);
    (rung < runs.family(family).rungs.len()).then_some(At { family, rung })
}

/// The work of three runs of a family of equal steps that may lead to the reference, and the finest of
/// them: what is left of an error is about its square.
fn lead(
    runs: &MeasuredRuns<'_>,
    reference: &Reference,
    tolerance: f64,
    family: usize,
) -> Option<(u64, At)> {
    let own = runs.family(family);
    let tried = runs.used().filter(|(at, _)| at.family == family);
    let errors = tried.filter_map(|(at, _)| match judge(runs, reference, tolerance, at)? {
        Judgement::Misses(error) => Some((at.rung, at_the_end(runs, at, error))),
        _ => None,
    });
    let is_low = own.kind == Kind::EqualSteps && LEADING.contains(&own.order);
    let (rung, error) = errors.last().filter(|(_, error)| is_low && *error < SMALL)?;
    let halvings = (error / tolerance.sqrt()).log2() / f64::from(own.order);
    let coarsest = rung + halvings.ceil().max(0.0) as usize;
    let at = |rung: usize| At { family, rung };
    let whole = |at: At| runs.seen(at).is_some_and(|run| run.whole().is_some());
    let three = (coarsest..coarsest + 3).map(at);
    let work = three.filter(|&at| at.rung < own.rungs.len() && !whole(at));
    let work = work.map(|at| runs.predicted(at)).sum();
    (coarsest + 2 < own.rungs.len()).then_some((work, at(coarsest + 2)))
}

/// An error above this says little of what finer steps lead to.
const SMALL: f64 = 0.3;
/// The orders of which coarse runs lead to what is far from them.
const LEADING: std::ops::RangeInclusive<u32> = 1..=2;
/// How often the runs of a sort of families may lead nowhere.
const LEADS: usize = 3;

/// The error that a run comes to which was stopped, where errors grow as they began.
fn at_the_end(runs: &MeasuredRuns<'_>, at: At, error: f64) -> f64 {
    let moments = runs.seen(at).map_or(0, |run| run.course.values.len().saturating_sub(1));
    error * MOMENTS as f64 / moments.max(1) as f64
}

/// How uncertain what runs lead to may be by itself, in tolerances.
const VAGUE: f64 = 4.0;

/// What another family's rungs lead to, where that agrees with the reference though they themselves
/// are too coarse.
fn extrapolation_agrees(
    runs: &mut MeasuredRuns<'_>,
    at: At,
    reference: &Reference,
    tolerance: f64,
) -> Option<Reference> {
    let other = Reference::at(runs, at.family, at.rung)?;
    let apart = reference.error(&other.course);
    // Of two answers that agree by luck, the less certain one would be elsewhere at most moments.
    let agrees =
        other.uncertainty <= VAGUE * tolerance && apart.is_ok_and(|apart| apart <= tolerance);
    agrees.then_some(other)
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use stationary_calculus::Covector;
    use stationary_integrators::State;
    use stationary_integrators::problems::oscillator;

    use super::*;
    use crate::motion::Motion;
    use crate::reference::preferred;
    use crate::search::refer;

    #[test]
    fn steps_that_were_too_coarse_for_one_are_passed_over_by_its_like_but_not_those_that_were_unstable()
     {
        // A bob that swings at 1 per second, and a step of a 20th of the horizon: the one method is
        // stable up to 1.6 s, the other up to 2.8 s.
        let next = |horizon: f64| {
            let bob = oscillator(1.0).unwrap();
            let start = State::new(vec![0.5], Covector(vec![0.0]));
            let place = |state: &State<Vec<f64>>| vec![state.q[0]];
            let motion = Motion::new(&bob.system, start, horizon, place).unwrap();
            let mut runs = MeasuredRuns::new(&motion, Duration::from_secs(600)).unwrap();
            let families = preferred(&runs, 1e-6);
            let reference = refer(&mut runs, &families, 1e-6).unwrap();
            let family = |name: &str| {
                runs.ladder().families.iter().position(|family| family.name == name).unwrap()
            };
            let (tried, like) = (family("triple-jump-4"), family("runge-kutta-4"));
            let (most_work, foresight) = (u64::MAX, Foresight::None);
            let trial =
                StopRule { reference: Some(&reference), most_error: 1e-2, most_work, foresight };
            let first = At { family: tried, rung: 0 };
            runs.attempt(first, &trial);
            let next = next_rung(&runs, &reference, 1e-2, like).map(|at| at.rung);
            (judge(&runs, &reference, 1e-2, first).unwrap(), next)
        };
        let (said, rung) = next(20.0);
        assert!(matches!(said, Judgement::Misses(_)) && rung == Some(1), "{said:?} {rung:?}");
        let (said, rung) = next(50.0);
        let unstable = matches!(said, Judgement::Failed(Failure::Unstable(_)));
        assert!(unstable && rung == Some(0), "{said:?} {rung:?}");
    }
}
