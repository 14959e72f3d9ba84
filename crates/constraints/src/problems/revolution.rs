//! The time in which a crank goes round, from energy alone.
//!
//! ```text
//! T = integral over a revolution of  sqrt(M(a) / 2 (E - V(a))) da
//! ```
//! `a` the crank's angle, `M` the metric pulled back from unit masses, `V` their height under unit
//! gravity, `E` the energy: where E is above V all the way, the crank goes round in the time T. The
//! sum over equal angles gives T to rounding, as for every smooth periodic function.

use std::f64::consts::TAU;

use stationary_calculus::{Vector, directional_derivative};

use crate::Embedding;

/// Angles over which the time is summed.
const ANGLES: u32 = 512;

/// The time of a revolution of a crank that passes an angle at a rate; none where it does not go
/// round.
pub(super) fn revolution(crank: &impl Embedding<1, 4>, angle: f64, rate: f64) -> Option<f64> {
    let (metric, height) = at(crank, angle);
    let energy = 0.5 * metric * rate * rate + height;
    let times = (0..ANGLES).map(|i| {
        let (metric, height) = at(crank, TAU * f64::from(i) / f64::from(ANGLES));
        (metric / (2.0 * (energy - height))).sqrt() * TAU / f64::from(ANGLES)
    });
    let time: f64 = times.sum();
    time.is_finite().then_some(time)
}

/// The pulled-back metric and the height at an angle.
fn at(crank: &impl Embedding<1, 4>, angle: f64) -> (f64, f64) {
    let along: [f64; 4] = directional_derivative(|a| crank.places(a), [angle], Vector([1.0]));
    let places = crank.places([angle]);
    (along.iter().map(|v| v * v).sum(), places[1] + places[3])
}
