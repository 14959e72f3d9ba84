//! The engine of a run: step after step to the horizon, with samples and checkpoints on the way.
//!
//! ```text
//! state_0, state_1, ..., state_k        state_i at the time i h, sampled every so many steps
//! checkpoint of k                       state_k-1 with what the method remembers there, and state_k
//! ```
//! A run that is resumed takes the step from `k - 1` to `k` once more: then the method remembers
//! what it did, and the state shows whether this machine still computes the same bits. That step
//! costs nothing in the counts.

use std::cell::LazyCell;

use stationary_integrators::{Cost, State};

use crate::model::built::Built;
use crate::model::observable::Observable;
use crate::model::scene::Scene;
use crate::run::checkpoint::{Before, Checkpoint, CheckpointError};
use crate::run::error::{RunError, StepFailure};
use crate::run::observer::{Control, Observer, Progress};
use crate::run::own_samples::OwnSamples;
use crate::run::recorder::{Failed, Recorder};
use crate::run::samples::{Run, Samples};
use crate::run::stepper::{Stepped, Stepper};
use crate::text::limits;

/// The part of a step over which the tensions at the start are means: the second such part.
const SMALL_PART: f64 = 1.0 / 64.0;

/// Everything that a run needs: a scene's state, what steps it, and what takes samples of it.
///
/// Nothing here is generic: it is compiled once for all that a scene can be.
pub(crate) struct Engine<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) state: State<Vec<f64>>,
    pub(crate) stepper: Box<dyn Stepper + 'a>,
    pub(crate) recorder: Box<dyn Recorder + 'a>,
    pub(crate) clock: Clock,
    pub(crate) built: Built,
}

/// What the time of a state is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Clock {
    /// The scene's, set after every step.
    OfTheScene,
    /// A sum of steps, by which joints remember the state.
    OfTheSteps,
}

impl Engine<'_> {
    /// Runs to the horizon, or until the observer stops.
    pub(crate) fn integrate(
        mut self,
        from: Option<Checkpoint>,
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        if let Some(kept) = observer.kept() {
            return self.revisit(&kept, observer);
        }
        let (scene, timing) = (self.scene, self.scene.timing);
        // Of a large scene it takes longer than a step.
        let fingerprint = LazyCell::new(|| Checkpoint::fingerprint(scene));
        let (steps, every, h) = (timing.steps(), timing.sample_every(), timing.stepping().step());
        let time = |step: u64| timing.stepping().time(step);
        let (mut done, mut cost) = (0, Cost::default());
        let mut samples = scene.no_samples();
        match from {
            Some(checkpoint) => {
                done = checkpoint.step;
                cost = checkpoint.cost;
                samples = self.resume(checkpoint)?;
            }
            None => {
                self.feel_the_start(h)?;
                let prepared = self.stepper.prepared();
                cost.differentials = prepared.differentials.into();
                cost.hessians = prepared.hessians.into();
                cost.energies = prepared.energies.into();
                let checked = self.recorder.check(&self.state);
                if let Err(source) = checked.and(self.sample(0.0, &mut samples)) {
                    let failed = Failed { step: 0, time: time(0), source };
                    return Err(failed.stops(self.run(samples, cost), None));
                }
            }
        }
        let mut own = OwnSamples::of(scene, observer.own_parts());
        self.stepper.keep_own(observer.own_parts());
        self.stepper.break_off_at(observer.deadline());
        own.add(std::slice::from_ref(&self.state), &mut *self.recorder);
        let mut asked = Control::Continue;
        for step in done + 1..=steps {
            let before = (asked == Control::Checkpoint).then(|| self.before());
            if observer.keeps_starts() {
                observer.start(self.start());
            }
            if self.stepper.takes_parts() {
                self.look_inside(observer, (step, h))?;
            }
            match self.step(h, time(step)) {
                Ok(stepped) => {
                    cost.add(&stepped.report);
                    observer.own_ends(self.stepper.own_ends());
                    own.add(self.stepper.own_states(), &mut *self.recorder);
                    let room = samples.impacts.len() < limits::IMPACTS;
                    samples.impacts.extend(stepped.impacts.filter(|_| room));
                    samples.lasting.steps += u64::from(stepped.lasting > 0.0);
                    samples.lasting.time += stepped.lasting;
                    samples.chosen.add(stepped.chosen);
                    if let Some(residual) = stepped.unsettled {
                        samples.unsettled.add(residual);
                    }
                    let driven =
                        self.stepper.works().iter().copied().chain([self.stepper.driven_work()]);
                    samples.works.iter_mut().zip(driven).for_each(|(sum, work)| *sum += work);
                    let next = samples.times.len();
                    let rows = &mut samples.contacts;
                    self.stepper.pushes(time(step), &mut |push| rows.push(next, push));
                }
                Err(source) => {
                    let from = time(step - 1);
                    // A state that was stepped to and is none is not shown.
                    let is_one = self.recorder.check(&self.state).is_ok();
                    if is_one && samples.times.last().is_some_and(|&last| last < from) {
                        self.recorder.sample(&self.state, from, &mut samples);
                    }
                    let failed = Failed { step, time: from, source };
                    let run = self.run(samples, cost);
                    return Err(self.recorder.failed(failed, &self.state, run));
                }
            }
            let due = step % every == 0 || step == steps;
            let unsampled = |source| Failed { step, time: time(step - 1), source };
            if due && let Err(source) = self.sample(time(step), &mut samples) {
                return Err(unsampled(source).stops(self.run(samples, cost), None));
            }
            if let Some(before) = before {
                let (scene, after) = (*fingerprint, self.state.clone());
                let checkpoint = Checkpoint { scene, step, before, after, cost, samples };
                observer.keep(&checkpoint);
                samples = checkpoint.samples;
            }
            let (q, now) = (&self.state.q, time(step));
            let observed = samples.last_observed();
            asked = observer.stepped(Progress { step, steps, time: now, q, cost, observed });
            if asked == Control::Stop {
                if !due && let Err(source) = self.sample(now, &mut samples) {
                    return Err(unsampled(source).stops(self.run(samples, cost), None));
                }
                break;
            }
        }
        if observer.keeps_starts() {
            observer.start(self.start());
        }
        if let Some(sampled) = own.kept() {
            observer.own(self.run(sampled, Cost::default()));
        }
        Ok(self.run(samples, cost))
    }

    pub(crate) fn run(&self, samples: Samples, cost: Cost) -> Run {
        let broken = self.recorder.broken().to_vec();
        Run { scene: self.scene.clone(), samples, broken, cost, built: self.built }
    }

    /// Moves by a step of length `h` to the time `to`, or stays as it is.
    fn step(&mut self, h: f64, to: f64) -> Result<Stepped, StepFailure> {
        let stepped = self.stepper.step(&mut self.state, h, to)?;
        self.recorder.check(&self.state)?;
        if self.clock == Clock::OfTheScene {
            self.state.t = to;
        }
        self.recorder.feel(self.stepper.multipliers(), stepped.broken);
        Ok(stepped)
    }

    /// Lets the recorder feel what rods bear at the start: in small parts of a step, which are taken back
    /// and cost nothing in the counts. What fails does so again where it counts.
    fn feel_the_start(&mut self, h: f64) -> Result<(), CheckpointError> {
        let is_asked = |observable: &Observable| matches!(observable, Observable::Tension(_));
        if self.scene.observables.iter().any(is_asked) {
            let (before, part) = (self.before(), SMALL_PART * h);
            // The first step of the constrained Hamilton principle bears half of what bends the path.
            let _ = self.step(part, part).and_then(|_| self.step(part, 2.0 * part));
            self.load(&before)?;
        }
        Ok(())
    }

    /// Shows the parts of a step that the observer is to see, and leaves everything as it was. A part
    /// that has no solution is passed over: the step itself will say so.
    pub(crate) fn look_inside(
        &mut self,
        observer: &mut dyn Observer,
        (step, h): (u64, f64),
    ) -> Result<(), CheckpointError> {
        let parts = observer.parts(step).to_vec();
        let from = self.scene.timing.stepping().time(step - 1);
        for part in parts {
            let to = from + part * h;
            let before = (!self.stepper.reads_off()).then(|| self.before());
            if self.step(part * h, to).is_ok() {
                observer.own_ends(self.stepper.own_ends());
                let mut samples = self.scene.no_samples();
                self.recorder.sample(&self.state, to, &mut samples);
                observer.inside(to, samples.last_observed());
            }
            if let Some(before) = before {
                self.load(&before)?;
            }
        }
        Ok(())
    }

    /// Adds a sample, all of whose numbers are finite.
    pub(crate) fn sample(&mut self, time: f64, samples: &mut Samples) -> Result<(), StepFailure> {
        self.recorder.sample(&self.state, time, samples);
        match samples.overflow(self.scene) {
            Some((quantity, value)) => Err(StepFailure::Overflow { quantity, value }),
            None => Ok(()),
        }
    }

    pub(crate) fn before(&mut self) -> Before {
        let (memory, broken) = (self.stepper.save(), self.recorder.broken().to_vec());
        Before { state: self.state.clone(), memory, broken }
    }

    pub(crate) fn load(&mut self, before: &Before) -> Result<(), CheckpointError> {
        self.stepper.load(before)?;
        self.state.clone_from(&before.state);
        self.recorder.restore(&before.broken);
        Ok(())
    }

    /// Takes the last step of a checkpoint once more, and returns its samples.
    fn resume(&mut self, checkpoint: Checkpoint) -> Result<Samples, CheckpointError> {
        checkpoint.check(self.scene, &self.state)?;
        self.load(&checkpoint.before)?;
        let stepping = self.scene.timing.stepping();
        let stepped = self.step(stepping.step(), stepping.time(checkpoint.step));
        match stepped.is_ok() && self.state == checkpoint.after {
            true => Ok(checkpoint.samples),
            false => Err(CheckpointError::OtherBits { step: checkpoint.step }),
        }
    }
}
