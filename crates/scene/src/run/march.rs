//! The march of a run: step after step to the horizon, with samples and checkpoints on the way.
//!
//! ```text
//! state_0, state_1, ..., state_k        state_i at the time i h, sampled every so many steps
//! checkpoint of k                       state_k-1 with what the method remembers there, and state_k
//! ```
//! A run that is resumed takes the step from `k - 1` to `k` once more: then the method remembers
//! what it did, and the state shows whether this machine still computes the same bits. That step
//! costs nothing in the counts.

use std::cell::LazyCell;

use stationary_integrators::{Cost, Saved, State, StepReport};

use crate::model::built::Built;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, Checkpoint, CheckpointError};
use crate::run::contact_impulses::Push;
use crate::run::error::RunError;
use crate::run::error::StepFailure;
use crate::run::samples::{BrokenRod, Progress, Run, Samples};
use crate::run::steps::Stepped;
use crate::text::limits;

/// What a watcher wishes after a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wish {
    /// That the run goes on.
    GoOn,
    /// That the run goes on, and after its next step makes a checkpoint.
    Checkpoint,
    /// That the run ends here, which is no error.
    Stop,
}

/// Looks on while a scene runs.
pub trait Watcher {
    /// Sees every step, and says what is to be done.
    fn stepped(&mut self, now: Progress<'_>) -> Wish;

    /// Takes a checkpoint for which it has wished.
    fn keep(&mut self, checkpoint: &Checkpoint);

    /// The parts of a step, between 0 and 1, at which it wishes to see the observables too.
    fn parts(&mut self, _step: u64) -> &[f64] {
        &[]
    }

    /// Sees the observables at a part of a step before it sees the step: what the method gives by a
    /// step of that part, which is then taken back. No cost is counted for it but that of adaptive
    /// steps, which are read off.
    fn inside(&mut self, _time: f64, _observed: &[f64]) {}

    /// Sees where the steps ended that an adaptive method chose itself.
    fn own_ends(&mut self, _ends: &[f64]) {}
}

/// What is stepped: particles, bodies, or heat.
pub(crate) trait Moving {
    /// Where it is.
    fn state(&self) -> &State<Vec<f64>>;

    /// Moves by a step of length `h` to the time `to`, or stays as it is.
    fn step(&mut self, h: f64, to: f64) -> Result<Stepped, StepFailure>;

    /// What was computed before the first step.
    fn prepared(&self) -> StepReport {
        StepReport::default()
    }

    /// What was built for it.
    fn built(&self) -> Built;

    /// Shows the contact impulses of the last step, which ended at `time`.
    fn pushes(&self, _time: f64, _see: &mut dyn FnMut(Push)) {}

    /// Adds a sample of where it is.
    fn sample(&mut self, time: f64, samples: &mut Samples);

    /// The rods that broke so far.
    fn broken(&self) -> &[BrokenRod];

    /// The error of a run of which this step failed.
    fn failed(&self, step: u64, time: f64, failure: StepFailure, run: Run) -> RunError;

    /// Whether it can take a part of a step and go back.
    fn takes_parts(&self) -> bool {
        true
    }

    /// Whether it goes to a time whatever the step, so that it need not go back.
    fn reads_off(&self) -> bool {
        false
    }

    /// The ends of the steps that the method itself chose within the last one.
    fn own_ends(&self) -> &[f64] {
        &[]
    }

    /// What the method remembers.
    fn save(&mut self) -> Saved;

    /// Goes on from another state, with what the method remembered there.
    fn load(&mut self, before: &Before) -> Result<(), CheckpointError>;
}

/// Runs to the horizon, or until the watcher stops.
pub(crate) fn march<M: Moving>(
    scene: &Scene,
    mut moving: M,
    from: Option<Checkpoint>,
    watcher: &mut dyn Watcher,
) -> Result<Run, RunError> {
    let timing = scene.timing;
    // Of a large scene it takes longer than a step.
    let fingerprint = LazyCell::new(|| Checkpoint::fingerprint(scene));
    let (steps, every, h) = (timing.steps(), timing.sample_every(), timing.stepping().step());
    let time = |step: u64| timing.stepping().time(step);
    let (mut done, mut cost) = (0, Cost::default());
    let built = moving.built();
    let stopped = |moving: &M, samples, cost, step: u64, failure| {
        let broken = moving.broken().to_vec();
        let run = Run { scene: scene.clone(), samples, broken, cost, built };
        run.stopped(step, time(step.saturating_sub(1)), failure)
    };
    let mut samples = scene.no_samples();
    match from {
        Some(checkpoint) => {
            done = checkpoint.step;
            cost = checkpoint.cost;
            samples = resume(scene, &mut moving, checkpoint)?;
        }
        None => {
            let prepared = moving.prepared();
            cost.differentials = prepared.differentials.into();
            cost.hessians = prepared.hessians.into();
            cost.energies = prepared.energies.into();
            if let Err(failure) = sample(scene, &mut moving, 0.0, &mut samples) {
                return Err(stopped(&moving, samples, cost, 0, failure));
            }
        }
    }
    let mut wish = Wish::GoOn;
    for step in done + 1..=steps {
        let before = (wish == Wish::Checkpoint).then(|| Before::of(&mut moving));
        if moving.takes_parts() {
            look_inside(scene, &mut moving, watcher, (step, h))?;
        }
        match moving.step(h, time(step)) {
            Ok(stepped) => {
                cost.add(&stepped.report);
                watcher.own_ends(moving.own_ends());
                let room = samples.impacts.len() < limits::IMPACTS;
                samples.impacts.extend(stepped.impacts.filter(|_| room));
                moving.pushes(time(step), &mut |push| samples.push_impulse(push));
            }
            Err(failure) => {
                let from = time(step - 1);
                if samples.times.last().is_some_and(|&last| last < from) {
                    moving.sample(from, &mut samples);
                }
                let broken = moving.broken().to_vec();
                let run = Run { scene: scene.clone(), samples, broken, cost, built };
                return Err(moving.failed(step, from, failure, run));
            }
        }
        let due = step % every == 0 || step == steps;
        if due && let Err(failure) = sample(scene, &mut moving, time(step), &mut samples) {
            return Err(stopped(&moving, samples, cost, step, failure));
        }
        if let Some(before) = before {
            let (scene, after) = (*fingerprint, moving.state().clone());
            let checkpoint = Checkpoint { scene, step, before, after, cost, samples };
            watcher.keep(&checkpoint);
            samples = checkpoint.samples;
        }
        let (q, now) = (&moving.state().q, time(step));
        let observed = samples.last_observed();
        wish = watcher.stepped(Progress { step, steps, time: now, q, cost, observed });
        if wish == Wish::Stop {
            if !due && let Err(failure) = sample(scene, &mut moving, now, &mut samples) {
                return Err(stopped(&moving, samples, cost, step, failure));
            }
            break;
        }
    }
    let broken = moving.broken().to_vec();
    Ok(Run { scene: scene.clone(), samples, broken, cost, built })
}

/// Shows the parts of a step that the watcher wishes to see, and leaves everything as it was. A part
/// that has no solution is passed over: the step itself will say so.
fn look_inside<M: Moving>(
    scene: &Scene,
    moving: &mut M,
    watcher: &mut dyn Watcher,
    (step, h): (u64, f64),
) -> Result<(), CheckpointError> {
    let parts = watcher.parts(step).to_vec();
    let from = scene.timing.stepping().time(step - 1);
    for part in parts {
        let to = from + part * h;
        let before = (!moving.reads_off()).then(|| Before::of(moving));
        if moving.step(part * h, to).is_ok() {
            watcher.own_ends(moving.own_ends());
            let mut samples = scene.no_samples();
            moving.sample(to, &mut samples);
            watcher.inside(to, samples.last_observed());
        }
        if let Some(before) = before {
            moving.load(&before)?;
        }
    }
    Ok(())
}

/// Adds a sample, all of whose numbers are finite.
fn sample<M: Moving>(
    scene: &Scene,
    moving: &mut M,
    time: f64,
    samples: &mut Samples,
) -> Result<(), StepFailure> {
    moving.sample(time, samples);
    match samples.overflow(scene) {
        Some((quantity, value)) => Err(StepFailure::Overflow { quantity, value }),
        None => Ok(()),
    }
}

impl Before {
    fn of(moving: &mut impl Moving) -> Self {
        let memory = moving.save();
        Before { state: moving.state().clone(), memory, broken: moving.broken().to_vec() }
    }
}

/// Takes the last step of a checkpoint once more, and returns its samples.
fn resume<M: Moving>(
    scene: &Scene,
    moving: &mut M,
    checkpoint: Checkpoint,
) -> Result<Samples, CheckpointError> {
    checkpoint.check(scene, moving.state())?;
    moving.load(&checkpoint.before)?;
    let stepping = scene.timing.stepping();
    let stepped = moving.step(stepping.step(), stepping.time(checkpoint.step));
    match stepped.is_ok() && *moving.state() == checkpoint.after {
        true => Ok(checkpoint.samples),
        false => Err(CheckpointError::OtherBits { step: checkpoint.step }),
    }
}
