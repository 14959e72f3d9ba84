//! The tableaus of Gauss-Legendre collocation, computed from their nodes.
//!
//! ```text
//! P_s(2 c_i - 1) = 0                   c the nodes in (0, 1), P_s Legendre's polynomial
//! b_j = int_0^1 l_j                    l_j Lagrange's polynomials on the nodes
//! A_ij = int_0^(c_i) l_j,    (A^-1)_ij = d/dt (t l_j(t)/c_j) at c_i
//! ```
//! The second line of matrices holds because a polynomial of degree s that is zero at zero is both
//! the integral of its derivative and the interpolation of its values.

use crate::{
    Conservation, Damping, EnergyBehavior, ErrorGrowth, Evaluation, Facts, Stability, Symplecticity,
};

/// The number of Gaussian nodes s in a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Nodes {
    /// One: the implicit midpoint rule, of order 2.
    One,
    /// Two: order 4.
    Two,
    /// Three: order 6.
    Three,
    /// Four: order 8.
    Four,
}

impl Nodes {
    /// The number s.
    pub const fn count(self) -> usize {
        match self {
            Nodes::One => 1,
            Nodes::Two => 2,
            Nodes::Three => 3,
            Nodes::Four => 4,
        }
    }

    /// What is known of collocation at these nodes.
    pub const fn facts(self) -> Facts {
        Facts {
            name: match self {
                Nodes::One => "gauss-legendre-2",
                Nodes::Two => "gauss-legendre-4",
                Nodes::Three => "gauss-legendre-6",
                Nodes::Four => "gauss-legendre-8",
            },
            order: 2 * self.count() as u32,
            stages: self.count() as u32,
            evaluation: Evaluation::Implicit,
            symmetric: true,
            symplecticity: Symplecticity::Symplectic,
            energy: EnergyBehavior::Bounded,
            linear_momentum: Conservation::Exact,
            angular_momentum: Conservation::Exact,
            stability: Stability::Always,
            damping: Damping::AStable,
            error_growth: ErrorGrowth::Linear,
        }
    }

    /// The smallest squared size of an eigenvalue of A.
    fn blend(self) -> f64 {
        match self {
            Nodes::One => 0.25,
            Nodes::Two => 1.0 / 12.0,
            Nodes::Three => 0.038_703_089_243_768,
            Nodes::Four => 0.021_762_216_405_424,
        }
    }
}

/// Nodes, weights, and the matrices that the stages are solved with.
#[derive(Clone, Debug)]
pub(crate) struct Collocation {
    /// The nodes c.
    pub(crate) nodes: Vec<f64>,
    /// The weights b.
    pub(crate) weights: Vec<f64>,
    /// A^2, by rows.
    pub(crate) square: Vec<Vec<f64>>,
    /// A^-2, by rows.
    pub(crate) inverse_square: Vec<Vec<f64>>,
    /// The weight g of the Hessian in the one matrix that is factored.
    pub(crate) blend: f64,
}

impl Collocation {
    pub(crate) fn new(nodes: Nodes) -> Self {
        let s = nodes.count();
        let (c, b): (Vec<f64>, Vec<f64>) = (0..s).map(|i| gaussian(s, i)).unzip();
        // Gauss quadrature on (0, c_i) is exact for the Lagrange polynomials, of degree s - 1.
        let integral = |i: usize, j: usize| -> f64 {
            let terms = c.iter().zip(&b).map(|(t, weight)| weight * lagrange(&c, j, c[i] * t));
            c[i] * terms.sum::<f64>()
        };
        let square = squared(&matrix(s, integral));
        let inverse_square = squared(&matrix(s, |i, j| derivative(&c, j, i)));
        Collocation { nodes: c, weights: b, square, inverse_square, blend: nodes.blend() }
    }
}

/// The node i and its weight on (0, 1), by Newton's method on Legendre's polynomial.
fn gaussian(s: usize, i: usize) -> (f64, f64) {
    let mut x = -(std::f64::consts::PI * (i as f64 + 0.75) / (s as f64 + 0.5)).cos();
    let mut slope = 1.0;
    for _ in 0..8 {
        let (mut before, mut p) = (1.0, x);
        for k in 2..=s {
            let k = k as f64;
            (before, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * before) / k);
        }
        slope = s as f64 * (before - x * p) / ((1.0 - x) * (1.0 + x));
        x -= p / slope;
    }
    (0.5 * (1.0 + x), 1.0 / ((1.0 - x) * (1.0 + x) * slope * slope))
}

/// Lagrange's polynomial l_j at t.
fn lagrange(c: &[f64], j: usize, t: f64) -> f64 {
    let others = c.iter().enumerate().filter(|&(k, _)| k != j);
    others.map(|(_, node)| (t - node) / (c[j] - node)).product()
}

/// The derivative of `t l_j(t)/c_j` at the node i.
fn derivative(c: &[f64], j: usize, i: usize) -> f64 {
    let others = || c.iter().enumerate().filter(|&(k, _)| k != j);
    if i == j {
        return 1.0 / c[j] + others().map(|(_, node)| 1.0 / (c[j] - node)).sum::<f64>();
    }
    let rest: f64 = others().filter(|&(k, _)| k != i).map(|(_, node)| c[i] - node).product();
    let whole: f64 = others().map(|(_, node)| c[j] - node).product();
    c[i] / c[j] * rest / whole
}

fn matrix(s: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Vec<f64>> {
    (0..s).map(|i| (0..s).map(|j| entry(i, j)).collect()).collect()
}

fn squared(a: &[Vec<f64>]) -> Vec<Vec<f64>> {
    matrix(a.len(), |i, j| a[i].iter().zip(a).map(|(x, row)| x * row[j]).sum())
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Nodes; 4] = [Nodes::One, Nodes::Two, Nodes::Three, Nodes::Four];

    #[test]
    fn the_tableau_of_two_nodes_is_the_known_one() {
        let table = Collocation::new(Nodes::Two);
        let r = 3_f64.sqrt() / 6.0;
        assert!(
            (table.nodes[0] - (0.5 - r)).abs() < 2e-16 && (table.weights[0] - 0.5).abs() < 2e-16
        );
        let a = [[0.25, 0.25 - r], [0.25 + r, 0.25]];
        for (i, row) in table.square.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                let expected = a[i][0] * a[0][j] + a[i][1] * a[1][j];
                assert!((entry - expected).abs() < 2e-16, "({i}, {j}): {entry}");
            }
        }
    }

    #[test]
    fn the_weights_integrate_polynomials_of_degree_2_s_minus_1_exactly_and_no_higher() {
        for nodes in ALL {
            let Collocation { nodes: c, weights: b, .. } = Collocation::new(nodes);
            for degree in 0..=2 * c.len() as i32 {
                let sum: f64 = c.iter().zip(&b).map(|(c, b)| b * c.powi(degree)).sum();
                let off = (sum - 1.0 / f64::from(degree + 1)).abs();
                assert_eq!(
                    off < 1e-15,
                    degree < 2 * c.len() as i32,
                    "{nodes:?}, {degree}: {off:e}"
                );
            }
        }
    }

    #[test]
    fn the_squares_of_a_and_of_its_inverse_are_inverse() {
        for nodes in ALL {
            let Collocation { square, inverse_square, .. } = Collocation::new(nodes);
            for i in 0..square.len() {
                for j in 0..square.len() {
                    let entry: f64 =
                        square[i].iter().zip(&inverse_square).map(|(a, row)| a * row[j]).sum();
                    assert!((entry - f64::from(u8::from(i == j))).abs() < 1e-12, "{nodes:?}");
                }
            }
        }
    }
}
