//! A sum of terms with closed forms for its differential and Hessian.
//!
//! ```text
//! V(q) = sum of E phi(s / L),    s = <a, q> - c    or    s = |q_b - q_a| - c
//! ```
//! `E` an energy, `L` a length, `phi` a shape, `a` a direction of few freedoms, `q_a q_b` points.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{Covector, Potential, Sink};

/// A function of one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shape {
    Linear,
    Quadratic,
    /// `-x^2/2`
    Hill,
    /// `-x^2/2 + x^4/4`
    TwoWells,
    /// `-x^3/3`
    Fall,
    /// `|x|^p`
    Power(f64),
    /// `x^2/2` where x is negative
    Ground,
    /// `|x|^3/3` where x is negative
    SoftGround,
    /// `-ln x`
    Barrier,
    Cosine,
    /// `exp(-x)`
    Fade,
    /// `4 (x^-12 - x^-6)`
    LennardJones,
    /// `1/x`
    Inverse,
}

impl Shape {
    /// The function with its first two derivatives.
    pub(super) fn at(self, x: f64) -> [f64; 3] {
        let below = x.min(0.0);
        match self {
            Shape::Linear => [x, 1.0, 0.0],
            Shape::Quadratic => [0.5 * x * x, x, 1.0],
            Shape::Hill => [-0.5 * x * x, -x, -1.0],
            Shape::TwoWells => [-0.5 * x * x + 0.25 * x.powi(4), -x + x.powi(3), 3.0 * x * x - 1.0],
            Shape::Fall => [-x.powi(3) / 3.0, -x * x, -2.0 * x],
            Shape::Power(p) => {
                let r = x.abs();
                let sign = if x == 0.0 { 0.0 } else { x.signum() };
                // A power of zero is zero, also where the exponent is not positive.
                let power = |k: f64| {
                    if k == 0.0 {
                        1.0
                    } else if r == 0.0 {
                        0.0
                    } else {
                        r.powf(k)
                    }
                };
                [power(p), sign * p * power(p - 1.0), p * (p - 1.0) * power(p - 2.0)]
            }
            Shape::Ground => [0.5 * below * below, below, if x < 0.0 { 1.0 } else { 0.0 }],
            Shape::SoftGround => [-below.powi(3) / 3.0, -below * below, -2.0 * below],
            Shape::Barrier if x > 0.0 => [-x.ln(), -x.recip(), x.powi(-2)],
            Shape::Inverse if x > 0.0 => [x.recip(), -x.powi(-2), 2.0 * x.powi(-3)],
            Shape::Barrier | Shape::Inverse => [f64::NAN; 3],
            Shape::Cosine => [x.cos(), -x.sin(), -x.cos()],
            Shape::Fade => [(-x).exp(), -(-x).exp(), (-x).exp()],
            Shape::LennardJones => [
                4.0 * (x.powi(-12) - x.powi(-6)),
                4.0 * (-12.0 * x.powi(-13) + 6.0 * x.powi(-7)),
                4.0 * (156.0 * x.powi(-14) - 42.0 * x.powi(-8)),
            ],
        }
    }
}

/// What a term looks at.
#[derive(Clone, Debug)]
pub(super) enum Coordinate {
    /// `<a, q>`, by freedoms and components.
    Along(Vec<(usize, f64)>),
    /// The distance of the points that begin at two freedoms, in so many dimensions. A point that is
    /// held lies at the given place.
    Distance(usize, End, usize),
}

/// The other end of a distance.
#[derive(Clone, Copy, Debug)]
pub(super) enum End {
    Free(usize),
    Held([f64; 2]),
}

/// One term.
#[derive(Clone, Debug)]
pub(super) struct Term {
    pub(super) coordinate: Coordinate,
    pub(super) offset: f64,
    pub(super) energy: f64,
    pub(super) length: f64,
    pub(super) shape: Shape,
}

/// What a term is at a configuration: `E phi, E phi'/L, E phi''/L^2`, the freedoms, the direction of
/// steepest ascent, the curvature across it, and how large the numbers are that s is made of.
struct Local {
    energy: f64,
    slope: f64,
    bend: f64,
    freedoms: Vec<usize>,
    direction: Vec<f64>,
    across: f64,
    /// Coordinates of a point; 0 where there are no points.
    dimension: usize,
    size: f64,
}

impl Term {
    pub(super) fn along(direction: Vec<(usize, f64)>, offset: f64, shape: Shape) -> Self {
        let coordinate = Coordinate::Along(direction);
        Term { coordinate, offset, energy: 1.0, length: 1.0, shape }
    }

    pub(super) fn scaled(self, energy: f64, length: f64) -> Self {
        Term { energy, length, ..self }
    }

    fn local(&self, q: &[f64]) -> Local {
        let (s, freedoms, direction, size): (f64, Vec<usize>, Vec<f64>, f64) =
            match &self.coordinate {
                Coordinate::Along(a) => (
                    a.iter().map(|&(i, a)| a * q[i]).sum(),
                    a.iter().map(|&(i, _)| i).collect(),
                    a.iter().map(|&(_, a)| a).collect(),
                    a.iter().map(|&(i, a)| (a * q[i]).abs()).sum(),
                ),
                &Coordinate::Distance(a, end, d) => {
                    let other = |k: usize| match end {
                        End::Free(b) => q[b + k],
                        End::Held(place) => place[k],
                    };
                    let apart: Vec<f64> = (0..d).map(|k| q[a + k] - other(k)).collect();
                    let r = apart.iter().fold(0.0_f64, |r, x| r.hypot(*x));
                    let unit: Vec<f64> = apart.iter().map(|x| x / r).collect();
                    let size = (0..d).map(|k| q[a + k].abs() + other(k).abs()).sum();
                    let mut freedoms: Vec<usize> = (a..a + d).collect();
                    let mut direction = unit.clone();
                    if let End::Free(b) = end {
                        freedoms.extend(b..b + d);
                        direction.extend(unit.iter().map(|u| -u));
                    }
                    (r, freedoms, direction, size)
                }
            };
        let [value, first, second] = self.shape.at((s - self.offset) / self.length);
        let slope = self.energy * (first / self.length);
        let (across, dimension) = match self.coordinate {
            Coordinate::Along(_) => (0.0, 0),
            Coordinate::Distance(_, _, dimension) => (slope / s, dimension),
        };
        Local {
            energy: self.energy * value,
            slope,
            bend: self.energy * (second / self.length / self.length),
            freedoms,
            direction,
            across,
            dimension,
            size: size + self.offset.abs(),
        }
    }
}

impl Local {
    /// The Hessian's block, by columns.
    fn block(&self) -> Vec<f64> {
        let (k, d) = (self.freedoms.len(), self.dimension);
        let entry = |e: usize| {
            let (i, j) = (e % k, e / k);
            let uu = self.direction[i] * self.direction[j];
            let identity = match self.dimension {
                0 => return self.bend * uu,
                _ if i % d != j % d => 0.0,
                _ if i / d == j / d => 1.0,
                _ => -1.0,
            };
            self.bend * uu + self.across * (identity - uu)
        };
        (0..k * k).map(entry).collect()
    }
}

/// A sum of terms.
#[derive(Clone, Debug)]
pub(super) struct Landscape {
    pub(super) freedoms: usize,
    pub(super) terms: Vec<Term>,
}

impl Landscape {
    pub(super) fn differential(&self, q: &[f64]) -> Vec<f64> {
        let mut dv = Covector(vec![0.0; self.freedoms]);
        self.add_differential(q, dv.view_mut());
        dv.0
    }

    /// The blocks of the Hessian: freedoms and entries.
    pub(super) fn blocks(&self, q: &[f64]) -> Vec<(Vec<usize>, Vec<f64>)> {
        let block = |term: &Term| {
            let local = term.local(q);
            let block = local.block();
            (local.freedoms, block)
        };
        self.terms.iter().map(block).collect()
    }

    pub(super) fn hessian(&self, q: &[f64]) -> DMatrix<f64> {
        let mut h = DMatrix::zeros(self.freedoms, self.freedoms);
        for (freedoms, block) in self.blocks(q) {
            for (e, entry) in block.iter().enumerate() {
                h[(freedoms[e % freedoms.len()], freedoms[e / freedoms.len()])] += entry;
            }
        }
        h
    }

    /// How large the numbers are that the differential is the sum of, where q is rounded.
    pub(super) fn size_of_terms(&self, q: &[f64]) -> DVector<f64> {
        let mut sizes = DVector::zeros(self.freedoms);
        for term in &self.terms {
            let local = term.local(q);
            let size = (local.bend.abs() + local.across.abs()) * local.size + local.slope.abs();
            for (&i, a) in local.freedoms.iter().zip(&local.direction) {
                sizes[i] += if local.dimension > 0 { 1.0 } else { a.abs() } * size;
            }
        }
        sizes
    }
}

impl Potential for Landscape {
    fn dim(&self) -> usize {
        self.freedoms
    }

    fn energy(&self, q: &[f64]) -> f64 {
        self.terms.iter().map(|term| term.local(q).energy).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        for term in &self.terms {
            let local = term.local(q);
            for (&i, a) in local.freedoms.iter().zip(&local.direction) {
                dv.0[i] += local.slope * a;
            }
        }
    }

    fn add_hessian(&self, q: &[f64], hessian: &mut impl Sink) {
        for (freedoms, block) in self.blocks(q) {
            hessian.add_symmetric(&freedoms, &block);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The referee's own forms, against plain differences.
    #[test]
    fn closed_forms_are_the_derivatives_of_the_energy() {
        let distance = |end| Coordinate::Distance(0, end, 2);
        let coordinates = [
            Coordinate::Along(vec![(0, 0.3), (3, -1.2)]),
            distance(End::Free(2)),
            distance(End::Held([3.0, -0.4])),
        ];
        let shapes = [
            Shape::Quadratic,
            Shape::TwoWells,
            Shape::Fall,
            Shape::Power(1.5),
            Shape::Fade,
            Shape::LennardJones,
            Shape::Barrier,
            Shape::SoftGround,
        ];
        for (coordinate, shape) in coordinates.iter().flat_map(|c| shapes.map(|s| (c.clone(), s))) {
            let term = Term { coordinate, offset: -1.5, energy: 3.0, length: 1.1, shape };
            let v = Landscape { freedoms: 4, terms: vec![term] };
            let q = [0.2, -0.3, 1.1, 0.7];
            let (dv, h) = (v.differential(&q), v.hessian(&q));
            for j in 0..4 {
                let at = |s: f64| {
                    let mut q = q;
                    q[j] += s;
                    q
                };
                let e = 1e-5;
                let slope = (v.energy(&at(e)) - v.energy(&at(-e))) / (2.0 * e);
                assert!((slope - dv[j]).abs() < 1e-8 * (1.0 + slope.abs()), "{v:?}");
                let (plus, minus) = (v.differential(&at(e)), v.differential(&at(-e)));
                for i in 0..4 {
                    let row = (plus[i] - minus[i]) / (2.0 * e);
                    assert!((row - h[(i, j)]).abs() < 1e-7 * (1.0 + row.abs()), "{v:?}");
                }
            }
        }
    }
}
