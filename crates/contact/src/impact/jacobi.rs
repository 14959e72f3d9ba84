//! Jacobi: every contact at once, each as if it were alone.
//!
//! ```text
//! lambda_i = -(1 + c_i) u_i/d_i where u_i < 0,   v <- v + M^-1 sum lambda_i dg_i^T
//! ```
//! No order is chosen. Contacts that share a body count its momentum twice: energy may be lost or
//! gained whatever the restitution (a wall listed twice turns -1 into +3). Source: notes 11.5,
//! errata 11.5.

use stationary_calculus::Vector;

use crate::{Impact, ImpactReport};

pub(crate) fn pass(
    impact: &Impact,
    rounding: f64,
    v: &mut Vector<Vec<f64>>,
    report: &mut ImpactReport,
) {
    let approaching = |&i: &usize| impact.relative_velocity(i, v.view()) < -rounding;
    let impulses: Vec<_> = (0..impact.len())
        .filter(approaching)
        .map(|contact| (contact, impact.single_impulse(contact, v.view())))
        .collect();
    for (contact, lambda) in impulses {
        impact.push(contact, lambda, v.view_mut());
        report.impulses[contact] += lambda;
        report.solves += 1;
    }
}
