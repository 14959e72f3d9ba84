//! Every constructor and function of the crate with bad numbers and sizes.

mod joints;
mod masses;
mod motions;
mod rotations;
mod sizes;

use nalgebra::Vector3;
use stationary_rigid::Body;

use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "bad-input-rigid",
    krate: "rigid",
    rule: "a panic or a hang; Ok where numbers or sizes are bad or a body is absent, or Ok with \
           numbers that are not finite",
    in_tests: 2000,
    trial,
};

fn trial(draw: &mut Draw) -> Verdict {
    match draw.below(9) {
        0 => motions::states(draw),
        1 => motions::bodies(draw),
        2 => sizes::absent(draw),
        3 => sizes::short(draw),
        4 => rotations::rotations(draw),
        5 => rotations::matrices(draw),
        6 => masses::masses(draw),
        7 => motions::tops(draw),
        _ => joints::joints(draw),
    }
}

fn number(draw: &mut Draw, good: f64, bad: f64) -> f64 {
    if draw.chance(bad) { draw.any_f64() } else { good }
}

fn vector(draw: &mut Draw, bad: f64) -> Vector3<f64> {
    let mut v = Vector3::from_fn(|_, _| draw.symmetric());
    if draw.chance(bad) {
        v[draw.below(3)] = draw.any_f64();
    }
    v
}

fn finite(numbers: &[f64]) -> bool {
    numbers.iter().all(|x| x.is_finite())
}

fn unit(q: &[f64]) -> bool {
    (q.iter().map(|c| c * c).sum::<f64>().sqrt() - 1.0).abs() < 1e-6
}

fn box_of_one() -> Body {
    Body::solid_box(1.0, [0.1, 0.2, 0.3]).expect("a box")
}
