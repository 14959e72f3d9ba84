//! Quadratic energies of which the whole spectrum is known, because they were made from it.
//!
//! ```text
//! V(d) = 1/2 d^T H d,    H = S Q L Q^T S,    M = S^2,    L = diag(lambda)
//! ```
//! `Q` a product of reflections or of turns of pairs, `S` diagonal, or symmetric and full.

use nalgebra::{DMatrix, DVector};
use stationary_calculus::{Covector, DenseMetric, DiagonalMetric, Metric, Potential, Sink, Vector};

use crate::Draw;

/// `1/2 (q - q0)^T H (q - q0)` with H a sum of blocks.
#[derive(Clone, Debug)]
pub(super) struct Quadratic {
    pub(super) q0: Vec<f64>,
    pub(super) blocks: Vec<(Vec<usize>, Vec<f64>)>,
}

impl Quadratic {
    /// `H x`.
    pub(super) fn times(&self, x: &[f64]) -> Vec<f64> {
        let mut y = vec![0.0; x.len()];
        for (freedoms, entries) in &self.blocks {
            for (&j, column) in freedoms.iter().zip(entries.chunks_exact(freedoms.len())) {
                for (&i, entry) in freedoms.iter().zip(column) {
                    y[i] += entry * x[j];
                }
            }
        }
        y
    }

    fn seen(&self, q: &[f64]) -> Vec<f64> {
        q.iter().zip(&self.q0).map(|(q, q0)| q - q0).collect()
    }
}

impl Potential for Quadratic {
    fn dim(&self) -> usize {
        self.q0.len()
    }

    fn energy(&self, q: &[f64]) -> f64 {
        let d = self.seen(q);
        self.times(&d).iter().zip(&d).map(|(y, d)| 0.5 * y * d).sum()
    }

    fn add_differential(&self, q: &[f64], dv: Covector<&mut [f64]>) {
        let force = self.times(&self.seen(q));
        dv.0.iter_mut().zip(force).for_each(|(dv, f)| *dv += f);
    }

    fn add_hessian(&self, _: &[f64], hessian: &mut impl Sink) {
        for (freedoms, entries) in &self.blocks {
            hessian.add_symmetric(freedoms, entries);
        }
    }
}

/// A diagonal mass or a full one.
#[derive(Clone, Debug)]
pub(super) enum Mass {
    Diagonal(DiagonalMetric<Vec<f64>>),
    Full(DenseMetric),
}

impl Metric for Mass {
    fn dim(&self) -> usize {
        match self {
            Mass::Diagonal(m) => m.dim(),
            Mass::Full(m) => m.dim(),
        }
    }

    fn flat(&self, v: Vector<&[f64]>, p: Covector<&mut [f64]>) {
        match self {
            Mass::Diagonal(m) => m.flat(v, p),
            Mass::Full(m) => m.flat(v, p),
        }
    }

    fn sharp(&self, p: Covector<&[f64]>, v: Vector<&mut [f64]>) {
        match self {
            Mass::Diagonal(m) => m.sharp(p, v),
            Mass::Full(m) => m.sharp(p, v),
        }
    }

    fn add_matrix(&self, sink: &mut impl Sink) {
        match self {
            Mass::Diagonal(m) => m.add_matrix(sink),
            Mass::Full(m) => m.add_matrix(sink),
        }
    }
}

/// Masses of this size, one kilogram times `spread` at most.
fn masses(draw: &mut Draw, n: usize) -> Vec<f64> {
    let size = if draw.chance(0.3) { draw.log_uniform(1e-9, 1e9) } else { 1.0 };
    let spread = draw.one_of(&[1.0, 10.0, 1e4]);
    (0..n).map(|_| size * draw.log_uniform(1.0, spread)).collect()
}

fn diagonal(masses: Vec<f64>) -> Mass {
    Mass::Diagonal(DiagonalMetric::new(masses).expect("positive masses"))
}

/// A product of three reflections, or the identity in parts of the space.
fn reflections(draw: &mut Draw, n: usize) -> DMatrix<f64> {
    let mut q = DMatrix::identity(n, n);
    for _ in 0..3 {
        let u = DVector::from_vec((0..n).map(|_| draw.symmetric() + 1e-3).collect());
        let w = q.tr_mul(&u);
        q -= (2.0 / u.norm_squared()) * &u * w.transpose();
    }
    q
}

/// Every freedom coupled to every other, with a mass that may be full.
pub(super) fn dense(draw: &mut Draw, spectrum: &[f64]) -> (Mass, Quadratic) {
    let n = spectrum.len();
    let q = reflections(draw, n);
    let own = &q * DMatrix::from_diagonal(&DVector::from_row_slice(spectrum)) * q.transpose();
    let (mass, stiffness) = if draw.chance(0.3) {
        let p = reflections(draw, n);
        let m = DVector::from_vec((0..n).map(|_| draw.log_uniform(1.0, 100.0)).collect());
        let root = &p * DMatrix::from_diagonal(&m.map(f64::sqrt)) * p.transpose();
        let full = symmetric(&(&root * &root));
        (Mass::Full(DenseMetric::new(full).expect("definite")), &root * own * &root)
    } else {
        let m = masses(draw, n);
        let root = DVector::from_vec(m.iter().map(|m| m.sqrt()).collect());
        let scaled = DMatrix::from_fn(n, n, |i, j| root[i] * own[(i, j)] * root[j]);
        (diagonal(m), scaled)
    };
    let block = ((0..n).collect(), symmetric(&stiffness).as_slice().to_vec());
    (mass, Quadratic { q0: vec![0.0; n], blocks: vec![block] })
}

fn symmetric(a: &DMatrix<f64>) -> DMatrix<f64> {
    (a + a.transpose()) * 0.5
}

/// Freedoms alone or turned in pairs, at random places.
pub(super) fn sparse(draw: &mut Draw, spectrum: &[f64]) -> (Mass, Quadratic) {
    let n = spectrum.len();
    let mut places: Vec<usize> = (0..n).collect();
    for k in (1..n).rev() {
        places.swap(k, draw.below(k + 1));
    }
    let m = masses(draw, n);
    let pairs = draw.chance(0.6);
    let mut blocks = Vec::new();
    let mut k = 0;
    while k < n {
        if pairs && k + 1 < n {
            let (i, j) = (places[k], places[k + 1]);
            let (a, b) = (spectrum[k], spectrum[k + 1]);
            let (s, c) = draw.uniform(0.1, 1.4).sin_cos();
            let root = [m[i].sqrt(), m[j].sqrt()];
            let off = (a - b) * s * c * root[0] * root[1];
            let ends = [(c * c * a + s * s * b) * m[i], (s * s * a + c * c * b) * m[j]];
            blocks.push((vec![i, j], vec![ends[0], off, off, ends[1]]));
            k += 2;
        } else {
            blocks.push((vec![places[k]], vec![spectrum[k] * m[places[k]]]));
            k += 1;
        }
    }
    (diagonal(m), Quadratic { q0: vec![0.0; n], blocks })
}

/// Equal chains between walls side by side: every value as often as there are chains.
pub(super) fn chains(draw: &mut Draw, copies: usize, length: usize) -> (Mass, Quadratic, Vec<f64>) {
    let n = copies * length;
    let (mass, spring) = (draw.log_uniform(1e-3, 1e3), draw.log_uniform(1e-3, 1e3));
    let mut blocks = Vec::new();
    for start in (0..n).step_by(length) {
        for i in 0..length {
            blocks.push((vec![start + i], vec![2.0 * spring]));
            if i + 1 < length {
                blocks.push((vec![start + i, start + i + 1], vec![0.0, -spring, -spring, 0.0]));
            }
        }
    }
    let angle = |k: usize| 0.5 * std::f64::consts::PI * k as f64 / (length + 1) as f64;
    let value = |k: usize| 4.0 * spring / mass * angle(k).sin().powi(2);
    let spectrum = (0..copies).flat_map(|_| (1..=length).map(value)).collect();
    (diagonal(vec![mass; n]), Quadratic { q0: vec![0.0; n], blocks }, spectrum)
}
