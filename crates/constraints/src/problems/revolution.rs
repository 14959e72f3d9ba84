//! The time in which a crank goes round, from energy alone.
//!
//! ```text
//! T = integral over a revolution of  sqrt(M(a) / 2 (E - V(a))) da
//! a = end +- x,    x = l / (1 + exp(-pi sinh t)),    t in equal steps
//! ```
//! `a` the crank's angle, `M` its inertia (kg m^2), `V` the potential energy (J), `E` the energy: where E is above V
//! all the way, the crank goes round in the time T. It is slow near the top of V, the slower the less E is above it,
//! and there the angles of the sum lie close together, as they do at angles where bars are told to turn fast: these
//! are the ends, `2 l` apart. Its steps are halved until it stands. Source of the sum: Takahasi and Mori, Double
//! exponential formulas for numerical integration (1974).

use std::f64::consts::{PI, TAU};

use stationary_calculus::{Vector, directional_derivative};

use super::top::top;
use crate::Embedding;

/// Beyond these t, x is 0 and pi to rounding.
const END: f64 = 3.75;
/// The first step of t, and how often it is halved.
const STEP: f64 = 0.125;
const HALVINGS: u32 = 9;
/// A sum that its halved step changes by less is right to far more: its digits double.
const STANDS: f64 = 1e-9;
/// A time is known where rounding of the energies changes it by less than this part.
const KNOWN: f64 = 1e-8;

/// The time of a revolution, seconds, of a crank that passes `angle` at `rate` (rad/s), where `at` gives its
/// inertia (kg m^2) and its potential energy (J) at an angle. Beside the angles `sharp` (radians) both may change as
/// fast as they will; elsewhere not within a hundredth of a turn. `None` where it does not go round, or where it
/// has so little energy more than it needs that rounding leaves fewer than eight digits of the time.
pub fn time_of_revolution(
    angle: f64,
    rate: f64,
    sharp: &[f64],
    at: impl Fn(f64) -> (f64, f64),
) -> Option<f64> {
    let (inertia, potential) = at(angle);
    let kinetic = 0.5 * inertia * rate * rate;
    let energy = kinetic + potential;
    let (top, highest) = top(|angle| at(angle).1, sharp)?;
    let rounding = 2.0 * f64::EPSILON * (kinetic + potential.abs() + highest.abs());
    // Written so that what is not a number does not go round.
    let goes_round = energy - highest > rounding;
    if !goes_round {
        return None;
    }
    // What an angle adds to the time, and to its change with rounding of the energy.
    let density = |angle: f64| {
        let (inertia, potential) = at(angle);
        let above = energy - potential;
        let time = (inertia / (2.0 * above)).sqrt();
        [time, time * rounding / (2.0 * above)]
    };
    let pairs = pairs(top, sharp);
    let summand = |t: f64| {
        let (x, weight) = distance(t);
        pairs.iter().fold([0.0; 2], |sum, &([from, to], part)| {
            let [ahead, behind] = [density(from + part * x), density(to - part * x)];
            [0, 1].map(|k| sum[k] + (ahead[k] + behind[k]) * (part * weight))
        })
    };
    let mut step = STEP;
    let mut sums = sum(&summand, 0.0, step);
    for _ in 0..HALVINGS {
        let between = sum(&summand, 0.5 * step, step);
        let finer = [0, 1].map(|k| 0.5 * (sums[k] + between[k]));
        if (finer[0] - sums[0]).abs() <= STANDS * finer[0] && finer[0].is_finite() {
            let [time, doubt] = finer;
            return (doubt <= KNOWN * time).then_some(time);
        }
        (sums, step) = (finer, 0.5 * step);
    }
    None
}

/// Ends in turn around the circle from the top on, by pairs, with the part of half a turn to the middle between them.
fn pairs(top: f64, sharp: &[f64]) -> Vec<([f64; 2], f64)> {
    let beyond = |&end: &f64| (end, (end - top).rem_euclid(TAU));
    let mut ends: Vec<(f64, f64)> = sharp.iter().map(beyond).collect();
    ends.extend([(top, 0.0), (top, TAU)]);
    ends.sort_by(|a, b| a.1.total_cmp(&b.1));
    ends.windows(2).map(|two| ([two[0].0, two[1].0], (two[1].1 - two[0].1) / TAU)).collect()
}

/// The distance x from an end of half a turn that belongs to t, and its slope.
fn distance(t: f64) -> (f64, f64) {
    let decay = (-PI * t.sinh()).exp();
    let x = PI / (1.0 + decay);
    (x, x * PI * t.cosh() * (decay / (1.0 + decay)))
}

/// The sum over equal steps from `-END + shift` on.
fn sum(summand: &impl Fn(f64) -> [f64; 2], shift: f64, step: f64) -> [f64; 2] {
    let count = (2.0 * END / step).round() as u32;
    let mut sums = [0.0; 2];
    for i in 0..count {
        let of_one = summand(-END + shift + f64::from(i) * step);
        sums = [0, 1].map(|k| sums[k] + step * of_one[k]);
    }
    sums
}

/// The time of a revolution of a crank between unit masses under unit gravity.
pub(super) fn revolution(crank: &impl Embedding<1, 4>, angle: f64, rate: f64) -> Option<f64> {
    time_of_revolution(angle, rate, &[], |angle| {
        let along: [f64; 4] = directional_derivative(|a| crank.places(a), [angle], Vector([1.0]));
        let places = crank.places([angle]);
        (along.iter().map(|v| v * v).sum(), places[1] + places[3])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problems::{four_bar, slider_crank};

    #[test]
    fn the_time_is_that_of_a_pendulum_that_goes_round_at_every_energy() {
        // A unit pendulum with V = 1 - cos a, pushed at the bottom: 2 K(2/v) 2/v.
        let period = |speed: f64| crate::problems::pendulum(speed).unwrap().period;
        let time = |speed| time_of_revolution(0.0, speed, &[], |a| (1.0, 1.0 - a.cos()));
        for above in [1e-5, 1e-4, 1e-2, 1.0, 10.0, 1e4] {
            let (found, right) = (time(2.0 + above).unwrap(), period(2.0 + above));
            assert!((found / right - 1.0).abs() < 1e-10, "{above}: {found} {right}");
        }
        // It goes from slow to never, and is not guessed in between.
        assert_eq!([2.0 + 1e-14, 2.0, 2.0 - 1e-14, 1.9, 0.0, f64::NAN].map(time), [None; 6]);
    }

    #[test]
    fn the_times_near_the_top_are_those_of_adaptive_quadrature() {
        let crank = |rate| four_bar(0.0, rate).unwrap().revolution;
        let piston = |rate| slider_crank(0.0, rate).unwrap().revolution;
        let cases = [
            (crank(0.905_924_040_256_265_4), 4.101_939_141_855_913),
            (crank(0.651_688_857_288_687_5), 9.419_407_319_123_174),
            (crank(0.648_643_481_979_303_9), 14.587_632_188_036_485),
            (crank(0.648_612_956_017_867_1), 19.753_271_921_871_807),
            (piston(2.0), 4.061_392_412_287_951),
            (piston(1.421_267_040_355_189_5), 10.401_101_805_628_58),
            (piston(1.414_284_271_283_535), 16.906_721_030_539_728),
            (piston(1.414_214_269_479_699_3), 23.419_274_293_217_946),
        ];
        for (found, right) in cases {
            assert!((found.unwrap() / right - 1.0).abs() < 1e-9, "{found:?} {right}");
        }
    }

    #[test]
    fn a_crank_that_is_just_short_of_the_top_does_not_go_round() {
        for short in [0.648_612_616_832_447_6, 0.648_612_339_316_972_5] {
            assert_eq!(four_bar(0.0, short).unwrap().revolution, None);
        }
        for short in [1.414_213_491_662_415_2, 1.414_212_855_266_137] {
            assert_eq!(slider_crank(0.0, short).unwrap().revolution, None);
        }
    }
}
