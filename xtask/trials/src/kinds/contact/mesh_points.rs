//! Contact points of a solid with a surface of triangles, which the referee looks at one by one.
//!
//! ```text
//! gap_t = max s(n) - r           over every way of triangle t and of the solid's core, r the radius around it
//! ```
//! Surfaces are flat, rough or bent sheets, and triangles that hang in the air on their own.

use stationary_contact::{Collider, ContactError, ContactPoint, Detector, Shape};
use stationary_rigid::{LieGroup, RigidMotion};

use nalgebra::Vector3;

use super::hulls::{Hull, farthest};
use super::points::{SolidKind, configuration, form, rotation, shape};
use super::solids::{Form, Three, exactly, minus, norm};
use crate::kinds::rigid::double_double::Twofold;
use crate::{Draw, Kind, Verdict};

pub(super) const KIND: Kind = Kind {
    name: "mesh-contact-points",
    krate: "contact",
    rule: "a ball, capsule, box or hull beside fixed triangles; with P = 1e-12 of the larger of the sizes and the \
           coordinates: the least gap off the least separation from any triangle by more than P, where that is \
           an overlap of less than 1e-6 of the solid's radius by more than this overlap (at seams it is left to a \
           neighbour); a gap off its own triangle's separation downwards by more than P; points outside of the \
           solid or the triangle, or off the gap along the normal, by more than 10 P; a normal whose length is off 1 by \
           1e-14; none where the least separation is below the margin by P, one whose gap is above it; none \
           with a triangle that is within the margin by P and farther from all others than 1e-3 of the radius",
    in_tests: 300,
    trial,
};

type V = Vector3<f64>;

/// Corners and triangles.
struct Surface {
    corners: Vec<V>,
    triangles: Vec<[u32; 3]>,
}

impl Surface {
    /// Of a rectangular net over a unit square, whose corners rise by a height.
    fn sheet(draw: &mut Draw, mut rise: impl FnMut(&mut Draw, f64, f64) -> f64) -> Self {
        let [m, n] = [(); 2].map(|()| draw.between(1, 4));
        let stretch = if draw.chance(0.3) { draw.log_uniform(1e-3, 1.0) } else { 1.0 };
        // Inner corners anywhere between their neighbours, or in rows.
        let stray = if draw.chance(0.5) { 0.4 } else { 0.0 };
        let mut corners = Vec::new();
        for j in 0..=n {
            for i in 0..=m {
                let x = (i as f64 + stray * draw.symmetric()) / m as f64;
                let y = (j as f64 + stray * draw.symmetric()) / n as f64;
                let z = rise(draw, x, y);
                corners.push(V::new(x - 0.5, (y - 0.5) * stretch, z));
            }
        }
        let mut triangles = Vec::new();
        for j in 0..n {
            for i in 0..m {
                let at = |i: usize, j: usize| (j * (m + 1) + i) as u32;
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                let cut = match draw.chance(0.5) {
                    true => [[a, b, c], [a, c, d]],
                    false => [[a, b, d], [b, c, d]],
                };
                triangles.extend(cut);
            }
        }
        Surface { corners, triangles }
    }

    fn drawn(draw: &mut Draw, size: f64) -> Self {
        let mut surface = match draw.below(4) {
            0 => Self::sheet(draw, |_, _, _| 0.0),
            1 => {
                let height = draw.log_uniform(1e-12, 0.5);
                Self::sheet(draw, |draw, _, _| height * draw.symmetric())
            }
            2 => {
                // A roof or a valley.
                let (slope, ridge) = (draw.symmetric(), draw.uniform(0.2, 0.8));
                Self::sheet(draw, |_, x, _| slope * (x - ridge).abs())
            }
            _ => {
                let count = draw.between(1, 4);
                let any = |draw: &mut Draw| V::from_fn(|_, _| draw.symmetric());
                let mut corners = Vec::new();
                for _ in 0..count {
                    let (middle, width) = (any(draw) * 0.7, draw.log_uniform(1e-2, 0.5));
                    corners.extend((0..3).map(|_| middle + any(draw) * width));
                }
                let triangles = (0..count as u32).map(|t| [0, 1, 2].map(|k| 3 * t + k)).collect();
                Surface { corners, triangles }
            }
        };
        surface.corners.iter_mut().for_each(|corner| *corner *= size);
        surface
    }
}

struct Case {
    form: Form,
    pose: RigidMotion,
    surface: Surface,
    /// Of the surface.
    place: RigidMotion,
    margin: f64,
}

fn drawn(draw: &mut Draw) -> Case {
    let size = draw.log_uniform(1e-6, 1e6);
    let surface = Surface::drawn(draw, size);
    let width = size * draw.log_uniform(1e-2, 1.0);
    let form =
        form(draw, width, &[SolidKind::Ball, SolidKind::Capsule, SolidKind::Box, SolidKind::Hull]);
    let level = draw.chance(0.5);
    let place_turn = if level { LieGroup::identity() } else { rotation(draw) };
    let turn = rotation(draw);
    // A point of a triangle: within, on an edge or a corner; the solid is placed before it.
    let corners = surface.triangles[draw.below(surface.triangles.len())]
        .map(|k| place_turn.rotate(&surface.corners[k as usize]));
    let [a, b, c] = corners;
    let weights = match draw.below(4) {
        0 => [1.0, 0.0, 0.0],
        1 => {
            let t = draw.unit();
            [1.0 - t, t, 0.0]
        }
        _ => {
            let (t, u) = (draw.unit(), draw.unit());
            [(1.0 - t) * (1.0 - u), t * (1.0 - u), u]
        }
    };
    let point = a * weights[0] + b * weights[1] + c * weights[2];
    let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or(V::z());
    let n = match draw.below(4) {
        0 => V::from_fn(|_, _| draw.symmetric()).try_normalize(1e-3).unwrap_or(V::z()),
        1 => -normal,
        _ => normal,
    };
    let thin = form.thin();
    let gap = match draw.below(6) {
        0 => 0.0,
        1 => width * draw.symmetric() * draw.log_uniform(1e-18, 1e-9),
        2 => -thin * draw.log_uniform(1e-12, 0.5),
        3 => width * draw.log_uniform(1e-9, 1.0),
        // The middle of the solid is on the surface, but for little.
        4 => -reach(&form, &turn, -n) + width * draw.symmetric() * draw.log_uniform(1e-18, 1e-6),
        _ => thin * draw.symmetric(),
    };
    let far = if draw.chance(0.3) { size * draw.log_uniform(1.0, 1e4) } else { 0.0 };
    let origin = V::from_fn(|_, _| draw.symmetric()) * far;
    let place = RigidMotion { translation: origin, rotation: place_turn };
    let translation = origin + point + n * (reach(&form, &turn, -n) + gap);
    let pose = RigidMotion { translation, rotation: turn };
    let margin = width * draw.one_of(&[0.1, 1e-3, 1e-6]);
    draw.note(format!("{form:?} at {:?} {:?}", pose.translation, turn.quaternion()));
    draw.note(format!("{:?} {:?}", surface.corners, surface.triangles));
    draw.note(format!("at {:?} {:?}, margin {margin:e}", origin, place_turn.quaternion()));
    Case { form, pose, surface, place, margin }
}

/// How far a form reaches from its origin along a direction.
fn reach(form: &Form, turn: &stationary_rigid::Rotation, n: V) -> f64 {
    use super::solids::Solid;
    Solid::<f64>::new(form, [0.0; 3], turn.quaternion()).reach(&n.into())
}

fn trial(draw: &mut Draw) -> Verdict {
    let case = drawn(draw);
    let Case { form, pose, surface, place, margin } = &case;
    let (solid, mesh) = match (shape(form), Shape::mesh(&surface.corners, &surface.triangles)) {
        (Ok(solid), Ok(mesh)) => (solid, mesh),
        // A hull or a triangle may be too thin to be one.
        (Err(ContactError::Flat { .. }), _) | (_, Err(ContactError::Flat { .. })) => {
            return Verdict::due();
        }
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    let colliders = vec![Collider::on_body(0, solid), Collider::fixed(*place, mesh)];
    let mut detector = match Detector::new(colliders, 1) {
        Ok(detector) => detector,
        Err(error) => return Verdict::refused(error),
    };
    let q = configuration(&[*pose]);
    let sizes = form.size() + surface.corners.iter().map(|c| c.norm()).fold(0.0, f64::max);
    let mut found = |margin: f64| detector.detect(&q, margin).map(<[ContactPoint]>::to_vec);
    let (all, near) = match (found(20.0 * sizes), found(*margin)) {
        (Ok(all), Ok(near)) => (all, near),
        (Err(error), _) | (_, Err(error)) => return Verdict::refused(error),
    };
    let coordinate = pose.translation.iter().chain(&place.translation).map(|x| x.abs());
    let promised = 1e-12 * coordinate.fold(sizes, f64::max);
    Referee::of(&case, promised).judge(&all, &near, *margin)
}

/// What knows how far a solid is from each triangle.
struct Referee {
    core: Hull<Twofold>,
    round: f64,
    /// Overlaps that seams may leave to neighbours, m.
    felt: f64,
    triangles: Vec<Hull<Twofold>>,
    gaps: Vec<f64>,
    /// The least distance of each from another.
    alone: Vec<f64>,
    promised: f64,
}

/// How far two hulls are apart.
fn apart(one: &Hull<Twofold>, other: &Hull<Twofold>) -> f64 {
    farthest([one, other]).first().map_or(f64::NEG_INFINITY, |(value, _)| value.value())
}

impl Referee {
    fn of(case: &Case, promised: f64) -> Self {
        let Case { form, pose, surface, place, .. } = case;
        let round = match form {
            Form::Ball(r) | Form::Capsule(_, r) => *r,
            _ => 0.0,
        };
        let core = Hull::core(form, pose);
        let corners: Vec<[f64; 3]> = surface.corners.iter().map(|c| (*c).into()).collect();
        let there = Hull::core(&Form::Hull(corners), place).corners;
        let triangles = surface.triangles.iter();
        let triangles: Vec<Hull<Twofold>> =
            triangles.map(|t| Hull::new(t.map(|k| there[k as usize]).to_vec())).collect();
        let gaps = triangles.iter().map(|t| apart(&core, t) - round).collect();
        let alone = |k: usize| {
            let others = triangles.iter().enumerate().filter(|(i, _)| *i != k);
            others.map(|(_, other)| apart(&triangles[k], other)).fold(f64::INFINITY, f64::min)
        };
        // Neighbours of a sheet share a corner.
        let sheet = surface.corners.len() < 3 * triangles.len();
        let alone = (0..triangles.len()).map(|k| if sheet { 0.0 } else { alone(k) }).collect();
        Referee { core, round, felt: 1e-6 * form.size(), triangles, gaps, alone, promised }
    }

    fn judge(&self, all: &[ContactPoint], near: &[ContactPoint], margin: f64) -> Verdict {
        let promised = self.promised;
        let least = self.gaps.iter().copied().fold(f64::INFINITY, f64::min);
        let told =
            |found: &[ContactPoint]| found.iter().map(|c| c.gap).fold(f64::INFINITY, f64::min);
        let may_be_off = promised.max(if least > -self.felt { -least } else { 0.0 });
        let mut verdict = Verdict::of((told(all) - least).abs(), may_be_off, "the least gap");
        if near.is_empty() && least < margin - may_be_off {
            verdict = verdict.and(Verdict::wrong(format!("lost: a gap of {least:e}")));
        }
        if near.iter().any(|c| c.gap > margin) {
            verdict = verdict.and(Verdict::wrong("a gap beyond the margin"));
        }
        if !near.is_empty() {
            let off = (told(near) - least).abs();
            let what = "the least gap within another margin";
            verdict = verdict.and(Verdict::of(off, may_be_off, what));
        }
        for (t, (&gap, &alone)) in self.gaps.iter().zip(&self.alone).enumerate() {
            let met = |found: &[ContactPoint]| found.iter().any(|c| c.id.parts[1] == t as u32);
            let lost = !met(all) || (gap < margin - promised && !met(near));
            if alone > 1e3 * self.felt && lost {
                let what = format!("lost: triangle {t} at a gap of {gap:e}");
                verdict = verdict.and(Verdict::wrong(what));
            }
        }
        near.iter().chain(all).fold(verdict, |verdict, contact| verdict.and(self.certify(contact)))
    }

    fn certify(&self, contact: &ContactPoint) -> Verdict {
        let (promised, t) = (self.promised, contact.id.parts[1] as usize);
        let Some((triangle, gap)) = self.triangles.get(t).zip(self.gaps.get(t)) else {
            return Verdict::wrong(format!("there is no triangle {t}"));
        };
        let invented = (gap - contact.gap).max(0.0);
        let verdict = Verdict::of(invented, promised, "a gap that is invented");
        let three = |v: &V| -> Three<Twofold> { exactly((*v).into()) };
        let length = (norm(&three(&contact.normal)) - Twofold::from(1.0)).value().abs();
        let verdict = verdict.and(Verdict::of(length, 1e-14, "a normal's length"));
        let [x1, x2] = contact.points.each_ref().map(three);
        let along = three(&(contact.normal * contact.gap));
        let off = norm(&minus(&minus(&x2, &x1), &along)).value();
        let verdict = verdict.and(Verdict::of(off, 10.0 * promised, "points across the gap"));
        let outside = |x: Three<Twofold>, hull: &Hull<Twofold>, round: f64| {
            (apart(&Hull::new(vec![x]), hull) - round).max(0.0)
        };
        let off = outside(x1, &self.core, self.round);
        let verdict =
            verdict.and(Verdict::of(off, 10.0 * promised, "a point outside of the solid"));
        let off = outside(x2, triangle, 0.0);
        verdict.and(Verdict::of(off, 10.0 * promised, "a point outside of the triangle"))
    }
}
