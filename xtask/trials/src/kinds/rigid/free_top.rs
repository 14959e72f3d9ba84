//! The free top in closed form against Euler's equations in 32 digits.
//!
//! ```text
//! m. = m x I^-1 m,   q. = q (0, I^-1 m)/2        Taylor's series, coefficient by coefficient
//! ```

use nalgebra::Vector3;
use stationary_rigid::{Body, FreeTop, LieGroup, Rotation};

use super::double_double::Twofold;
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "free-top",
    krate: "rigid",
    rule: "attitude or momentum are off by more than roundings that grow with the angle turned, and \
           what two roundings of the start are amplified to",
    in_tests: 50,
    trial,
};

/// Terms of a series, and the angle of a step: 0.15^24 is 2e-20.
const TERMS: usize = 24;
const ANGLE: f64 = 0.15;

/// Where a top is: momentum and quaternion.
#[derive(Clone, Copy)]
struct Turned {
    m: [Twofold; 3],
    q: [Twofold; 4],
}

type Series = [Twofold; TERMS + 1];

/// One term of a product of series.
fn product(a: &Series, b: &Series, k: usize) -> Twofold {
    (0..=k).fold(Twofold::from(0.0), |sum, i| sum + a[i] * b[k - i])
}

fn step(start: Turned, inverse: [Twofold; 3], h: Twofold) -> Turned {
    let zero = [Twofold::from(0.0); TERMS + 1];
    let (mut m, mut w, mut q) = ([zero; 3], [zero; 3], [zero; 4]);
    (0..3).for_each(|c| m[c][0] = start.m[c]);
    (0..4).for_each(|c| q[c][0] = start.q[c]);
    for k in 0..TERMS {
        for c in 0..3 {
            w[c][k] = m[c][k] * inverse[c];
        }
        let next = Twofold::from((k + 1) as f64);
        for c in 0..3 {
            let (a, b) = ((c + 1) % 3, (c + 2) % 3);
            m[c][k + 1] = (product(&m[a], &w[b], k) - product(&m[b], &w[a], k)) / next;
        }
        let p = |a: usize, b: usize| product(&q[a], &w[b], k);
        let turned = [
            -(p(1, 0) + p(2, 1) + p(3, 2)),
            p(0, 0) + p(2, 2) - p(3, 1),
            p(0, 1) + p(3, 0) - p(1, 2),
            p(0, 2) + p(1, 1) - p(2, 0),
        ];
        (0..4).for_each(|c| q[c][k + 1] = turned[c] * 0.5 / next);
    }
    let sum = |series: &Series| series.iter().rev().fold(Twofold::from(0.0), |s, &x| s * h + x);
    Turned { m: [0, 1, 2].map(|c| sum(&m[c])), q: [0, 1, 2, 3].map(|c| sum(&q[c])) }
}

/// The top of these moments after a time.
fn integrated(moments: [f64; 3], momentum: [Twofold; 3], t: f64, speed: f64) -> Turned {
    let one = Twofold::from(1.0);
    let inverse = moments.map(|i| one / Twofold::from(i));
    let steps = (t.abs() * speed / ANGLE).ceil().max(1.0);
    let h = Twofold::from(t) / Twofold::from(steps);
    let zero = Twofold::from(0.0);
    let mut at = Turned { m: momentum, q: [one, zero, zero, zero] };
    for _ in 0..steps as usize {
        at = step(at, inverse, h);
    }
    at
}

impl Turned {
    fn rotation(&self) -> Rotation {
        let length = self.q.iter().fold(Twofold::from(0.0), |s, &x| s + x * x).sqrt();
        let q = self.q.map(|x| (x / length).value());
        Rotation::from_quaternion(q).unwrap_or(Rotation::identity())
    }

    fn momentum(&self) -> Vector3<f64> {
        Vector3::from(self.m.map(Twofold::value))
    }
}

/// Moments of some mass, often nearly equal.
fn moments(draw: &mut Draw) -> [f64; 3] {
    let spread = draw.one_of(&[2.0, 10.0, 1e3]);
    let mut of = [0; 3].map(|_| draw.log_uniform(1.0, spread));
    if draw.chance(0.4) {
        // Two alike, or all three.
        of[1] = of[0] * (1.0 + draw.one_of(&[0.0, 1.0]) * draw.log_uniform(1e-16, 1e-2));
        if draw.chance(0.3) {
            of[2] = of[0] * (1.0 - draw.log_uniform(1e-16, 1e-2));
        }
    }
    let size = draw.one_of(&[1.0, 1e-6, 1e6]);
    let mut moments = [of[1] + of[2], of[2] + of[0], of[0] + of[1]].map(|i| i * size);
    moments.rotate_left(draw.below(3));
    if draw.chance(0.5) {
        moments.swap(0, 1);
    }
    moments
}

/// A direction of the angular velocity: any, beside an axis, beside the separatrix.
fn direction(draw: &mut Draw, i: &[f64; 3]) -> Vector3<f64> {
    let mut w = Vector3::from_fn(|_, _| draw.symmetric());
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| i[a].total_cmp(&i[b]));
    let [a, b, c] = axes;
    match draw.below(4) {
        0 => {}
        1 => {
            let thin = draw.log_uniform(1e-17, 1e-1);
            let kept = draw.below(3);
            (0..3).filter(|&k| k != kept).for_each(|k| w[k] *= thin);
        }
        _ => {
            // I_c (I_c - I_b) w_c^2 = I_a (I_b - I_a) w_a^2, nearly.
            let off = draw.one_of(&[0.0, 1.0, -1.0]) * draw.log_uniform(1e-17, 1e-1);
            let ratio = i[a] * (i[b] - i[a]) / (i[c] * (i[c] - i[b]));
            if ratio.is_finite() {
                w[c] = (w[a].abs() * ratio.sqrt() * (1.0 + off)).copysign(w[c]);
            }
        }
    }
    if w.amax() == 0.0 { Vector3::new(0.0, 0.0, 1.0) } else { w / w.amax() }
}

fn trial(draw: &mut Draw) -> Verdict {
    let moments = moments(draw);
    let w = direction(draw, &moments) * draw.one_of(&[1.0, 1e-3, 1e3]);
    let angle = draw.log_uniform(1e-2, 20.0);
    let t = angle / w.norm() * draw.one_of(&[1.0, -1.0]);
    draw.note(format!("moments {moments:?}, w {w:?}, t {t:e}, angle {angle:.3}"));
    let body = match Body::new(1.0, moments) {
        Ok(body) => body,
        Err(error) => return Verdict::refused(error),
    };
    let start = Rotation::exp(Vector3::new(0.3, -0.8, 0.2));
    let top = match FreeTop::new(body, start, w) {
        Ok(top) => top,
        Err(error) => return Verdict::refused(error),
    };
    let m = Vector3::from(moments).component_mul(&w);
    let speed = m.norm() / moments.iter().fold(f64::INFINITY, |a, &b| a.min(b));
    if angle * speed / w.norm() > 2_000.0 {
        return Verdict::due();
    }
    let at = |signs: [f64; 3]| {
        let rounded = [0, 1, 2]
            .map(|c| Twofold::from(m[c]) * (Twofold::from(1.0) + Twofold::from(2e-16 * signs[c])));
        integrated(moments, rounded, t, speed)
    };
    let exact = at([0.0; 3]);
    // What roundings of the start are amplified to, seen through ten thousand times as much.
    let spread = |signs: [f64; 3]| {
        let other = at(signs.map(|s| 1e4 * s));
        let attitude = exact.rotation().direction_to(&other.rotation()).norm();
        let momentum = (exact.momentum() - other.momentum()).norm() / m.norm();
        (1e-4 * attitude, 1e-4 * momentum)
    };
    let (attitude, momentum) = spread([1.0, -1.0, 1.0]);
    let rounding = 2e-14 * (1.0 + angle);
    let expected = start.compose(&exact.rotation());
    let (orientation, momentum_then) = match (top.orientation(t), top.momentum(t)) {
        (Ok(orientation), Ok(momentum)) => (orientation, momentum),
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    let off = expected.direction_to(&orientation).norm();
    let verdict = Verdict::of(off, rounding + 10.0 * attitude, "the attitude");
    let off = (momentum_then - exact.momentum()).norm() / m.norm();
    verdict.and(Verdict::of(off, rounding + 10.0 * momentum, "the momentum"))
}
