//! Forces beside the potential's in steps whose lengths are chosen, and what moves as it is told: each knows the step
//! over which it acts.

use stationary_calculus::{Force, Vector};
use stationary_integrators::State;

/// Forces that are constant over a step, such as means of what changes within it.
pub trait StepForces: Force {
    /// Looks at the step of `h` seconds that starts from a state: what follows is asked of this one. Obstacles are
    /// placed where they are then, with the mean velocity of the step.
    fn prepare(&mut self, state: &mut State<Vec<f64>>, h: f64);

    /// Adds the work of each thing that acts, J, in the step from one state to another, along which the mean
    /// velocity is `u`. There are as many as [`Force::works`] says.
    fn add_works(&self, ends: [&State<Vec<f64>>; 2], u: Vector<&[f64]>, works: &mut [f64]);

    /// Adds to each component of `swings` (N, N m) no less than by how much the force there leaves its mean within the
    /// step, at the place where it starts; of obstacles their mass times by how much their acceleration does.
    fn add_swings(&self, start: &State<Vec<f64>>, swings: &mut [f64]);

    /// The first time after `t` at which a force, or what moves as it is told, is not smooth: a step ends there.
    fn next_corner(&self, t: f64) -> Option<f64>;

    /// Whether a speed that is told jumps at `t`: what it takes along does.
    fn jumps(&self, _t: f64) -> bool {
        false
    }
}

/// Nothing acts.
impl StepForces for () {
    fn prepare(&mut self, _: &mut State<Vec<f64>>, _: f64) {}

    fn add_works(&self, _: [&State<Vec<f64>>; 2], _: Vector<&[f64]>, _: &mut [f64]) {}

    fn add_swings(&self, _: &State<Vec<f64>>, _: &mut [f64]) {}

    fn next_corner(&self, _: f64) -> Option<f64> {
        None
    }
}
