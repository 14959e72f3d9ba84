//! Landscapes of which it is known whether they have a lowest place.

use super::{Case, Known};
use crate::Draw;
use crate::kinds::calculus::landscape::{Coordinate, End, Landscape, Shape, Term};

/// A direction of unit length; now and then a single freedom.
fn direction(draw: &mut Draw, n: usize) -> Vec<(usize, f64)> {
    if n == 1 || draw.chance(0.4) {
        return vec![(draw.below(n), 1.0)];
    }
    let a = draw.vector(n);
    let length = a.iter().map(|a| a * a).sum::<f64>().sqrt().max(1e-3);
    a.iter().enumerate().map(|(i, a)| (i, a / length)).collect()
}

fn along(a: &[(usize, f64)], q: &[f64]) -> f64 {
    a.iter().map(|&(i, a)| a * q[i]).sum()
}

/// Quadratic terms for every freedom and a few more, all lowest at `centre`.
fn bowl_at(draw: &mut Draw, centre: &[f64]) -> Vec<Term> {
    let n = centre.len();
    let spread = draw.one_of(&[1.0, 1e3, 1e8]);
    let mut terms = Vec::new();
    for (i, &middle) in centre.iter().enumerate() {
        let k = draw.log_uniform(1.0, spread);
        terms.push(Term::along(vec![(i, 1.0)], middle, Shape::Quadratic).scaled(k, 1.0));
    }
    for _ in 0..draw.below(n + 1) {
        let a = direction(draw, n);
        let offset = along(&a, centre);
        let k = draw.log_uniform(1.0, spread);
        terms.push(Term::along(a, offset, Shape::Quadratic).scaled(k, 1.0));
    }
    terms
}

fn places(draw: &mut Draw, n: usize) -> Vec<f64> {
    let far = draw.one_of(&[1.0, 1.0, 1e3, 1e6]);
    draw.vector(n).iter().map(|x| far * x).collect()
}

pub(super) fn bowl(draw: &mut Draw) -> Case {
    let n = draw.between(0, 6);
    let (centre, start) = (places(draw, n), places(draw, n));
    let mut terms = if n > 0 { bowl_at(draw, &centre) } else { Vec::new() };
    if n > 0 && draw.chance(0.5) {
        let a = direction(draw, n);
        let c = along(&a, &centre);
        terms.push(Term::along(a, c, Shape::Power(4.0)).scaled(draw.log_uniform(1e-3, 1e3), 1.0));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

/// Weights above and in a ground that pushes back where they sink in.
fn ground_of(draw: &mut Draw, shape: Shape) -> Case {
    let n = draw.between(1, 6);
    let mut terms = Vec::new();
    let mut start = Vec::new();
    for i in 0..n {
        let k = draw.log_uniform(1e-3, 1e6);
        let floor = draw.symmetric();
        terms.push(Term::along(vec![(i, 1.0)], floor, shape).scaled(k, 1.0));
        terms.push(
            Term::along(vec![(i, 1.0)], 0.0, Shape::Linear)
                .scaled(draw.log_uniform(1e-2, 1e2), 1.0),
        );
        let height = draw.log_uniform(1e-4, 1e4);
        start.push(floor + if draw.chance(0.3) { -height } else { height });
    }
    for _ in 0..draw.below(n) {
        let a = direction(draw, n);
        terms.push(Term::along(a, draw.symmetric(), Shape::Quadratic));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

pub(super) fn ground(draw: &mut Draw) -> Case {
    ground_of(draw, Shape::Ground)
}

pub(super) fn cubic_ground(draw: &mut Draw) -> Case {
    ground_of(draw, Shape::SoftGround)
}

/// Sums of |s|, lowest at a corner.
pub(super) fn kink(draw: &mut Draw) -> Case {
    let n = draw.between(1, 4);
    let (centre, start) = (places(draw, n), places(draw, n));
    let mut terms: Vec<Term> = (0..n)
        .map(|i| {
            let k = draw.log_uniform(0.1, 10.0);
            Term::along(vec![(i, 1.0)], centre[i], Shape::Power(1.0)).scaled(k, 1.0)
        })
        .collect();
    if draw.chance(0.3) {
        terms.extend(bowl_at(draw, &centre));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Kink }
}

/// Two wells with a ridge between them, from the ridge itself or from beside it.
pub(super) fn ridge(draw: &mut Draw) -> Case {
    let n = draw.between(1, 5);
    let centre = draw.vector(n);
    let across = draw.below(n);
    let mut start = places(draw, n);
    start[across] = centre[across] + draw.one_of(&[0.0, 0.0, 1e-12, 1e-6, 1e-2]);
    let scaled = |term: Term, draw: &mut Draw| {
        term.scaled(draw.log_uniform(1e-3, 1e3), draw.log_uniform(0.1, 10.0))
    };
    let two = Term::along(vec![(across, 1.0)], centre[across], Shape::TwoWells);
    let mut terms = vec![scaled(two, draw)];
    for i in (0..n).filter(|&i| i != across) {
        let k = draw.log_uniform(1e-3, 1e4);
        terms.push(Term::along(vec![(i, 1.0)], centre[i], Shape::Quadratic).scaled(k, 1.0));
        if draw.chance(0.3) {
            let warped = Term::along(vec![(i, 1.0)], centre[i], Shape::Power(4.0));
            terms.push(scaled(warped, draw));
        }
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

/// Wells, waves and hills in all directions, held together by a bowl.
pub(super) fn wells(draw: &mut Draw) -> Case {
    let n = draw.between(1, 6);
    let start = places(draw, n);
    let centre = draw.vector(n);
    let mut terms = bowl_at(draw, &centre);
    for _ in 0..draw.between(1, 4) {
        let a = direction(draw, n);
        let shape = draw.one_of(&[Shape::Cosine, Shape::TwoWells, Shape::Power(4.0)]);
        let length = draw.log_uniform(0.1, 10.0);
        let term = Term::along(a, draw.symmetric(), shape);
        terms.push(term.scaled(draw.log_uniform(1e-2, 1e2), length));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

/// What falls without end in one direction.
pub(super) fn fall(draw: &mut Draw) -> Case {
    let n = draw.between(1, 5);
    let down = draw.below(n);
    let (centre, mut start) = (draw.vector(n), places(draw, n));
    let shape = draw.one_of(&[Shape::Linear, Shape::Hill, Shape::Fall]);
    if shape == Shape::Fall {
        start[down] = centre[down] + draw.log_uniform(1e-3, 1e3);
    }
    let mut terms = vec![
        Term::along(vec![(down, 1.0)], centre[down], shape)
            .scaled(draw.log_uniform(1e-3, 1e3), draw.log_uniform(0.1, 10.0)),
    ];
    for i in (0..n).filter(|&i| i != down) {
        let k = draw.log_uniform(1e-3, 1e3);
        terms.push(Term::along(vec![(i, 1.0)], centre[i], Shape::Quadratic).scaled(k, 1.0));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Unbounded }
}

/// A slope that flattens and never ends.
pub(super) fn fade(draw: &mut Draw) -> Case {
    let n = draw.between(1, 4);
    let (centre, start) = (draw.vector(n), draw.vector(n));
    let down = draw.below(n);
    let length = draw.log_uniform(0.2, 5.0);
    let mut terms = vec![
        Term::along(vec![(down, 1.0)], centre[down], Shape::Fade)
            .scaled(draw.log_uniform(1e-2, 1e2), length),
    ];
    for i in (0..n).filter(|&i| i != down) {
        terms.push(Term::along(vec![(i, 1.0)], centre[i], Shape::Quadratic));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::NoRest }
}

/// Springs that leave some directions free, or nothing at all.
pub(super) fn flat(draw: &mut Draw) -> Case {
    let n = draw.between(1, 6);
    let (centre, start) = (draw.vector(n), places(draw, n));
    let springs = draw.below(n);
    let terms = (0..springs)
        .map(|_| {
            let a = direction(draw, n);
            let offset = along(&a, &centre);
            Term::along(a, offset, Shape::Quadratic).scaled(draw.log_uniform(1e-3, 1e3), 1.0)
        })
        .collect();
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

/// A slender beam of points in the plane, clamped at two of them, under its weight.
pub(super) fn beam(draw: &mut Draw) -> Case {
    let points = draw.between(2, 14);
    let n = 2 * points;
    let spacing = draw.log_uniform(0.01, 1.0);
    let [stretch, bend] = [draw.log_uniform(1e2, 1e9), draw.log_uniform(1e-2, 1e2)];
    let load = bend / (points as f64).powi(4) * spacing * draw.log_uniform(1e-4, 0.3);
    let origin = [draw.one_of(&[0.0, 1.0, 1e3]), draw.symmetric()];
    let held = |k: i64| [origin[0] + k as f64 * spacing, origin[1]];
    let mut terms = Vec::new();
    for p in 0..points {
        let end = if p == 0 { End::Held(held(0)) } else { End::Free(2 * (p - 1)) };
        let coordinate = Coordinate::Distance(2 * p, end, 2);
        terms.push(Term {
            coordinate,
            offset: spacing,
            energy: stretch,
            length: 1.0,
            shape: Shape::Quadratic,
        });
        for c in 0..2 {
            // x_(p-2) - 2 x_(p-1) + x_p, of which the first two may be held.
            let (mut a, mut offset) = (vec![(2 * p + c, 1.0)], 0.0);
            for (back, weight) in [(1, -2.0), (2, 1.0)] {
                match p.checked_sub(back) {
                    Some(other) => a.push((2 * other + c, weight)),
                    None => offset -= weight * held(1 + p as i64 - back as i64)[c],
                }
            }
            terms.push(Term::along(a, offset, Shape::Quadratic).scaled(bend, 1.0));
        }
        terms.push(Term::along(vec![(2 * p + 1, 1.0)], 0.0, Shape::Linear).scaled(load, 1.0));
    }
    let start = (0..points).flat_map(|p| held(1 + p as i64)).collect();
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

/// A load against a logarithmic wall.
pub(super) fn barrier(draw: &mut Draw) -> Case {
    let n = draw.between(1, 4);
    let mut terms = Vec::new();
    let mut start = Vec::new();
    for i in 0..n {
        let wall = draw.symmetric();
        let k = draw.log_uniform(1e-6, 1.0);
        terms.push(Term::along(vec![(i, 1.0)], wall, Shape::Barrier).scaled(k, 1.0));
        terms.push(Term::along(vec![(i, 1.0)], 0.0, Shape::Linear));
        start.push(wall + draw.log_uniform(1e-5, 1e3));
    }
    Case { v: Landscape { freedoms: n, terms }, start, known: Known::Minimum }
}

/// Two to four atoms in the plane, free to move and to turn.
pub(super) fn molecule(draw: &mut Draw) -> Case {
    let atoms = draw.between(2, 4);
    let mut start = Vec::new();
    for k in 0..atoms {
        // Corners of a square of side 1.2, shaken.
        let corner = [(k % 2) as f64, (k / 2) as f64];
        start.extend(corner.map(|x| 1.2 * x + 0.15 * draw.symmetric()));
    }
    let mut terms = Vec::new();
    for a in 0..atoms {
        for b in 0..a {
            terms.push(Term {
                coordinate: Coordinate::Distance(2 * a, End::Free(2 * b), 2),
                offset: 0.0,
                energy: 1.0,
                length: 1.0,
                shape: Shape::LennardJones,
            });
        }
    }
    Case { v: Landscape { freedoms: 2 * atoms, terms }, start, known: Known::Minimum }
}
