//! The search: from cheap to dear, and only where it may still pay.
//!
//! 1. The family that makes the reference is climbed anyway; the cheapest of its rungs that meets
//!    the tolerance is the first choice.
//! 2. Each other family is tried six rungs below the finest that would be cheaper. A rung that
//!    misses the tolerance is followed by the next that can meet it, were the family's order one
//!    better than it is; a family ends where that rung would be dearer than the choice.
//!    It ends as well where a family of the same or a higher order did better for the same work: it
//!    will also do so with finer steps.
//! 3. A rung that meets it is the new choice where it is cheaper, and coarser ones are tried.
//!
//! A rung whose error is nearer to the tolerance than the reference is certain is not decided: the
//! reference is refined where the rung would be the choice, and else it counts as missing.

use super::lab::{At, Lab};
use super::ladder::Kind;
use super::reference::Reference;
use super::run::Failure;

/// What the reference says of a rung.
#[derive(Clone, Debug, PartialEq)]
pub enum Judgement {
    /// Its error, which is certainly within the tolerance.
    Meets(f64),
    /// Its error, which may or may not be within the tolerance.
    Unclear(f64),
    /// Its error, which is certainly beyond the tolerance.
    Misses(f64),
    /// There is no error to speak of.
    Failed(Failure),
}

/// The search for the cheapest rung within a tolerance.
#[derive(Debug)]
pub struct Climb<'a> {
    /// What was run.
    pub lab: &'a mut Lab,
    /// The answer so far.
    pub reference: Reference,
    /// The error that may be made.
    pub tolerance: f64,
    /// Refinements of the reference that are left.
    refinements: u32,
    best: Option<(At, u64)>,
}

/// Rungs below the finest that would be cheaper, where a family is tried first.
const BELOW: usize = 6;
/// Work that differs by less is the same.
const SAME: f64 = 1.1;
/// An error above this says little of the next rung's.
const SATURATED: f64 = 0.3;
/// How often the reference is refined for a rung that is too close to tell.
const REFINEMENTS: u32 = 2;

/// What is judged of a rung that was run.
pub fn judge(lab: &Lab, reference: &Reference, tolerance: f64, at: At) -> Option<Judgement> {
    let (_, run) = lab.used().find(|(own, _)| *own == at)?;
    let own = At { family: reference.family, rung: reference.finest };
    let error = run.outcome.as_ref().map_err(Clone::clone);
    Some(match error.and_then(|course| reference.error(course)) {
        // What the reference is made of is as wrong as it is uncertain.
        Ok(error)
            if at == own && error < reference.uncertainty && reference.uncertainty <= tolerance =>
        {
            Judgement::Meets(reference.uncertainty)
        }
        Err(failure) => Judgement::Failed(failure),
        Ok(error) if error + reference.uncertainty <= tolerance => Judgement::Meets(error),
        Ok(error) if error - reference.uncertainty > tolerance => Judgement::Misses(error),
        Ok(error) => Judgement::Unclear(error),
    })
}

impl<'a> Climb<'a> {
    /// A search that has run nothing but the reference.
    pub fn new(lab: &'a mut Lab, reference: Reference, tolerance: f64) -> Self {
        Climb { lab, reference, tolerance, refinements: REFINEMENTS, best: None }
    }

    /// Searches, and returns the cheapest rung that was run and meets the tolerance.
    pub fn search(&mut self) -> Option<At> {
        let own = self.reference.family;
        self.take_over(own);
        let mut others: Vec<usize> = (0..self.lab.ladder().families.len()).collect();
        others.retain(|&family| family != own);
        // Which is best is not known; what likely is makes all others cheaper to rule out.
        let likely = 2.0 - self.tolerance.log10();
        others.sort_by_key(|&family| {
            let family = self.lab.family(family);
            let off = (f64::from(family.order) - likely).abs();
            ((10.0 * off) as u64, family.rungs[0].least_work)
        });
        for family in others {
            self.try_family(family);
        }
        self.settle()
    }

    /// The cheapest of all that meets the tolerance, by the reference as it is now.
    fn settle(&mut self) -> Option<At> {
        let meeting = self.lab.used().filter(|(at, _)| {
            let said = judge(self.lab, &self.reference, self.tolerance, *at);
            matches!(said, Some(Judgement::Meets(_)))
        });
        meeting.min_by_key(|(_, run)| run.work).map(|(at, _)| at)
    }

    /// What was run for the reference is judged, and its family climbed on to the first rung that
    /// meets the tolerance.
    fn take_over(&mut self, family: usize) {
        let run: Vec<At> = self.lab.used().map(|(at, _)| at).collect();
        let mut coarsest = None;
        for at in run.into_iter().rev() {
            if matches!(self.judged(at), Judgement::Meets(_)) && at.family == family {
                coarsest = Some(at.rung);
            }
        }
        match coarsest {
            Some(rung) => self.descend(At { family, rung }),
            None => {
                let first = At { family, rung: self.reference.finest + 1 };
                self.ascend(first);
            }
        }
    }

    fn try_family(&mut self, family: usize) {
        let rungs = self.lab.family(family).rungs.len();
        let cheaper = |rung: &usize| self.pays(At { family, rung: *rung });
        let Some(finest) = (0..rungs).rev().find(cheaper) else { return };
        let first = match self.lab.family(family).kind {
            Kind::EqualSteps => finest.saturating_sub(BELOW),
            Kind::OwnSteps => (-self.tolerance.log10()).round().max(2.0) as usize - 2,
        };
        self.ascend(At { family, rung: first.min(rungs - 1) });
    }

    /// Tries a rung and finer ones, to the first that meets the tolerance.
    fn ascend(&mut self, mut at: At) {
        while at.rung < self.lab.family(at.family).rungs.len() && self.pays(at) {
            if self.lab.late() {
                return;
            }
            match self.judged(at) {
                Judgement::Meets(_) => return self.descend(at),
                Judgement::Misses(error) | Judgement::Unclear(error) => {
                    if self.outdone(at, error) {
                        return;
                    }
                    at.rung += self.rungs_to_go(at, error);
                }
                Judgement::Failed(_) if self.outdone(at, f64::INFINITY) => return,
                Judgement::Failed(_) => at.rung += 1,
            }
        }
    }

    /// Whether a family of the same or a higher order has a smaller error for the same work.
    fn outdone(&self, at: At, error: f64) -> bool {
        let order = self.lab.family(at.family).order;
        let work = self.lab.predicted(at) as f64;
        self.lab.used().any(|(other, run)| {
            let family = self.lab.family(other.family);
            let no_dearer = run.work as f64 <= SAME * work;
            let known = || run.outcome.as_ref().ok().and_then(|c| self.reference.error(c).ok());
            let comparable = family.kind == Kind::EqualSteps && family.order >= order;
            let better = |own: f64| own < error && own < SATURATED;
            other.family != at.family && comparable && no_dearer && known().is_some_and(better)
        })
    }

    /// Tries coarser rungs than one that meets the tolerance, while they do.
    fn descend(&mut self, mut at: At) {
        while at.rung > 0 && !self.lab.late() {
            at.rung -= 1;
            if !matches!(self.judged(at), Judgement::Meets(_)) {
                return;
            }
        }
    }

    /// Whether the rung would be cheaper than the choice.
    fn pays(&self, at: At) -> bool {
        self.best.is_none_or(|(_, work)| self.lab.predicted(at) < work)
    }

    /// Rungs that are left at least, if the error shrinks by a power that is one better than known.
    fn rungs_to_go(&self, at: At, error: f64) -> usize {
        if error > SATURATED || error <= self.tolerance {
            return 1;
        }
        let family = self.lab.family(at.family);
        let per_rung = match family.kind {
            Kind::EqualSteps => f64::from(family.order + 1) * 2_f64.log10(),
            Kind::OwnSteps => 1.5,
        };
        ((error / self.tolerance).log10() / per_rung).ceil().max(1.0) as usize
    }

    fn judged(&mut self, at: At) -> Judgement {
        let work = self.lab.measure(at).work;
        let mut said = self.said(at);
        while matches!(said, Judgement::Unclear(_)) && self.refinements > 0 && self.pays(at) {
            self.refinements -= 1;
            let Some(finer) = self.reference.refined(self.lab) else { break };
            self.reference = finer;
            said = self.said(at);
        }
        let cheaper = self.best.is_none_or(|(_, best)| work < best);
        if matches!(said, Judgement::Meets(_)) && cheaper {
            self.best = Some((at, work));
        }
        said
    }

    fn said(&self, at: At) -> Judgement {
        let said = judge(self.lab, &self.reference, self.tolerance, at);
        said.unwrap_or(Judgement::Failed(Failure::OutOfBudget))
    }
}
