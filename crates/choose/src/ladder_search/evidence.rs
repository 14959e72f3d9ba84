//! What the runs of some families say of others, so that these need not be run.
//!
//! - Where explicit steps of order 2 are unstable, few stages are likelier to do than a high order.
//! - A family of the same or a higher order that did better for the same work will also do so with
//!   finer steps.
//! - Where finer steps change nothing, or three methods have the same error by one model, what is
//!   left is the model's error.
//! - A family whose steps have no solution, or all of whose rungs are too dear, speaks for its sort.

use std::collections::BTreeSet;

use super::{Judgement, LadderSearch, SAME, SATURATED, family_class};
use crate::ladder::{At, Kind};
use crate::measured::{End, Failure, Measured};

/// A family that would need so much more work than the choice speaks for others of its order.
const FAR: f64 = 4.0;
/// Errors that differ by less are the same, and methods that must have the same one.
const SHARED: f64 = 1.05;
const SHARING: usize = 2;
/// Over so few moments an error is a matter of luck, unless it is smaller by such a factor.
const FEW_MOMENTS: usize = 3;
const CONFIDENT: f64 = 0.25;

impl LadderSearch<'_, '_> {
    /// Whether stability bounds the explicit steps: then what takes the least of them is likely.
    pub(super) fn is_stiff(&self) -> bool {
        self.runs.used().any(|(at, run)| {
            let family = self.runs.family(at.family);
            let unstable = matches!(run.end, End::Failed(Failure::Unstable(_)));
            family.kind == Kind::EqualSteps && family.order == 2 && unstable
        })
    }

    /// Whether a family was tried, and no rung of it has an error to speak of.
    pub(super) fn only_failed(&self, family: usize) -> bool {
        let mut own = self.runs.used().filter(|(at, _)| at.family == family).peekable();
        own.peek().is_some()
            && own
                .all(|(at, _)| matches!(self.said(at), Judgement::Failed(Failure::NotConverged(_))))
    }

    /// The families that take steps without what is held and project back to it: their errors are those of the
    /// projection, whatever their order.
    pub(super) fn projected(&self) -> Vec<usize> {
        let ladder = self.runs.ladder();
        let projects = |family: &usize| {
            let family = &ladder.families[*family];
            ladder.is_constrained
                && !family.holds_constraints
                && family.kind == Kind::EqualSteps
                && family.model == 0
        };
        (0..ladder.families.len()).filter(projects).collect()
    }

    /// Whether a family was tried, and every rung of it comes to another motion or to none.
    pub(super) fn only_stray(&self, family: usize) -> bool {
        let mut own = self.runs.used().filter(|(at, _)| at.family == family).peekable();
        own.peek().is_some() && own.all(|(at, _)| matches!(self.said(at), Judgement::Failed(_)))
    }

    /// Whether a family that solves equations was tried and every rung of it is too dear.
    pub(super) fn is_over_limit(&self, family: usize) -> bool {
        let solves = family_class(self.runs.family(family)).solves;
        let mut own = self.runs.used().filter(|(at, _)| at.family == family).peekable();
        solves
            && own.peek().is_some()
            && own.all(|(at, _)| matches!(self.said(at), Judgement::CostLimit))
    }

    /// Whether a family that was tried would need far more work than the choice.
    pub(super) fn is_far(&self, family: usize) -> bool {
        let Some((_, best)) = self.best else { return false };
        let own = self.runs.family(family);
        let needs = self.runs.used().filter(|(at, _)| at.family == family).filter_map(
            |(at, run)| match self.said(at) {
                Judgement::Meets(_) => Some(run.work as f64),
                Judgement::Misses(error) | Judgement::Unclear(error) => {
                    let power = f64::from(own.order.max(1));
                    Some(run.expected() as f64 * (error / self.tolerance).powf(1.0 / power))
                }
                Judgement::CostLimit | Judgement::Failed(_) => None,
            },
        );
        let least = needs.reduce(f64::min);
        own.kind == Kind::EqualSteps && least.is_some_and(|least| least > FAR * best as f64)
    }

    /// Whether finer steps change nothing any more: what is left is the model's error.
    pub(super) fn is_still(&self, at: At, before: Option<At>) -> bool {
        let seen = |at: At| self.runs.seen(at).map(|run| &run.course);
        let (Some(fine), Some(coarse)) = (seen(at), before.and_then(seen)) else { return false };
        let moments = fine.values.len().min(coarse.values.len());
        let [now, then] = [fine, coarse].map(|course| self.reference.error_until(course, moments));
        let family = self.runs.family(at.family);
        let steps = !family.converges() && family.kind != Kind::Modes;
        steps && moments > 1 && now > then / SAME && now < then * SAME
    }

    /// Whether other methods have the same error by the same model: then it is the model's.
    pub(super) fn is_shared(&self, at: At) -> bool {
        let family = self.runs.family(at.family);
        let Some(own) = self.runs.seen(at).map(|run| &run.course) else { return false };
        if family.converges() || own.values.len() < 2 {
            return false;
        }
        let error = self.reference.error_until(own, own.values.len());
        let same = |other: f64| other > error / SHARED && other < error * SHARED;
        let sharing = self.runs.used().filter(|(other, run)| {
            other.family != at.family
                && self.runs.family(other.family).model == family.model
                && self.error_until(run, own.values.len()).is_some_and(same)
        });
        let families: BTreeSet<usize> = sharing.map(|(other, _)| other.family).collect();
        families.len() >= SHARING
    }

    /// Whether a family of the same or a higher order has a smaller error for the same work, as far
    /// as both were run.
    pub(super) fn outdone(&self, at: At, error: f64) -> bool {
        let family = self.runs.family(at.family);
        let work = self.runs.predicted(at) as f64;
        let moments = self.runs.seen(at).map_or(0, |run| run.course.values.len());
        self.runs.used().any(|(other, run)| {
            let other_family = self.runs.family(other.family);
            let no_dearer = run.expected() as f64 <= SAME * work;
            let comparable = other_family.kind == Kind::EqualSteps
                && family.kind != Kind::Modes
                && other_family.model == family.model
                && other_family.order >= family.order;
            // What was stopped may have failed later on, as this one did; and what finds its own
            // steps is stable where equal ones are not.
            let equal = family.kind == Kind::EqualSteps;
            let judged = equal && error.is_finite() || run.end == End::Whole;
            let luck = if moments <= FEW_MOMENTS { CONFIDENT } else { 1.0 };
            let better = |own: f64| judged && own < luck * error && own < SATURATED;
            other.family != at.family
                && comparable
                && no_dearer
                && self.error_until(run, moments).is_some_and(better)
        })
    }

    /// The error of a run over its first moments, where it has so many.
    pub(super) fn error_until(&self, run: &Measured, moments: usize) -> Option<f64> {
        let enough = !matches!(run.end, End::Failed(_)) && run.course.values.len() >= moments;
        enough.then(|| self.reference.error_until(&run.course, moments))
    }
}
