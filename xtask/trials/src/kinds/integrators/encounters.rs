//! Families of close encounters under gravity: orbits, falls and stars that pass each other.

use std::f64::consts::{PI, TAU};

use super::problem::{Energy, InitialValue, mechanics, motion};
use crate::Draw;

/// `V = -strength m / |q|` in D dimensions, as a problem without its answer.
fn central(mass: f64, strength: f64, start: Vec<f64>, end: f64, sizes: [f64; 2]) -> InitialValue {
    let n = start.len() / 2;
    let field = mechanics(
        vec![mass; n],
        move |q, dv| {
            let square: f64 = q.iter().map(|x| x * x).sum();
            let factor = strength * mass / (square * square.sqrt());
            dv.iter_mut().zip(q).for_each(|(dv, q)| *dv = factor * q);
        },
        move |q, h| {
            let square: f64 = q.iter().map(|x| x * x).sum();
            let factor = strength * mass / (square * square.sqrt());
            for j in 0..n {
                for i in 0..n {
                    let one = if i == j { 1.0 } else { 0.0 };
                    h[i + n * j] = factor * (one - 3.0 * q[i] * q[j] / square);
                }
            }
        },
    );
    let [length, momentum] = sizes;
    let sizes = (0..2 * n).map(|i| if i < n { length } else { momentum }).collect();
    let energy: Energy = Box::new(move |q| {
        let square: f64 = q.iter().map(|x| x * x).sum();
        -strength * mass / square.sqrt()
    });
    motion("orbit", vec![mass; n], field, Some(energy), (start, sizes, end))
}

/// The eccentric anomaly E of `E - e sin E = mean`, by bisection and then Newton's steps.
fn eccentric_anomaly(e: f64, mean: f64) -> f64 {
    let turns = (mean / TAU).round();
    let rest = mean - TAU * turns;
    let (mut low, mut high) = (-PI, PI);
    for _ in 0..20 {
        let middle = 0.5 * (low + high);
        if middle - e * middle.sin() < rest { low = middle } else { high = middle }
    }
    let mut anomaly = 0.5 * (low + high);
    for _ in 0..12 {
        let next = anomaly - (anomaly - e * anomaly.sin() - rest) / (1.0 - e * anomaly.cos());
        anomaly = next.clamp(low - 1e-9, high + 1e-9);
    }
    anomaly + TAU * turns
}

/// An ellipse, often very long, in any units, from any place on it.
pub fn orbit(draw: &mut Draw) -> InitialValue {
    let rest = draw.log_uniform(1.0, 3e-5);
    orbit_of(draw, rest)
}

/// An ellipse of eccentricity `1 - rest`.
pub fn orbit_of(draw: &mut Draw, rest: f64) -> InitialValue {
    let e = 1.0 - rest;
    let phase = match draw.below(3) {
        0 => PI,
        1 => 0.0,
        _ => draw.uniform(-PI, PI),
    };
    let turns = draw.uniform(0.3, 2.0);
    let (axis, strength, mass) = match draw.chance(0.3) {
        false => (1.0, 1.0, 1.0),
        true => {
            let any = |draw: &mut Draw| draw.log_uniform(1e-3, 1e3);
            (any(draw), any(draw), any(draw))
        }
    };
    let angle = draw.uniform(0.0, TAU);
    let rate = (strength / (axis * axis * axis)).sqrt();
    let end = turns * TAU / rate;
    draw.note(format!(
        "orbit, 1 - e = {rest:e}, from phase {phase} over {turns} turns, axis {axis}, \
         strength {strength}, mass {mass}, turned by {angle}"
    ));
    let minor = ((1.0 - e) * (1.0 + e)).sqrt();
    let at = move |t: f64| {
        let anomaly = eccentric_anomaly(e, phase + rate * t);
        let half = (0.5 * anomaly).sin();
        let (sin, cos) = anomaly.sin_cos();
        // cos E - e and 1 - e cos E without cancellation near the pericentre.
        let (x, y) = (axis * (rest - 2.0 * half * half), axis * minor * sin);
        let near = rest + e * 2.0 * half * half;
        let speed = mass * axis * rate / near;
        let (px, py) = (-speed * sin, speed * minor * cos);
        let (s, c) = angle.sin_cos();
        vec![c * x - s * y, s * x + c * y, c * px - s * py, s * px + c * py]
    };
    let sizes = [axis, mass * axis * rate];
    let problem = central(mass, strength, at(0.0), end, sizes);
    InitialValue { truth: Some(Box::new(at)), ..problem }
}

/// A fall from rest straight into the sun, on a line or in the plane, with the part of the time
/// until the collision at which it ends: above 1 there is no answer.
pub fn fall(draw: &mut Draw) -> (InitialValue, f64) {
    let n = draw.between(1, 2);
    let height = draw.log_uniform(0.1, 10.0);
    let strength = draw.log_uniform(0.1, 10.0);
    let part = match draw.chance(0.3) {
        false => draw.uniform(1.01, 3.0),
        true => draw.uniform(0.3, 0.99),
    };
    let angle = if draw.chance(0.5) { draw.uniform(0.0, TAU) } else { 0.0 };
    let collision = PI * (height * height * height / (8.0 * strength)).sqrt();
    let mut start = vec![0.0; 2 * n];
    start[0] = height;
    if n == 2 {
        (start[0], start[1]) = (height * angle.cos(), height * angle.sin());
    }
    draw.note(format!("fall from {start:?}, strength {strength}, to {part} of its time"));
    let sizes = [height, (strength / height).sqrt()];
    (central(1.0, strength, start, part * collision, sizes), part)
}

/// Stars in the plane, of unequal masses, that pass each other closely.
pub fn stars(draw: &mut Draw) -> InitialValue {
    let count = draw.between(2, 3);
    let n = 2 * count;
    let bodies: Vec<f64> = (0..count).map(|_| draw.log_uniform(1.0, 1e-3)).collect();
    let masses: Vec<f64> = (0..n).map(|i| bodies[i / 2]).collect();
    let mut start: Vec<f64> = (0..2 * n).map(|_| draw.normal()).collect();
    for i in 0..n {
        start[n + i] *= 0.3 * masses[i];
    }
    let end = draw.uniform(0.3, 4.0);
    draw.note(format!("stars of {bodies:?} from {start:?} until {end}"));
    let weights = bodies.clone();
    let field = mechanics(
        masses.clone(),
        move |q, dv| {
            dv.fill(0.0);
            for i in 0..count {
                for j in 0..i {
                    let d = [q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]];
                    let square = d[0] * d[0] + d[1] * d[1];
                    let factor = bodies[i] * bodies[j] / (square * square.sqrt());
                    for c in 0..2 {
                        dv[2 * i + c] += factor * d[c];
                        dv[2 * j + c] -= factor * d[c];
                    }
                }
            }
        },
        move |q, h| {
            h.fill(0.0);
            for i in 0..count {
                for j in 0..i {
                    let d = [q[2 * i] - q[2 * j], q[2 * i + 1] - q[2 * j + 1]];
                    let square = d[0] * d[0] + d[1] * d[1];
                    let factor = weights[i] * weights[j] / (square * square.sqrt());
                    for a in 0..2 {
                        for b in 0..2 {
                            let one = if a == b { 1.0 } else { 0.0 };
                            let entry = factor * (one - 3.0 * d[a] * d[b] / square);
                            h[2 * i + a + n * (2 * i + b)] += entry;
                            h[2 * j + a + n * (2 * j + b)] += entry;
                            h[2 * i + a + n * (2 * j + b)] -= entry;
                            h[2 * j + a + n * (2 * i + b)] -= entry;
                        }
                    }
                }
            }
        },
    );
    let sizes = (0..2 * n).map(|i| if i < n { 1.0 } else { masses[i - n] }).collect();
    motion("stars", masses, field, None, (start, sizes, end))
}
