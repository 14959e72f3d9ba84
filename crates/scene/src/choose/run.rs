//! A setting of a model, run: what the search is left of it.

use std::ops::ControlFlow;
use std::rc::Rc;
use std::time::Instant;

use stationary_choose::{
    Energies, Failure, Kind, MOMENTS, Record, Samples, Watch, counted, own_parts,
};
use stationary_integrators::{Cost, StepError};

use super::candidate::Variation;
use super::declaration::changed;
use super::model::{Model, moved};
use crate::model::observable::Observable;
use crate::model::scene::Scene;
use crate::run::checkpoint::Checkpoint;
use crate::run::error::{RunError, StepFailure};
use crate::run::observer::{Control, Observer, Progress};
use crate::run::samples::Run;
use crate::run::start::Start;

/// Where the steps of a run start, so that it can be looked at again, and what is known of it.
#[derive(Clone, Debug)]
pub(super) struct Kept {
    pub(super) starts: Rc<[Start]>,
    /// Counted work of all its steps.
    pub(super) work: u64,
    pub(super) kinetic: f64,
    pub(super) told: f64,
}

/// Numbers of a run that are kept at most, a megabyte of them: a search keeps some hundreds of runs.
const MOST: usize = 1 << 17;

/// Runs a model as a setting says, until the watch breaks off; and where its equal steps start, if it came to
/// its end and these are few.
pub(super) fn run(
    name: &str,
    model: &Model,
    (kind, setting): (Kind, &Variation),
    watch: &mut Watch<'_>,
) -> (Record, Option<Kept>) {
    let scene = match Scene::parse_at(name, &changed(&model.text, &setting.changes)) {
        Ok(scene) => scene,
        Err(error) => {
            let failure = Some(Failure::NotConverged(first_line(&error.to_string())));
            return (Record { failure, ..Record::default() }, None);
        }
    };
    let (every, hessian) = (scene.timing().steps() / MOMENTS, setting.hessian_work);
    let pieces = model.pieces;
    let work = |cost: Cost| pieces * counted(own(cost, kind), hessian);
    let parts = if kind == Kind::Adaptive { own_parts().to_vec() } else { Vec::new() };
    let starts = (kind == Kind::EqualSteps).then(Vec::new);
    let accepted = Vec::new();
    let mut judging =
        Judging { every, work: &work, watch, accepted, parts, own: None, starts, numbers: 0 };
    let run = scene.run_from(None, &mut judging);
    let Judging { accepted, own, starts, .. } = judging;
    let (partial, failure) = match &run {
        Ok(run) => (Some(run), None),
        Err(error) => (error.partial(), Some(failure(error))),
    };
    let each = (every / scene.timing().sample_every()) as usize;
    let Some(run) = partial else { return (Record { failure, ..Record::default() }, None) };
    let whole = |starts: &Vec<Start>| starts.len() as u64 == scene.timing().steps() + 1;
    let kept = starts.filter(whole).map(|starts| Kept {
        starts: starts.into(),
        work: pieces * counted(run.cost(), hessian),
        kinetic: run.kinetic_energies().iter().copied().fold(0.0, f64::max),
        told: told(run),
    });
    let record = Record {
        samples: samples(run, model),
        each,
        accepted,
        own: own.map(|own| samples(&own, model)),
        outcomes: run.broken().iter().map(|broken| broken.rod).collect(),
        told: told(run),
        size: size(run),
        work: work(run.cost()),
        is_smooth: is_smooth(run),
        failure,
    };
    (record, kept)
}

/// What a run took itself: where a method chooses its own steps, those of the scene are read off, which takes
/// no evaluation.
pub(super) fn own(cost: Cost, kind: Kind) -> Cost {
    if kind == Kind::Adaptive { Cost { steps: 0, ..cost } } else { cost }
}

/// What the run showed at each of its samples.
fn samples(run: &Run, model: &Model) -> Samples {
    let scene = run.scene();
    let has_energy = scene.heat().is_none();
    let (totals, kinetics) = match has_energy {
        true => (run.energies(), run.kinetic_energies().to_vec()),
        false => (Vec::new(), Vec::new()),
    };
    let (d, moved) = (scene.dimension(), moved(model));
    let (mut samples, mut places) = (Samples::default(), Vec::new());
    for sample in 0..run.times().len() {
        let energies = totals.get(sample).zip(kinetics.get(sample));
        let energies = energies.map(|(&total, &kinetic)| Energies { total, kinetic });
        let all = run.positions(sample);
        places.clear();
        moved.iter().for_each(|&k| places.extend(&all[d * k..d * (k + 1)]));
        samples.push(run.observed(sample), energies, &places);
    }
    samples
}

/// Whether no samples are joined by lines, and all are at equal distances.
fn is_smooth(run: &Run) -> bool {
    let scene = run.scene();
    let breaks = scene.rods().iter().any(|rod| rod.strength.is_finite());
    let parts = run.times().len().saturating_sub(1).max(1);
    let spacing = scene.timing().horizon() / parts as f64;
    let is_equal = |(k, t): (usize, &f64)| (t - k as f64 * spacing).abs() <= 1e-6 * spacing;
    !breaks && run.times().iter().enumerate().all(is_equal)
}

/// Tells the watch of steps and moments.
struct Judging<'t, 'w> {
    /// Steps from one moment to the next.
    every: u64,
    work: &'t dyn Fn(Cost) -> u64,
    watch: &'t mut Watch<'w>,
    accepted: Vec<f64>,
    /// The parts at which the method's own steps are sampled, and what that gave.
    parts: Vec<f64>,
    own: Option<Run>,
    /// Where steps start, as long as these are few, and how many numbers that are.
    starts: Option<Vec<Start>>,
    numbers: usize,
}

impl Observer for Judging<'_, '_> {
    fn stepped(&mut self, now: Progress<'_>) -> Control {
        let on = self.watch.stepped();
        let at_moment = on.is_continue() && now.step.is_multiple_of(self.every);
        let on = match at_moment {
            true => self.watch.moment(now.observed, (self.work)(now.cost)),
            false => on,
        };
        match on {
            ControlFlow::Continue(()) => Control::Continue,
            ControlFlow::Break(()) => Control::Stop,
        }
    }

    fn keep(&mut self, _: &Checkpoint) {}

    fn deadline(&self) -> Option<Instant> {
        Some(self.watch.deadline())
    }

    fn own_ends(&mut self, ends: &[f64]) {
        self.accepted.extend_from_slice(ends);
    }

    fn own_parts(&self) -> &[f64] {
        &self.parts
    }

    fn own(&mut self, sampled: Run) {
        self.own = Some(sampled);
    }

    fn keeps_starts(&self) -> bool {
        self.starts.is_some()
    }

    fn start(&mut self, start: Start) {
        self.numbers += start.numbers();
        match &mut self.starts {
            Some(starts) if self.numbers <= MOST => starts.push(start),
            _ => self.starts = None,
        }
    }
}

/// The scale of momenta: the sum of the parts' magnitudes.
pub(super) fn told(run: &Run) -> f64 {
    let [linear, angular] = run.momentum_scales();
    match run.scene().observables().first() {
        Some(Observable::LinearMomentum) => linear,
        Some(Observable::AngularMomentum) => angular,
        _ => 0.0,
    }
}

/// What a place's or a velocity's scale would be where everything moved as far as the scene is wide.
fn size(run: &Run) -> f64 {
    let scene = run.scene();
    let places = run.positions(0).chunks(scene.dimension());
    let first = run.positions(0).get(..scene.dimension()).unwrap_or_default();
    let distance =
        |x: &[f64]| x.iter().zip(first).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt();
    let wide = places.map(distance).fold(0.0, f64::max);
    let far = run.positions(0).iter().fold(0.0_f64, |far, x| far.max(x.abs()));
    match scene.observables().first() {
        Some(Observable::Position(_)) => wide.max(far),
        Some(Observable::Velocity(_)) => wide.max(far) / scene.timing().horizon(),
        _ => 0.0,
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
        Some(StepFailure::TimeIsOver) => Failure::OutOfBudget,
        _ => Failure::NotConverged(said),
    }
}

fn first_line(text: &str) -> String {
    text.lines().next().unwrap_or_default().to_owned()
}
