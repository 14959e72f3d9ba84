//! A rung that was run: what it cost, and what its observable did, or how it failed.
//!
//! ```text
//! work = max(steps, differentials + energies) + w Hessians
//! ```
//! `w` the work of a Hessian in differentials. Work is counted and so the same on every machine; the wall
//! time stands beside it. A run that is judged is stopped at the first moment at which it certainly
//! misses: its error is the largest of all moments.

use std::fmt;
use std::sync::Arc;
use std::time::Duration;

use stationary_integrators::Cost;

use crate::experiment::Record;
use crate::ladder::{Ladder, MOMENTS, Scale};
use crate::look::Look;
use crate::reference::{OFF, Reference};
use crate::track::Track;
use crate::watch::Watch;

/// What an observable did in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// The observable's numbers at each moment, the start first.
    pub values: Vec<Vec<f64>>,
    /// The energy at each moment.
    pub energies: Vec<f64>,
    /// The largest kinetic energy.
    pub kinetic: f64,
    /// What happened once and for all, in the order of time.
    pub outcomes: Vec<usize>,
    /// What errors are relative to.
    pub scale: f64,
    /// Whether that is no more than rounding.
    pub is_still: bool,
    /// That rounding.
    pub rounding: f64,
}

/// How a rung failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// Its numbers grew out of bounds.
    Unstable(String),
    /// Its energy was kept, and the observable was no number all the same.
    Undefined(String),
    /// An equation of a step was not solved.
    NotConverged(String),
    /// It ran to its end, but to another motion.
    WrongPhysics(String),
    /// It ran to its end, but not to where a reference led that nothing confirmed.
    Differs(String),
    /// The time was over.
    OutOfBudget,
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Unstable(how) => write!(f, "unstable: {how}"),
            Failure::Undefined(how) => write!(f, "undefined: {how}"),
            Failure::NotConverged(how) => write!(f, "not converged: {how}"),
            Failure::WrongPhysics(how) => write!(f, "wrong physics: {how}"),
            Failure::Differs(how) => write!(f, "differs from the unconfirmed reference: {how}"),
            Failure::OutOfBudget => f.write_str("out of budget"),
        }
    }
}

/// How a run ended.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// At the horizon.
    Whole,
    /// At a moment at which it was known to be of no use.
    Stopped,
    /// It failed.
    Failed(Failure),
}

/// A rung that was run.
#[derive(Clone, Debug)]
pub struct Measured {
    /// Counted work.
    pub work: u64,
    /// Counted work at each moment of the course.
    pub works: Vec<u64>,
    /// Wall time of the run, once.
    pub wall: Duration,
    /// What happened, as far as it went.
    pub course: Course,
    /// How it ended.
    pub end: End,
    /// All its samples, where it came to its end and they are at equal distances.
    pub track: Option<Arc<Track>>,
    /// The ends of the steps that an adaptive method accepted.
    pub accepted: Arc<[f64]>,
    /// What it showed within these and at their ends, where that was kept.
    pub own: Option<Arc<Look>>,
}

/// What a run is stopped by as soon as it shows at a moment.
#[derive(Clone, Copy, Debug)]
pub struct StopRule<'r> {
    /// What it is judged by, where there is something yet.
    pub reference: Option<&'r Reference>,
    /// An error above this is one too many.
    pub most_error: f64,
    /// Work above this is too much.
    pub most_work: u64,
    /// Whether work that goes on as it began is taken for what it will come to.
    pub foresight: Foresight,
}

/// When a run is known to be too dear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foresight {
    /// When it is.
    None,
    /// When it will be by far, going on as it began.
    Steady,
    /// When what it has still to do is too much, going on as it began: what it cost is spent.
    RemainingCost,
}

/// Moments that a run is watched before it is foreseen, and the factor by which it must be too dear.
const WATCHED: usize = 3;
const FAR: u64 = 2;

impl StopRule<'_> {
    pub(crate) fn is_lost(&self, moment: usize, observed: &[f64], work: u64) -> bool {
        let error = self.reference.map_or(0.0, |known| known.error_at(moment, observed));
        let (most, past) = (self.most_work, moment as u64);
        let foreseen = |moments: u64| moment >= WATCHED && work * moments / past > most;
        let dear = match self.foresight {
            Foresight::None => work > most,
            Foresight::Steady => work > most || foreseen(MOMENTS / FAR),
            Foresight::RemainingCost => foreseen(MOMENTS.saturating_sub(past)),
        };
        dear || error.is_nan() || error > self.most_error
    }
}

impl Measured {
    /// The course of a run that came to its end.
    pub fn whole(&self) -> Option<&Course> {
        (self.end == End::Whole).then_some(&self.course)
    }

    /// The work that it takes to its end: its own, or what it took so far in proportion, beside its start
    /// where that can be told; zero where it failed.
    pub fn expected(&self) -> u64 {
        match (&self.end, self.works.len().saturating_sub(1) as u64) {
            (End::Whole, _) => self.work,
            (End::Stopped, 1) => self.work * MOMENTS,
            (End::Stopped, moments) if moments > 1 => {
                let first = self.works[1];
                first + (self.work - first) * (MOMENTS - 1) / (moments - 1)
            }
            _ => 0,
        }
    }

    /// The same run, stopped where a trial stops it; `None` where that cannot be said, since it was
    /// cut before.
    pub fn seen_by(&self, trial: Option<&StopRule<'_>>) -> Option<Measured> {
        let values = &self.course.values;
        let lost = trial.and_then(|trial| {
            let lost = |&k: &usize| trial.is_lost(k, &values[k], self.works[k]);
            (1..values.len()).find(lost)
        });
        match lost {
            Some(last) => Some(self.until(last)),
            None if self.end == End::Stopped => None,
            None => Some(self.clone()),
        }
    }

    fn until(&self, last: usize) -> Measured {
        let mut part = self.clone();
        part.works.truncate(last + 1);
        part.course.values.truncate(last + 1);
        part.course.energies.truncate(last + 1);
        part.work = self.works[last];
        part.end = End::Stopped;
        (part.track, part.own) = (None, None);
        part
    }
}

/// Below this part of the energy, a kinetic energy is rounding.
const NOTHING: f64 = 1e-9;

impl Measured {
    /// What a run left, judged to its end.
    pub(crate) fn of(record: Record, watch: Watch<'_>, wall: Duration, ladder: &Ladder) -> Self {
        let Watch { mut works, end, .. } = watch;
        let course = Course::of(&record, works.len(), ladder.scale);
        works.truncate(course.values.len());
        let Record { samples, accepted, own, told, work, is_smooth, failure, .. } = record;
        let end = match failure {
            Some(failure) => End::Failed(failure),
            None if !course.is_finite() => End::Failed(course.not_finite()),
            // What stopped by itself is not at its end.
            None if end == End::Whole && works.len() <= MOMENTS as usize => {
                End::Failed(Failure::NotConverged("it ended before the horizon".to_owned()))
            }
            None => end,
        };
        let own = own.filter(|_| end == End::Whole).map(|own| {
            let look = Look::of(&own, 0);
            let kinetic = look.kinetic.max(samples.kinetic(samples.len()));
            Arc::new(Look { kinetic, told, ..look })
        });
        let whole = Some(samples).filter(|_| end == End::Whole && is_smooth);
        let track =
            whole.and_then(|samples| Track::of(samples, told, ladder.horizon)).map(Arc::new);
        Measured { work, works, wall, course, end, track, accepted: accepted.into(), own }
    }
}

/// Counted work of one element, where a Hessian counts as so many differentials.
pub fn counted(cost: Cost, hessian: u64) -> u64 {
    cost.steps.max(cost.differentials + cost.energies) + hessian * cost.hessians
}

/// Energies change by this part of the largest by rounding alone.
const OF_ENERGIES: f64 = 1e-13;

/// The largest change of an energy beyond rounding, relative to the largest kinetic energy.
pub fn drift(energies: &[f64], kinetic: f64) -> f64 {
    let first = energies.first().copied().unwrap_or_default();
    let largest = energies.iter().fold(0.0_f64, |largest, energy| largest.max(energy.abs()));
    let most = energies.iter().map(|energy| (energy - first).abs()).fold(0.0, f64::max);
    (most - OF_ENERGIES * largest).max(0.0) / kinetic.max(f64::MIN_POSITIVE)
}

impl Course {
    /// What was observed at the first so many moments: a run that failed has another sample where it
    /// did.
    fn of(record: &Record, moments: usize, scale: Scale) -> Self {
        let (samples, each) = (&record.samples, record.each.max(1));
        if samples.is_empty() {
            return Course::default();
        }
        let moments = moments.min(samples.len().div_ceil(each));
        let seen = (each * moments.saturating_sub(1) + 1).min(samples.len());
        let at = |moment: usize| moment * each;
        let values: Vec<Vec<f64>> =
            (0..moments).map(|moment| samples.observed(at(moment)).to_vec()).collect();
        let energies: Vec<f64> =
            (0..moments).filter_map(|moment| Some(samples.energies(at(moment))?.total)).collect();
        let kinetic = samples.kinetic(seen);
        let size = match scale {
            Scale::Kinetic => energies.iter().fold(0.0_f64, |largest, x| largest.max(x.abs())),
            _ => record.size,
        };
        let rounding = ROUNDING * size;
        let observed = || (0..seen).map(|sample| samples.observed(sample));
        let scale = scale_of(scale, observed, kinetic, record.told);
        let is_still = scale <= rounding;
        let scale = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
        let outcomes = record.outcomes.clone();
        Course { values, energies, kinetic, outcomes, scale, is_still, rounding }
    }
}

/// The part of a scale that is left where it was that of a motion.
const LEFT: f64 = 0.5;
/// A scale below this part of the sizes is rounding.
const ROUNDING: f64 = 1e-11;

impl Course {
    /// What errors of the energy are relative to: the largest kinetic energy, or where nothing
    /// moves, the largest energy.
    pub fn of_energies(&self) -> f64 {
        let largest = self.energies.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()));
        if self.kinetic > NOTHING * largest { self.kinetic } else { largest.max(f64::MIN_POSITIVE) }
    }

    /// The largest change of the energy, relative to the largest kinetic energy.
    pub fn drift(&self) -> f64 {
        drift(&self.energies, self.kinetic)
    }

    /// What is kept by the motion moves in a run by its errors alone: a scale that nothing of is left
    /// where these are extrapolated away was none.
    pub(crate) fn shrink_scale(&mut self, extrapolated: &[Vec<f64>]) {
        let way =
            |rows: &[Vec<f64>]| rows.iter().map(|x| distance(x, &rows[0])).fold(0.0, f64::max);
        let left = way(extrapolated) / way(&self.values);
        if left < LEFT {
            self.scale *= left.max(f64::MIN_POSITIVE);
            self.is_still = self.scale <= self.rounding;
        }
    }

    fn is_finite(&self) -> bool {
        self.values.iter().flatten().chain(&self.energies).all(|x| x.is_finite())
    }

    /// Why it is not: a motion that kept its energy has come to where there is nothing to observe.
    fn not_finite(&self) -> Failure {
        let moment = self.values.iter().position(|row| !row.iter().all(|x| x.is_finite()));
        let kept = |moment: &usize| {
            let energies = &self.energies[..self.energies.len().min(moment + 1)];
            energies.iter().all(|x| x.is_finite()) && drift(energies, self.of_energies()) < OFF
        };
        match moment.filter(kept) {
            Some(moment) => Failure::Undefined(format!(
                "the observable is no number at {moment} of {MOMENTS} moments"
            )),
            None => Failure::Unstable("the observable is not finite".to_owned()),
        }
    }
}

/// What an observable's errors are relative to, by all that was observed.
pub(crate) fn scale_of<'o, O: Iterator<Item = &'o [f64]>>(
    scale: Scale,
    observed: impl Fn() -> O,
    kinetic: f64,
    told: f64,
) -> f64 {
    match scale {
        Scale::Kinetic => kinetic,
        Scale::Told(_) => told,
        Scale::Largest => observed().map(norm).fold(0.0, f64::max),
        Scale::Way => {
            let Some(first) = observed().next() else { return 0.0 };
            observed().map(|x| distance(x, first)).fold(0.0, f64::max)
        }
    }
}

/// The Euclidean norm.
pub fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

/// The Euclidean distance.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// The largest distance of two courses at a moment.
pub fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| distance(a, b)).fold(0.0, f64::max)
}
