//! The trials' own bodies: the sum of a law's density over linear elements, with its differential
//! and its Hessian, all of them plain and dense.
//!
//! ```text
//! B = [X_1 - X_0, ...] = E T,  F = [x_1 - x_0, ...] T^-1,   V = sum |T|/R! section W(F)
//! ```

use nalgebra::{DMatrix, DVector};

use super::law::{Columns, Law, Moduli, density, derivatives, stress};
use crate::Draw;

/// Linear elements of R dimensions in D.
pub struct Body {
    pub law: Law,
    pub pair: Moduli,
    elements: Vec<Simplex>,
}

struct Simplex {
    nodes: Vec<usize>,
    /// `T^-1`, R x R.
    inverse: DMatrix<f64>,
    size: f64,
}

impl Body {
    /// The elements by their nodes, at rest at these places.
    pub fn new(
        (law, pair): (Law, Moduli),
        rest: &[Vec<f64>],
        elements: impl Iterator<Item = Vec<usize>>,
        section: f64,
    ) -> Self {
        let elements = elements.map(|nodes| {
            let (d, r) = (rest[0].len(), nodes.len() - 1);
            let edges = DMatrix::from_fn(d, r, |i, k| rest[nodes[k + 1]][i] - rest[nodes[0]][i]);
            // The triangular factor where the element is thinner than its space.
            let t = if d == r { edges } else { triangular(&edges) };
            let factorial = [1.0, 1.0, 2.0, 6.0][r];
            let size = t.determinant().abs() / factorial * section;
            Simplex { nodes, inverse: t.try_inverse().expect("no flat elements"), size }
        });
        Body { law, pair, elements: elements.collect() }
    }

    fn deformation(element: &Simplex, x: &[Vec<f64>]) -> Columns<f64> {
        let (d, r) = (x[0].len(), element.nodes.len() - 1);
        let edge = |k: usize, i: usize| x[element.nodes[k + 1]][i] - x[element.nodes[0]][i];
        let entry =
            |l: usize, i: usize| (0..r).map(|k| edge(k, i) * element.inverse[(k, l)]).sum::<f64>();
        (0..r).map(|l| (0..d).map(|i| entry(l, i)).collect()).collect()
    }

    /// The gradients of the shape functions, node by node.
    fn gradients(element: &Simplex) -> Vec<Vec<f64>> {
        let r = element.nodes.len() - 1;
        let after = |k: usize| -> Vec<f64> { (0..r).map(|l| element.inverse[(k, l)]).collect() };
        let mut all: Vec<Vec<f64>> = (0..r).map(after).collect();
        let first = (0..r).map(|l| -all.iter().map(|g| g[l]).sum::<f64>()).collect();
        all.insert(0, first);
        all
    }

    /// The differential at all coordinates, and what its entries are sums of.
    pub fn differential(&self, x: &[Vec<f64>]) -> [Vec<Vec<f64>>; 2] {
        let zero: Vec<Vec<f64>> = x.iter().map(|x| vec![0.0; x.len()]).collect();
        let mut sums = [zero.clone(), zero];
        for element in &self.elements {
            let f = Self::deformation(element, x);
            let p = stress::<f64>(&f, |f| density(self.law, self.pair, f));
            let size: f64 = f.iter().flatten().map(|x| x.abs()).fold(1.0, f64::max);
            for (node, gradient) in element.nodes.iter().zip(Self::gradients(element)) {
                let steep = gradient.iter().fold(0.0_f64, |m, g| m.max(g.abs()));
                for i in 0..x[0].len() {
                    let force: f64 = (0..p.len()).map(|k| p[k][i] * gradient[k]).sum();
                    sums[0][*node][i] += element.size * force;
                    sums[1][*node][i] += element.size * steep * self.pair.size() * size.powi(3);
                }
            }
        }
        sums
    }

    /// The Hessian of all coordinates.
    pub fn hessian(&self, x: &[Vec<f64>]) -> DMatrix<f64> {
        let d = x[0].len();
        let n = d * x.len();
        let mut hessian = DMatrix::zeros(n, n);
        for element in &self.elements {
            let f = Self::deformation(element, x);
            let gradients = Self::gradients(element);
            let motions: Vec<(usize, Columns<f64>)> = element
                .nodes
                .iter()
                .zip(&gradients)
                .flat_map(|(&node, gradient)| {
                    (0..d).map(move |i| {
                        let column =
                            |g: &f64| (0..d).map(|j| if i == j { *g } else { 0.0 }).collect();
                        (d * node + i, gradient.iter().map(column).collect::<Columns<f64>>())
                    })
                })
                .collect();
            for (row, a) in &motions {
                for (column, b) in &motions {
                    if row >= column {
                        let value =
                            derivatives::<f64>(&f, [a, b], |f| density(self.law, self.pair, f));
                        let entry = element.size * value.both;
                        hessian[(*row, *column)] += entry;
                        if row != column {
                            hessian[(*column, *row)] += entry;
                        }
                    }
                }
            }
        }
        hessian
    }

    /// The least ratio of an element's volume to that at rest, where elements fill their space.
    pub fn least_volume(&self, x: &[Vec<f64>]) -> f64 {
        let volume = |element: &Simplex| super::law::determinant(&Self::deformation(element, x));
        self.elements.iter().map(volume).fold(f64::INFINITY, f64::min)
    }

    /// How far from rest `x` is by one step of Newton's method on the free coordinates, the distance
    /// that rounding accounts for, and the least eigenvalue of the Hessian over the largest.
    pub fn correction(
        &self,
        x: &[Vec<f64>],
        forces: &[Vec<f64>],
        free: &[usize],
    ) -> Option<Correction> {
        if free.is_empty() {
            return Some(Correction { length: 0.0, rounding: 0.0, least: 1.0 });
        }
        let d = x[0].len();
        let [differential, terms] = self.differential(x);
        let at = |all: &[Vec<f64>], k: usize| all[k / d][k % d];
        let residual = DVector::from_iterator(
            free.len(),
            free.iter().map(|&k| at(&differential, k) - at(forces, k)),
        );
        let noise = DVector::from_iterator(
            free.len(),
            free.iter().map(|&k| f64::EPSILON * (at(&terms, k) + at(forces, k).abs())),
        );
        let all = self.hessian(x);
        let hessian = DMatrix::from_fn(free.len(), free.len(), |i, j| all[(free[i], free[j])]);
        // Scaled to a unit diagonal where that is positive.
        let scale = DVector::from_iterator(
            free.len(),
            (0..free.len()).map(|i| hessian[(i, i)].abs().max(f64::MIN_POSITIVE).sqrt().recip()),
        );
        let scaled =
            DMatrix::from_fn(free.len(), free.len(), |i, j| hessian[(i, j)] * scale[i] * scale[j]);
        let eigen = nalgebra::SymmetricEigen::try_new(scaled, 1e-15, 10_000)?;
        let largest = eigen.eigenvalues.amax();
        let solve = |r: &DVector<f64>, absolute: bool| {
            let mut z = eigen.eigenvectors.transpose() * r.component_mul(&scale);
            for (z, l) in z.iter_mut().zip(eigen.eigenvalues.iter()) {
                *z /= if absolute { l.abs() } else { *l };
            }
            (&eigen.eigenvectors * z).component_mul(&scale)
        };
        let least = eigen.eigenvalues.min();
        // The worst signs: rounding through the absolute inverse, by its norm.
        let norm = noise.component_mul(&scale).norm()
            / eigen.eigenvalues.iter().fold(f64::INFINITY, |m, l| m.min(l.abs()));
        let rounding = norm * scale.amax();
        Some(Correction {
            length: solve(&residual, false).amax(),
            rounding,
            least: least / largest,
        })
    }
}

pub struct Correction {
    pub length: f64,
    pub rounding: f64,
    pub least: f64,
}

/// Gram and Schmidt's triangular factor.
fn triangular(edges: &DMatrix<f64>) -> DMatrix<f64> {
    let r = edges.ncols();
    let mut frame = edges.clone();
    let mut t = DMatrix::zeros(r, r);
    for k in 0..r {
        for m in 0..k {
            let along = frame.column(m).dot(&frame.column(k));
            t[(m, k)] = along;
            let other = frame.column(m).clone_owned();
            frame.column_mut(k).axpy(-along, &other, 1.0);
        }
        let length = frame.column(k).norm();
        t[(k, k)] = length;
        frame.column_mut(k).scale_mut(1.0 / length);
    }
    t
}

/// Young's modulus and Poisson's ratio that all laws take.
pub fn moduli(draw: &mut Draw) -> [f64; 2] {
    let young = draw.log_uniform(1.0, 1e12);
    [young, draw.one_of(&[0.3, 0.0, 0.45, 0.2])]
}
