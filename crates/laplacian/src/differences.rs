//! The differential of a quadratic energy, by differences along the edges of its matrix.
//!
//! ```text
//! dV(f)_i = sum_j W_ij (f_j - f_i) + s_i f_i + g_i
//! s_i = sum_j W_ij = sum over elements of (row i of W - what is coupled to held values),  g = dV(0)
//! ```
//! `W` the Hessian (n x n), `f` a function on the freedoms. The same as the sum over elements, for
//! a fraction of its reading: an edge has one number where its triangles have nine each. Where
//! nothing is held s and g are zero, and the differential of a constant is zero to the last bit. Sums
//! of rows come from the elements' matrices: held values may be of any size against 1.

use stationary_calculus::{Covector, FIXED, Potential, Sink, SymmetricMatrix};

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
        let zero = vec![0.0; energy.dim()];
        let mut at_zero = Covector(zero.clone());
        energy.add_differential(&zero, at_zero.view_mut());
        let mut sums = RowSums(zero.clone());
        energy.add_hessian(&zero, &mut sums);
        Differences { matrix, row_sums: sums.0, at_zero: at_zero.0 }
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

/// The sums of a matrix's rows over the freedoms.
struct RowSums(Vec<f64>);

/// A whole row of an element that adds up to less than this part of its sizes adds up to nothing.
const ROUNDING: f64 = 8.0 * f64::EPSILON;

impl Sink for RowSums {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        // The block is symmetric: its columns are its rows.
        for (&freedom, row) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            if freedom == FIXED {
                continue;
            }
            let (whole, size) = (row.iter().sum::<f64>(), row.iter().map(|w| w.abs()).sum::<f64>());
            let coupled = freedoms.iter().zip(row).filter(|(other, _)| **other == FIXED);
            // Not the rest of the row, which may be far larger than what it adds up to.
            self.0[freedom] -= coupled.map(|(_, w)| w).sum::<f64>();
            if whole.abs() > ROUNDING * size {
                self.0[freedom] += whole;
            }
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

    #[test]
    fn what_is_as_warm_as_all_that_is_held_gains_nothing_at_any_warmth() {
        let mesh = rectangle([1.0, 2.0], [7, 5], Diagonals::Crossed).unwrap();
        let mesh = mesh.mapped(|x| x + x.yx() * (0.1 * x.x)).unwrap();
        for warmth in [1.0, 1e6, 1e15, 1e18] {
            let held = [(0, warmth), (3, warmth), (20, warmth)];
            let domain = Domain::held(Elements::of(&mesh).unwrap(), &held).unwrap();
            let n = domain.dim();
            let matrix = SymmetricMatrix::hessian(domain.dirichlet(), &vec![0.0; n]).unwrap();
            let largest = matrix.values().iter().fold(0.0_f64, |most, w| most.max(w.abs()));
            let mut dv = vec![0.0; n];
            Differences::new(domain.dirichlet(), matrix).differential(&vec![warmth; n], &mut dv);
            assert!(dv.iter().all(|dv| dv.abs() < 1e-15 * largest * warmth), "{warmth}: {dv:?}");
        }
    }
}
