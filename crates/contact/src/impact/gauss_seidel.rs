//! Gauss-Seidel: one contact after another, each with its own restitution.
//!
//! ```text
//! for each i in order:   u = dg_i v,   if u < 0:   v <- v - (1 + c_i) u/d_i M^-1 dg_i^T
//! ```
//! Each impulse is a single impact, so that energy never grows and is kept where `c = 1`. The order
//! of the list decides the answer, and symmetric impacts come out lopsided. Source: notes 11.5.

use stationary_calculus::Vector;

use crate::{Impact, ImpactReport};

pub(crate) fn pass(
    impact: &Impact,
    rounding: f64,
    v: &mut Vector<Vec<f64>>,
    report: &mut ImpactReport,
) {
    for contact in 0..impact.len() {
        if impact.relative_velocity(contact, v.view()) < -rounding {
            let lambda = impact.single_impulse(contact, v.view());
            impact.push(contact, lambda, v.view_mut());
            report.impulses[contact] += lambda;
            report.solves += 1;
        }
    }
}
