//! Right potentials, each with a configuration to be checked at: smooth ones in units of their own, and ones
//! that end or bend sharply nearby.

use super::Case;
use crate::Draw;
use crate::kinds::calculus::landscape::{Coordinate, End, Landscape, Shape, Term};

/// Any sum of smooth terms, in units of its own.
pub(super) fn smooth(draw: &mut Draw) -> Case {
    let n = draw.one_of(&[1, 1, 2, 3, 5, 8, 40]);
    let (length, energy) = match draw.below(3) {
        0 => (1.0, 1.0),
        _ => (draw.log_uniform(1e-12, 1e6), draw.log_uniform(1e-26, 1e20)),
    };
    let q: Vec<f64> = draw.vector(n).iter().map(|x| x * length).collect();
    let shapes = [
        Shape::Linear,
        Shape::Quadratic,
        Shape::Hill,
        Shape::TwoWells,
        Shape::Fall,
        Shape::Power(4.0),
        Shape::Cosine,
        Shape::Fade,
    ];
    let count = n + draw.below(3);
    let mut terms = Vec::new();
    for k in 0..count {
        let mut a = vec![(k % n, draw.uniform(0.3, 1.0))];
        if n > 1 && draw.chance(0.5) {
            a.push(((k + 1 + draw.below(n - 1)) % n, draw.symmetric()));
        }
        let term = Term::along(a, length * draw.symmetric(), draw.one_of(&shapes));
        let scale = length * draw.uniform(0.7, 3.0);
        terms.push(term.scaled(energy * draw.log_uniform(0.1, 10.0), scale));
    }
    // A typical length that q does not show has to be told.
    let shown = q.iter().fold(0.0_f64, |m, x| m.max(x.abs())) > 0.2 * length;
    let told = !shown || draw.chance(0.3);
    let case_length = told.then_some(length);
    Case { v: Landscape { freedoms: n, terms }, q, length: case_length }
}

/// Functions that end or bend sharply at a place very near, without a length told.
pub(super) fn singular(draw: &mut Draw) -> Case {
    let n = draw.between(1, 3);
    let mut terms = Vec::new();
    let mut q = Vec::new();
    for i in 0..n {
        let distance = draw.log_uniform(1e-10, 1.0);
        let shape = draw.one_of(&[
            Shape::Power(1.5),
            Shape::Power(2.5),
            Shape::Ground,
            Shape::SoftGround,
            Shape::Barrier,
            Shape::Inverse,
        ]);
        let k = draw.log_uniform(1e-3, 1e6);
        terms.push(Term::along(vec![(i, 1.0)], 0.0, shape).scaled(k, 1.0));
        let one_sided = matches!(shape, Shape::Barrier | Shape::Inverse);
        q.push(if !one_sided && draw.chance(0.5) { -distance } else { distance });
    }
    Case { v: Landscape { freedoms: n, terms }, q, length: None }
}

/// Walls and grounds beside which the configuration lies, away from the origin.
pub(super) fn walls(draw: &mut Draw) -> Case {
    let n = draw.between(1, 3);
    let mut terms = Vec::new();
    let mut q = Vec::new();
    for i in 0..n {
        let wall = draw.uniform(-2.0, 2.0);
        let distance = draw.log_uniform(1e-10, 1.0);
        let shape = draw.one_of(&[Shape::Barrier, Shape::Ground, Shape::Power(2.5)]);
        let k = draw.log_uniform(1e-3, 1e6);
        terms.push(Term::along(vec![(i, 1.0)], wall, shape).scaled(k, 1.0));
        let below = shape != Shape::Barrier && draw.chance(0.7);
        q.push(wall + if below { -distance } else { distance });
    }
    Case { v: Landscape { freedoms: n, terms }, q, length: None }
}

/// Atoms of a real or of another gas, in SI units or in their own.
pub(super) fn atoms(draw: &mut Draw) -> Case {
    let (sigma, epsilon) = match draw.below(2) {
        0 => (draw.log_uniform(1e-10, 1e-9), draw.log_uniform(1e-23, 1e-20)),
        _ => (draw.log_uniform(1e-3, 1e3), draw.log_uniform(1e-6, 1e6)),
    };
    let (dimension, atoms) = (draw.between(2, 3), draw.between(2, 4));
    let mut q = Vec::new();
    for k in 0..atoms {
        let corner = [(k % 2) as f64, (k / 2) as f64, 0.0];
        let spread = draw.uniform(1.0, 1.8);
        q.extend(corner[..dimension].iter().map(|x| sigma * (spread * x + 0.1 * draw.symmetric())));
    }
    let mut terms = Vec::new();
    for a in 0..atoms {
        for b in 0..a {
            let coordinate =
                Coordinate::Distance(dimension * a, End::Free(dimension * b), dimension);
            let shape = Shape::LennardJones;
            terms.push(Term { coordinate, offset: 0.0, energy: epsilon, length: sigma, shape });
        }
    }
    let length = draw.chance(0.3).then_some(sigma);
    Case { v: Landscape { freedoms: dimension * atoms, terms }, q, length }
}
