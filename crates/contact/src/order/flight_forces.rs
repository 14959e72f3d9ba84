//! Forces beside the potential's in flight, and what moves there as it is told: kicks before and after each drift.
//!
//! ```text
//! kick s/2 by F(t, q, v),   drift s,   kick s/2 by F(t + s, q', v')     the second kick is the first one backward
//! ```
//! So a stage stays symmetric, and stages of a higher order stay of it; those of fourth order go back in time as well.
//! No flight is longer than to the next corner of what acts.

use stationary_integrators::State;

use crate::order::step_forces::StepForces;

/// At which end of a stage a kick is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum StageEnd {
    /// Before the drift.
    Start,
    /// After it.
    Finish,
}

/// Forces in flight and in steps of contact.
pub trait FlightForces: StepForces {
    /// Gives the impulses of half a stage from `t` to `t + h` (s, `h` may be negative) to a state at one end of it;
    /// obstacles start with the velocity that leads them to where they are at its end.
    fn kick(&mut self, end: StageEnd, stage: (f64, f64), state: &mut State<Vec<f64>>);

    /// Forgets what kicks did.
    fn begin_flight(&mut self);

    /// Adds the work of each thing that acts in the kicks since, J.
    fn add_flown_works(&self, works: &mut [f64]);

    /// Places obstacles where they are at the state's time, with their velocity then.
    fn place(&self, state: &mut State<Vec<f64>>);

    /// Adds to each component of `bounds` (N, N m) no less than the size of the forces between two times at the place
    /// and the momentum of a state; of obstacles their mass times their largest acceleration.
    fn add_bounds(&self, between: (f64, f64), state: &State<Vec<f64>>, bounds: &mut [f64]);
}

/// Nothing acts.
impl FlightForces for () {
    fn kick(&mut self, _: StageEnd, _: (f64, f64), _: &mut State<Vec<f64>>) {}

    fn begin_flight(&mut self) {}

    fn add_flown_works(&self, _: &mut [f64]) {}

    fn place(&self, _: &mut State<Vec<f64>>) {}

    fn add_bounds(&self, _: (f64, f64), _: &State<Vec<f64>>, _: &mut [f64]) {}
}
