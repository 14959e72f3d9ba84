//! The answer that rungs are judged by, made on the ladder itself, with its uncertainty.
//!
//! ```text
//! equal steps    x(h) = x + c h^p + ...     d1 = |x(2h) - x(4h)|, d2 = |x(h) - x(2h)|
//!                d1 / d2 within a third of 2^p:   x* = x(h) + (x(h) - x(2h)) / (2^p - 1)
//!                                                 uncertainty |x*(h) - x*(2h)|
//!                else                             x* = x(h),  uncertainty d2 max(1, 1/(d1/d2 - 1))
//!                the same of impacts and the like, by one method alone: no less than d1/2
//!                two rungs alone                  x* = x(h),  uncertainty d2
//! adaptive       x* = x(tolerance),               uncertainty |x* - x(the looser one before)|
//! closed form    x* = x(all modes of heat),       uncertainty that of the modes
//! ```
//! Each is the error of what is one rung coarser than `x*`, not of `x*`. Differences of equal steps
//! that do not shrink prove nothing: their uncertainty is infinite. A rung that failed is passed over;
//! where there is no third that did not, there are two alone. Where something stops within a step, differences
//! shrink over several rungs, not from each to the next. How fast those of adaptive steps shrink is not trusted:
//! at the border of stability a tighter tolerance may change less than it should. Where nothing takes energy,
//! a reference is as uncertain as its energy changes, times a margin: what is asked for may hide it.

use std::cmp::Reverse;

use stationary_integrators::Evaluation;

use crate::ladder::{At, Kind, Scale};
use crate::measured::{Course, End, Failure, Foresight, StopRule, apart, distance};
use crate::measured_runs::MeasuredRuns;

/// The best answer so far.
#[derive(Clone, Debug)]
pub struct Reference {
    /// The family that it is made by.
    pub family: usize,
    /// Its finest rung.
    pub finest: usize,
    /// Whether it is extrapolated to a step of zero.
    pub extrapolated: Extrapolated,
    /// The answer.
    pub course: Course,
    /// Its own error, relative to its scale.
    pub uncertainty: f64,
    /// The coarser rung that it was compared with, and how far apart the two are at the moments.
    pub before: usize,
    /// See there.
    pub apart: f64,
    /// Whether its runs may differ by more between the moments: there they near each other faster than their order,
    /// as where a phase does not show, or nothing tells how fast.
    pub may_hide: bool,
    /// Whether a run of another kind was found to agree with it over the whole way.
    pub is_confirmed: bool,
}

/// Whether an order held.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolated {
    /// By Richardson.
    Yes,
    /// The finest run as it is.
    No,
}

/// How near the ratio of differences must be to the order's power, as a factor.
const NEAR: f64 = 1.33;
/// An uncertainty above this says little of the next one.
const SATURATED: f64 = 0.3;
/// Below this ratio differences do not shrink.
const SHRINKING: f64 = 1.5;
/// Differences that shrink all together where the last two do not.
const SEVERAL: usize = 5;
/// Differences below this part of the scale may be rounding, which adds up to so many times that.
const ROUNDING: f64 = 1e-10;
const FROM_ROUNDING: f64 = 10.0;
/// A reference is to keep its energy better than what is asked for, so many times.
const MARGIN: f64 = 2.5;
/// Runs of a family that come to where there is nothing to observe before it is given up.
const UNDEFINED: usize = 3;
/// The factor by which the scales of two runs of one motion may differ.
const SCALES: f64 = 2.0;
/// What all modes together are uncertain by.
const OF_MODES: f64 = 1e-9;

/// The order from which on steps of their own choice are cheap for many digits.
const MANY_DIGITS: u32 = 8;

/// The ladder's families in the order in which references within so much are made by them: first
/// those without equations whose order fits, of which the one of the most stages errs the least.
pub fn preferred(runs: &MeasuredRuns<'_>, enough: f64) -> Vec<usize> {
    let wanted: u32 = if enough > 1e-4 {
        4
    } else if enough > 1e-7 {
        6
    } else {
        8
    };
    let mut families: Vec<usize> = (0..runs.ladder().families.len()).collect();
    families.retain(|&family| runs.family(family).converges());
    families.sort_by_key(|&place| {
        let family = runs.family(place);
        let solves = family.evaluation == Evaluation::Implicit;
        // What chooses its steps is asked for more digits than a choice.
        let low = family.kind == Kind::Adaptive && !solves && family.order < MANY_DIGITS;
        let own = family.kind == Kind::Adaptive && wanted < 8;
        let work = Reverse((family.rungs[0].least_work, place));
        (solves, low, family.order.abs_diff(wanted), own, Reverse(family.order), work)
    });
    families
}

/// A family on its way to a reference.
struct Making {
    family: usize,
    finest: usize,
    best: Option<Reference>,
}

impl Making {
    fn new(runs: &MeasuredRuns<'_>, family: usize, enough: f64) -> Self {
        let finest = match runs.family(family).kind {
            Kind::EqualSteps => 1,
            Kind::Adaptive => runs.family(family).at_most(enough) + 1,
            Kind::Modes => runs.family(family).rungs.len() - 1,
        };
        Making { family, finest, best: None }
    }

    /// The work that is left, where there is a next rung: to that, and to as many more as its order
    /// asks for where it is known how far there is to go.
    fn left(&self, runs: &MeasuredRuns<'_>, enough: f64) -> Option<f64> {
        let next = self.next(runs)? as f64;
        let family = runs.family(self.family);
        let (shrinks, grows) = match family.kind {
            Kind::Adaptive => (10.0, 10_f64.powf(1.0 / f64::from(family.order + 1))),
            Kind::EqualSteps | Kind::Modes => (2_f64.powi(family.order as i32), 2.0),
        };
        let far = self.uncertainty().min(SATURATED) / enough;
        // Where nothing is known yet, the next one may do.
        let rungs = if self.is_known(runs) && self.uncertainty() <= BEYOND {
            far.ln() / f64::ln(shrinks)
        } else {
            1.0
        };
        Some((0..rungs.ceil().max(1.0) as i32).map(|rung| next * f64::powi(grows, rung)).sum())
    }

    /// Whether what was run says how far there is to go: what equal steps differ from across those
    /// that failed does not.
    fn is_known(&self, runs: &MeasuredRuns<'_>) -> bool {
        let came = |rung: &usize| {
            let run = runs.seen(At { family: self.family, rung: *rung });
            run.is_some_and(|run| run.whole().is_some())
        };
        let own = runs.family(self.family).kind == Kind::Adaptive;
        let first = self.finest.saturating_sub(2);
        self.best.is_some() && (own || (first..self.finest).all(|rung| came(&rung)))
    }

    /// Whether its last runs came to where there is nothing to observe: a finer one comes there too.
    fn is_undefined(&self, runs: &MeasuredRuns<'_>) -> bool {
        let undefined = |rung: usize| {
            let run = runs.seen(At { family: self.family, rung });
            run.is_some_and(|run| matches!(run.end, End::Failed(Failure::Undefined(_))))
        };
        self.finest >= UNDEFINED && (self.finest - UNDEFINED..self.finest).all(undefined)
    }

    /// The work of the next rung, where there is one, and of another where that would be alone: the
    /// coarser one, or where that failed, a finer one.
    fn next(&self, runs: &MeasuredRuns<'_>) -> Option<u64> {
        let rungs = runs.family(self.family).rungs.len();
        let at = |rung: usize| At { family: self.family, rung };
        if self.finest >= rungs || !runs.affords(at(self.finest)) || self.is_undefined(runs) {
            return None;
        }
        if runs.family(self.family).is_closed {
            return Some(runs.predicted(at(self.finest)));
        }
        let before = runs.seen(at(self.finest - 1));
        let other = match before {
            _ if self.is_known(runs) => None,
            None => Some(self.finest - 1),
            Some(run) if run.whole().is_some() => None,
            Some(_) => Some(self.finest + 1).filter(|&after| after < rungs),
        };
        let other = other.map_or(0, |other| runs.predicted(at(other)));
        Some(runs.predicted(at(self.finest)) + other)
    }

    /// Tries the next rung; where that has more to do still than others, it is stopped, and tried
    /// again only where those turn out to be dearer.
    fn advance(&mut self, runs: &mut MeasuredRuns<'_>, others: f64) {
        let trial = StopRule {
            reference: None,
            most_error: f64::INFINITY,
            most_work: others as u64,
            foresight: Foresight::RemainingCost,
        };
        let at = At { family: self.family, rung: self.finest };
        let spent = runs.spent();
        // What is stopped where it was before, and has the least left still, is run to its end.
        if runs.attempt(at, &trial).end == End::Stopped && runs.spent() > spent {
            return;
        }
        let next = Reference::at(runs, self.family, self.finest);
        let hopeless = next.as_ref().is_none_or(|next| next.uncertainty > SATURATED);
        // A decade of tolerance costs little.
        let own = runs.family(self.family).kind == Kind::Adaptive;
        self.finest += if own && hopeless { 2 } else { 1 };
        let better = |next: &Reference| self.best.as_ref().is_none_or(|best| next.is_better(best));
        self.best = next.filter(better).or(self.best.take());
    }

    /// Whether what is asked for does not move, so that no rung will be nearer to it.
    fn is_still(&self) -> bool {
        self.best.as_ref().is_some_and(|best| best.course.is_still)
    }

    fn uncertainty(&self) -> f64 {
        self.best.as_ref().map_or(f64::INFINITY, |best| best.uncertainty)
    }
}

impl Reference {
    /// The answer by one of these families, in turn the one that has the least work left, until
    /// the uncertainty of one is at most `enough`; else the best that they can do, nothing where
    /// they can do nothing.
    pub fn make(runs: &mut MeasuredRuns<'_>, families: &[usize], enough: f64) -> Option<Self> {
        let mut making: Vec<Making> =
            families.iter().map(|&family| Making::new(runs, family, enough)).collect();
        let ends = |making: &Making| making.uncertainty() <= enough || making.is_still();
        while !runs.late() && !making.iter().any(ends) {
            let left = making.iter_mut();
            let left = left.filter_map(|making| Some((making.left(runs, enough)?, making)));
            let mut left: Vec<(f64, &mut Making)> = left.collect();
            left.sort_by(|a, b| a.0.total_cmp(&b.0));
            let mut left = left.into_iter();
            let Some((_, cheapest)) = left.next() else { break };
            cheapest.advance(runs, left.next().map_or(f64::INFINITY, |(others, _)| others));
        }
        let made = making.into_iter().filter_map(|making| making.best);
        made.reduce(|best, other| if best.is_better(&other) { best } else { other })
    }

    /// Whether it is no less certain than another. What does not move in one moves in another by its
    /// errors alone.
    pub(crate) fn is_better(&self, other: &Reference) -> bool {
        match (self.course.is_still, other.course.is_still) {
            (true, false) => true,
            (false, true) => false,
            _ => self.uncertainty <= other.uncertainty,
        }
    }

    /// The work of one more rung, where there is one.
    pub fn next(&self, runs: &MeasuredRuns<'_>) -> Option<u64> {
        let at = At { family: self.family, rung: self.finest + 1 };
        let there = at.rung < runs.family(self.family).rungs.len() && runs.affords(at);
        there.then(|| runs.predicted(at))
    }

    /// The answer by one more rung; nothing where that is no better.
    pub fn refined(&self, runs: &mut MeasuredRuns<'_>) -> Option<Self> {
        self.next(runs)?;
        if runs.late() {
            return None;
        }
        Reference::at(runs, self.family, self.finest + 1)
            .filter(|new| new.uncertainty < self.uncertainty)
    }

    /// The answer by a family as its rungs up to this one give it.
    pub fn at(runs: &mut MeasuredRuns<'_>, family: usize, finest: usize) -> Option<Self> {
        let (kind, order) = (runs.family(family).kind, runs.family(family).order);
        let mut fine = runs.measure(At { family, rung: finest }).whole().cloned()?;
        if runs.family(family).is_closed {
            return Some(Reference {
                family,
                finest,
                extrapolated: Extrapolated::No,
                course: fine,
                uncertainty: OF_MODES,
                before: finest,
                apart: 0.0,
                may_hide: false,
                is_confirmed: false,
            });
        }
        let (before, middle) = Reference::coarser(runs, family, finest)?;
        let scale = fine.scale;
        let last = apart(&fine.values, &middle.values);
        let keeps = runs.ladder().keeps_energy;
        let reference = |course: Course, extrapolated, error: f64| {
            let own = if error.is_finite() { error / course.scale } else { f64::INFINITY };
            let uncertainty = if keeps { own.max(MARGIN * course.drift()) } else { own };
            let (apart, may_hide, is_confirmed) = (last, false, false);
            Reference {
                family,
                finest,
                extrapolated,
                course,
                uncertainty,
                before,
                apart,
                may_hide,
                is_confirmed,
            }
        };
        // What grows without bounds has another scale at each rung: relative to it anything is kept.
        let [smaller, larger] = [scale.min(middle.scale), scale.max(middle.scale)];
        let is_another = runs.ladder().scale != Scale::Way && larger > SCALES * smaller;
        if is_another || middle.outcomes != fine.outcomes {
            return Some(reference(fine, Extrapolated::No, f64::INFINITY));
        }
        if kind == Kind::Adaptive {
            return Some(reference(fine, Extrapolated::No, last).hiding());
        }
        let alone = runs.ladder().families.iter().filter(|f| f.converges()).count() == 1;
        let Some((third, coarse)) = Reference::coarser(runs, family, before) else {
            // Whoever has nothing to compare with must show that differences shrink.
            let uncertainty = if alone { f64::INFINITY } else { last };
            return Some(reference(fine, Extrapolated::No, uncertainty).hiding());
        };
        let halved = finest - before == 1 && before - third == 1;
        let ratio = apart(&middle.values, &coarse.values) / last;
        let power = f64::from(1_u32 << order);
        // Nothing differs where an observable is kept to rounding.
        if last <= 1e-13 * scale {
            return Some(reference(fine, Extrapolated::No, last).hiding());
        }
        if halved && ratio > power / NEAR && ratio < power * NEAR {
            let weight = 1.0 / (power - 1.0);
            let best = extrapolated(&middle.values, &fine.values, weight);
            let before = extrapolated(&coarse.values, &middle.values, weight);
            let error = apart(&best, &before);
            for (fine, middle) in fine.energies.iter_mut().zip(&middle.energies) {
                *fine += weight * (*fine - middle);
            }
            if runs.ladder().scale == Scale::Way {
                fine.shrink_scale(&best);
            }
            let course = Course { values: best, ..fine };
            return Some(reference(course, Extrapolated::Yes, error));
        }
        let error = if ratio < SHRINKING {
            Reference::by_many(runs, family, finest, scale)
        } else {
            last / (ratio - 1.0).min(1.0)
        };
        // Errors of what happens at once fall with the step, and the last two runs may be near each other by luck.
        let error =
            if alone && !runs.ladder().is_smooth { error.max(0.5 * ratio * last) } else { error };
        let made = reference(fine, Extrapolated::No, error);
        Some(if ratio >= power * NEAR { made.hiding() } else { made })
    }

    fn hiding(self) -> Self {
        Reference { may_hide: true, ..self }
    }

    /// The error where the last two differences do not shrink: they are rounding, or those of several
    /// rungs shrink all the same, as where something stops within a step.
    fn by_many(runs: &MeasuredRuns<'_>, family: usize, finest: usize, scale: f64) -> f64 {
        let course = |rung: usize| runs.seen(At { family, rung }).and_then(|run| run.whole());
        let values: Vec<&Vec<Vec<f64>>> =
            (0..=finest).rev().map_while(course).map(|course| &course.values).collect();
        let differences: Vec<f64> =
            values.windows(2).take(SEVERAL).map(|pair| apart(pair[0], pair[1])).collect();
        let (Some(&last), Some(&before)) = (differences.first(), differences.get(1)) else {
            return f64::INFINITY;
        };
        let largest = last.max(before);
        if largest <= ROUNDING * scale {
            return FROM_ROUNDING * largest;
        }
        let Some(first) = differences.get(SEVERAL - 1) else { return f64::INFINITY };
        let ratio = (first / largest).powf(1.0 / (SEVERAL - 2) as f64);
        if ratio < SHRINKING { f64::INFINITY } else { largest / (ratio - 1.0).min(1.0) }
    }

    /// The next coarser rung of a family that came to its end: the one before, or where that failed,
    /// or tolerances are meant, one that was run already.
    fn coarser(runs: &mut MeasuredRuns<'_>, family: usize, rung: usize) -> Option<(usize, Course)> {
        let before = At { family, rung: rung.checked_sub(1)? };
        let looser = |rung: &usize| runs.seen(At { family, rung: *rung }).is_some();
        let known = runs.family(family).kind == Kind::Adaptive && (0..rung).any(|r| looser(&r));
        if !known {
            runs.measure(before);
        }
        (0..rung).rev().find_map(|rung| {
            let run = runs.seen(At { family, rung })?;
            Some((rung, run.whole()?.clone()))
        })
    }

    /// The error of a course as far as it goes, relative to the scale.
    ///
    /// # Errors
    /// [`Failure::WrongPhysics`] where the course is that of another motion: its energy changes by
    /// half of the largest kinetic energy too much or too little, or other things happen on the way;
    /// [`Failure::Unstable`] where it changes by far more.
    pub fn error(&self, course: &Course) -> Result<f64, Failure> {
        let own = &self.course;
        let change = |energies: &[f64], k: usize| energies[k] - energies[0];
        let moments = 0..course.energies.len().min(own.energies.len());
        let apart = moments.map(|k| (change(&course.energies, k) - change(&own.energies, k)).abs());
        let off = apart.fold(0.0, f64::max) / own.of_energies();
        // Heat has none: its Dirichlet energy is of the mesh.
        if off > OFF && own.kinetic > 0.0 {
            let said = |off: String| {
                format!("its energy is off by {off} times the largest kinetic energy")
            };
            return Err(match off > BEYOND {
                true => Failure::Unstable(said(format!("{off:.0e}"))),
                false => Failure::WrongPhysics(said(format!("{off:.1}"))),
            });
        }
        let whole = course.values.len() == own.values.len();
        if whole && course.outcomes != own.outcomes || !own.outcomes.starts_with(&course.outcomes) {
            return Err(Failure::WrongPhysics("other things happen on the way".to_owned()));
        }
        Ok(self.error_until(course, course.values.len()))
    }

    /// The largest error of the first so many moments of a course, relative to the scale.
    pub fn error_until(&self, course: &Course, moments: usize) -> f64 {
        let values = course.values.iter().take(moments).enumerate();
        values.map(|(k, observed)| self.error_at(k, observed)).fold(0.0, f64::max)
    }

    /// The error at a moment, relative to the scale.
    pub fn error_at(&self, moment: usize, observed: &[f64]) -> f64 {
        let own = &self.course;
        own.values.get(moment).map_or(0.0, |values| distance(observed, values) / own.scale)
    }
}

/// An energy that is off by this part of the largest kinetic energy belongs to another motion.
pub(crate) const OFF: f64 = 0.5;
/// An energy that is off by more grows without bounds.
const BEYOND: f64 = 10.0;

/// `fine + weight (fine - coarse)` at every moment.
fn extrapolated(coarse: &[Vec<f64>], fine: &[Vec<f64>], weight: f64) -> Vec<Vec<f64>> {
    let moment = |(coarse, fine): (&Vec<f64>, &Vec<f64>)| {
        coarse.iter().zip(fine).map(|(coarse, fine)| fine + weight * (fine - coarse)).collect()
    };
    coarse.iter().zip(fine).map(moment).collect()
}
