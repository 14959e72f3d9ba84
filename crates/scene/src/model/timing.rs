//! Steps, horizon and samples.

use serde::Serialize;
use stationary_integrators::Horizon;

use crate::text::fault::Fault;
use crate::text::limits;

/// Equal steps to a horizon, and how many of them from one sample to the next.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Timing {
    pub(crate) step: f64,
    pub(crate) horizon: f64,
    /// Follows from the two before.
    #[serde(skip)]
    pub(crate) steps: Horizon,
    pub(crate) sample_every: u64,
}

impl Timing {
    pub(crate) fn new(step: f64, horizon: f64, sample_every: u64) -> Result<Self, Fault> {
        let steps = Horizon::new(horizon, step)?;
        if steps.steps() > limits::STEPS {
            return Err(Fault::too_many_steps(steps.steps()));
        }
        Ok(Timing { step, horizon, steps, sample_every })
    }

    /// The step.
    pub fn step(&self) -> f64 {
        self.step
    }

    /// The time to which the scene runs.
    pub fn horizon(&self) -> f64 {
        self.horizon
    }

    /// The number of steps.
    pub fn steps(&self) -> u64 {
        self.steps.steps()
    }

    /// The same steps, for an integrator.
    pub(crate) fn stepping(&self) -> Horizon {
        self.steps
    }

    /// The number of steps from one sample to the next.
    pub fn sample_every(&self) -> u64 {
        self.sample_every
    }

    /// The number of samples: the start, every so many steps, and the end.
    pub fn samples(&self) -> u64 {
        1 + self.steps().div_ceil(self.sample_every)
    }
}
