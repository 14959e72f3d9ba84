//! How large the terms are that a differential is the sum of, where its argument is rounded.
//!
//! ```text
//! T_i = sum over blocks B of  sum_j |B_ij| |q_j|        dV is known to about eps T
//! s   = max_i sum_j |H_ij| / sqrt(M_ii M_jj)            the scale of the Hessian in the metric
//! ```
//! A configuration is rounded by eps q, which moves the differential by the Hessian times that: no
//! residual can be told from zero below it (Oettli and Prager 1964).

use crate::hessian_solver::Diagonal;
use crate::{FIXED, Metric, Potential, Sink, Vector};

/// Adds `|B| |x|` of each block.
struct Magnitudes<'a> {
    x: &'a [f64],
    y: &'a mut [f64],
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

/// Writes `|H| |x|` block by block into y.
pub(super) fn magnitudes(potential: &impl Potential, q: &[f64], x: &[f64], y: &mut [f64]) {
    y.fill(0.0);
    potential.add_hessian(q, &mut Magnitudes { x, y });
}

/// The scale s of the Hessian; 0 where there is none, not finite where the Hessian is not.
pub(super) fn scale(metric: &impl Metric, potential: &impl Potential, q: &[f64]) -> f64 {
    let n = metric.dim();
    let (mut mass, mut rows) = (vec![0.0; n], vec![0.0; n]);
    metric.add_matrix(&mut Diagonal { weight: 1.0, values: &mut mass });
    let roots: Vec<f64> = mass.iter().map(|m| m.sqrt()).collect();
    let inverse: Vec<f64> = roots.iter().map(|root| root.recip()).collect();
    magnitudes(potential, q, &inverse, &mut rows);
    let each = rows.iter().zip(&inverse).map(|(row, inverse)| row * inverse);
    crate::hessian_solver::largest_or_nan(each)
}

/// The length of a vector in the metric.
pub(super) fn length(metric: &impl Metric, v: &[f64], p: &mut [f64]) -> f64 {
    let largest = v.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    if largest == 0.0 || !largest.is_finite() {
        return largest;
    }
    let unit: Vec<f64> = v.iter().map(|v| v / largest).collect();
    metric.flat(Vector(&unit), crate::Covector(&mut *p));
    largest * crate::Covector(p).apply(&Vector(&unit)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::DiagonalMetric;

    #[test]
    fn the_length_is_that_of_the_metric_at_every_scale() {
        let metric = DiagonalMetric::new([1.0, 4.0]).unwrap();
        for scale in [0.0, 1e-200, 1.0, 1e200] {
            let length = length(&metric, &[3.0 * scale, 2.0 * scale], &mut [0.0; 2]);
            assert!((length - 5.0 * scale).abs() <= 1e-15 * length, "{scale}: {length}");
        }
    }
}
