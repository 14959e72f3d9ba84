//! A run looked at again without its steps: where each of them starts was kept.
//!
//! ```text
//! start_0, start_1, ..., start_k        state_i with what the method remembers there
//! ```
//! What lies within a step costs its parts, what lies at its end nothing.

use stationary_integrators::Cost;

use crate::run::engine::Engine;
use crate::run::error::RunError;
use crate::run::observer::{Control, Observer, Progress};
use crate::run::samples::Run;
use crate::run::start::Start;

impl Engine<'_> {
    /// Where the next step starts.
    pub(crate) fn start(&mut self) -> Start {
        Start { multipliers: self.stepper.multipliers().to_vec(), before: self.before() }
    }

    /// Shows the parts of steps that the observer asks for, and the end of every step.
    pub(crate) fn revisit(
        mut self,
        kept: &[Start],
        observer: &mut dyn Observer,
    ) -> Result<Run, RunError> {
        let (timing, mut samples) = (self.scene.timing, self.scene.no_samples());
        let (steps, h) = (timing.steps(), timing.stepping().step());
        let mut at = kept.iter();
        let Some(mut start) = at.next() else { return Ok(self.run(samples, Cost::default())) };
        self.go_to(start)?;
        self.recorder.sample(&self.state, 0.0, &mut samples);
        for (step, end) in (1..=steps).zip(at) {
            if self.stepper.takes_parts() && !observer.parts(step).is_empty() {
                self.go_to(start)?;
                self.look_inside(observer, (step, h))?;
            }
            self.go_to(end)?;
            let (time, mut sampled) = (timing.stepping().time(step), self.scene.no_samples());
            self.recorder.sample(&self.state, time, &mut sampled);
            let observed = sampled.last_observed();
            let (q, cost) = (&self.state.q, Cost::default());
            let now = Progress { step, steps, time, q, cost, observed };
            if observer.stepped(now) == Control::Stop {
                break;
            }
            start = end;
        }
        Ok(self.run(samples, Cost::default()))
    }

    fn go_to(&mut self, start: &Start) -> Result<(), RunError> {
        self.load(&start.before)?;
        self.recorder.feel(&start.multipliers, None);
        Ok(())
    }
}
