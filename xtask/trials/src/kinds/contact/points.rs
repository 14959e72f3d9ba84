//! Contact points of pairs of shapes: gaps between two bounds of 32 digits.
//!
//! ```text
//! s(n) <= gap <= |x2 - x1|        any unit n, any point of each;  s(n) = min n.x2 - max n.x1
//! ```
//! Of solids that are apart the contact's own normal and points prove its gap. How deep solids overlap
//! is bounded by every direction: those of faces and across edges, of axes, of centres, random ones,
//! and the best of them followed by random turns that get smaller.

use stationary_calculus::Vector;
use stationary_contact::{Collider, ContactError, ContactPoint, Detector, Shape, gap_rows};
use stationary_rigid::{LieGroup, Poses, RigidMotion, Rotation};

use nalgebra::Vector3;

use super::solids::{Form, Solid, Three, cross, exactly, minus, norm, separation, unit};
use crate::kinds::rigid::double_double::Twofold;
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "contact-points",
    krate: "contact",
    rule: "with P = 1e-12 of the larger of the pair's size and coordinate: the least gap off the \
           separation of the solids by more than P; a gap below it by more than P; points outside of \
           their solids, or off the gap along the normal, by more than 10 P (of two boxes, also 4e-9 of the larger least half \
           size, by which they are clipped wider); a normal whose length is \
           off 1 by 1e-14; none where the separation is below the margin by P, one whose gap is above \
           it; the gap's rate off its differential by 1e-3 of the speed and the spin times how far the \
           point moves over its body",
    in_tests: 300,
    trial,
};

type V = Vector3<f64>;

/// A drawn pair.
pub(super) struct Pair {
    pub(super) forms: [Form; 2],
    pub(super) poses: [RigidMotion; 2],
    pub(super) margin: f64,
    size: f64,
}

/// Kinds of solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SolidKind {
    /// Edges of three lengths.
    Box,
    /// A radius.
    Ball,
    /// A length and a radius.
    Capsule,
    /// A length and a radius.
    Cylinder,
    /// A height and a radius.
    Cone,
    /// Three half axes.
    Ellipsoid,
    /// The hull of four to nine points.
    Hull,
}

const ALL: [SolidKind; 7] = [
    SolidKind::Box,
    SolidKind::Ball,
    SolidKind::Capsule,
    SolidKind::Cylinder,
    SolidKind::Cone,
    SolidKind::Ellipsoid,
    SolidKind::Hull,
];

/// One of these forms.
pub(super) fn form(draw: &mut Draw, size: f64, of: &[SolidKind]) -> Form {
    let thin = match draw.below(4) {
        0 => draw.log_uniform(1e-4, 1.0),
        _ => draw.uniform(0.3, 1.0),
    };
    let short = size * thin;
    let swap = draw.chance(0.5);
    let (a, b) = if swap { (short, size) } else { (size, short) };
    match draw.one_of(of) {
        SolidKind::Box => Form::Box([size, draw.one_of(&[short, size]), short]),
        SolidKind::Ball => Form::Ball(size),
        SolidKind::Capsule => Form::Capsule(a, b),
        SolidKind::Cylinder => Form::Cylinder(a, b),
        SolidKind::Cone => Form::Cone(a, b),
        SolidKind::Ellipsoid => Form::Ellipsoid([size, draw.one_of(&[short, size]), short]),
        SolidKind::Hull => {
            let count = draw.between(4, 9);
            let scale = [size, size, short];
            let corner = |draw: &mut Draw| scale.map(|s| s * draw.symmetric());
            // Not in one plane, whatever is drawn.
            let mut corners = vec![[0.0; 3], [size, 0.0, 0.0], [0.0, size, 0.0], [0.0, 0.0, short]];
            corners.extend((4..count).map(|_| corner(draw)));
            Form::Hull(corners)
        }
    }
}

pub(super) fn rotation(draw: &mut Draw) -> Rotation {
    let any =
        |draw: &mut Draw, most: f64| Rotation::exp(V::from_fn(|_, _| most * draw.symmetric()));
    if draw.chance(0.4) {
        return any(draw, 3.0);
    }
    // Quarter turns, and off them by rounding or by little.
    let quarter =
        |axis: V, turns: usize| Rotation::exp(axis * (std::f64::consts::FRAC_PI_2 * turns as f64));
    let turned = quarter(V::x(), draw.below(4)).compose(&quarter(V::y(), draw.below(4)));
    let yaw = if draw.chance(0.5) { 3.0 * draw.symmetric() } else { 0.0 };
    let tilt = match draw.below(3) {
        0 => 0.0,
        _ => draw.log_uniform(1e-17, 1e-2),
    };
    let lean = any(draw, tilt);
    Rotation::exp(V::z() * yaw).compose(&lean).compose(&turned)
}

fn drawn(draw: &mut Draw) -> Pair {
    let size = draw.log_uniform(1e-6, 1e6);
    let first = form(draw, size, &ALL);
    let ratio = if draw.chance(0.3) { draw.log_uniform(1e-2, 1.0) } else { 1.0 };
    let floor = draw.chance(0.15);
    let second = if floor { Form::Floor } else { form(draw, size * ratio, &ALL) };
    placed(draw, [first, second], size)
}

/// Two forms, the first of this size, placed beside each other.
pub(super) fn placed(draw: &mut Draw, forms: [Form; 2], size: f64) -> Pair {
    let floor = matches!(forms[1], Form::Floor);
    let turns = [rotation(draw), if floor { Rotation::identity() } else { rotation(draw) }];
    // Along a direction they are placed at a gap, and shifted across it.
    let n = match draw.below(3) {
        0 => V::z(),
        1 => turns[1].rotate(&draw.one_of(&[V::x(), V::y(), V::z()])),
        _ => V::from_fn(|_, _| draw.symmetric()),
    };
    let n = if floor { -V::z() } else { n.try_normalize(1e-3).unwrap_or(V::z()) };
    let least = forms[0].thin().min(forms[1].thin());
    let gap = match draw.below(5) {
        0 => 0.0,
        1 => size * draw.symmetric() * draw.log_uniform(1e-18, 1e-9),
        2 => -least * draw.log_uniform(1e-12, 0.5),
        3 => size * draw.log_uniform(1e-9, 1.0),
        _ => least * draw.symmetric(),
    };
    let shift = if draw.chance(0.3) {
        0.0
    } else {
        forms[0].size().min(if floor { size } else { forms[1].size() }) * draw.unit()
    };
    let across = V::from_fn(|_, _| draw.symmetric());
    let across = across - n * across.dot(&n);
    let at_origin = |k: usize, at: V| {
        let q = turns[k].quaternion();
        Solid::<f64>::new(&forms[k], at.into(), q)
    };
    let reach = |k: usize, n: V| at_origin(k, V::zeros()).reach(&n.into());
    let apart = reach(0, n) + reach(1, -n) + gap;
    let far = if draw.chance(0.3) { size * draw.log_uniform(1.0, 1e4) } else { 0.0 };
    let origin = if floor { V::zeros() } else { V::from_fn(|_, _| draw.symmetric()) * far };
    let second = origin;
    let first = origin - n * apart + across * shift;
    let poses = [
        RigidMotion { translation: first, rotation: turns[0] },
        RigidMotion { translation: second, rotation: turns[1] },
    ];
    let margin = size * draw.one_of(&[0.1, 1e-3, 1e-6]);
    draw.note(format!("{:?} at {:?} {:?}", forms[0], poses[0].translation, turns[0].quaternion()));
    draw.note(format!("{:?} at {:?} {:?}", forms[1], poses[1].translation, turns[1].quaternion()));
    draw.note(format!("gap {gap:e} along {n:?}, margin {margin:e}"));
    Pair { forms, poses, margin, size }
}

pub(super) fn shape(form: &Form) -> Result<Shape, ContactError> {
    match form {
        Form::Ball(r) => Shape::ball(*r),
        Form::Capsule(a, r) => Shape::capsule(*a, *r),
        Form::Cylinder(a, r) => Shape::cylinder(*a, *r),
        Form::Cone(h, r) => Shape::cone(*h, *r),
        Form::Ellipsoid(half) => Shape::ellipsoid(*half),
        Form::Box(half) => Shape::cuboid(*half),
        Form::Hull(corners) => {
            Shape::convex(&corners.iter().map(|c| V::from(*c)).collect::<Vec<_>>())
        }
        Form::Floor => Shape::half_space(V::z()),
    }
}

pub(super) fn configuration(poses: &[RigidMotion]) -> Vec<f64> {
    let numbers = |pose: &RigidMotion| {
        let t = pose.translation;
        [t.x, t.y, t.z].into_iter().chain(pose.rotation.quaternion())
    };
    poses.iter().flat_map(numbers).collect()
}

fn trial(draw: &mut Draw) -> Verdict {
    let pair = drawn(draw);
    let floor = matches!(pair.forms[1], Form::Floor);
    let bodies = if floor { 1 } else { 2 };
    let mut detector = {
        let shapes = match (shape(&pair.forms[0]), shape(&pair.forms[1])) {
            (Ok(first), Ok(second)) => [first, second],
            // A hull may be too thin to be one.
            (Err(ContactError::Flat { .. }), _) | (_, Err(ContactError::Flat { .. })) => {
                return Verdict::due();
            }
            (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
        };
        let [first, second] = shapes;
        let second = match floor {
            true => Collider::fixed(RigidMotion::identity(), second),
            false => Collider::on_body(1, second),
        };
        match Detector::new(vec![Collider::on_body(0, first), second], bodies) {
            Ok(detector) => detector,
            Err(error) => return Verdict::refused(error),
        }
    };
    let seeds = [draw.word(), draw.word()];
    let velocity: Vec<f64> = (0..6 * bodies).map(|_| draw.symmetric()).collect();
    let q = configuration(&pair.poses[..bodies]);
    let wide = 10.0 * (pair.size + pair.margin);
    let all: Vec<ContactPoint> = match detector.detect(&q, wide) {
        Ok(found) => found.to_vec(),
        Err(error) => return Verdict::refused(error),
    };
    let near: Vec<ContactPoint> = match detector.detect(&q, pair.margin) {
        Ok(found) => found.to_vec(),
        Err(error) => return Verdict::refused(error),
    };
    let Some(closest) = all.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)) else {
        return Verdict::wrong("no contact within ten sizes");
    };
    let referee = Referee::of(&pair, seeds);
    let promised = referee.promised;
    let mut verdict = referee.certify(&all, closest);
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
    verdict.and(rate(&pair, &mut detector, &q, &velocity, closest))
}

/// Compares the rate of the least gap with its differential, where its normal does not jump.
fn rate(
    pair: &Pair,
    detector: &mut Detector,
    q: &[f64],
    velocity: &[f64],
    closest: &ContactPoint,
) -> Verdict {
    use stationary_calculus::Space;
    let reach = pair.forms.iter().map(Form::size).fold(0.0, f64::max);
    let thin = pair.forms.iter().map(Form::thin).fold(f64::INFINITY, f64::min);
    let far = q.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // Angular velocities move the rim as fast as the others move the centre.
    let velocity: Vec<f64> =
        velocity.iter().enumerate().map(|(k, v)| if k % 6 < 3 { v * reach } else { *v }).collect();
    let h = 1e-5 * thin / reach;
    // Rounding alone would be seen.
    if 1e-15 * (far + reach) > 1e-4 * h * reach {
        return Verdict::due();
    }
    let mut at = |h: f64| -> Option<ContactPoint> {
        let mut moved = q.to_vec();
        Poses.advance(&mut moved, h, Vector(&velocity[..]));
        let found = detector.detect(&moved, 20.0 * pair.size).ok()?;
        found.iter().min_by(|a, b| a.gap.total_cmp(&b.gap)).copied()
    };
    let (Some(ahead), Some(behind)) = (at(h), at(-h)) else {
        return Verdict::wrong("no contact a little farther");
    };
    let turned = (ahead.normal - behind.normal).norm();
    let far = |one: &ContactPoint, other: &ContactPoint| {
        (0..2).any(|k| (one.arms[k] - other.arms[k]).norm() > 0.1 * thin)
    };
    let jumps = far(&ahead, &behind) || far(closest, &ahead);
    if turned > 1e-3 || (closest.normal - ahead.normal).norm() > 1e-3 || jumps {
        return Verdict::due();
    }
    let rows = gap_rows(&[*closest], q);
    let rate = rows.along(0, Vector(&velocity[..]));
    let slope = (ahead.gap - behind.gap) / (2.0 * h);
    // How fast a point of either may move: a normal that turns by 1e-3 changes the rate by that part of it,
    // and a point that moves over its body by a way changes it by the body's spin times that.
    let length = |v: &[f64]| v.iter().map(|v| v * v).sum::<f64>().sqrt();
    let speeds = velocity.chunks_exact(6).map(|v| length(&v[..3]) + reach * length(&v[3..]));
    let shift = |k: usize| {
        let way = |to: &ContactPoint| (to.arms[k] - closest.arms[k]).norm();
        way(&ahead).max(way(&behind))
    };
    let shifts = velocity.chunks_exact(6).enumerate().map(|(k, v)| length(&v[3..]) * shift(k));
    let bound = 1e-3 * speeds.sum::<f64>() + shifts.sum::<f64>();
    Verdict::of((slope - rate).abs(), bound, "the gap's rate")
}

/// What knows how far two solids are apart.
pub(super) struct Referee {
    exact: [Solid<Twofold>; 2],
    /// The largest separation that was found by directions of its own.
    pub(super) best: f64,
    /// The larger of size and coordinate, m.
    pub(super) scale: f64,
    promised: f64,
    /// How far points may be off, m.
    place: f64,
}

impl Referee {
    pub(super) fn of(pair: &Pair, seeds: [u64; 2]) -> Self {
        let place =
            |k: usize| (pair.poses[k].translation.into(), pair.poses[k].rotation.quaternion());
        let [(x, p), (y, q)] = [place(0), place(1)];
        let exact: [Solid<Twofold>; 2] =
            [Solid::new(&pair.forms[0], x, p), Solid::new(&pair.forms[1], y, q)];
        let coarse: [Solid<f64>; 2] =
            [Solid::new(&pair.forms[0], x, p), Solid::new(&pair.forms[1], y, q)];
        let scale = pair.forms.iter().map(Form::size).sum::<f64>();
        let coordinate = x.iter().chain(&y).fold(0.0_f64, |most: f64, x: &f64| most.max(x.abs()));
        let best = match pair.forms[1] {
            Form::Floor => separation([&exact[0], &exact[1]], &exactly([0.0, 0.0, -1.0])).value(),
            _ => search(&coarse, &exact, seeds),
        };
        let scale = scale.max(coordinate);
        let promised = 1e-12 * scale;
        let place = match &pair.forms {
            [Form::Box(_), Form::Box(_)] => {
                10.0 * promised + 4e-9 * pair.forms[0].thin().max(pair.forms[1].thin())
            }
            _ => 10.0 * promised,
        };
        Referee { exact, best, scale, promised, place }
    }

    /// The separation along a direction; none along zero.
    pub(super) fn separation_along(&self, direction: &V) -> Option<f64> {
        let n = unit(&exactly::<Twofold>((*direction).into()))?;
        let [a, b] = &self.exact;
        Some(separation([a, b], &n).value())
    }

    fn certify(&self, contacts: &[ContactPoint], closest: &ContactPoint) -> Verdict {
        let [a, b] = &self.exact;
        let promised = self.promised;
        let own = |c: &ContactPoint| self.separation_along(&c.normal);
        if own(closest).is_none() {
            return Verdict::wrong("no normal");
        }
        // Where gaps are equal to rounding, the normal of any of them proves the least.
        let best = contacts.iter().filter_map(own).fold(self.best, f64::max);
        let mut verdict = Verdict::of((closest.gap - best).abs(), promised, "the least gap");
        for contact in contacts {
            let deep = (best - contact.gap).max(0.0);
            verdict = verdict.and(Verdict::of(deep, promised, "a gap that is invented"));
            let length =
                (norm(&exactly::<Twofold>(contact.normal.into())) - Twofold::from(1.0)).value();
            verdict = verdict.and(Verdict::of(length.abs(), 1e-14, "a normal's length"));
            let [x1, x2] = contact.points.map(|x| exactly::<Twofold>(x.into()));
            let along = contact.normal * contact.gap;
            let off = norm(&minus(&minus(&x2, &x1), &exactly(along.into()))).value();
            verdict = verdict.and(Verdict::of(off, self.place, "points across the gap"));
            for (solid, x) in [(a, &x1), (b, &x2)] {
                let what = format!("a point of {:?} outside, gap {:e}", contact.id, contact.gap);
                let outside = solid.outside(x).max(0.0);
                verdict = verdict.and(Verdict::of(outside, self.place, &what));
            }
        }
        verdict
    }
}

/// The largest separation along directions: those that are likely, and the best of them followed.
fn search(coarse: &[Solid<f64>; 2], exact: &[Solid<Twofold>; 2], seeds: [u64; 2]) -> f64 {
    let [a, b] = coarse;
    let mut random = Draw::new(seeds[0] ^ seeds[1].rotate_left(7));
    let mut starts: Vec<Three<f64>> = Vec::new();
    starts.extend(a.normals.iter().copied());
    starts.extend(b.normals.iter().map(|n| n.map(|x| -x)));
    let lines = |solid: &Solid<f64>| -> Vec<Three<f64>> {
        let mut lines = solid.edges();
        lines.extend(solid.axis());
        lines
    };
    let (first, second) = (lines(a), lines(b));
    for e in &first {
        for f in &second {
            starts.extend(unit(&cross(e, f)).into_iter().flat_map(|n| [n, n.map(|x| -x)]));
        }
    }
    for axis in [a.axis(), b.axis()].into_iter().flatten() {
        starts.extend([axis, axis.map(|x| -x)]);
    }
    starts.extend((0..200).filter_map(|_| unit(&[0; 3].map(|_| random.normal()))));
    let value = |n: &Three<f64>| separation([a, b], n);
    let mut found: Vec<(f64, Three<f64>)> = starts.iter().map(|n| (value(n), *n)).collect();
    found.sort_by(|x, y| y.0.total_cmp(&x.0));
    found.truncate(6);
    for (best, n) in &mut found {
        let mut turn = 0.3;
        for _ in 0..150 {
            let mut gained = false;
            for _ in 0..12 {
                let next = [0, 1, 2].map(|k| n[k] + turn * random.normal());
                let Some(next) = unit(&next) else { continue };
                let there = value(&next);
                if there > *best {
                    (*best, *n, gained) = (there, next, true);
                }
            }
            turn *= if gained { 1.2 } else { 0.4 };
        }
    }
    let judged = found.iter().filter_map(|(_, n)| unit(&n.map(Twofold::from)));
    let [a, b] = exact;
    judged.map(|n| separation([a, b], &n).value()).fold(f64::NEG_INFINITY, f64::max)
}
