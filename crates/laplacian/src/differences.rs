//! The differential of a quadratic energy, by differences along the edges of its matrix.
//!
//! ```text
//! dV(f)_i = sum_j W_ij (f_j - f_i) + s_i f_i + g_i
//! s_i = sum_j W_ij = dV(1)_i - dV(0)_i,     g = dV(0)
//! ```
//! `W` the Hessian (n x n), `f` a function on the freedoms. The same as the sum over elements, for
//! a fraction of its reading: an edge has one number where its triangles have nine each. Where
//! nothing is held s and g are zero, and the differential of a constant is zero to the last bit.

use stationary_calculus::{Covector, Potential, SymmetricMatrix};

/// The matrix, its rows' sums, and the differential at zero.
#[derive(Debug)]
pub(crate) struct Differences {
    matrix: SymmetricMatrix,
    row_sums: Vec<f64>,
    at_zero: Vec<f64>,
}

impl Differences {
    /// Of an energy whose Hessian, the same everywhere, is this matrix.
    pub(crate) fn new(energy: &impl Potential, matrix: SymmetricMatrix) -> Self {
        let at = |value: f64| {
            let mut dv = Covector(vec![0.0; energy.dim()]);
            energy.add_differential(&vec![value; energy.dim()], dv.view_mut());
            dv.0
        };
        let at_zero = at(0.0);
        let row_sums = at(1.0).iter().zip(&at_zero).map(|(one, zero)| one - zero).collect();
        Differences { matrix, row_sums, at_zero }
    }

    /// Writes the differential at `f`.
    pub(crate) fn differential(&self, f: &[f64], dv: &mut [f64]) {
        for (i, dv) in dv.iter_mut().enumerate() {
            *dv = self.row_sums[i] * f[i] + self.at_zero[i];
        }
        let (rows, values) = (self.matrix.rows(), self.matrix.values());
        for (j, ends) in self.matrix.column_starts().windows(2).enumerate() {
            let below = ends[0] as usize + 1..ends[1] as usize;
            let here = f[j];
            let mut sum = 0.0;
            for (&i, w) in rows[below.clone()].iter().zip(&values[below]) {
                let flow = w * (f[i as usize] - here);
                sum += flow;
                dv[i as usize] -= flow;
            }
            dv[j] += sum;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Domain, Elements};
    use stationary_mesh::{Diagonals, rectangle};

    #[test]
    fn differences_give_the_differential_of_the_energy_and_of_a_constant_nothing() {
        let mesh = rectangle([1.0, 2.0], [7, 5], Diagonals::Crossed).unwrap();
        let elements = Elements::of(&mesh).unwrap();
        for held in [&[][..], &[(3, 2.0), (20, -1.0)]] {
            let domain = Domain::held(elements.clone(), held).unwrap();
            let n = domain.dim();
            let matrix = SymmetricMatrix::hessian(domain.dirichlet(), &vec![0.0; n]).unwrap();
            let differences = Differences::new(domain.dirichlet(), matrix);
            let f: Vec<f64> = (0..n).map(|k| (k as f64).sin()).collect();
            let (mut dv, mut exact) = (vec![1.0; n], Covector(vec![0.0; n]));
            differences.differential(&f, &mut dv);
            domain.dirichlet().add_differential(&f, exact.view_mut());
            assert!(dv.iter().zip(&exact.0).all(|(a, b)| (a - b).abs() < 1e-13));
            differences.differential(&vec![0.7; n], &mut dv);
            assert!(held.len() == 2 || dv.iter().all(|x| *x == 0.0));
        }
    }
}
