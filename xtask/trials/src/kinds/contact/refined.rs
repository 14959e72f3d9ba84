//! A scene beside itself with steps a hundred times smaller.
//!
//! ```text
//! |x - x_fine| <= 20 h V max(1, A)          A = |x_fine - x_fine'|/delta,   starts delta apart
//! ```
//! `V` the fastest speed, `h` the step: an impact comes by up to a step too early or too late. Where
//! that bound is no small part of a body, or a body moves by more than a fifth of itself in a step, the
//! two need not agree.

use nalgebra::Vector3;
use stationary_contact::ContactError;

use super::case::Case;
use super::engine::{Body, Engine};
use super::hull::depth;
use crate::Verdict;

/// How much smaller the steps of the reference are.
const FINER: usize = 100;
/// Steps that are compared at most.
const STEPS: usize = 6;
/// How far starts are apart, in parts of a body.
const APART: f64 = 1e-5;

type Make = fn(&Case) -> Result<Box<dyn Engine>, ContactError>;

/// Where bodies are in the end, and the fastest speed of any; none where a step fails or has not
/// settled.
fn run(make: Make, case: &Case) -> Option<(Vec<Vector3<f64>>, f64)> {
    let bodies = Body::all(case);
    let mut engine = make(case).ok()?;
    let mut fastest = 0.0_f64;
    for step in 0..=case.steps {
        for (motion, body) in engine.motions().iter().zip(&bodies) {
            let spin = body.spin(&motion.pose.r, &motion.l).norm();
            fastest = fastest.max(motion.p.norm() / body.mass + spin * body.hull.radius);
        }
        if step < case.steps && !engine.step(case.step).ok()?.settled {
            return None;
        }
    }
    Some((engine.motions().iter().map(|motion| motion.pose.x).collect(), fastest))
}

fn apart(a: &[Vector3<f64>], b: &[Vector3<f64>]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

/// The word on a scene; nothing where it need not agree.
pub(super) fn compared(make: Make, case: &Case) -> Option<Verdict> {
    let mut coarse = case.clone();
    coarse.steps = coarse.steps.min(STEPS);
    let (x, speed) = run(make, &coarse)?;
    let bodies = Body::all(case);
    let thin = bodies.iter().map(|body| body.hull.thin).fold(f64::INFINITY, f64::min);
    let h = case.step;
    if speed * h > 0.2 * thin {
        return None;
    }
    let mut fine = coarse.clone();
    (fine.step, fine.steps) = (h / FINER as f64, coarse.steps * FINER);
    let (reference, fastest) = run(make, &fine)?;
    let mut moved = fine.clone();
    for (k, thing) in moved.things.iter_mut().enumerate() {
        let (s, c) = (1.0 + 2.4 * k as f64).sin_cos();
        let aside = if case.flat { Vector3::new(s, c, 0.0) } else { Vector3::new(s, 0.0, c) };
        thing.place += aside * (APART * thin);
    }
    let (other, _) = run(make, &moved)?;
    let grows = (apart(&reference, &other) / (APART * thin)).max(1.0);
    let radius = bodies.iter().map(|body| body.hull.radius).fold(0.0, f64::max);
    // A place is known to rounding.
    let rounding = 1e-14 * reference.iter().map(|x| x.norm()).fold(radius, f64::max);
    let promised =
        20.0 * (h * speed.max(fastest) + overlap(make, case, &bodies)?) * grows + rounding;
    (promised <= 0.2 * thin).then(|| Verdict::of(apart(&x, &reference), promised, "finer steps"))
}

/// How deep bodies are in each other at the start: lifting goes by steps, not by time.
fn overlap(make: Make, case: &Case, bodies: &[Body]) -> Option<f64> {
    let motions = make(case).ok()?.motions();
    let mut deepest = 0.0_f64;
    for (k, body) in bodies.iter().enumerate() {
        let pose = &motions[k].pose;
        for normal in &case.grounds {
            deepest = deepest.max(body.hull.below(pose, normal));
        }
        for (other, motion) in bodies[..k].iter().zip(&motions) {
            deepest = deepest.max(depth([&other.hull, &body.hull], [&motion.pose, pose]));
        }
    }
    Some(deepest)
}
