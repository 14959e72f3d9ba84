//! Contact points of pairs of shapes of the plane: gaps by every direction that can bound them.
//!
//! ```text
//! gap = max s(n) - r1 - r2,     s(n) = min n.y - max n.x     x y the corners, r the radii around them
//! ```
//! The largest `s` is taken across an edge of either, or from a corner of one to a corner of the other: a
//! disc is a corner and a radius, a capsule two. All of them are tried, by 32 digits.

use nalgebra::Vector2;
use stationary_calculus::Vector;
use stationary_contact::{
    ContactError, PlanarCollider, PlanarContactPoint, PlanarDetector, PlanarShape, gap_rows,
};

use super::solids::{Number, Three, dot, minus, norm, unit};
use crate::kinds::rigid::double_double::Twofold;
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "planar-contact-points",
    krate: "contact",
    rule: "with P = 1e-12 of the larger of the pair's size and coordinate: the least gap off the \
           separation by more than P; a gap below it by more than P; points outside of their shapes, or \
           off the gap along the normal, by more than 10 P; a normal whose length is off 1 by 1e-14; none \
           where the separation is below the margin by P, one whose gap is above it; the gap's rate off its \
           differential by 1e-3 of the speed and the spin times how far the point moves over its body",
    in_tests: 1000,
    trial,
};

type V = Vector2<f64>;

/// Corners, counterclockwise, and the radius around their hull, m.
struct Outline {
    corners: Vec<[f64; 2]>,
    radius: f64,
}

impl Outline {
    fn drawn(draw: &mut Draw, size: f64) -> Self {
        let thin =
            if draw.chance(0.3) { draw.log_uniform(1e-4, 1.0) } else { draw.uniform(0.3, 1.0) };
        let short = size * thin;
        let (a, b) = if draw.chance(0.5) { (short, size) } else { (size, short) };
        match draw.below(4) {
            0 => Outline { corners: vec![[0.0; 2]], radius: size },
            1 => Outline { corners: vec![[-a, 0.0], [a, 0.0]], radius: b },
            2 => Outline { corners: vec![[-a, -b], [a, -b], [a, b], [-a, b]], radius: 0.0 },
            _ => {
                // On an ellipse, and so convex; no two close to each other.
                let count = draw.between(3, 8);
                let step = std::f64::consts::TAU / count as f64;
                let corner = |k: usize, draw: &mut Draw| {
                    let (s, c) = (step * (k as f64 + 0.4 * draw.symmetric())).sin_cos();
                    [a * c, b * s]
                };
                let corners = (0..count).map(|k| corner(k, draw)).collect();
                Outline { corners, radius: 0.0 }
            }
        }
    }

    fn shape(&self) -> Result<PlanarShape, ContactError> {
        match self.corners[..] {
            [_] => PlanarShape::disc(self.radius),
            [_, [a, _]] => PlanarShape::capsule(a, self.radius),
            _ => {
                let corners: Vec<V> = self.corners.iter().map(|c| V::from(*c)).collect();
                PlanarShape::polygon(&corners)
            }
        }
    }

    fn size(&self) -> f64 {
        self.corners.iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max) + self.radius
    }

    fn thin(&self) -> f64 {
        let least = |k: usize| self.corners.iter().map(|c| c[k].abs()).fold(0.0, f64::max);
        if self.radius > 0.0 { self.radius } else { 0.3 * least(0).min(least(1)) }
    }

    fn placed<T: Number>(&self, pose: &[f64; 3], sine: T, cosine: T) -> Vec<Three<T>> {
        let at = |[x, y]: &[f64; 2]| {
            let (x, y) = (T::from(*x), T::from(*y));
            let [px, py, _] = pose.map(T::from);
            [px + cosine * x - sine * y, py + sine * x + cosine * y, T::from(0.0)]
        };
        self.corners.iter().map(at).collect()
    }
}

/// Outward normals of the edges between corners; a segment has two.
fn normals<T: Number>(corners: &[Three<T>]) -> Vec<Three<T>> {
    if corners.len() < 2 {
        return Vec::new();
    }
    let across = |k: usize| {
        let along = minus(&corners[(k + 1) % corners.len()], &corners[k]);
        unit(&[along[1], -along[0], T::from(0.0)])
    };
    (0..corners.len()).filter_map(across).collect()
}

/// How far a hull reaches along a direction.
fn reach(corners: &[Three<Twofold>], n: &Three<Twofold>) -> Twofold {
    let mut reaches = corners.iter().map(|c| dot(c, n));
    let first = reaches.next().unwrap_or(Twofold::from(0.0));
    reaches.fold(first, |a, b| if (a - b).value() >= 0.0 { a } else { b })
}

fn separation(corners: [&[Three<Twofold>]; 2], n: &Three<Twofold>) -> f64 {
    let back = n.map(|x| -x);
    (-reach(corners[1], &back) - reach(corners[0], n)).value()
}

/// How far outside of a hull a point is.
fn outside(corners: &[Three<Twofold>], x: &Three<Twofold>) -> f64 {
    best([corners, &[*x]])
}

/// The largest separation of two hulls.
fn best(corners: [&[Three<Twofold>]; 2]) -> f64 {
    let [a, b] = corners;
    let mut directions = normals(a);
    directions.extend(normals(b).iter().map(|n| n.map(|x| -x)));
    let between = a.iter().flat_map(|x| b.iter().map(move |y| minus(y, x)));
    directions.extend(between.filter_map(|way| unit(&way)));
    directions.iter().map(|n| separation(corners, n)).fold(f64::NEG_INFINITY, f64::max)
}

struct Pair {
    outlines: [Outline; 2],
    poses: [[f64; 3]; 2],
    margin: f64,
    size: f64,
}

fn angle(draw: &mut Draw) -> f64 {
    if draw.chance(0.4) {
        return 3.0 * draw.symmetric();
    }
    let quarter = std::f64::consts::FRAC_PI_2 * draw.below(4) as f64;
    quarter + if draw.chance(0.6) { draw.symmetric() * draw.log_uniform(1e-17, 1e-2) } else { 0.0 }
}

fn drawn(draw: &mut Draw) -> Pair {
    let size = draw.log_uniform(1e-6, 1e6);
    let ratio = if draw.chance(0.3) { draw.log_uniform(1e-2, 1.0) } else { 1.0 };
    let outlines = [Outline::drawn(draw, size), Outline::drawn(draw, size * ratio)];
    let turns = [angle(draw), angle(draw)];
    let n = match draw.below(3) {
        0 => V::y(),
        1 => V::new(turns[1].cos(), turns[1].sin()),
        _ => {
            let (s, c) = (3.2 * draw.symmetric()).sin_cos();
            V::new(c, s)
        }
    };
    let least = outlines[0].thin().min(outlines[1].thin());
    let gap = match draw.below(5) {
        0 => 0.0,
        1 => size * draw.symmetric() * draw.log_uniform(1e-18, 1e-9),
        2 => -least * draw.log_uniform(1e-12, 0.5),
        3 => size * draw.log_uniform(1e-9, 1.0),
        _ => least * draw.symmetric(),
    };
    let shift = if draw.chance(0.3) { 0.0 } else { size * ratio * draw.symmetric() };
    let extent = |k: usize, n: V| {
        let (s, c) = Twofold::from(turns[k]).sin_cos();
        let corners = outlines[k].placed(&[0.0, 0.0, turns[k]], s, c);
        reach(&corners, &[n.x, n.y, 0.0].map(Twofold::from)).value() + outlines[k].radius
    };
    let apart = extent(0, n) + extent(1, -n) + gap;
    let far = if draw.chance(0.3) { size * draw.log_uniform(1.0, 1e4) } else { 0.0 };
    let second = V::from_fn(|_, _| draw.symmetric()) * far;
    let first = second - n * apart + V::new(-n.y, n.x) * shift;
    let poses = [[first.x, first.y, turns[0]], [second.x, second.y, turns[1]]];
    let margin = size * draw.one_of(&[0.1, 1e-3, 1e-6]);
    for (outline, pose) in outlines.iter().zip(&poses) {
        draw.note(format!("{:?} within {:e} at {pose:?}", outline.corners, outline.radius));
    }
    draw.note(format!("gap {gap:e} along {n:?}, margin {margin:e}"));
    Pair { outlines, poses, margin, size }
}

fn trial(draw: &mut Draw) -> Verdict {
    let pair = drawn(draw);
    let [first, second] = match (pair.outlines[0].shape(), pair.outlines[1].shape()) {
        (Ok(first), Ok(second)) => [first, second],
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    let colliders = vec![PlanarCollider::on_body(0, first), PlanarCollider::on_body(1, second)];
    let mut detector = match PlanarDetector::new(colliders, 2) {
        Ok(detector) => detector,
        Err(error) => return Verdict::refused(error),
    };
    let velocity: Vec<f64> = (0..6).map(|_| draw.symmetric()).collect();
    let q = pair.poses.concat();
    let mut found = |margin: f64| detector.detect(&q, margin).map(<[PlanarContactPoint]>::to_vec);
    let (all, near) = match (found(10.0 * (pair.size + pair.margin)), found(pair.margin)) {
        (Ok(all), Ok(near)) => (all, near),
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    let Some(closest) = all.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)) else {
        return Verdict::wrong("no contact within ten sizes");
    };
    let sizes: f64 = pair.outlines.iter().map(Outline::size).sum();
    let coordinate = pair.poses.iter().flat_map(|p| &p[..2]).fold(0.0_f64, |m, x| m.max(x.abs()));
    let promised = 1e-12 * sizes.max(coordinate);
    let mut verdict = certify(&pair, &all, closest, promised);
    let least = near.iter().map(|c| c.gap).fold(f64::INFINITY, f64::min);
    if near.is_empty() && closest.gap < pair.margin - promised {
        verdict = verdict.and(Verdict::wrong(format!("lost: a gap of {:e}", closest.gap)));
    }
    if near.iter().any(|c| c.gap > pair.margin) {
        verdict = verdict.and(Verdict::wrong("a gap beyond the margin"));
    }
    if !near.is_empty() {
        let off = (least - closest.gap).abs();
        verdict = verdict.and(Verdict::of(off, promised, "the gap within another margin"));
    }
    verdict.and(rate(&pair, &mut detector, &q, velocity, closest))
}

fn certify(
    pair: &Pair,
    contacts: &[PlanarContactPoint],
    closest: &PlanarContactPoint,
    promised: f64,
) -> Verdict {
    let corners = [0, 1].map(|k| {
        let (s, c) = Twofold::from(pair.poses[k][2]).sin_cos();
        pair.outlines[k].placed(&pair.poses[k], s, c)
    });
    let radii = [0, 1].map(|k| pair.outlines[k].radius);
    let gap = best([&corners[0], &corners[1]]) - radii[0] - radii[1];
    let three = |v: V| [v.x, v.y, 0.0].map(Twofold::from);
    let mut verdict = Verdict::of((closest.gap - gap).abs(), promised, "the least gap");
    for contact in contacts {
        let deep = (gap - contact.gap).max(0.0);
        verdict = verdict.and(Verdict::of(deep, promised, "a gap that is invented"));
        let length = (norm(&three(contact.normal)) - Twofold::from(1.0)).value();
        verdict = verdict.and(Verdict::of(length.abs(), 1e-14, "a normal's length"));
        let [x1, x2] = contact.points.map(three);
        let off = norm(&minus(&minus(&x2, &x1), &three(contact.normal * contact.gap))).value();
        verdict = verdict.and(Verdict::of(off, 10.0 * promised, "points across the gap"));
        for (k, x) in [x1, x2].iter().enumerate() {
            let off = (outside(&corners[k], x) - radii[k]).max(0.0);
            verdict = verdict.and(Verdict::of(off, 10.0 * promised, "a point outside"));
        }
    }
    verdict
}

/// Compares the rate of the least gap with its differential, where its normal does not jump.
fn rate(
    pair: &Pair,
    detector: &mut PlanarDetector,
    q: &[f64],
    mut velocity: Vec<f64>,
    closest: &PlanarContactPoint,
) -> Verdict {
    let reach = pair.outlines.iter().map(Outline::size).fold(0.0, f64::max);
    let thin = pair.outlines.iter().map(Outline::thin).fold(f64::INFINITY, f64::min);
    let far = q.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Spins move the rim as fast as the others move the centre.
    velocity.iter_mut().enumerate().filter(|(k, _)| k % 3 < 2).for_each(|(_, v)| *v *= reach);
    let h = 1e-5 * thin / reach;
    // Rounding alone would be seen.
    if 1e-15 * (far + reach) > 1e-4 * h * reach {
        return Verdict::due();
    }
    let mut at = |h: f64| {
        let moved: Vec<f64> = q.iter().zip(&velocity).map(|(q, v)| q + h * v).collect();
        let found = detector.detect(&moved, 10.0 * (pair.size + pair.margin)).ok()?;
        found.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)).copied()
    };
    let (Some(ahead), Some(behind)) = (at(h), at(-h)) else {
        return Verdict::wrong("no contact beside one");
    };
    let both = [&ahead, &behind];
    let way = |k: usize| both.map(|to| (to.arms[k] - closest.arms[k]).norm());
    let shifts = [0, 1].map(|k| way(k)[0].max(way(k)[1]));
    let turned = both.map(|to| (to.normal - closest.normal).norm());
    if turned.iter().any(|&turn| turn > 1e-3) || shifts.iter().any(|&shift| shift > 0.1 * thin) {
        return Verdict::due();
    }
    let slope = (ahead.gap - behind.gap) / (2.0 * h);
    let rate = gap_rows(&[*closest], q).along(0, Vector(&velocity[..]));
    let moves = velocity.chunks_exact(3).zip(shifts);
    let bound =
        moves.map(|(v, shift)| 1e-3 * (v[0].hypot(v[1]) + reach * v[2].abs()) + shift * v[2].abs());
    Verdict::of((slope - rate).abs(), bound.sum(), "the gap's rate")
}
