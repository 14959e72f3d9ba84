//! Scenes that are seen from elsewhere: in other units, turned, shifted, their lists in another order.
//!
//! ```text
//! x'(t') = L (R x(t) + s),   t' = T t            of every particle and body, at every sample
//! ```
//! by another text alone. How far rounding may lead is measured by a third run, whose places start 1e-8 off.

mod drawn;
mod seen;

use nalgebra::{UnitQuaternion, Vector3};
use stationary_scene::{Run, Scene};

use crate::{Draw, Kind, Verdict};
use drawn::{Drawn, drawn, in_order};
use seen::{ENERGY, LENGTH, Seen, TIME};

/// Scenes in other units, turned, shifted and in another order.
pub const KIND: Kind = Kind {
    name: "moved-scenes",
    krate: "scene",
    rule: "a scene in other units (powers of 4), turned, shifted by up to twice its size or with its lists in another \
           order moves otherwise than the one that is moved: places by more than 1e-10 max(1, A) of the scene's size, \
           of what touches by 1e-7 max(1, A), which contacts are solved to, and kinetic energies by as much of the \
           largest, A the growth of distances by a run that starts 1e-8 off; or one of the two alone is refused",
    in_tests: 1000,
    trial,
};

/// How far off the third run starts.
const OFF: f64 = 1e-8;
/// What rounding makes of a run without growth.
const ROUNDING: f64 = 1e-10;
/// What it makes of one whose contacts are solved, to a tolerance.
const SOLVED: f64 = 1e-7;
/// The smallest kinetic energy that is one.
const STILL: f64 = 1e-6;
/// Beyond this a case is too chaotic.
const CHAOS: f64 = 1e-3;

fn trial(draw: &mut Draw) -> Verdict {
    let start = draw.clone();
    let scene = drawn(draw, 0.0);
    let (seen, orders) = view(draw, &scene);
    let plainly = Seen::plainly(scene.dimension);
    let own = run(&scene.text(&plainly, &in_order(&scene)));
    let other = run(&scene.text(&seen, &orders));
    draw.note(scene.text(&seen, &orders));
    let (own, other) = match (own, other) {
        (Ok(own), Ok(other)) => (own, other),
        (Err(_), Err(_)) => return Verdict::due(),
        (Ok(_), Err(why)) | (Err(why), Ok(_)) => {
            return Verdict::wrong(format!("one of two runs alone is refused: {why}"));
        }
    };
    let third = drawn_off(start);
    let Ok(third) = run(&third.text(&plainly, &in_order(&third))) else {
        return Verdict::not_judged("the run that starts beside it fails");
    };
    let growth = (apart(&own, &third, &plainly) / OFF).max(1.0);
    let rounding = if own.scene().contact().is_some() { SOLVED } else { ROUNDING };
    if growth.is_nan() || growth * rounding > CHAOS {
        return Verdict::not_judged(format!("chaos: distances grow by {growth:.1e}"));
    }
    Verdict::of(apart(&own, &other, &seen), rounding * growth, "the moved scene")
}

/// The same scene, its places off.
fn drawn_off(mut start: Draw) -> Drawn {
    drawn(&mut start, OFF)
}

fn run(text: &str) -> Result<Run, String> {
    let scene = Scene::parse("moved.toml", text).map_err(|error| error.to_string())?;
    scene.run().map_err(|error| error.to_string())
}

/// From where it is seen, and the orders of its lists.
fn view(draw: &mut Draw, scene: &Drawn) -> (Seen, Vec<Vec<usize>>) {
    let mut seen = Seen::plainly(scene.dimension);
    if draw.chance(0.5) {
        seen.units = [0; 3].map(|_| 4.0_f64.powi(draw.between(0, 12) as i32 - 6));
    }
    if draw.chance(0.5) {
        let axis =
            if scene.dimension == 2 { Vector3::z() } else { Vector3::from_vec(draw.vector(3)) };
        seen.turn = UnitQuaternion::from_scaled_axis(axis * draw.uniform(-3.0, 3.0));
    }
    if draw.chance(0.5) {
        let shift = draw.vector(3);
        seen.shift
            .iter_mut()
            .zip(shift)
            .take(scene.dimension)
            .for_each(|(to, from)| *to = 2.0 * from);
    }
    let mut orders = in_order(scene);
    for order in &mut orders {
        for k in (1..order.len()).rev() {
            order.swap(k, draw.below(k + 1));
        }
    }
    (seen, orders)
}

/// The largest difference of places, of the scene's size, and of kinetic energies, of the largest.
fn apart(own: &Run, other: &Run, seen: &Seen) -> f64 {
    let d = seen.dimension;
    let of_times = own.times().len() == other.times().len()
        && own.times().iter().zip(other.times()).all(|(a, b)| a * seen.unit(TIME) == *b);
    if !of_times {
        return f64::INFINITY;
    }
    let place = |x: &[f64]| Vector3::from_iterator(x.iter().copied().chain([0.0; 3]).take(3));
    let names = |run: &Run| -> Vec<String> {
        run.scene().particles().iter().map(|particle| particle.name.clone()).collect()
    };
    let (from, to) = (names(own), names(other));
    let (mut size, mut off) = (0.0_f64, 0.0_f64);
    for (k, name) in from.iter().enumerate() {
        let Some(j) = to.iter().position(|other| other == name) else { return f64::INFINITY };
        for sample in 0..own.times().len() {
            let x = place(&own.positions(sample)[d * k..d * (k + 1)]);
            let y = place(&other.positions(sample)[d * j..d * (j + 1)]) / seen.unit(LENGTH);
            size = size.max(x.norm());
            // What is not a number is as far as can be.
            let distance = (seen.moved(x) - y).norm();
            off = if distance.is_nan() { f64::INFINITY } else { off.max(distance) };
        }
    }
    let kinetic = own.kinetic_energies().iter().zip(other.kinetic_energies());
    let largest = own.kinetic_energies().iter().fold(0.0_f64, |a, b| a.max(*b));
    let energies = kinetic.map(|(a, b)| (a - b / seen.unit(ENERGY)).abs()).fold(0.0, f64::max);
    // What stands still has energies of rounding.
    (off / size.max(1.0)).max(energies / largest.max(STILL))
}
