//! A rung that was run: what it cost, and what its observable did, or how it failed.
//!
//! ```text
//! work = n (max(steps, differentials + energies) + w Hessians)
//! ```
//! `w` the work of a Hessian in differentials ([`Rung::hessian_work`]), `n` the elements of a
//! model where they differ in size. Work is counted and so the same on every machine; the wall time
//! stands beside it. A run that is judged is stopped at the first moment at which it certainly
//! misses: its error is the largest of all moments.

use std::fmt;
use std::sync::Arc;
use std::time::{Duration, Instant};

use stationary_integrators::{Cost, StepError};
use stationary_scene::{
    Checkpoint, Observable, Progress, Run, RunError, Scene, StepFailure, Watcher, Wish,
};

use super::declaration::changed;
use super::ladder::{MOMENTS, Rung};
use super::model::Model;
use super::reference::Reference;
use super::track::Track;

/// What an observable did in a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// The observable's numbers at each moment, the start first.
    pub values: Vec<Vec<f64>>,
    /// The energy at each moment.
    pub energies: Vec<f64>,
    /// The largest kinetic energy.
    pub kinetic: f64,
    /// The rods that broke, in the order of time.
    pub broken: Vec<usize>,
    /// What errors are relative to.
    pub scale: f64,
    /// Whether that is no more than rounding of what the scene's sizes are.
    pub is_still: bool,
    /// That rounding.
    pub rounding: f64,
}

/// How a rung failed.
#[derive(Clone, Debug, PartialEq)]
pub enum Failure {
    /// Its numbers grew out of bounds.
    Unstable(String),
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
    Cut,
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
}

/// What a run is stopped by as soon as it shows at a moment.
#[derive(Clone, Copy, Debug)]
pub struct Trial<'r> {
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
    Rest,
}

/// Moments that a run is watched before it is foreseen, and the factor by which it must be too dear.
const WATCHED: usize = 3;
const FAR: u64 = 2;

impl Trial<'_> {
    fn is_lost(&self, moment: usize, observed: &[f64], work: u64) -> bool {
        let error = self.reference.map_or(0.0, |known| known.error_at(moment, observed));
        let (most, past) = (self.most_work, moment as u64);
        let foreseen = |moments: u64| moment >= WATCHED && work * moments / past > most;
        let dear = match self.foresight {
            Foresight::None => work > most,
            Foresight::Steady => work > most || foreseen(MOMENTS / FAR),
            Foresight::Rest => foreseen(MOMENTS.saturating_sub(past)),
        };
        dear || error.is_nan() || error > self.most_error
    }
}

impl Measured {
    /// The course of a run that came to its end.
    pub fn whole(&self) -> Option<&Course> {
        (self.end == End::Whole).then_some(&self.course)
    }

    /// The work that it takes to its end: its own, or what it took so far in proportion; zero where
    /// it failed.
    pub fn expected(&self) -> u64 {
        match (&self.end, self.works.len().saturating_sub(1) as u64) {
            (End::Whole, _) => self.work,
            (End::Cut, moments) if moments > 0 => self.work * MOMENTS / moments,
            _ => 0,
        }
    }

    /// The same run, stopped where a trial stops it; `None` where that cannot be said, since it was
    /// cut before.
    pub fn seen_by(&self, trial: Option<&Trial<'_>>) -> Option<Measured> {
        let values = &self.course.values;
        let lost = trial.and_then(|trial| {
            let lost = |&k: &usize| trial.is_lost(k, &values[k], self.works[k]);
            (1..values.len()).find(lost)
        });
        match lost {
            Some(last) => Some(self.until(last)),
            None if self.end == End::Cut => None,
            None => Some(self.clone()),
        }
    }

    fn until(&self, last: usize) -> Measured {
        let mut part = self.clone();
        part.works.truncate(last + 1);
        part.course.values.truncate(last + 1);
        part.course.energies.truncate(last + 1);
        part.work = self.works[last];
        part.end = End::Cut;
        part.track = None;
        part
    }
}

/// Below this part of the energy, a kinetic energy is rounding.
const NOTHING: f64 = 1e-9;

/// Steps between two looks at the clock.
const LOOK: u64 = 256;

/// Runs a model as the rung says, until the deadline or the moment at which the trial is lost.
pub fn measure(
    name: &str,
    model: &Model,
    rung: &Rung,
    trial: Option<&Trial<'_>>,
    deadline: Instant,
) -> Measured {
    let start = Instant::now();
    let scene = match Scene::parse_at(name, &changed(&model.text, &rung.changes)) {
        Ok(scene) => scene,
        Err(error) => {
            let end = End::Failed(Failure::NotConverged(first_line(&error.to_string())));
            let course = Course::default();
            let (works, wall, accepted) = (Vec::new(), start.elapsed(), Arc::default());
            return Measured { work: 0, works, wall, course, end, track: None, accepted };
        }
    };
    let (every, hessian) = (scene.timing().steps() / MOMENTS, rung.hessian_work);
    let samples = (every / scene.timing().sample_every()) as usize;
    let pieces = model.pieces;
    let work = |cost: Cost| pieces * counted(cost, hessian);
    let (works, end) = (vec![0], End::Whole);
    let mut judging =
        Judging { every, work: &work, trial, deadline, works, end, accepted: Vec::new() };
    let run = scene.run_from(None, &mut judging);
    let Judging { mut works, end, accepted, .. } = judging;
    let wall = start.elapsed();
    let (partial, failed) = match &run {
        Ok(run) => (Some(run), None),
        Err(error) => (error.partial(), Some(failure(error))),
    };
    let course = partial.map(|run| course(run, works.len(), samples)).unwrap_or_default();
    works.truncate(course.values.len());
    let end = match failed {
        Some(failure) => End::Failed(failure),
        None if !course.is_finite() => {
            End::Failed(Failure::Unstable("the observable is not finite".to_owned()))
        }
        None => end,
    };
    let whole = partial.filter(|_| end == End::Whole);
    let track = whole.and_then(|run| Track::of(run, model)).map(Arc::new);
    let work = partial.map_or(0, |run| work(run.cost()));
    Measured { work, works, wall, course, end, track, accepted: accepted.into() }
}

/// Looks on while a run is made, and stops it where its trial is lost or the time is over.
struct Judging<'t> {
    /// Steps from one moment to the next.
    every: u64,
    work: &'t dyn Fn(Cost) -> u64,
    trial: Option<&'t Trial<'t>>,
    deadline: Instant,
    works: Vec<u64>,
    end: End,
    accepted: Vec<f64>,
}

impl Watcher for Judging<'_> {
    fn stepped(&mut self, now: Progress<'_>) -> Wish {
        if now.step.is_multiple_of(LOOK) && Instant::now() >= self.deadline {
            self.end = End::Failed(Failure::OutOfBudget);
            return Wish::Stop;
        }
        if now.step.is_multiple_of(self.every) {
            let work = (self.work)(now.cost);
            self.works.push(work);
            let moment = self.works.len() - 1;
            let lost = |trial: &Trial<'_>| trial.is_lost(moment, now.observed, work);
            if now.step < now.steps && self.trial.is_some_and(lost) {
                self.end = End::Cut;
                return Wish::Stop;
            }
        }
        Wish::GoOn
    }

    fn keep(&mut self, _: &Checkpoint) {}

    fn own_ends(&mut self, ends: &[f64]) {
        self.accepted.extend_from_slice(ends);
    }
}

/// Counted work of one element.
pub fn counted(cost: Cost, hessian_work: u64) -> u64 {
    cost.steps.max(cost.differentials + cost.energies) + hessian_work * cost.hessians
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

/// What was observed at the first so many moments, with so many samples from one to the next: a run
/// that failed has another one where it did.
fn course(run: &Run, moments: usize, samples: usize) -> Course {
    let moments = moments.min(run.times().len().div_ceil(samples));
    let seen = (samples * moments.saturating_sub(1) + 1).min(run.times().len());
    let values: Vec<Vec<f64>> =
        (0..moments).map(|moment| run.observed(moment * samples).to_vec()).collect();
    let energies: Vec<f64> = run.energies().into_iter().step_by(samples).take(moments).collect();
    let kinetic = run.kinetic_energies().iter().take(seen).copied().fold(0.0, f64::max);
    let broken = run.broken().iter().map(|broken| broken.rod).collect();
    let scale = scale(run, seen, kinetic);
    let rounding = ROUNDING * size(run, &energies);
    let is_still = scale <= rounding;
    let scale = if scale > 0.0 && scale.is_finite() { scale } else { 1.0 };
    Course { values, energies, kinetic, broken, scale, is_still, rounding }
}

/// A scale below this part of a scene's sizes is rounding.
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

    fn is_finite(&self) -> bool {
        self.values.iter().flatten().chain(&self.energies).all(|x| x.is_finite())
    }
}

/// What an observable's errors are relative to, over all samples: for energies the largest kinetic
/// energy, for momenta the sum of the parts' magnitudes, for a place the way from its start, else the
/// largest value.
fn scale(run: &Run, samples: usize, kinetic: f64) -> f64 {
    let [linear, angular] = run.momentum_scales();
    let values = || (0..samples).map(|sample| run.observed(sample));
    let largest = || values().map(norm).fold(0.0, f64::max);
    let way = || values().map(|x| distance(x, run.observed(0))).fold(0.0, f64::max);
    match run.scene().observables().first() {
        Some(Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy) => {
            kinetic
        }
        Some(Observable::LinearMomentum) => linear,
        Some(Observable::AngularMomentum) => angular,
        Some(Observable::Position(_)) => way(),
        _ => largest(),
    }
}

/// What an observable's scale would be where everything moved as far as the scene is wide.
fn size(run: &Run, energies: &[f64]) -> f64 {
    let scene = run.scene();
    let places = run.positions(0).chunks(scene.dimension());
    let wide =
        places.map(|x| distance(x, &run.positions(0)[..scene.dimension()])).fold(0.0, f64::max);
    let far = run.positions(0).iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    match scene.observables().first() {
        Some(Observable::Position(_)) => wide.max(far),
        Some(Observable::Velocity(_)) => wide.max(far) / scene.timing().horizon(),
        Some(Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy) => {
            energies.iter().fold(0.0_f64, |largest, x| largest.max(x.abs()))
        }
        _ => 0.0,
    }
}

/// What errors of an observable are relative to, in words.
pub fn relative_to(observable: &Observable) -> &'static str {
    match observable {
        Observable::Energy | Observable::KineticEnergy | Observable::PotentialEnergy => {
            "the largest kinetic energy"
        }
        Observable::LinearMomentum => "the sum of |p|",
        Observable::AngularMomentum => "the sum of |q| |p|",
        Observable::Position(_) => "the largest way from its start",
        _ => "its largest value",
    }
}

fn failure(error: &RunError) -> Failure {
    let said = first_line(&error.to_string());
    let source = match error {
        RunError::Interrupted(interruption) => Some(&interruption.source),
        RunError::Stopped(stop) => Some(&stop.source),
        RunError::Assembly(_) | RunError::Checkpoint(_) => None,
    };
    match source {
        Some(StepFailure::Step(
            StepError::NonFiniteConfiguration { .. } | StepError::NonFiniteMomentum { .. },
        ))
        | Some(StepFailure::Overflow { .. }) => Failure::Unstable(said),
        _ => Failure::NotConverged(said),
    }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
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
