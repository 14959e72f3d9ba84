//! How large the terms are that a differential is the sum of, where its argument is rounded.
//!
//! ```text
//! T_i = sum over blocks B of  sum_j |B_ij| |q_j|        dV is known to about eps T
//! s   = max_i sum_j |H_ij| / sqrt(M_ii M_jj)            the scale of the Hessian in the metric
//! ```
//! A configuration is rounded by eps q, which moves the differential by the Hessian times that: no
//! residual can be told from zero below it (Oettli and Prager 1964).

use super::asked::Asked;
use crate::{FIXED, Sink};

/// Adds `|B| |x|` of each block.
pub(super) struct Magnitudes<'a> {
    pub(super) x: &'a [f64],
    pub(super) y: &'a mut [f64],
}

impl Sink for Magnitudes<'_> {
    fn add_symmetric(&mut self, freedoms: &[usize], block: &[f64]) {
        for (&j, column) in freedoms.iter().zip(block.chunks_exact(freedoms.len().max(1))) {
            if j == FIXED {
                continue;
            }
            let x = self.x[j].abs();
            for (&i, entry) in freedoms.iter().zip(column) {
                if i != FIXED {
                    self.y[i] += entry.abs() * x;
                }
            }
        }
    }
}

/// The scale s of the Hessian; 0 where there is none, not finite where the Hessian is not.
pub(super) fn scale(asked: &dyn Asked, q: &[f64]) -> f64 {
    let inverse: Vec<f64> = asked.masses().iter().map(|m| m.sqrt().recip()).collect();
    let mut rows = vec![0.0; inverse.len()];
    asked.magnitudes(q, &inverse, &mut rows);
    let each = rows.iter().zip(&inverse).map(|(row, inverse)| row * inverse);
    crate::hessian_solver::largest_or_nan(each)
}

/// The length of a vector in the metric.
pub(super) fn length(asked: &dyn Asked, v: &[f64], p: &mut [f64]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let unit: Vec<f64> = v.iter().map(|v| v / largest).collect();
    asked.flat(&unit, p);
    largest * dot(p, &unit).sqrt()
}

pub(super) fn dot(x: &[f64], y: &[f64]) -> f64 {
    x.iter().zip(y).map(|(x, y)| x * y).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::equilibrium::asked::Landscape;
    use crate::{Covector, DenseSolver, DiagonalMetric, Potential};

    struct Level;

    impl Potential for Level {
        fn dim(&self) -> usize {
            2
        }

        fn energy(&self, _: &[f64]) -> f64 {
            0.0
        }

        fn add_differential(&self, _: &[f64], _: Covector<&mut [f64]>) {}

        fn add_hessian(&self, _: &[f64], _: &mut impl Sink) {}
    }

    #[test]
    fn the_length_is_that_of_the_metric_at_every_scale() {
        let metric = DiagonalMetric::new([1.0, 4.0]).unwrap();
        let solver = DenseSolver::<[f64; 2]>::new(2).unwrap();
        let level = Landscape::new(&metric, &Level, solver).unwrap();
        for scale in [0.0, 1e-200, 1.0, 1e200] {
            let length = length(&level, &[3.0 * scale, 2.0 * scale], &mut [0.0; 2]);
            assert!((length - 5.0 * scale).abs() <= 1e-15 * length, "{scale}: {length}");
        }
    }
}
