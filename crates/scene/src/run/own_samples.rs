//! Samples within the steps that an adaptive method chooses itself, kept while they are few.

use stationary_integrators::State;

use crate::model::scene::Scene;
use crate::run::recorder::Recorder;
use crate::run::samples::Samples;

/// Numbers of positions that are kept at most.
const MOST: usize = 1 << 20;
/// Samples that are kept at most: a run of more steps is so dear that polynomials tell it.
const MOST_SAMPLES: usize = 6400;

/// Samples at parts of a method's own steps and at their ends, the start first.
pub(crate) struct OwnSamples(Option<Samples>);

impl OwnSamples {
    /// None where no parts are asked for.
    pub(crate) fn of(scene: &Scene, parts: &[f64]) -> Self {
        OwnSamples((!parts.is_empty()).then(|| scene.no_samples()))
    }

    /// Adds states.
    pub(crate) fn add(&mut self, states: &[State<Vec<f64>>], recorder: &mut dyn Recorder) {
        let Some(samples) = &mut self.0 else { return };
        for state in states {
            recorder.sample(state, state.t, samples);
        }
        if samples.times.len() > MOST_SAMPLES || samples.positions.len() > MOST {
            self.0 = None;
        }
    }

    /// What was kept.
    pub(crate) fn kept(self) -> Option<Samples> {
        self.0.filter(|samples| !samples.times.is_empty())
    }
}
