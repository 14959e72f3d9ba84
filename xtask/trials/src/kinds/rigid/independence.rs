//! How independent the equations of a linkage are, masses counted.
//!
//! ```text
//! sigma(D^-1 J M^-1/2) over the longest row that would be normal, 1/sqrt(m)
//! ```
//! `J` the differential, `D` the slopes of the equations, `M` masses and moments, `m` the largest of them
//! that an equation touches.

use nalgebra::DMatrix;
use stationary_constraints::{Constraint, Rows};
use stationary_rigid::Body;

/// Below this part of the largest a singular value is rounding of zero.
const ZERO: f64 = 1e-11;

struct Weighted<'a> {
    roots: &'a [f64],
    rows: DMatrix<f64>,
    normal: f64,
}

impl Rows for Weighted<'_> {
    fn add(&mut self, row: usize, freedom: usize, value: f64) {
        self.rows[(row, freedom)] += value / self.roots[freedom];
    }
}

/// The smallest singular value that is not zero, over a normal one.
pub(super) fn independence(bodies: &[Body], joints: &impl Constraint, q: &[f64]) -> f64 {
    let of_body = |body: &Body| {
        let [mass, moments] = [[body.mass(); 3], body.moments().into()];
        mass.into_iter().chain(moments).map(f64::sqrt)
    };
    let roots: Vec<f64> = bodies.iter().flat_map(of_body).collect();
    let rows = DMatrix::zeros(joints.count(), roots.len());
    let mut weighted = Weighted { roots: &roots, rows, normal: 0.0 };
    if joints.differential(0.0, q, &mut weighted).is_err() {
        return 0.0;
    }
    for (k, mut row) in weighted.rows.row_iter_mut().enumerate() {
        row /= joints.scale(k).slope;
        let touched = row.iter().zip(&roots).filter(|(entry, _)| **entry != 0.0);
        let largest = touched.map(|(_, root)| *root).fold(0.0, f64::max);
        weighted.normal = weighted.normal.max(largest.recip());
    }
    let sigma = weighted.rows.svd(false, false).singular_values;
    let zero = ZERO * sigma.max();
    sigma.iter().filter(|&&s| s > zero).fold(f64::INFINITY, |a, &s| a.min(s)) / weighted.normal
}
