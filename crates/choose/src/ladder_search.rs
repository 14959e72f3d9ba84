//! The search: from cheap to dear, and only where it may still pay.
//!
//! 1. The family that makes the reference is run anyway; the cheapest of its rungs that meets
//!    the tolerance is the first choice.
//! 2. Each other family is tried six rungs below the finest that would be cheaper. A rung that
//!    misses the tolerance is followed by the next that can meet it, were the family's order one
//!    better than it is; a family ends where that rung would be dearer than the choice.
//!    What was learned from others ends it as well (`evidence`). Of families of one order up to 2,
//!    or of one that solve equations, only the cheapest is tried, unless that comes near to the
//!    choice.
//! 3. A rung that meets it is the new choice where it is cheaper, and coarser ones are tried: of the
//!    reference's own family last, when there may be something cheaper.
//!
//! Every run is stopped at the first moment at which it misses, costs more than the choice, or goes
//! on to cost twice as much.
//! A rung whose error is nearer to the tolerance than the reference is certain is not decided: the
//! reference is refined where the rung would be the choice, likely meets the tolerance, and saves
//! much or costs little to decide; else it counts as missing.

mod evidence;

use std::cmp::Reverse;
use std::collections::{BTreeMap, BTreeSet};

use stationary_integrators::Evaluation;

use crate::effort::Purpose;
use crate::ladder::{At, Family, Kind};
use crate::measured::{End, Failure, Foresight, StopRule};
use crate::measured_runs::MeasuredRuns;
use crate::reference::Reference;

/// What the reference says of a rung.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    /// Its error, which is certainly within the tolerance.
    Meets(f64),
    /// Its error, which may or may not be within the tolerance.
    Unclear(f64),
    /// Its error, which is certainly beyond the tolerance: at the moment at which it was stopped.
    Misses(f64),
    /// It was stopped where it cost more than the choice, or had more to do than another reference.
    CostLimit,
    /// There is no error to speak of.
    Failed(Failure),
}

/// The search for the cheapest rung within a tolerance.
#[derive(Debug)]
pub struct LadderSearch<'a, 'e> {
    /// What was run.
    pub runs: &'a mut MeasuredRuns<'e>,
    /// The answer so far.
    pub reference: Reference,
    /// The error that may be made.
    pub tolerance: f64,
    /// Refinements of the reference that are left.
    refinements: u32,
    best: Option<(At, u64)>,
    /// Models whose own error is beyond the tolerance.
    lost: BTreeSet<usize>,
}

/// Rungs below the finest that would be cheaper, where a family is tried first.
const BELOW: usize = 6;
/// Work that differs by less is the same.
const SAME: f64 = 1.1;
/// An error above this says little of the next rung's.
const SATURATED: f64 = 0.3;
/// The part of a rung by which an error may be smaller than its power tells.
const NEARLY: f64 = 0.25;
/// How often the reference is refined for a rung that is too close to tell.
const REFINEMENTS: u32 = 1;
/// Beyond so many tolerances a model's error is no matter of luck with a step.
const CLEAR: f64 = 1.25;
/// Families that come to no solution of a step speak for others of their class.
const FAILURES: u32 = 2;
/// Families that project back to what is held, and only come to other motions, before the others are passed
/// over.
const STRAYS: u32 = 3;
/// A rung that is so much cheaper than the choice is worth any refinement of the reference, and one
/// that is not is worth so many runs of itself.
const MUCH: f64 = 1.5;
const LITTLE: u64 = 4;
/// Modes that are tried first.
const FIRST_MODES: usize = 3;

/// What is judged of a rung that was run.
pub fn judge(
    runs: &MeasuredRuns<'_>,
    reference: &Reference,
    tolerance: f64,
    at: At,
) -> Option<Judgement> {
    let run = runs.seen(at)?;
    if let End::Failed(failure) = &run.end {
        return Some(Judgement::Failed(failure.clone()));
    }
    let error = match reference.error(&run.course) {
        Ok(error) => error,
        Err(failure) => return Some(Judgement::Failed(failure)),
    };
    let error = runs.way(at).unwrap_or(0.0).max(error);
    let own = At { family: reference.family, rung: reference.finest };
    let (least, most) = (error - reference.uncertainty, error + reference.uncertainty);
    Some(match run.end {
        _ if least > tolerance => Judgement::Misses(error),
        End::Stopped => Judgement::CostLimit,
        // What the reference is made of is as wrong as it is uncertain.
        _ if at == own && error < reference.uncertainty && reference.uncertainty <= tolerance => {
            Judgement::Meets(reference.uncertainty)
        }
        _ if most <= tolerance => Judgement::Meets(error),
        _ => Judgement::Unclear(error),
    })
}

/// Rungs that are left at least, if the error shrinks by a power that is one better than known.
pub fn rungs_to_go(family: &Family, tolerance: f64, error: f64) -> usize {
    if error > SATURATED || error <= tolerance {
        return 1;
    }
    let per_rung = match family.kind {
        Kind::EqualSteps => f64::from(family.order + 1) * 2_f64.log10(),
        Kind::Adaptive => 1.5,
        Kind::Modes => return 2,
    };
    ((error / tolerance).log10() / per_rung).ceil().max(1.0) as usize
}

/// Rungs that are left if the error shrinks by the power that is known, or nearly so.
pub fn likely_rungs(family: &Family, tolerance: f64, error: f64) -> usize {
    if error > SATURATED || error <= tolerance {
        return 1;
    }
    let per_rung = match family.kind {
        Kind::EqualSteps => f64::from(family.order) * 2_f64.log10(),
        Kind::Adaptive => 1.0,
        Kind::Modes => return 2,
    };
    ((error / tolerance).log10() / per_rung - NEARLY).ceil().max(1.0) as usize
}

/// What families have in common that likely fail and do well together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct FamilyClass {
    model: usize,
    kind: Kind,
    order: u32,
    solves: bool,
    holds_constraints: bool,
}

pub fn family_class(family: &Family) -> FamilyClass {
    let &Family { model, kind, order, evaluation, holds_constraints, .. } = family;
    FamilyClass {
        model,
        kind,
        order,
        solves: evaluation == Evaluation::Implicit,
        holds_constraints,
    }
}

impl<'a, 'e> LadderSearch<'a, 'e> {
    /// A search that has run nothing but the reference.
    pub fn new(runs: &'a mut MeasuredRuns<'e>, reference: Reference, tolerance: f64) -> Self {
        LadderSearch {
            runs,
            reference,
            tolerance,
            refinements: REFINEMENTS,
            best: None,
            lost: BTreeSet::new(),
        }
    }

    /// Searches, and returns the cheapest rung that was run and meets the tolerance.
    pub fn search(&mut self) -> Option<At> {
        let own = self.reference.family;
        let coarsest = self.take_over(own);
        if coarsest.is_none() {
            // Without a first choice nothing says how dear another may be.
            self.ascend(At { family: own, rung: self.reference.finest + 1 });
        }
        let mut others: Vec<usize> = (0..self.runs.ladder().families.len()).collect();
        others.retain(|&family| family != own);
        // Simple models first. Which method is best is not known; what likely is makes all others
        // cheaper to rule out.
        let likely = if self.is_stiff() { 2.0 } else { 2.0 - self.tolerance.log10() };
        others.sort_by_key(|&family| {
            let family = self.runs.family(family);
            let off = (f64::from(family.order) - likely).abs();
            (
                Reverse(family.simplicity),
                family.model,
                (10.0 * off) as u64,
                family.rungs[0].least_work,
            )
        });
        let mut hopeless: BTreeMap<FamilyClass, bool> = BTreeMap::new();
        let mut failed: BTreeMap<FamilyClass, u32> = BTreeMap::new();
        let projected = self.projected();
        let mut strays = 0;
        for family in others {
            let of = self.class(family);
            if hopeless.get(&of).copied().unwrap_or(false) || self.lost.contains(&of.model) {
                continue;
            }
            self.try_family(family);
            let failures = failed.entry(of).or_default();
            *failures += u32::from(self.only_failed(family));
            if *failures >= FAILURES {
                hopeless.insert(of, true);
                continue;
            }
            if projected.contains(&family) {
                strays += u32::from(self.only_stray(family));
                if strays >= STRAYS {
                    hopeless.extend(projected.iter().map(|&other| (self.class(other), true)));
                    continue;
                }
            }
            // At high orders the constants differ by more than the orders.
            let far = self.is_far(family) || self.is_over_limit(family);
            hopeless.insert(of, (of.order <= 2 || of.solves) && far);
        }
        // By now something cheaper is known than what the reference is made of.
        if let Some(rung) = coarsest {
            self.descend(At { family: own, rung });
        }
        self.answer_own_tolerance();
        self.settle()
    }

    fn class(&self, family: usize) -> FamilyClass {
        family_class(self.runs.family(family))
    }

    /// What names a tolerance asks which one to name, cheap or not.
    fn answer_own_tolerance(&mut self) {
        let Some(family) = self.runs.ladder().asks else { return };
        for rung in self.first(family)..self.runs.family(family).rungs.len() {
            let at = At { family, rung };
            if self.runs.late() || !self.runs.affords(at) {
                return;
            }
            self.runs.measure(at);
            if matches!(self.said(at), Judgement::Meets(_)) {
                return;
            }
        }
    }

    /// The rung at which a family of adaptive steps is tried first.
    fn first(&self, family: usize) -> usize {
        self.runs.family(family).at_most(10.0 * self.tolerance)
    }

    /// The cheapest of all that meets the tolerance, by the reference as it is now; of equal ones
    /// that of the simplest model.
    pub fn settle(&mut self) -> Option<At> {
        let meeting = self.runs.used().filter(|(at, _)| {
            let said = judge(self.runs, &self.reference, self.tolerance, *at);
            matches!(said, Some(Judgement::Meets(_)))
        });
        meeting.min_by_key(|(at, run)| (run.work, Reverse(self.simplicity(*at)))).map(|(at, _)| at)
    }

    /// The same, where coarser rungs than this one are tried too.
    pub fn settle_below(&mut self, at: At) -> Option<At> {
        self.best = Some((at, self.runs.seen(at)?.work));
        self.descend(at);
        self.settle()
    }

    /// What was run for the reference is judged; the coarsest rung of its family that meets the
    /// tolerance, where one does.
    fn take_over(&mut self, family: usize) -> Option<usize> {
        // What was stopped for its cost is tried in its turn.
        let ended = self.runs.used().filter(|(_, run)| run.end != End::Stopped);
        let run: Vec<At> = ended.map(|(at, _)| at).collect();
        let mut coarsest = None;
        for at in run.into_iter().rev() {
            if matches!(self.judged(at), Judgement::Meets(_)) && at.family == family {
                coarsest = Some(at.rung);
            }
        }
        coarsest
    }

    fn try_family(&mut self, family: usize) {
        let rungs = self.runs.family(family).rungs.len();
        let cheaper = |rung: &usize| self.pays(At { family, rung: *rung });
        let Some(finest) = (0..rungs).rev().find(cheaper) else { return };
        let first = match self.runs.family(family).kind {
            Kind::EqualSteps => finest.saturating_sub(BELOW),
            Kind::Adaptive => self.first(family),
            Kind::Modes => FIRST_MODES,
        };
        self.ascend(At { family, rung: first.min(rungs - 1) });
    }

    /// Tries a rung and finer ones, to the first that meets the tolerance.
    fn ascend(&mut self, mut at: At) {
        let mut before = None;
        while at.rung < self.runs.family(at.family).rungs.len() && self.pays(at) {
            if self.runs.late() || !self.runs.affords(at) {
                return;
            }
            match self.judged(at) {
                Judgement::Meets(_) => return self.descend(at),
                Judgement::Misses(error) | Judgement::Unclear(error) => {
                    let still = self.is_still(at, before);
                    let lost = self.is_shared(at) || still && error > CLEAR * self.tolerance;
                    if lost {
                        self.lost.insert(self.runs.family(at.family).model);
                    }
                    if lost || still || self.outdone(at, error) {
                        return;
                    }
                    before = Some(at);
                    at.rung += rungs_to_go(self.runs.family(at.family), self.tolerance, error);
                }
                Judgement::CostLimit => return,
                Judgement::Failed(_) if self.outdone(at, f64::INFINITY) => return,
                Judgement::Failed(_) => at.rung += 1,
            }
        }
    }

    /// Tries coarser rungs than one that meets the tolerance, while they do.
    fn descend(&mut self, mut at: At) {
        while at.rung > 0 && !self.runs.late() {
            at.rung -= 1;
            if !self.pays(at) || !matches!(self.judged(at), Judgement::Meets(_)) {
                return;
            }
        }
    }

    fn simplicity(&self, at: At) -> u32 {
        self.runs.family(at.family).simplicity
    }

    /// Whether the rung would be cheaper than the choice, or as cheap by a simpler model.
    fn pays(&self, at: At) -> bool {
        let Some((best, work)) = self.best else { return true };
        let predicted = self.runs.predicted(at);
        match self.simplicity(at) > self.simplicity(best) {
            true => predicted <= work,
            false => SAME * (predicted as f64) < work as f64,
        }
    }

    fn judged(&mut self, at: At) -> Judgement {
        let work = self.attempted(at);
        let mut said = self.said(at);
        while self.refinements > 0 && self.deserves(at, &said, work) {
            self.refinements -= 1;
            self.runs.turn_to(Purpose::Reference);
            let finer = self.reference.refined(self.runs);
            self.runs.turn_to(Purpose::Search);
            let Some(finer) = finer else { break };
            self.reference = finer;
            said = self.said(at);
        }
        let better = self.best.is_none_or(|(best, least)| {
            work < least || work == least && self.simplicity(at) > self.simplicity(best)
        });
        if matches!(said, Judgement::Meets(_)) && better {
            self.best = Some((at, work));
        }
        said
    }

    /// Whether what is too close to tell is worth a finer reference: it likely meets the tolerance,
    /// and saves much or costs little to decide.
    fn deserves(&self, at: At, said: &Judgement, work: u64) -> bool {
        let likely = matches!(said, Judgement::Unclear(error) if *error <= self.tolerance);
        let next = self.reference.next(self.runs);
        let saves = self.best.is_none_or(|(_, least)| least as f64 > MUCH * work as f64);
        likely && self.pays(at) && next.is_some_and(|next| saves || next <= LITTLE * work)
    }

    /// Runs a rung as long as it may be the choice, and returns its work.
    fn attempted(&mut self, at: At) -> u64 {
        // What is coarser than an adaptive run that came to its end will come there sooner.
        let finer = At { rung: at.rung + 1, ..at };
        let own = self.runs.family(at.family).kind == Kind::Adaptive;
        let ended = own && self.runs.seen(finer).is_some_and(|run| run.end == End::Whole);
        let trial = StopRule {
            reference: Some(&self.reference),
            most_error: self.tolerance + self.reference.uncertainty,
            most_work: self.best.map_or(u64::MAX, |(_, work)| work),
            foresight: if ended { Foresight::None } else { Foresight::Steady },
        };
        if self.runs.seen(at).is_some_and(|run| run.end == End::Whole) {
            return self.runs.measure(at).work;
        }
        self.runs.attempt(at, &trial).work
    }

    fn said(&self, at: At) -> Judgement {
        let said = judge(self.runs, &self.reference, self.tolerance, at);
        said.unwrap_or(Judgement::Failed(Failure::OutOfBudget))
    }
}
